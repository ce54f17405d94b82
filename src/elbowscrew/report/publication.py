"""Publication figures of finished results, of each trial and of all of them together."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Final, NamedTuple

from elbowscrew.errors import SettingError
from elbowscrew.report.captions import overlay_caption
from elbowscrew.report.figure_files import figure_files, files_of
from elbowscrew.results.staging import settle, write_files
from elbowscrew.results.trial_views import view_of_result
from elbowscrew.view.figure_names import OVERLAY, caption_file, chosen_figures, has_figure

_LONGEST_NAME: Final = 80


class Published(NamedTuple):
    """The files written, and what was not.

    Attributes
    ----------
    files : tuple of Path
    left_out : tuple of Path
        Results that an overlay had to leave out, as they have no movement out and back.
    not_drawn : tuple of (Path, str)
        Results, and the figures asked for that they have nothing for.
    """

    files: tuple[Path, ...]
    left_out: tuple[Path, ...]
    not_drawn: tuple[tuple[Path, str], ...]


def save_publication_figures(
    results: Sequence[Path],
    folder: Path,
    names: Sequence[str],
    formats: Sequence[str],
    *,
    width_mm: float,
    font: str | None = None,
    force: bool = False,
    report: Callable[[int, int], None] = lambda _done, _total: None,
) -> Published:
    """Write figures of results, all of them or none.

    Parameters
    ----------
    results : sequence of Path
        Result folders; of several, the name of each begins the names of its files.
    folder : Path
        Where to; it is made.
    names : sequence of str
        Of the figures of a trial, and ``overlay`` for one of all of them.
    formats : sequence of {"png", "svg", "pdf", "tiff", "eps"}
    width_mm : float
        Width on paper.
    font : str, optional
        Family of the letters; that of each trial's settings by default.
    force : bool
        Replace files of these names.
    report : callable, optional
        Called with how many results are drawn, and how many there are.

    Returns
    -------
    Published

    Raises
    ------
    ResultError
        If a result cannot be read.
    SettingError
        If an overlay is asked for and fewer than two results have a movement out and back.
    OutputError
        If a file is there already, or the disk does not take them.
    """
    from elbowscrew.plots.overlay import LEAST_TRIALS, mean_curve, overlay_figure

    contents: dict[str, bytes] = {}
    single = chosen_figures(names)
    prefixes = _prefixes(results)
    curves, left_out, not_drawn, units = [], [], [], set()
    for done, (result, prefix) in enumerate(zip(results, prefixes, strict=True)):
        report(done, len(results))
        settle(result)
        trial = view_of_result(result, single)
        not_drawn += [(result, name) for name in single if not has_figure(name, trial)]
        for name, content in figure_files(trial, single, formats, width_mm, font).items():
            contents[f"{prefix}{name}"] = content
        if OVERLAY in names:
            curve = mean_curve(trial)
            if curve is None:
                left_out.append(result)
            else:
                curves.append(curve)
                units.add(trial.settings.angle_unit)
    if OVERLAY in names:
        if len(curves) < LEAST_TRIALS:
            msg = (
                f"--figures overlay: expected at least {LEAST_TRIALS} results with a movement out and back "
                f"(repetitions.csv), found {len(curves)} of {len(results)}; give more results, or leave overlay out"
            )
            raise SettingError(msg)
        unit = units.pop() if len(units) == 1 else "deg"
        drawn = files_of({OVERLAY: partial(overlay_figure, curves, width_mm=width_mm, unit=unit)}, formats, font)
        cycles = sum(curve.cycles for curve in curves)
        contents |= drawn | {caption_file(OVERLAY): overlay_caption(len(curves), cycles, unit).encode()}
    write_files(folder, contents, replaceable=("",) if force else None)
    return Published(tuple(folder / name for name in contents), tuple(left_out), tuple(not_drawn))


def _prefixes(results: Sequence[Path]) -> list[str]:
    """Names of files begin with that of their result, made safe for any disk, and numbered where two are alike."""
    if len(results) == 1:
        return [""]
    prefixes: list[str] = []
    seen: dict[str, int] = {}
    for result in results:
        plain = unicodedata.normalize("NFC", result.resolve().name.removesuffix("_elbowscrew"))
        stem = re.sub(r"[^\w.+-]+", "_", plain).strip("._")[:_LONGEST_NAME] or "trial"
        seen[stem.casefold()] = seen.get(stem.casefold(), 0) + 1
        count = seen[stem.casefold()]
        prefixes.append(f"{stem}_" if count == 1 else f"{stem}~{count}_")
    return prefixes
