"""Figures as the bytes of files: the same result gives the same bytes."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, Final

from matplotlib.figure import Figure

from elbowscrew.model.shown import Shown
from elbowscrew.plots.figures import FIGURES, WIDTH_MM, MakeFigure
from elbowscrew.plots.paper_figures import PAPER_FIGURES
from elbowscrew.plots.style import publication_style, settle

# Without dates and program versions the same analysis gives the same bytes.
_METADATA: Final[dict[str, dict[str, Any]]] = {
    "png": {"Software": None},
    "svg": {"Date": None, "Creator": None},
    "pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}
# A third less time for a tenth more bytes.
_ENCODING: Final[dict[str, dict[str, Any]]] = {"png": {"pil_kwargs": {"compress_level": 3}}, "svg": {}, "pdf": {}}
_FIGURES: Final[dict[str, MakeFigure]] = {**FIGURES, **PAPER_FIGURES}


def figure_files(
    shown: Shown, names: Sequence[str], formats: Sequence[str], width_mm: float = WIDTH_MM
) -> dict[str, bytes]:
    """Draw figures of a trial.

    Parameters
    ----------
    shown : Shown
        An analysis, or a result read back.
    names : sequence of str
        Of `elbowscrew.plots.FIGURES` or `elbowscrew.plots.paper_figures.PAPER_FIGURES`.
    formats : sequence of {"png", "svg", "pdf"}
    width_mm : float
        Width on paper; the fonts keep their size.

    Returns
    -------
    dict of str to bytes
        Files by name, as in ``theta.png``.
    """
    return files_of({name: partial(_FIGURES[name], shown, width_mm=width_mm) for name in names}, formats)


def files_of(drawings: Mapping[str, Callable[[], Figure]], formats: Sequence[str]) -> dict[str, bytes]:
    """Draw and save figures, one at a time, in all formats."""
    files = {}
    with publication_style():
        for name, draw in drawings.items():
            figure = draw()
            settle(figure)
            for kind in formats:
                stream = io.BytesIO()
                figure.savefig(stream, format=kind, metadata=_METADATA[kind], **_ENCODING[kind])
                files[f"{name}.{kind}"] = stream.getvalue()
    return files
