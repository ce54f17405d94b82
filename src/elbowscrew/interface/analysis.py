"""What `elbowscrew.analyze` gives, and `elbowscrew.read_result` of its files: numbers, tables, plots, and a display."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal, get_args

from elbowscrew._version import __version__
from elbowscrew.choices import AngleUnit, LengthUnit
from elbowscrew.errors import NotKeptError, UsageError, did_you_mean
from elbowscrew.interface.listed import joint_estimates, listed_warnings
from elbowscrew.interface.python_words import in_python
from elbowscrew.model import Analysis as Findings
from elbowscrew.model.array_record import html_table
from elbowscrew.model.joint_summary_types import JointSummary
from elbowscrew.model.summary_types import Summary
from elbowscrew.model.table_record import TableRecord
from elbowscrew.results.joint_summary import joint_summary
from elbowscrew.results.kept import read_kept
from elbowscrew.results.summary import summary_from_analysis
from elbowscrew.results.trial_views import Viewed, view_of_analysis
from elbowscrew.results.writing import results_by_table
from elbowscrew.view.figure_names import FIGURE_ENTRIES
from elbowscrew.view.trial_view import TrialView

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from elbowscrew.interface.calls import StrPath
    from elbowscrew.interface.plotting import Plots
    from elbowscrew.interface.space import SpaceView
    from elbowscrew.model import Mesh

TableName = Literal[
    "screw", "interpolation", "keyframes", "instantaneous", "steps", "repetitions", "cycles", "repetition_curve",
    "anatomy", "joint_angles", "axis_path", "joint", "warnings",
]  # fmt: skip
"""Tables of a result: those that are files, of their names, and the joint's estimates and the warnings."""

_OF_FRAMES: Final = ("interpolation", "instantaneous", "joint_angles", "anatomy")
_WHERE: Final = "; numbers stand in to_frame(), summary and joint_summary, and elbowscrew.save_analysis writes them"
_PARTS: Final = tuple(field.name for field in fields(Findings))


class Analysis(Findings, Viewed):  # noqa: D101 - it has one
    __doc__ = f"""{Findings.__doc__}
    Notes
    -----
    One read back by `elbowscrew.read_result` has what the files hold: tables, summaries, plots, and of the attributes
    above all but `recording`, `proximal`, `distal`, `joint`, `elapsed`, `displacement`, `sense`, `mean_axis`,
    `joint_axis`, `joint_type`, `points`, `quality`, `anatomy` where there are landmarks, `cycle_curves` where there is
    no cycle, `repeatability` of less than two, and `keyframes` of the joint's own angles. To ask for one of these
    raises `NotKeptError`.
    """

    folder: Path | None = None
    """Where it was read from; None of one that was analyzed."""

    @classmethod
    def of(cls, found: Findings) -> Analysis:
        """Give what an analysis found the means to show itself."""
        return cls._made({name: getattr(found, name) for name in _PARTS})

    @classmethod
    def read(cls, folder: Path) -> Analysis:
        """Read a result back; see `elbowscrew.read_result`."""
        kept = read_kept(folder)
        known = {"folder": folder, "summary": kept.summary, "joint_summary": kept.joint_summary, "_view": kept.view}
        return cls._made({**kept.parts, **known, "tables": kept.tables})

    @classmethod
    def _made(cls, state: Mapping[str, object]) -> Analysis:
        made = object.__new__(cls)
        made.__setstate__(state)
        return made

    def __setstate__(self, state: Mapping[str, object]) -> None:
        for name, value in state.items():
            object.__setattr__(self, name, value)

    def __getstate__(self) -> dict[str, object]:
        parts = {name: getattr(self, name) for name in _PARTS if hasattr(self, name)}
        return parts | {name: value for name, value in vars(self).items() if name != "plot"}

    if not TYPE_CHECKING:  # a type checker would take any attribute for one of these

        def __getattr__(self, name: str) -> Any:
            """Say of what a result's files do not hold that they do not."""
            if name in _PARTS:
                msg = (
                    f"{self.folder}: {name} is not kept in the files of a result; they have the tables (to_frame), "
                    "summary and joint_summary; analyze the recording for it"
                )
                raise NotKeptError(msg)
            near = did_you_mean(name, [one for one in dir(self) if one[0] != "_"]) or _WHERE
            hint = "" if name.startswith("_") else near
            msg = f"{type(self).__name__!r} object has no attribute {name!r}{hint}"
            raise AttributeError(msg)

    @cached_property
    def summary(self) -> Summary:
        """What stands in ``summary.json``: degrees and millimeters, None where nothing is known."""
        return summary_from_analysis(self)

    @cached_property
    def joint_summary(self) -> JointSummary:
        """What stands in ``joint.json``: the joint's type, axes or center by all estimators, with their intervals."""
        return joint_summary(self)

    @cached_property
    def tables(self) -> Mapping[str, TableRecord]:
        """The tables that are files of the result, by their names; those that this trial has."""
        return results_by_table(self)

    @cached_property
    def _view(self) -> TrialView:
        return view_of_analysis(self, self.summary, self.joint_summary, tuple(FIGURE_ENTRIES))

    def trial_view(self) -> TrialView:
        """Give what figures and pages show of the trial."""
        return self._view

    def table(self, name: TableName) -> TableRecord:
        """Give a table by its name.

        Raises
        ------
        UsageError
            If there is none of that name, or this trial has nothing for it.
        """
        if not isinstance(name, str):
            msg = f"expected the name of a table, found {type(name).__name__}; there are {', '.join(self.tables)}"
            raise UsageError(msg)
        if name == "joint":
            return joint_estimates(self.joint_summary)
        if name == "warnings":
            return listed_warnings([{**one, "message": in_python(one["message"])} for one in self.summary["warnings"]])
        if name not in self.tables:
            whose = "this trial" if name in get_args(TableName) else "a result"
            known = (*self.tables, "joint", "warnings")
            msg = f"{whose} has no table {name!r}{did_you_mean(name, known)}; there are {', '.join(known)}"
            raise UsageError(msg)
        return self.tables[name]

    def to_frame(
        self, table: TableName = "screw", angle_unit: AngleUnit = "deg", length_unit: LengthUnit = "mm"
    ) -> pd.DataFrame:
        """Give a table as a pandas data frame, the measured motion by default, with the names of its CSV.

        Raises
        ------
        UsageError
            If there is no such table.
        """
        return self.table(table).to_frame(angle_unit, length_unit)

    def to_xarray(
        self, table: TableName | None = None, angle_unit: AngleUnit = "deg", length_unit: LengthUnit = "mm"
    ) -> xr.Dataset:
        """Give all that is known of each frame as one xarray Dataset, or a table alone.

        The measured motion has the names of ``screw.csv`` without units and components; what is of other tables has
        their name before it, as in ``interpolation_theta``. What the trial is stands in the attributes.

        Raises
        ------
        UsageError
            If there is no such table, or xarray is not installed.
        """
        if table is not None:
            return self.table(table).to_xarray(angle_unit, length_unit)
        data = self.tables["screw"].to_xarray(angle_unit, length_unit)
        for name in _OF_FRAMES:
            if name in self.tables:
                other = self.tables[name].to_xarray(angle_unit, length_unit)
                data = data.assign({f"{name}_{one}": values for one, values in other.data_vars.items()})
        trial = self.summary["trial"]
        return data.assign_attrs(
            source=self.summary["source"]["name"] or "",
            joint=trial["joint"]["name"],
            proximal="" if trial["proximal"] is None else trial["proximal"]["name"],
            distal=trial["distal"]["name"],
            rate_hz=trial["rate_hz"],
            expressed_in=self.joint_summary["expressed_in"],
            joint_type=self.joint_summary["joint_type"]["type"],
            warnings=", ".join(one["code"] for one in self.summary["warnings"]),
            elbowscrew=self.summary["elbowscrew"] or __version__,
        )

    @cached_property
    def plot(self) -> Plots:
        """Draw: ``plot()`` an overview, ``plot.theta()`` and the others a figure each."""
        from elbowscrew.interface.plotting import Plots

        return Plots(self._view)

    def view_3d(self, height: int = 720, meshes: Mapping[str, Mesh | StrPath] | None = None) -> SpaceView:
        """Show bodies, axes and motion in space, in a notebook: to turn, to zoom and to play, as on the trial's page.

        Parameters
        ----------
        height : int
            Pixels.
        meshes : mapping of str to Mesh or path-like, optional
            Bones by the segment or the name of their body, in its frame: what `elbowscrew.read_mesh` gives, or files in
            millimeters. Those of the result by default.

        Raises
        ------
        UsageError
            If positions were not measured, so that nothing has a place, or a mesh is none or of no body of the trial.
        """
        from elbowscrew.interface.space import SpaceView

        return SpaceView.of(self._view, height, meshes)

    @property
    def _title(self) -> str:
        return f"Analysis of {self.summary['source']['name'] or 'a recording in memory'}"

    @property
    def _facts(self) -> list[tuple[str, str]]:
        from elbowscrew.interface.facts import facts, warned  # with the words of pages, which need their own library

        return [*facts(self.summary, self.joint_summary), warned(self.summary)]

    def __repr__(self) -> str:
        told = self._facts
        width = max(len(name) for name, _ in told)
        return "\n".join([f"<elbowscrew.{self._title}>", *(f"  {name:<{width}}  {text}" for name, text in told)])

    def _repr_html_(self) -> str:
        messages: list[tuple[str, str]] = [
            (one["severity"], f"{in_python(one['message'])} ({one['code']})") for one in self.summary["warnings"]
        ]
        return html_table(self._title, [*self._facts[:-1], *(messages or self._facts[-1:])])
