"""What two bodies of a recording do together that no two bodies can: swap places, be one, or stand where they turn."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import pose_from_dual_quat
from elbowscrew.model import QualityWarning, Recording, RigidBody
from elbowscrew.motion.difference import origin_distance
from elbowscrew.motion.tracking.leaps import LONGEST_EXCURSION_S
from elbowscrew.motion.tracking.losses import frames_of, frames_warning, is_same_pose, poses_at

# Two bodies are swapped if each comes to lie where the other was, much nearer than to where it was itself.
_CROSSED_SHARE: Final = 0.25
_LEAST_SWAP_M: Final = 0.05

# Positions that were never measured: constant to the arithmetic's last digits while the body turns.
_CONSTANT_M: Final = 1e-12
_TURNED: Final = np.radians(1.0)
_FIRST_POSES: Final = 1024


def check_swaps(one: RigidBody, other: RigidBody, recording: Recording, elapsed: Float) -> tuple[QualityWarning, ...]:
    """Tell of frames at which two bodies, as they are in the file, take each other's place, be it behind a short gap.

    Parameters
    ----------
    one, other : RigidBody
        Unchecked.
    recording : Recording
        Gives the frame numbers.
    elapsed : ndarray, shape (N,)
        Seconds.
    """
    rows = np.flatnonzero(one.tracked & other.tracked)
    before, after = rows[:-1], rows[1:]
    starts, ends = ([poses_at(body.dual_quat_lab_body, at) for body in (one, other)] for at in (before, after))
    moved = origin_distance(ends[0], starts[0]), origin_distance(ends[1], starts[1])
    crossed = origin_distance(ends[0], starts[1]) + origin_distance(ends[1], starts[0])
    swapped = after[
        (crossed < _CROSSED_SHARE * (moved[0] + moved[1]))
        & (np.minimum(*moved) > _LEAST_SWAP_M)
        & (elapsed[after] - elapsed[before] <= LONGEST_EXCURSION_S)
    ]
    if not swapped.size:
        return ()
    message = (
        f"bodies {one.name!r} and {other.name!r} swap places at {frames_of(swapped, recording)}: their poses "
        "are swapped from there on, or up to there; relabel them in Motive"
    )
    return (frames_warning("swapped-bodies", message, swapped, recording),)


def check_same_pose(one: RigidBody, other: RigidBody) -> tuple[QualityWarning, ...]:
    """Tell of two bodies, unchecked, that have one and the same changing pose wherever both have one."""
    rows = np.flatnonzero(one.tracked & other.tracked)
    first, second = (poses_at(body.dual_quat_lab_body, rows) for body in (one, other))
    if rows.size < 2 or not is_same_pose(second, first).all():
        return ()
    message = (
        f"bodies {one.name!r} and {other.name!r} have one and the same pose in every frame, as one body under two "
        "names has: nothing moves between them"
    )
    return (QualityWarning(code="same-pose", message=message, count=int(rows.size)),)


def turns_on_the_spot(body: RigidBody) -> bool:
    """Whether a body turns while its position stays exactly as it is."""
    poses = poses_at(body.dual_quat_lab_body, np.flatnonzero(body.tracked))
    # The first poses tell it of nearly all bodies.
    if not body.located or len(poses) < 2 or _goes_away(poses[:_FIRST_POSES]) or _goes_away(poses):
        return False
    rotation = poses[:, :4]
    return bool((np.abs(rotation @ rotation[0]) <= np.cos(_TURNED / 2.0)).any())


def _goes_away(poses: Float) -> bool:
    return bool((np.ptp(pose_from_dual_quat(poses)[1], axis=0) > _CONSTANT_M).any())


def constant_positions_warning(names: Sequence[str]) -> QualityWarning:
    """Say that bodies turn while the positions of all of them stay exactly as they are."""
    message = (
        f"bodies {', '.join(map(repr, names))} turn while their positions stay exactly as they are: these are no "
        "measured positions, and the orientations alone are used"
    )
    return QualityWarning(code="constant-positions", message=message)


def on_the_spot_warning(name: str) -> QualityWarning:
    """Say that one body alone does."""
    message = (
        f"body {name!r} turns while its position stays exactly as it is: if that was not measured, slide and place of "
        "the axis mean nothing"
    )
    return QualityWarning(code="on-the-spot", message=message)


def no_positions_warnings(unused: Sequence[str], tolerance: float | str | None) -> tuple[QualityWarning, ...]:
    """Say what is found of a joint of which no positions were measured.

    Parameters
    ----------
    unused : sequence of str
        Bodies whose positions are not used, as the other one has none.
    tolerance : float, str or None
        That of the model as it is stated: what is without a unit is an angle here.
    """
    message = (
        "there are orientations and no positions: angles, directions of axes and their errors are told; slide, places "
        "of axes, centers, distances and linear speeds are left empty, and errors and tolerance of the model are angles"
    )
    if unused:
        message += f" (the positions of {', '.join(map(repr, unused))} are not used, as the other body has none)"
    found = [QualityWarning(code="no-positions", message=message)]
    if isinstance(tolerance, float):
        message = f"--tolerance {tolerance:g} is taken as {tolerance:g} deg, as there are no positions"
        found.append(QualityWarning(code="tolerance-in-degrees", message=message))
    return tuple(found)
