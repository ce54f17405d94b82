"""One `Settings`, from defaults, a TOML file and options, each stronger than the one before."""

from __future__ import annotations

import csv
import difflib
import itertools
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator, model_validator

from elbowscrew.errors import UsageError
from elbowscrew.tables import AngleUnit, LengthUnit

LISTS: Final = ("keyframes", "figure-format", "export", "proximal-markers", "distal-markers")
"""Settings of which there may be several."""
_UNIT_SUFFIXES: Final = ("_deg_s", "_rad_s", "_m_s", "_deg", "_mm", "_hz", "_s", "_percent")

JointName = Literal["elbow", "wrist", "knee", "ankle", "hip", "shoulder", "finger"]
LawName = Literal[
    "cycloidal",
    "linear",
    "harmonic",
    "polynomial-345",
    "polynomial-4567",
    "modified-trapezoid",
    "modified-sine",
    "empirical",
    "best",
]

STILL: Final = "none"
"""The value of ``proximal`` that says: the file has no such body, it stands still."""


_FORMER_NAMES: Final = {
    "arm": "proximal",
    "forearm": "distal",
    "arm-markers": "proximal-markers",
    "forearm-markers": "distal-markers",
}
"""Names that settings had for an elbow alone, still understood."""


def option_name(field: str) -> str:
    """Give a field's name on the command line and in TOML: ``min_angle_deg`` is ``min-angle``."""
    suffix = next((suffix for suffix in _UNIT_SUFFIXES if field.endswith(suffix)), "")
    name = field.removesuffix(suffix).replace("_", "-")
    return _FORMER_NAMES.get(name, name)


class Settings(BaseModel):
    """How a recording is analyzed.

    The names here carry their units; on the command line and in TOML the unit is left out (`option_name`).
    An impossible value raises `UsageError` through `settings_from`, and pydantic's own error here.

    Attributes
    ----------
    joint : str or None
        What the joint is called (`elbowscrew.joints`); None to go by the bodies' names.
    proximal, distal : str or None
        Names or ids of the two bodies; None to go by the names in the file; "none" for a still proximal one.
    proximal_markers, distal_markers : tuple of str or None
        Markers the bodies' poses are found from: names or patterns; None for the file's own bodies.
    pose_method : {"svd", "dual-qr"}
        How poses are found from markers.
    reference : int or None
        Frame all displacements are counted from; None for the first one tracked.
    reference_window : int
        Frames from the reference on whose mean is taken.
    express_in : {"distal", "proximal", "lab"}
        Frame the screw is written in.
    max_gap_s : float
        Longest gap that is filled, seconds.
    frozen : {"lost", "keep"}
        What poses that repeat to the last digit are taken for.
    max_turn_deg_s, max_speed_m_s : float
        Fastest motion of a body, beyond which it leaps.
    min_tracked_percent : float
        Least share of frames tracked.
    lowpass_hz : float, "auto" or None
        Cut-off of the filter of the bodies' poses; "auto" finds one for each body; None for no filter.
    resample_hz : float or None
        Rate to resample the recording to, before all else.
    min_rate_rad_s : float
        Least angular velocity that gives an instantaneous axis.
    min_angle_deg : float
        Least angle that gives an axis.
    axis_sd_deg : float or None
        Give an axis where its direction is known this well, in place of `min_angle_deg`.
    step_deg : float or None
        Give axes between successive poses so far apart, too.
    marker_noise_mm : float or None
        Noise of each coordinate of each marker.
    noise : {"auto", "residuals", "still", "error-column", "none"}
        Where the noise of the poses is known from.
    signed : {"auto", "yes", "no"}
        Give theta a sense: where one axis dominates the motion, always, or never.
    robust : bool
        Weigh outliers down in the joint's axis.
    cycle_swing_deg : float or None
        Least swing between turns that counts; None for what noise and range ask for.
    cycles : tuple of (float, float) or None
        Start and end time of each cycle in seconds of the recording's own clock, or the CSV file that has them; None
        to find them.
    no_cycles : bool
        Look for no cycles.
    inversion : int or None
        Frame where the motion turns back; None for the frame of the largest angle.
    keyframes : tuple of int or None
        Frames the model passes through; None for start, inversion and end.
    phases : {"movement", "whole"}
        Phases between the rests of the movement, or over the whole recording as in the paper.
    tolerance_mm : float or None
        Choose the fewest keyframes between which the RMS displacement stays below this; None to choose by phases.
    method : {"dlb", "sclerp", "sdlb", "dib", "catmull-rom"} or None
        Interpolation of poses; None for DLB, or ScLERP with a tolerance (`model_method`).
    blend : {"piecewise", "global"}
        Phase by phase, or all poses at once.
    law : str or None
        Law of motion in each phase; None for the cycloidal one, or the linear one with a tolerance (`model_law`).
    law_peak : float or None
        Time of the law's highest velocity as a share of the phase; None for the middle.
    knots : {"law", "chord", "uniform", "angle"}
        Parameter of the keyframes.
    radius_mm : float or None
        Radius of gyration of the distal body's points; None for its markers, else 50 mm.
    angle_unit : {"deg", "rad"}
        Unit of angles in tables and figures.
    length_unit : {"mm", "m"}
        Unit of lengths in tables and figures.
    figure_format : tuple of {"png", "svg", "pdf", "none"}
        Formats of the figures.
    export : tuple of {"parquet", "mat", "sto"}
        Formats of other programs to write the tables in, too.
    units : {"m", "cm", "mm"} or None
        Unit of length of a file that states none.
    rotation : {"quaternion", "XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"} or None
        Rotation type of a file that states none.
    """

    model_config = ConfigDict(
        frozen=True, extra="forbid", alias_generator=option_name, populate_by_name=True, allow_inf_nan=False
    )

    joint: JointName | None = Field(None, description="What the joint is called; by default as the bodies' names say")
    proximal: str | None = Field(None, description="Name or id of the proximal body; 'none' if it stands still")
    distal: str | None = Field(None, description="Name or id of the distal body")
    proximal_markers: tuple[str, ...] | None = Field(
        None, min_length=1, description="Markers of the proximal body: names or patterns"
    )
    distal_markers: tuple[str, ...] | None = Field(
        None, min_length=1, description="Markers of the distal body: names or patterns"
    )
    pose_method: Literal["svd", "dual-qr"] = Field("svd", description="Poses from markers")
    reference: int | None = Field(None, description="Frame all displacements are counted from")
    reference_window: int = Field(1, ge=1, description="Take the mean of so many frames from the reference on")
    express_in: Literal["distal", "proximal", "lab"] = Field("distal", description="Frame the screw is written in")
    max_gap_s: float = Field(0.1, ge=0, description="Longest gap that is filled, in seconds")
    frozen: Literal["lost", "keep"] = Field("lost", description="Poses that repeat: lost tracking, or kept")
    max_turn_deg_s: float = Field(3000.0, gt=0, description="Fastest turn of a body, in degrees a second")
    max_speed_m_s: float = Field(15.0, gt=0, description="Fastest motion of a body, in meters a second")
    min_tracked_percent: float = Field(50.0, ge=0, le=100, description="Least share of frames tracked")
    lowpass_hz: float | Literal["auto"] | None = Field(
        None, description="Cut-off of the filter of the poses, in hertz; 'auto' by residual analysis; 'none'"
    )
    resample_hz: float | None = Field(None, gt=0, description="Rate to resample the recording to, in hertz")
    min_rate_rad_s: float = Field(
        0.25, gt=0, description="Least angular velocity that gives an instantaneous axis, in radians a second"
    )
    min_angle_deg: float = Field(10.0, gt=0, lt=180, description="Least angle that gives an axis, in degrees")
    axis_sd_deg: float | None = Field(
        None, gt=0, lt=90, description="Give an axis where its direction is known this well, in degrees"
    )
    step_deg: float | None = Field(
        None, gt=0, lt=180, description="Axes between successive poses so many degrees apart, too"
    )
    marker_noise_mm: float | None = Field(
        None, gt=0, le=100, description="Noise of each coordinate of each marker, in millimeters"
    )
    noise: Literal["auto", "residuals", "still", "error-column", "none"] = Field(
        "auto", description="Where the noise of the poses is known from"
    )
    signed: Literal["auto", "yes", "no"] = Field("auto", description="Give theta a sense, by the dominant axis")
    robust: bool = Field(False, description="Weigh outliers down in the joint's axis")
    cycle_swing_deg: float | None = Field(
        None, gt=0, lt=360, description="Least swing between the turns of a cycle, in degrees"
    )
    cycles: tuple[tuple[float, float], ...] | None = Field(
        None, min_length=1, description="File with start_time_s and end_time_s of each cycle"
    )
    no_cycles: bool = Field(False, description="Look for no cycles")
    inversion: int | None = Field(None, description="Frame where the motion turns back")
    keyframes: tuple[int, ...] | None = Field(None, min_length=2, description="Frames the model passes through")
    phases: Literal["movement", "whole"] = Field("movement", description="Phases between rests, or the whole recording")
    tolerance_mm: float | None = Field(
        None, ge=1e-3, le=1e5, description="Fewest keyframes that keep the RMS displacement below this, in millimeters"
    )
    method: Literal["dlb", "sclerp", "sdlb", "dib", "catmull-rom"] | None = Field(
        None, description="Interpolation of poses; default: dlb, sclerp with a tolerance"
    )
    blend: Literal["piecewise", "global"] = Field("piecewise", description="Phase by phase, or all poses at once")
    law: LawName | None = Field(
        None, description="Law of motion in each phase; default: cycloidal, linear with a tolerance"
    )
    law_peak: float | None = Field(
        None, ge=0.05, le=0.95, description="Time of the law's highest velocity, as a share of the phase"
    )
    knots: Literal["law", "chord", "uniform", "angle"] = Field("law", description="Parameter of the keyframes")
    radius_mm: float | None = Field(
        None,
        gt=0,
        le=1e5,
        description="Radius of gyration of the distal body's points; default: its markers, else 50 mm",
    )
    angle_unit: AngleUnit = Field("deg", description="Unit of angles in tables and figures")
    length_unit: LengthUnit = Field("mm", description="Unit of lengths in tables and figures")
    figure_format: tuple[Literal["png", "svg", "pdf", "none"], ...] = Field(
        ("png",), min_length=1, description="Formats of the figures"
    )
    export: tuple[Literal["parquet", "mat", "sto"], ...] = Field(
        (), description="Formats of other programs to write the tables in, too"
    )
    units: Literal["m", "cm", "mm"] | None = Field(None, description="Unit of length of a file that states none")
    rotation: Literal["quaternion", "XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"] | None = Field(
        None, description="Rotation type of a file that states none"
    )

    @property
    def markers(self) -> tuple[str, ...]:
        """All markers wanted of the recording."""
        return (*(self.proximal_markers or ()), *(self.distal_markers or ()))

    @property
    def figure_formats(self) -> tuple[str, ...]:
        """Formats to write, without doubles; empty for no figures."""
        return tuple(dict.fromkeys(kind for kind in self.figure_format if kind != "none"))

    @property
    def model_method(self) -> str:
        """The interpolation, the default resolved."""
        return self.method or ("dlb" if self.tolerance_mm is None else "sclerp")

    @property
    def model_law(self) -> str:
        """The law of motion, the default resolved."""
        return self.law or ("cycloidal" if self.tolerance_mm is None else "linear")

    @model_validator(mode="before")
    @classmethod
    def _former_names(cls, values: object) -> object:
        """Take what an elbow's two bodies were called before for proximal and distal."""
        if not isinstance(values, Mapping):
            return values
        return {_FORMER_NAMES.get(str(name).replace("_", "-"), name): value for name, value in values.items()}

    @field_validator("express_in", mode="before")
    @classmethod
    def _segment(cls, value: object) -> object:
        """Take an elbow's own words for its two bodies."""
        return {"arm": "proximal", "forearm": "distal"}.get(value, value) if isinstance(value, str) else value

    @field_validator("lowpass_hz", mode="before")
    @classmethod
    def _cutoff(cls, value: object) -> object:
        """Take ``none`` for no filter, and numbers as text, as the command line gives them."""
        if value == "none":
            return None
        if isinstance(value, str) and value != "auto":
            try:
                value = float(value)
            except ValueError as error:
                msg = f"expected a cut-off in hertz, auto or none, found {value!r}"
                raise ValueError(msg) from error
        if isinstance(value, int | float) and not 0.0 < value < np.inf:
            msg = f"expected a cut-off above 0 Hz, found {value:g}"
            raise ValueError(msg)
        return value

    @field_validator("cycles", mode="before")
    @classmethod
    def _cycle_times(cls, value: object) -> object:
        """Take the path of a CSV file for the times that stand in it."""
        return _read_cycles(Path(value)) if isinstance(value, str | Path) else value

    @model_validator(mode="after")
    def _check_cycles(self) -> Settings:
        if self.no_cycles and self.cycles is not None:
            msg = "--no-cycles and --cycles contradict each other; give one of them"
            raise ValueError(msg)
        return self

    @field_validator("axis_sd_deg", mode="before")
    @classmethod
    def _angle_with_unit(cls, value: object) -> object:
        """Take ``2deg`` and ``0.03rad`` for angles, too."""
        if not isinstance(value, str):
            return value
        number, unit = value.strip().removesuffix("deg").removesuffix("rad"), value.strip()[-3:]
        try:
            return float(np.degrees(float(number))) if unit == "rad" else float(number)
        except ValueError as error:
            msg = f"expected degrees or an angle with its unit, as in 2deg, found {value!r}"
            raise ValueError(msg) from error

    @field_validator("tolerance_mm", mode="before")
    @classmethod
    def _length_with_unit(cls, value: object) -> object:
        """Take ``2mm`` and ``0.002m`` for lengths, too."""
        if not isinstance(value, str):
            return value
        text = value.strip()
        unit = "mm" if text.endswith("mm") else "m" if text.endswith("m") else ""
        try:
            return float(text.removesuffix(unit)) * (1000.0 if unit == "m" else 1.0)
        except ValueError as error:
            msg = f"expected millimeters or a length with its unit, as in 2mm, found {value!r}"
            raise ValueError(msg) from error

    @model_validator(mode="after")
    def _check_law(self) -> Settings:
        if self.law_peak is not None and self.model_law in ("linear", "empirical", "best"):
            why = {"linear": "has no highest velocity", "empirical": "is the recording's own", "best": "finds its own"}
            msg = f"--law-peak: the law '{self.model_law}' {why[self.model_law]}; leave --law-peak out"
            raise ValueError(msg)
        return self

    @model_validator(mode="after")
    def _check_tolerance(self) -> Settings:
        if self.tolerance_mm is None:
            return self
        if self.keyframes is not None:
            msg = "--tolerance chooses the keyframes itself; give either --tolerance or --keyframes"
            raise ValueError(msg)
        if self.model_method not in ("sclerp", "sdlb"):
            msg = (
                f"--tolerance: with --method {self.method} a piece depends on more than its two keyframes, and no best "
                "set can be told; expected sclerp or sdlb"
            )
            raise ValueError(msg)
        if self.law == "empirical":
            msg = (
                "--tolerance: the recording's own law need not go forward all the time; expected another --law than "
                "empirical"
            )
            raise ValueError(msg)
        if self.knots != "law" or self.blend != "piecewise":
            msg = (
                "--tolerance: the model must pass each keyframe at its own time, piece by piece; leave --knots and "
                "--blend out"
            )
            raise ValueError(msg)
        return self

    @model_validator(mode="after")
    def _check_keyframes(self) -> Settings:
        frames = self.keyframes
        if frames is not None:
            if any(later <= earlier for earlier, later in itertools.pairwise(frames)):
                msg = "keyframes must increase"
                raise ValueError(msg)
            if self.inversion is not None and self.inversion not in frames[1:-1]:
                msg = (
                    f"the inversion ({self.inversion}) must be one of the keyframes between the first and the last: "
                    "add it to --keyframes or leave --inversion out"
                )
                raise ValueError(msg)
        return self


def settings_from(config: Path | None = None, options: Mapping[str, Any] | None = None) -> Settings:
    """Merge defaults, a TOML file and options; the later ones win.

    Parameters
    ----------
    config : Path, optional
        A TOML file with option names as keys (``min-angle = 5``).
    options : mapping, optional
        Field or option names; None means not given.

    Raises
    ------
    UsageError
        If the file cannot be read, or a key or value is not a possible one; it names the key.
    """
    given = {option_name(key): value for key, value in (options or {}).items() if value is not None}
    table = _read_toml(config) if config is not None else {}
    if config is not None:
        _validate(table, str(config))
    return _validate({**table, **given}, "settings")


def _read_cycles(path: Path) -> list[tuple[float, float]]:
    """Read start and end times of cycles from a CSV file with the columns start_time_s and end_time_s."""
    columns = ("start_time_s", "end_time_s")
    try:
        with path.open(encoding="utf-8-sig", newline="") as stream:
            table = csv.DictReader(stream)
            missing = [name for name in columns if name not in (table.fieldnames or ())]
            if missing:
                msg = f"{path}: expected the columns start_time_s and end_time_s, found no {' and no '.join(missing)}"
                raise ValueError(msg)
            times = []
            for row in table:
                start, end = (float(row[name] or "nan") for name in columns)
                if not (np.isfinite([start, end]).all() and start < end):
                    msg = f"{path}:{table.line_num}: expected a start before its end, found {row['start_time_s']} and "
                    raise ValueError(msg + f"{row['end_time_s']}")
                times.append((start, end))
    except OSError as error:
        msg = f"{path}: cannot be read as a file of cycles: {error.strerror}"
        raise ValueError(msg) from error
    except csv.Error as error:
        msg = f"{path}: not a CSV file: {error}"
        raise ValueError(msg) from error
    return times


def _read_toml(config: Path) -> dict[str, Any]:
    try:
        with config.open("rb") as stream:
            given = tomllib.load(stream)
            table = {option_name(key): value for key, value in given.items()}
            if len(table) < len(given):
                msg = f"{config}: one setting stands twice under two spellings; keep one of {', '.join(given)}"
                raise UsageError(msg)
            return {key: [value] if key in LISTS and isinstance(value, str) else value for key, value in table.items()}
    except OSError as error:
        msg = f"{config}: cannot be read as a settings file: {error.strerror}"
        raise UsageError(msg) from error
    except (ValueError, RecursionError) as error:
        msg = f"{config}: not TOML: {error}. Write one `key = value` a line, text in quotes"
        raise UsageError(msg) from error


def _validate(values: Mapping[str, Any], place: str) -> Settings:
    known = [option_name(name) for name in Settings.model_fields]
    try:
        return Settings.model_validate(dict(values))
    except ValidationError as error:
        raise UsageError("; ".join(_sentence(place, fault, known) for fault in error.errors())) from error


def _sentence(place: str, fault: Any, known: list[str]) -> str:
    key = str(fault["loc"][0]) if fault["loc"] else ""
    if fault["type"] == "extra_forbidden":
        close = difflib.get_close_matches(key, known, n=1)
        hint = f"did you mean {close[0]!r}?" if close else f"possible keys: {', '.join(known)}"
        return f"{place}: unknown key {key!r}; {hint}"
    message = str(fault["msg"]).removeprefix("Value error, ").replace("Input should", "should")
    if not key:
        return f"{place}: {message}"
    return f"{place}: {key}: {message}, found {fault['input']!r}"
