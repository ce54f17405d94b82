"""Publication figures of finished results, of each trial and of all of them together."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final, NamedTuple

from elbowscrew.choices import OverlayBy
from elbowscrew.report.figure_files import figure_files
from elbowscrew.report.overlays import OverlayOfTrials, overlay_of_groups
from elbowscrew.results.staging import settle, write_files
from elbowscrew.results.trial_views import view_of_result
from elbowscrew.view.figure_names import OVERLAY, chosen_figures, has_figure

_LONGEST_NAME: Final = 80


class Published(NamedTuple):
    """The files written, and what was not.

    Attributes
    ----------
    files : tuple of Path
    left_out : tuple of Path
        Results that an overlay had to leave out: without a whole movement out and back, or without the condition or
        subject that it is by.
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
    by: OverlayBy | None = None,
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
    by : {"condition", "subject"}, optional
        What the overlay shows: the conditions' means, or the subjects of each; all trials by default.
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
        If an overlay is asked for and fewer than two results have a movement out and back, or nothing says the
        conditions or subjects that it is to be by.
    OutputError
        If a file is there already, or the disk does not take them.
    """
    contents: dict[str, bytes] = {}
    single = chosen_figures(names)
    overlay = OverlayOfTrials() if OVERLAY in names and by is None else None
    tables = (*single, "cycles") if overlay is not None else single  # that figure needs the table of cycles, too
    not_drawn = []
    for done, (result, prefix) in enumerate(zip(results, _prefixes(results), strict=True)):
        report(done, len(results))
        settle(result)
        if not tables:
            continue
        trial = view_of_result(result, tables)
        not_drawn += [(result, name) for name in single if not has_figure(name, trial)]
        for name, content in figure_files(trial, single, formats, width_mm, font).items():
            contents[f"{prefix}{name}"] = content
        if overlay is not None:
            overlay.add(result, trial)
    drawn = None
    if overlay is not None:
        drawn = overlay.drawn(formats, width_mm, font)
    elif by is not None:
        drawn = overlay_of_groups(results, by, formats, width_mm, font)
    contents |= {} if drawn is None else drawn.files
    write_files(folder, contents, replaceable=("",) if force else None)
    left_out = () if drawn is None else drawn.left_out
    return Published(tuple(folder / name for name in contents), left_out, tuple(not_drawn))


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
