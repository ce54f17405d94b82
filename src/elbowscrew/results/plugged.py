"""Exporters of other distributions: found by their entry points, each with a folder of its own in the result."""

from __future__ import annotations

import contextlib
import copy
import re
import tempfile
from collections.abc import Callable, Collection, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Protocol

from elbowscrew import plug_ins
from elbowscrew.choices import AngleUnit, LengthUnit
from elbowscrew.errors import UsageError
from elbowscrew.model.joint_summary_types import JointSummary
from elbowscrew.model.summary_types import Summary, WarningSummary
from elbowscrew.model.table_record import TableRecord
from elbowscrew.opening import write_new

if TYPE_CHECKING:
    import pandas as pd

FOLDER: Final = "exports"
"""Folder of a result that has one for each exporter."""

_FILE: Final = r"[A-Za-z0-9][A-Za-z0-9._-]*"
_NAME: Final = re.compile(r"[a-z0-9][a-z0-9_-]*")
_DEVICES: Final = frozenset({"con", "prn", "aux", "nul", *(f"{port}{k}" for port in ("com", "lpt") for k in range(10))})
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
    if not _NAME.fullmatch(name) or _is_device(name):
        msg = (
            f"{plug_ins.told(plug_ins.EXPORTERS, name)}: its name is that of a folder: expected a-z, 0-9, - and _, "
            "and no device of Windows"
        )
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
        try:
            files = _written(name, _Trial(tables, summary, joint))
        except (Exception, SystemExit) as error:  # whatever a plug-in may do
            why = str(error) if isinstance(error, UsageError) else plug_ins.brief(error)
            failed.append(_warning(f"the export {name!r}, of a plug-in, was not written: {why}"))
            continue
        place = folder / FOLDER / name
        place.mkdir(parents=True)
        for file, content in files.items():
            write_new(place / file, content)
    return failed


def _written(name: str, trial: ExportedTrial) -> dict[str, bytes]:
    """Let an exporter write where nothing else of the result is, and give its files.

    Raises
    ------
    UsageError
        If it has left nothing, or what a result cannot hold.
    """
    write = exporter(name)
    with contextlib.chdir("."), tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as room:
        place = Path(room) / "result" / FOLDER / name  # as deep as in a result: what goes up from it stays in the room
        place.mkdir(parents=True)
        write(trial, place)
        others = [one for one in Path(room).rglob("*") if one not in place.parents and place not in (one, *one.parents)]
        if others or place.is_symlink() or not place.is_dir():
            msg = "it wrote outside its folder, or removed it"
            raise UsageError(msg)
        left = sorted(place.iterdir())
        _check(left)
        return {one.name: one.read_bytes() for one in left}


def missing(names: Sequence[str], files: Collection[str]) -> tuple[str, ...]:
    """Give the exporters of which a result has no file."""
    return tuple(name for name in names if not any(file.startswith(f"{FOLDER}/{name}/") for file in files))


FAILED: Final = "export-failed"
"""Code of the warning."""


def _warning(message: str) -> WarningSummary:
    return {"code": FAILED, "severity": "warning", "message": message, "frames": [], "count": 0}


def _check(left: Sequence[Path]) -> None:
    """Raise `UsageError` if an exporter has left nothing, or what a result cannot hold on every system."""
    if not left:
        msg = "it wrote no file"
        raise UsageError(msg)
    for one in left:
        if one.is_symlink() or not one.is_file() or not re.fullmatch(_FILE, one.name):
            msg = f"it left {one.name!r}: expected files alone, their names of letters, digits and . _ -"
            raise UsageError(msg)
        if _is_device(one.name) or one.name.endswith("."):
            msg = f"it left {one.name!r}, which is no name of a file on Windows; give another"
            raise UsageError(msg)
    names = [one.name.casefold() for one in left]
    again = next((one.name for one in left if names.count(one.name.casefold()) > 1), None)
    if again is not None:
        msg = f"it left {again!r} twice but for the case of letters, which Windows and macOS do not tell apart"
        raise UsageError(msg)


def _is_device(name: str) -> bool:
    return name.partition(".")[0].casefold() in _DEVICES
