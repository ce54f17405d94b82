"""A joint by the motion it allows: poses as a function of its own angles; frozen, in SI units and radians."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal, get_args

from elbowscrew.geometry.arrays import Float
from elbowscrew.model.array_record import ArrayRecord

MovingJoint = Literal["hinge", "screw_hinge", "two_axes", "ball"]
"""Types of joint that have angles of their own."""
MOVING_JOINTS: Final[tuple[MovingJoint, ...]] = get_args(MovingJoint)
_SHARED: Final = {"hinge": 9, "screw_hinge": 10, "two_axes": 12, "ball": 6}
JOINT_ANGLES: Final[dict[str, int]] = {"hinge": 1, "screw_hinge": 1, "two_axes": 2, "ball": 3}
"""How many angles each has."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class JointCoordinates(ArrayRecord):
    """What all poses of a joint share; `elbowscrew.motion.joint.coordinates` makes poses of it.

    A displacement since the reference is ``D = S(angles) E``: S turns about the first axis, then (nearer the body)
    about the second, or about the center of a ball; E is the pose that the joint has instead of the reference.

    Attributes
    ----------
    type : {"hinge", "screw_hinge", "two_axes", "ball"}
    axis : ndarray, shape (1 or 2, 3)
        Unit directions at the reference, the proximal body's first; of a ball shape (0, 3).
    point : ndarray, shape (1 or 2, 3)
        A point of each axis, m; of a ball its center.
    pitch : float
        Slide for each radian, m; 0 but for a screw-hinge.
    end : ndarray, shape (8,)
        E; of a joint that fits perfectly 1.
    """

    type: MovingJoint
    axis: Float
    point: Float
    pitch: float
    end: Float

    @property
    def shared(self) -> int:
        """How many numbers all poses share."""
        return _SHARED[self.type]

    @property
    def angles(self) -> int:
        """How many angles a pose has: of a ball the components of its rotation vector."""
        return JOINT_ANGLES[self.type]
