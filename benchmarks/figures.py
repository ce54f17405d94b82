"""Draw every figure of trials of all kinds at all widths and tell what is wrong: ``python benchmarks/figures.py``.

``--pictures DIR`` keeps them as PNG to look at, ``--figures``, ``--kinds`` and ``--widths`` take some of them alone.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent / "tests" / "support"))

from drawn_trials import KINDS, drawn_trial
from ink import faults_of

from elbowscrew.plots.layout import settle
from elbowscrew.plots.registry import FIGURES
from elbowscrew.plots.style import publication_style
from elbowscrew.view.figure_names import FIGURE_ENTRIES, has_figure

WIDTHS_MM = (60.0, 70.0, 85.0, 120.0, 170.0, 180.0)


def main() -> int:
    """Draw them; 1 if anything is wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pictures", type=Path)
    parser.add_argument("--dpi", type=int, default=110)
    parser.add_argument("--figures", nargs="*", default=list(FIGURE_ENTRIES))
    parser.add_argument("--kinds", nargs="*", default=list(KINDS))
    parser.add_argument("--widths", nargs="*", type=float, default=list(WIDTHS_MM))
    asked = parser.parse_args()
    drawn, wrong, started = 0, 0, time.process_time()
    for kind in asked.kinds:
        view = drawn_trial(kind)
        for name in (name for name in asked.figures if has_figure(name, view)):
            for width in asked.widths:
                with publication_style():
                    figure = FIGURES[name](view, width_mm=width)
                    settle(figure)
                    faults = faults_of(figure)
                    if asked.pictures is not None:
                        asked.pictures.mkdir(exist_ok=True)
                        target = asked.pictures / f"{name}_{kind.replace(' ', '_')}_{width:g}.png"
                        figure.savefig(target, dpi=asked.dpi)
                drawn, wrong = drawn + 1, wrong + bool(faults)
                if faults:
                    print(f"{name}, {kind}, {width:g} mm: {'; '.join(faults)}", flush=True)
    print(f"{drawn} figures, {wrong} of them with faults; {time.process_time() - started:.0f} s of CPU")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
