"""Pages and publication figures of finished results; nothing here analyzes anything.

Everything is imported where it is used: an analysis starts without the template engine.
"""

from __future__ import annotations

from pathlib import Path


def write_trial_page(folder: Path) -> Path:
    """Write ``report.html`` of one result folder, whole or not at all.

    Parameters
    ----------
    folder : Path
        As `elbowscrew.save_analysis` wrote it. A page of ours is replaced.

    Returns
    -------
    Path
        The page.

    Raises
    ------
    ResultError
        If the folder holds no finished result, or a damaged one.
    OutputError
        If something else has the page's name, or the disk does not take it.
    """
    from elbowscrew.report.trial_page import write_trial_page as write

    return write(folder)


def write_study_page(folder: Path) -> Path:
    """Write ``index.html`` over all result folders inside a folder, whole or not at all.

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

    return write(folder)
