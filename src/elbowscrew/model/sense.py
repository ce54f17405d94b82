"""The sense of a rotation: frozen, in radians."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from elbowscrew.geometry.arrays import Float
from elbowscrew.model.array_record import ArrayRecord

# Between these, another reference pose may decide otherwise.
_DOUBTFUL_RATIO: Final = (0.15, 0.25)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Sense(ArrayRecord):
    """Sense of the rotation in every frame, and the axis that gives it.

    Attributes
    ----------
    signed : bool
        Whether the angle has a sense.
    direction : ndarray, shape (3,)
        Unit dominant axis, about which a positive angle turns, in the frame the screw is expressed in; without a sense,
        the leading direction, positive where the twist about it is largest.
    ratio : float
        Second eigenvalue over the first of the axes' second moments: 0 for one axis, 1 where none goes before others.
    sigma : float
        Noise of a component of the rotation, radians, as it was used.
    counted : bool
        Whole turns were counted along time: the motion turns all the way round.
    tied : bool
        The excursions to both sides are equal: the one made first is positive.
    angle : ndarray, shape (N,)
        Theta, radians; NaN where there is no pose.
    sign : ndarray, shape (N,)
        1 or -1: the axis of theta is that of the quaternion with a positive scalar part times this; NaN with the angle.
    turns : ndarray, shape (N,)
        Whole turns k: ``theta = sign phi + 2 pi k``, with phi from 0 to pi; NaN with the angle.
    twist : ndarray, shape (N,)
        Rotation about `direction` alone, radians, whole turns included: where motions turn back, and nothing else.
    largest_jump : float
        How far theta moves beyond the rotation between two adjacent frames, at most; radians.
    jump_row : int or None
        Row before that step; None where theta moves as far as the joint does.
    jumps : int
        Steps that go beyond by more than 20 deg.
    bridged_rows : tuple of int
        Rows before gaps over which the speed beside them makes the joint turn by over half a turn: the whole turns
        there are those of that speed (`counted`), or it contradicts them.
    """

    signed: bool
    direction: Float
    ratio: float
    sigma: float
    counted: bool
    tied: bool
    angle: Float
    sign: Float
    turns: Float
    twist: Float
    largest_jump: float
    jump_row: int | None
    jumps: int
    bridged_rows: tuple[int, ...] = ()

    @property
    def doubtful(self) -> bool:
        """Whether another reference pose may decide otherwise that there is a sense, or that there is none."""
        return _DOUBTFUL_RATIO[0] < self.ratio < _DOUBTFUL_RATIO[1]
