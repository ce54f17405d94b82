"""Pages and publication figures of finished results; nothing here analyzes anything.

Everything is imported where it is used: an analysis starts without the template engine.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from elbowscrew.errors import ElbowscrewError, ResultError, files_beside

if TYPE_CHECKING:
    from elbowscrew.model.mesh import Mesh


def write_trial_page(folder: Path, meshes: Mapping[str, Mesh] | None = None) -> Path:
    """Write ``report.html`` of one result folder, whole or not at all.

    Parameters
    ----------
    folder : Path
        As `elbowscrew.save_analysis` wrote it. A page of ours is replaced, and its digest in ``SHA256SUMS``.
    meshes : mapping of str to Mesh, optional
        Bones to draw, by the segment or the name of their body; they are kept in ``meshes.json``. Those of the result
        by default.

    Returns
    -------
    Path
        The page.

    Raises
    ------
    ResultError
        If the folder holds no finished result, or a damaged one.
    UsageError
        If a mesh is of no body of the trial.
    OutputError
        If something else has the page's name, or the disk does not take it.
    """
    from elbowscrew.report.trial_page import write_trial_page as write

    return write(folder, meshes)


def write_study_page(folder: Path) -> Path:
    """Write ``index.html`` over all result folders inside a folder, with ``cycles.csv`` and ``repetitions.csv``.

    Whole or not at all.

    Results that cannot be read stand there as failures.

    Parameters
    ----------
    folder : Path
        Of a batch, with ``summary.csv`` and ``failures.csv`` if there; or any that holds result folders, however deep.

    Returns
    -------
    Path
        The page.

    Raises
    ------
    ResultError
        If there are neither results nor failures.
    OutputError
        If something else has the page's name, or the disk does not take it.
    """
    from elbowscrew.report.study_page import write_study_page as write

    return write(folder).page


class Remade(NamedTuple):
    """Pages and tables that were made, and why some could not be, or show a trial as failed: that stops no other."""

    files: tuple[Path, ...]
    errors: tuple[ElbowscrewError, ...]


def remake_pages(
    folders: Iterable[Path],
    report: Callable[[int, int], None] = lambda _done, _total: None,
    meshes: Mapping[str, Mesh] | None = None,
) -> Remade:
    """Make the pages of result folders anew; in a folder that holds some, theirs and the one over all of them.

    Parameters
    ----------
    folders : iterable of Path
    report : callable, optional
        Called with how many results have their page, and how many there are.
    meshes : mapping of str to Mesh, optional
        Bones to draw in the page of each result.

    Returns
    -------
    Remade

    Raises
    ------
    ResultError
        If a folder neither is nor holds a finished result.
    """
    from elbowscrew.report.study_page import not_shown
    from elbowscrew.report.study_page import write_study_page as write_index
    from elbowscrew.results.trial_views import is_result

    files: list[Path] = []
    errors: list[ElbowscrewError] = []
    inside = [(folder, results_in([folder])) for folder in folders]
    total = sum(len(results) for _, results in inside)
    done = count(1)
    report(0, total)
    for folder, results in inside:
        told: set[Path] = set()
        for result in results:
            try:
                files.append(write_trial_page(result, meshes))
            except ElbowscrewError as error:
                errors.append(error)
                told.add(result)
            report(next(done), total)
        try:
            if not is_result(folder):
                study = write_index(folder)
                files += [study.page, *study.tables]
                errors += [
                    ResultError(not_shown(study.page, one)) for one in study.unread if folder / one.path not in told
                ]
        except ElbowscrewError as error:
            errors.append(error)
    return Remade(tuple(dict.fromkeys(files)), tuple(errors))


def results_in(folders: Iterable[Path]) -> tuple[Path, ...]:
    """Find the result folders among folders and inside them, each once.

    Raises
    ------
    ResultError
        If a folder neither is nor holds a finished result.
    """
    from elbowscrew.report.study import result_folders
    from elbowscrew.results.trial_views import is_result

    found = []
    for folder in folders:
        inside = [folder] if is_result(folder) else list(result_folders(folder))
        if not inside:
            what = (
                "holds no finished result" if folder.is_dir() else f"no such folder{files_beside(folder, folders=True)}"
            )
            msg = f"{folder}: {what}; analyze trials first, and give the folders that were written"
            raise ResultError(msg)
        found += inside
    return tuple(dict.fromkeys(found))
