"""Exporters of other distributions: found by their entry points, each with a folder of its own in the result."""

from __future__ import annotations

import copy
import re
import shutil
from collections.abc import Callable, Collection, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Protocol

from elbowscrew import plug_ins
from elbowscrew.choices import AngleUnit, LengthUnit
from elbowscrew.errors import UsageError
from elbowscrew.model.joint_summary_types import JointSummary
from elbowscrew.model.summary_types import Summary, WarningSummary
from elbowscrew.model.table_record import TableRecord

if TYPE_CHECKING:
    import pandas as pd

FOLDER: Final = "exports"
"""Folder of a result that has one for each exporter."""

_FILE: Final = r"[A-Za-z0-9][A-Za-z0-9._-]*"
_NAME: Final = re.compile(r"[a-z0-9][a-z0-9_-]*")
_PLACED: Final = re.compile(rf"{FOLDER}/{_FILE}/{_FILE}")


class ExportedTrial(Protocol):
    """What an exporter is given of a trial; `elbowscrew.Analysis` has the same, one read back as well.

    An exporter may change all of it: it has copies.

    Attributes
    ----------
    tables : collection of str
        Names of the tables that this trial has, as ``screw``.
    summary, joint_summary : dict
        What stands in ``summary.json`` and ``joint.json``.
    """

    @property
    def tables(self) -> Collection[str]: ...  # noqa: D102 - above

    @property
    def summary(self) -> Summary: ...  # noqa: D102

    @property
    def joint_summary(self) -> JointSummary: ...  # noqa: D102

    def to_frame(
        self, table: Any = "screw", angle_unit: AngleUnit = "deg", length_unit: LengthUnit = "mm"
    ) -> pd.DataFrame:
        """Give a table as a pandas data frame, with the names of its CSV."""


class _Trial:
    """An `ExportedTrial` of tables."""

    def __init__(self, tables: Mapping[str, TableRecord], summary: Summary, joint: JointSummary) -> None:
        self._tables = tables
        self.tables = tuple(tables)
        self.summary = copy.deepcopy(summary)
        self.joint_summary = copy.deepcopy(joint)

    def to_frame(
        self, table: str = "screw", angle_unit: AngleUnit = "deg", length_unit: LengthUnit = "mm"
    ) -> pd.DataFrame:
        return self._tables[table].to_frame(angle_unit, length_unit)


def is_placed(name: str) -> bool:
    """Whether a path inside a result is that of an exporter's file."""
    return _PLACED.fullmatch(name) is not None


def exporter(name: str) -> Callable[[ExportedTrial, Path], object]:
    """Load an exporter.

    Raises
    ------
    UsageError
        If there is none of that name, or it cannot be loaded or called.
    """
    if name not in plug_ins.names(plug_ins.EXPORTERS):
        msg = f"export: there is no exporter {name!r} here; install the distribution that brings it"
        raise UsageError(msg)
    if not _NAME.fullmatch(name):
        msg = f"{plug_ins.told(plug_ins.EXPORTERS, name)}: its name is that of a folder: expected a-z, 0-9, - and _"
        raise UsageError(msg)
    found = plug_ins.loaded(plug_ins.EXPORTERS, name, object)
    if not callable(found):
        msg = f"{plug_ins.told(plug_ins.EXPORTERS, name)}: expected a function, found {type(found).__name__}"
        raise UsageError(msg)
    return found


def write_by_plug_ins(
    folder: Path,
    names: Sequence[str],
    tables: Mapping[str, TableRecord],
    summary: Summary,
    joint: JointSummary,
) -> list[WarningSummary]:
    """Let exporters write, each into its own folder; what one leaves that fails is removed, and told in a warning.

    Parameters
    ----------
    folder : Path
        The result.
    names : sequence of str
    tables : mapping of str to TableRecord
    summary, joint : dict

    Raises
    ------
    OSError
        If the disk does not take the folders.
    """
    failed: list[WarningSummary] = []
    for name in names:
        place = folder / FOLDER / name
        place.mkdir(parents=True)
        try:
            exporter(name)(_Trial(tables, summary, joint), place)
            _check(place)
        except (Exception, SystemExit) as error:  # whatever a plug-in may do
            shutil.rmtree(place)
            why = str(error) if isinstance(error, UsageError) else plug_ins.brief(error)
            failed.append(_warning(f"the export {name!r}, of a plug-in, was not written: {why}"))
    if names and not any((folder / FOLDER).iterdir()):
        (folder / FOLDER).rmdir()
    return failed


def missing(names: Sequence[str], files: Collection[str]) -> tuple[str, ...]:
    """Give the exporters of which a result has no file."""
    return tuple(name for name in names if not any(file.startswith(f"{FOLDER}/{name}/") for file in files))


FAILED: Final = "export-failed"
"""Code of the warning."""


def _warning(message: str) -> WarningSummary:
    return {"code": FAILED, "severity": "warning", "message": message, "frames": [], "count": 0}


def _check(place: Path) -> None:
    """Raise `UsageError` if an exporter has left nothing, or what a result cannot hold."""
    left = list(place.iterdir())
    if not left:
        msg = "it wrote no file"
        raise UsageError(msg)
    for one in left:
        if one.is_symlink() or not one.is_file() or not re.fullmatch(_FILE, one.name):
            msg = f"it left {one.name!r}: expected files alone, their names of letters, digits and . _ -"
            raise UsageError(msg)
