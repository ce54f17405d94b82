"""What laws, methods, knots and other choices are called: each list of names stands here, and nowhere else.

A name is a function of the module that does the work, found by `functions_named`, so that the command line can offer
the names without loading it, and a type checker knows them.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final, Literal, get_args

ClosedLaw = Literal[
    "cycloidal",
    "linear",
    "harmonic",
    "polynomial-345",
    "polynomial-4567",
    "modified-trapezoid",
    "modified-sine",
]
"""Laws of motion in closed form; functions of `elbowscrew.motion.interpolation.laws`."""
LawName = Literal[ClosedLaw, "empirical", "best"]
"""Laws of motion, those found from the recording among them."""
LAW_PEAKS: Final = (0.05, 0.95)
"""From where to where a law's highest velocity may be moved, as a share of its phase."""
SimulatedLaw = Literal["minimum-jerk", ClosedLaw]
"""Laws that synthetic trials move by."""
SimulatedJointType = Literal["hinge", "screw-hinge", "two-axes", "ball"]
"""Joints that synthetic trials move in."""
PoseMethodName = Literal["dlb", "sclerp", "sdlb", "dib", "catmull-rom"]
"""Interpolations of poses; functions of `elbowscrew.motion.interpolation.modeling`."""
MethodName = Literal[PoseMethodName, "joint"]
"""Interpolations of poses, and that of the joint's own angles."""
KnotName = Literal["law", "chord", "uniform", "angle"]
"""Parameters of the keyframes: the law's own, or functions of `elbowscrew.motion.interpolation.keyframes`."""
BlendName = Literal["piecewise", "global"]
"""Phase by phase, or all poses at once."""
KeyframeSource = Literal["raw", "lowpass", "decimated"]
"""What keyframes are taken from in a comparison."""
JointName = Literal["elbow", "wrist", "knee", "ankle", "hip", "shoulder", "finger"]
"""Joints; their words stand in `elbowscrew.joints`."""
ExpressIn = Literal["distal", "proximal", "lab"]
"""Frames a screw is written in."""
MarkersTold = Literal["motion", "errors"]
"""What a file tells of its markers: how they move among themselves, or only how large their errors are."""
NoiseSource = Literal["residuals", "error-column", "still"]
"""What tells the noise of a body's poses, the best first; functions of `elbowscrew.motion.screws.pose_noise`."""
StatedJoint = Literal["rigid", "hinge", "screw_hinge", "two_axes", "ball", "free"]
"""Types of joint that can be stated."""
AngleUnit = Literal["deg", "rad"]
LengthUnit = Literal["mm", "m"]
FileUnit = Literal["m", "cm", "mm"]
RotationType = Literal["quaternion", "XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"]
FigureFormat = Literal["png", "svg", "pdf", "tiff", "eps", "none"]
FigureName = Literal[
    "theta",
    "euler_parameters",
    "joint",
    "slide",
    "error",
    "anatomy",
    "velocity",
    "instantaneous_axes",
    "cycles",
    "quality",
    "axis",
    "joint_axis",
    "joint_angles",
    "axis_path",
    "fig7",
    "fig8",
    "fig9",
    "fig10",
]
"""Figures of a trial; their functions stand in `elbowscrew.view.figure_names`."""
FigureChoice = Literal[FigureName, "all"]

OverlayBy = Literal["condition", "subject"]
"""Figures of a trial, and all that it has anything for."""
ExportName = Literal["parquet", "mat", "sto"]

CLOSED_LAWS: Final[tuple[ClosedLaw, ...]] = get_args(ClosedLaw)
LAW_NAMES: Final[tuple[LawName, ...]] = get_args(LawName)
POSE_METHOD_NAMES: Final[tuple[PoseMethodName, ...]] = get_args(PoseMethodName)
METHOD_NAMES: Final[tuple[MethodName, ...]] = get_args(MethodName)
METHOD_LABELS: Final[dict[str, str]] = {
    "dlb": "DLB",
    "sclerp": "ScLERP",
    "sdlb": "sDLB",
    "dib": "DIB",
    "catmull-rom": "Catmull-Rom",
    "joint": "Joint's angles",
}
"""Methods as figures and charts call them."""
KNOT_NAMES: Final[tuple[KnotName, ...]] = get_args(KnotName)
BLEND_NAMES: Final[tuple[BlendName, ...]] = get_args(BlendName)
KEYFRAME_SOURCES: Final[tuple[KeyframeSource, ...]] = get_args(KeyframeSource)
NOISE_SOURCES: Final[tuple[NoiseSource, ...]] = get_args(NoiseSource)
JOINT_NAMES: Final[tuple[JointName, ...]] = get_args(JointName)
STATED_JOINTS: Final[tuple[StatedJoint, ...]] = get_args(StatedJoint)
FUNCTIONAL_AXIS_WORDS: Final[dict[str, str]] = {"joint_axis": "joint axis", "axis1": "first of the two axes"}
"""What the axis that a joint flexes about is called, by the joint's type, after "the"."""
JOINT_TYPE_WORDS: Final[dict[str, str]] = {
    "rigid": "a rigid joint",
    "hinge": "a hinge",
    "screw_hinge": "a screw-hinge",
    "two_axes": "two axes",
    "ball": "a ball joint",
    "free": "free",
    "undetermined": "undetermined",
}
"""What types of joint are called in a sentence."""
FRAMES: Final[tuple[ExpressIn, ...]] = get_args(ExpressIn)
EXPORT_NAMES: Final[tuple[ExportName, ...]] = get_args(ExportName)
FIGURE_FORMATS: Final[tuple[FigureFormat, ...]] = get_args(FigureFormat)
DRAWN_FORMATS: Final = tuple(kind for kind in FIGURE_FORMATS if kind != "none")


def functions_named(names: tuple[str, ...], module: Mapping[str, Any]) -> dict[str, Any]:
    """Find each name's function in a module's globals: ``catmull-rom`` is ``_catmull_rom``.

    Raises
    ------
    LookupError
        If a name has no function there.
    """
    found = {name: module.get(f"_{name.replace('-', '_')}") for name in names}
    missing = [name for name, function in found.items() if not callable(function)]
    if missing:
        msg = f"{module['__name__']}: no function for {', '.join(missing)}; expected one called _{missing[0]}"
        raise LookupError(msg.replace("-", "_"))
    return found
