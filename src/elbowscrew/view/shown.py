# ruff: noqa: D102 - a protocol tells its properties in the docstring of the class
"""What figures and pages show of a trial, whether just analyzed or read back from its result folder."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, Protocol

from elbowscrew.geometry.arrays import Float
from elbowscrew.joints import Joint
from elbowscrew.model.modeled import InterpolatedMotion, Keyframes
from elbowscrew.model.repetitions import MovementPhases, Repetitions
from elbowscrew.model.results import ScrewMotion

if TYPE_CHECKING:
    from elbowscrew.settings import Settings


class ShownLine(Protocol):
    """A line: unit direction and the point nearest the origin, meters; shape (3,)."""

    @property
    def direction(self) -> Float: ...
    @property
    def point(self) -> Float: ...


class ShownFit(Protocol):
    """A fitted joint with the half-angle (rad) and the radius (m) that hold 95 %."""

    @property
    def line(self) -> ShownLine: ...
    @property
    def axis_cone(self) -> float: ...
    @property
    def point_radius(self) -> float: ...


class ShownJointAxis(Protocol):
    """The fit to believe, if there is one, and the mean that stands in for it."""

    @property
    def preferred(self) -> Literal["hinge", "screw_hinge"] | None: ...
    @property
    def best(self) -> ShownFit | None: ...
    @property
    def weighted_mean(self) -> ShownLine: ...


class ShownMean(ShownLine, Protocol):
    """The mean axis, and the deviation (rad) and distance (m) from it that 95 % of the frames' axes keep within."""

    @property
    def spread95(self) -> tuple[float, float]: ...


class ShownBody(Protocol):
    """A body's markers in its own frame, shape (M, 3), meters, if it has any."""

    @property
    def marker_offsets(self) -> Float | None: ...


class ShownJoint(Protocol):
    """Poses at the reference, unit dual quaternions (8,): the forearm in the arm, and the arm in the laboratory."""

    @property
    def reference(self) -> Float: ...
    @property
    def dual_quat_lab_proximal(self) -> Float: ...


class ShownClock(Protocol):
    """Frames per second."""

    @property
    def rate_hz(self) -> float: ...


class Shown(Protocol):
    """A trial as far as it is shown; `Analysis` is one, and so is a result read back from its folder."""

    @property
    def settings(self) -> Settings: ...
    @property
    def recording(self) -> ShownClock: ...
    @property
    def proximal(self) -> ShownBody | None: ...
    @property
    def distal(self) -> ShownBody: ...
    @property
    def named_joint(self) -> Joint: ...
    @property
    def joint(self) -> ShownJoint: ...
    @property
    def screw(self) -> ScrewMotion: ...
    @property
    def mean_axis(self) -> ShownMean: ...
    @property
    def joint_axis(self) -> ShownJointAxis: ...
    @property
    def phases(self) -> MovementPhases: ...
    @property
    def repetitions(self) -> Repetitions: ...
    @property
    def keyframes(self) -> Keyframes: ...
    @property
    def interpolated(self) -> InterpolatedMotion: ...
