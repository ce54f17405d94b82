"""One `Settings`: each setting is declared here, once, with its name, type, default, bounds and text.

The options of the command line and their help, the keys of TOML files and manifests, the list in the class's docstring
and `docs/reference/settings.md` are made from it (`SETTINGS`). `configuring.py` takes values from a TOML file
and options.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, Final, Literal

from pydantic import (
    BaseModel,
    ValidationError,
    ValidationInfo,
    field_validator,
    model_validator,
)
from pydantic.functional_validators import ModelWrapValidatorHandler

from elbowscrew import setting_conflicts as conflicts
from elbowscrew import setting_values as taken
from elbowscrew.choices import (
    EXPORT_NAMES,
    LAW_NAMES,
    LAW_PEAKS,
    STATED_JOINTS,
    AngleUnit,
    BlendName,
    ExportName,
    FigureChoice,
    FigureFormat,
    FileUnit,
    JointName,
    KnotName,
    LawName,
    LengthUnit,
    MethodName,
    NoiseSource,
    RotationType,
    StatedJoint,
)
from elbowscrew.column_file import ColumnFile, read_column_file
from elbowscrew.cycle_times import read_cycle_times
from elbowscrew.declaring import (
    BODIES,
    FORMER_NAMES,
    MODEL,
    MOTION,
    OUTPUT,
    Angle,
    Tolerance,
    attributes,
    declared,
    setting,
)
from elbowscrew.errors import SettingError, UsageError
from elbowscrew.setting_faults import in_keywords, told_faults

STILL: Final = "none"
"""The value of ``proximal`` that says: the file has no such body, it stands still."""


class Settings(BaseModel, frozen=True, extra="forbid", allow_inf_nan=False, defer_build=True):
    """How a recording is analyzed.

    The names here carry their units; on the command line and in TOML the unit is left out (`option_name`).
    An impossible value raises `UsageError`, which names the field. Settings do not change; keywords beside them, as of
    `elbowscrew.analyze`, are stronger.
    """

    joint: JointName | None = setting(None, "Name of the joint.", BODIES, shown="by the bodies' names")
    proximal: str | None = setting(
        None, "Proximal body: name or id; 'none' if it stands still.", BODIES, metavar="NAME", shown="by the names"
    )
    distal: str | None = setting(None, "Distal body: name or id.", BODIES, metavar="NAME", shown="by the names")
    proximal_markers: tuple[str, ...] | None = setting(
        None, "Markers of the proximal body: names or patterns.", BODIES, metavar="NAMES", min_length=1
    )
    distal_markers: tuple[str, ...] | None = setting(
        None, "Markers of the distal body: names or patterns.", BODIES, metavar="NAMES", min_length=1
    )
    pose_method: Literal["svd", "dual-qr"] = setting("svd", "How poses are computed from markers.", BODIES)
    reference: int | None = setting(
        None, "Frame that all displacements are measured from.", MOTION, metavar="FRAME", shown="first tracked frame"
    )
    reference_window: int = setting(1, "Average this many frames from the reference on.", MOTION, metavar="N", ge=1)
    express_in: Literal["distal", "proximal", "lab", "arm", "forearm"] | str = setting(
        "distal",
        "Frame the screw is written in: distal, proximal, lab, or a segment's own word.",
        MOTION,
        metavar="FRAME",
    )
    max_gap_s: float = setting(0.1, "Longest gap that is filled, in seconds.", MOTION, metavar="SECONDS", ge=0)
    frozen: Literal["lost", "keep"] = setting("lost", "How to treat poses that repeat to the last digit.", BODIES)
    max_turn_deg_s: float = setting(
        3000.0, "Fastest rotation of a body, in degrees per second; more is a leap.", BODIES, metavar="DEG/S", gt=0
    )
    max_speed_m_s: float = setting(
        15.0, "Fastest motion of a body, in meters per second; more is a leap.", BODIES, metavar="M/S", gt=0
    )
    min_tracked_percent: float = setting(
        50.0, "Smallest share of tracked frames, in percent.", BODIES, metavar="PERCENT", ge=0, le=100
    )
    lowpass_hz: float | Literal["auto"] | None = setting(
        None, "Cut-off of the low-pass filter of the poses, in hertz; auto chooses one for each body.", MOTION,
        metavar="HZ", shown="none",
    )  # fmt: skip
    resample_hz: float | None = setting(
        None, "Rate to resample the recording to, in hertz.", MOTION, metavar="HZ", shown="the file's", gt=0
    )
    min_rate_rad_s: float = setting(
        0.25, "Least angular velocity with an instantaneous axis, in rad per second.", MOTION, metavar="RAD/S", gt=0
    )
    min_angle_deg: float = setting(
        10.0, "Smallest angle with an axis, in degrees.", MOTION, metavar="DEG", gt=0, lt=180
    )
    axis_sd_deg: Angle | None = setting(
        None, "Give an axis where its direction is known to this angle (2deg), instead of --min-angle.", MOTION,
        metavar="DEG", gt=0, lt=90,
    )  # fmt: skip
    step_deg: float | None = setting(
        None, "Also find axes between successive poses this many degrees apart (steps.csv).", MOTION,
        metavar="DEG", gt=0, lt=180,
    )  # fmt: skip
    marker_noise_mm: float | None = setting(
        None, "Noise of each coordinate of a marker, in millimeters.", MOTION,
        metavar="MM", shown="from the recording", gt=0, le=100,
    )  # fmt: skip
    noise: Literal["auto", NoiseSource, "none"] = setting("auto", "Source of the poses' noise.", MOTION)
    signed: Literal["auto", "yes", "no"] = setting(
        "auto", "Whether theta has a sign: where one axis dominates the motion, always, or never.", MOTION
    )
    joint_type: Literal["auto", StatedJoint] | str = setting(
        "auto", f"Type of joint: {', '.join(STATED_JOINTS[:-1])} or {STATED_JOINTS[-1]}; auto finds it.", MOTION,
        metavar="TYPE",
    )  # fmt: skip
    skin_motion: tuple[float, ...] | None = setting(
        None, "How far a cluster moves as a whole on its bone with the motion: mm, or mm and degrees.", MOTION,
        metavar="MM[,DEG]", shown="not stated", min_length=1, max_length=2,
    )  # fmt: skip
    robust: bool = setting(False, "Downweight outliers when the joint's axis is fitted.", MOTION)
    cycle_swing_deg: float | None = setting(
        None, "Smallest swing that makes a cycle, in degrees.", MOTION,
        metavar="DEG", shown="by noise and range", gt=0, lt=360,
    )  # fmt: skip
    cycles: tuple[tuple[float, float], ...] | None = setting(
        None, "File with the columns start_time_s and end_time_s of each cycle.", MOTION,
        metavar="FILE.csv", shown="found", min_length=1,
    )  # fmt: skip
    no_cycles: bool = setting(False, "Do not look for cycles.", MOTION)
    inversion: int | None = setting(
        None, "Frame where the motion reverses.", MODEL, metavar="FRAME", shown="largest angle"
    )
    keyframes: tuple[int, ...] | None = setting(
        None, "Frames the model passes through.", MODEL,
        metavar="F1,F2,...", shown="start, inversion, end", min_length=2,
    )  # fmt: skip
    phases: Literal["movement", "whole"] = setting(
        "movement", "Phases by the movement's reversals and rests, or the whole recording.", MODEL
    )
    tolerance_mm: Tolerance | None = setting(
        None, "Fewest keyframes that keep the RMS displacement below this length (2mm); without positions, the model's "
        "angle error below this angle (2deg).", MODEL, metavar="LENGTH",
    )  # fmt: skip
    method: MethodName | None = setting(
        None,
        "Interpolation of poses, or of the joint's own angles (joint).",
        MODEL,
        shown="dlb, with a tolerance sclerp",
    )
    blend: BlendName = setting("piecewise", "Phase by phase, or all poses at once.", MODEL)
    law: LawName | str | None = setting(
        None, f"Law of motion in each phase: {', '.join(LAW_NAMES)}, or one of a plug-in.", MODEL,
        metavar="LAW", shown="cycloidal, with a tolerance linear",
    )  # fmt: skip
    law_peak: float | None = setting(
        None, "Time of the law's highest velocity, as a share of the phase.", MODEL,
        metavar="SHARE", shown="0.5", ge=LAW_PEAKS[0], le=LAW_PEAKS[1],
    )  # fmt: skip
    knots: KnotName = setting("law", "Parameter of the keyframes.", MODEL)
    radius_mm: float | None = setting(
        None, "Radius of gyration of the distal body's points, for the RMS displacement.", MODEL,
        metavar="MM", shown="of its markers, else 50", gt=0, le=1e5,
    )  # fmt: skip
    angle_unit: AngleUnit = setting("deg", "Unit of angles in tables and figures.", OUTPUT)
    length_unit: LengthUnit = setting("mm", "Unit of lengths in tables and figures.", OUTPUT)
    figure_format: tuple[FigureFormat, ...] = setting(("png",), "Formats of the figures.", OUTPUT, min_length=1)
    figures: tuple[FigureChoice, ...] | None = setting(
        None, "Figures to draw, or all.", OUTPUT, metavar="NAMES",
        shown="theta, euler_parameters, joint, slide, error, anatomy", min_length=1,
    )  # fmt: skip
    font: str | None = setting(
        None, "Font of the figures: the name of an installed family.", OUTPUT, metavar="NAME", shown="DejaVu Sans"
    )
    export: tuple[ExportName | str, ...] = setting(
        (), f"Also write the tables in these formats: {', '.join(EXPORT_NAMES)}, or one of a plug-in.", OUTPUT,
        metavar="FORMATS", shown="none",
    )  # fmt: skip
    units: FileUnit | None = setting(None, "Unit of length, if the file states none.", BODIES)
    rotation: RotationType | None = setting(None, "Rotation type, if the file states none.", BODIES)
    rate_hz: float | None = setting(
        None, "Frames a second, if the file has no times, in hertz.", BODIES, metavar="HZ", ge=1e-3, le=1e6
    )
    columns: ColumnFile | None = setting(
        None, "File that says which columns of a table are the clock, bodies and markers.", BODIES, metavar="FILE.toml",
    )  # fmt: skip

    # An elbow's own words for the two bodies, as they were before: taken and given, but not stored.
    if TYPE_CHECKING:
        arm: str | None = None
        forearm: str | None = None
        arm_markers: tuple[str, ...] | None = None
        forearm_markers: tuple[str, ...] | None = None
    else:
        arm = property(lambda self: self.proximal)
        forearm = property(lambda self: self.distal)
        arm_markers = property(lambda self: self.proximal_markers)
        forearm_markers = property(lambda self: self.distal_markers)

    @property
    def markers(self) -> tuple[str, ...]:
        """All markers wanted of the recording."""
        return (*(self.proximal_markers or ()), *(self.distal_markers or ()))

    @property
    def statements(self) -> dict[str, Any]:
        """What a file must be told, and which of its bones may be meant, as `elbowscrew.read_recording` takes it."""
        bones = tuple(name for name in (self.proximal, self.distal) if name is not None)
        return {
            "units": self.units, "rotation": self.rotation, "rate_hz": self.rate_hz, "columns": self.columns,
            "bones": bones,
        }  # fmt: skip

    @property
    def figure_formats(self) -> tuple[str, ...]:
        """Formats to write, without doubles; empty for no figures."""
        return tuple(dict.fromkeys(kind for kind in self.figure_format if kind != "none"))

    @property
    def stated_joint(self) -> StatedJoint | None:
        """The type of joint that is stated; None where it is found."""
        return next((name for name in STATED_JOINTS if name == self.joint_type), None)

    def tolerance_in_si(self, *, located: bool) -> float:
        """Tolerance in m, or in rad where positions were not measured; a number without a unit suits both.

        Raises
        ------
        SettingError
            If it is an angle, and positions were measured.
        """
        stated = self.tolerance_mm or 0.0
        if not isinstance(stated, str):
            return 1e-3 * stated if located else math.radians(stated)
        if located:
            msg = f"--tolerance {stated}: the bodies have positions, and the error is a length; give one, as in 2mm"
            raise SettingError(msg)
        return math.radians(float(stated.removesuffix("deg")))

    @property
    def model_method(self) -> MethodName:
        """The interpolation, the default resolved."""
        return self.method or ("dlb" if self.tolerance_mm is None else "sclerp")

    @property
    def model_law(self) -> str:
        """The law of motion, the default resolved."""
        return self.law or ("cycloidal" if self.tolerance_mm is None else "linear")

    def __str__(self) -> str:
        return repr(self)

    def __repr_args__(self) -> Iterator[tuple[str, Any]]:
        """Show what is not the default."""
        return ((name, value) for name, value in self if value != type(self).model_fields[name].default)

    def __setattr__(self, name: str, value: object) -> None:
        """Say how other settings are made."""
        hint = f"give {name} beside them, as in analyze(path, settings, {name}=…)"
        msg = f"settings do not change: make new ones, or {hint}"
        raise UsageError(msg)

    @model_validator(mode="before")
    @classmethod
    def _former_names(cls, values: object) -> object:
        """Take what an elbow's two bodies were called before for proximal and distal, and one name for a list of it."""
        if not isinstance(values, Mapping):
            return values
        former = {name.replace("-", "_"): now.replace("-", "_") for name, now in FORMER_NAMES.items()}
        named = {former.get(str(name), name): value for name, value in values.items()}
        if len(named) < len(values):
            msg = f"one setting is given twice, under two names; keep one of {', '.join(map(str, values))}"
            raise ValueError(msg)
        return {name: (one,) if isinstance(one, str) and name in LIST_FIELDS else one for name, one in named.items()}

    _law = field_validator("law", mode="before")(taken.law)
    _export = field_validator("export", mode="before")(taken.exports)
    _frame = field_validator("express_in", mode="before")(taken.frame)
    _joint_type = field_validator("joint_type", mode="before")(taken.joint_type)
    _cutoff = field_validator("lowpass_hz", mode="before")(taken.cutoff)
    _cycles = field_validator("cycles", mode="before")(taken.read_where_named(read_cycle_times))
    _columns = field_validator("columns", mode="before")(taken.read_where_named(read_column_file))
    _skin = field_validator("skin_motion")(taken.skin_motion)

    @model_validator(mode="after")
    def _agree(self) -> Settings:
        faults = (
            conflicts.of_frame(self.express_in, self.joint),
            conflicts.of_cycles(self.cycles, no_cycles=self.no_cycles),
            conflicts.of_law(self.model_law, self.law_peak),
            self.tolerance_mm is not None
            and conflicts.of_tolerance(self.method, self.law, self.keyframes, self.knots, self.blend),
            conflicts.of_keyframes(self.keyframes or (), self.inversion),
        )
        found = next(filter(None, faults), None)
        if found is not None:
            raise ValueError(found)
        return self

    @model_validator(mode="wrap")
    @classmethod
    def _told_in_keywords(
        cls, values: object, handler: ModelWrapValidatorHandler[Settings], info: ValidationInfo
    ) -> Settings:
        """Raise `UsageError` in the fields' names, of the checks above as well.

        Where options are given, who gives them tells what is wrong.
        """
        if info.context is not None:
            return handler(values)
        try:
            return handler(values)
        except ValidationError as error:
            message = told_faults(error, "settings", list(cls.model_fields), str)
        raise UsageError(in_keywords(message, SETTING_KEYWORDS))


SETTINGS: Final = tuple(declared(field, info) for field, info in Settings.model_fields.items())
"""Every setting."""

SETTING_KEYWORDS: Final = {one.option: (one.field, one.choices) for one in SETTINGS}
"""Field and choices by the names of options."""

Settings.__doc__ = f"{(Settings.__doc__ or '').rstrip()}{attributes(SETTINGS)}"

LISTS: Final = tuple(one.option for one in SETTINGS if one.several)
"""Options of settings of which there may be several."""

LIST_FIELDS: Final = frozenset(one.field for one in SETTINGS if one.several)
"""Their fields."""

FILES: Final = tuple(one.option for one in SETTINGS if one.metavar.startswith("FILE"))
"""Options whose value is the name of a file."""
