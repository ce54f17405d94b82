"""Which poses of a body are measurements: sentinels, frozen poses and leaps are not."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from elbowscrew.geometry import sclerp
from elbowscrew.geometry.arrays import Float, Index
from elbowscrew.geometry.dual_quaternion import pose_from_dual_quat
from elbowscrew.model import QualityWarning, Recording, RigidBody, TrackingLoss
from elbowscrew.motion.difference import angle_between, origin_distance
from elbowscrew.motion.tracking.leaps import without_leaps
from elbowscrew.motion.tracking.losses import as_lost, frames_of, frames_warning, is_same_pose, poses_at
from elbowscrew.motion.tracking.resolution import coarse_step
from elbowscrew.quantities import in_digits
from elbowscrew.settings import Settings

# An exact identity this far from where its neighbors put the body is what is written for a body that is not solved.
_SENTINEL_TURN: Final = np.radians(2.0)
_SENTINEL_DISTANCE_M: Final = 0.02
_LONGEST_LEAD: Final = 2.0


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckedBody:
    """A body without the poses that are no measurements.

    Attributes
    ----------
    body : RigidBody
    warnings : tuple of QualityWarning
    leap_rows : ndarray of int, shape (L,)
        Rows at which the body arrives by a leap.
    broken_rows : ndarray of int, shape (B,)
        Those of them behind which the motion goes on elsewhere: no gap may be filled up to there.
    """

    body: RigidBody
    warnings: tuple[QualityWarning, ...]
    leap_rows: Index
    broken_rows: Index


def check_tracking(body: RigidBody, recording: Recording, elapsed: Float, settings: Settings) -> CheckedBody:
    """Mark the frames in which the body's pose is not a measurement, and say why.

    Parameters
    ----------
    body : RigidBody
    recording : Recording
        Gives the frame numbers.
    elapsed : ndarray, shape (N,)
        Seconds.
    settings : Settings
        What is done with frozen poses, and the limits of a step.
    """
    warnings: list[QualityWarning] = []
    body = _without_sentinels(body, recording, elapsed, warnings)
    if settings.frozen == "lost":
        body = _without_frozen(body, recording, warnings)
    body, leap_rows, broken_rows = without_leaps(body, recording, elapsed, settings, warnings)
    return CheckedBody(body=body, warnings=tuple(warnings), leap_rows=leap_rows, broken_rows=broken_rows)


def _without_sentinels(
    body: RigidBody, recording: Recording, elapsed: Float, warnings: list[QualityWarning]
) -> RigidBody:
    """Take out single frames of no rotation at all that do not fit the frames around them."""
    pose = body.dual_quat_lab_body
    known = np.flatnonzero(body.tracked)
    identity = known[(poses_at(pose, known)[:, 1:4] == 0.0).all(axis=1)]
    if not identity.size or known.size - identity.size < 2:
        return body
    others = np.setdiff1d(known, identity, assume_unique=True)
    # A run of such frames belongs to the motion if its ends lie where the two frames before, and after, lead.
    breaks = np.flatnonzero(np.searchsorted(others, identity[1:]) != np.searchsorted(others, identity[:-1]))
    firsts, lasts = identity[np.r_[0, breaks + 1]], identity[np.r_[breaks, identity.size - 1]]
    after = np.searchsorted(others, firsts)
    off = np.zeros(firsts.size, dtype=np.bool_)
    for ends, one, two, there in (
        (firsts, after - 1, after - 2, after >= 2),
        (lasts, after, after + 1, after <= others.size - 2),
    ):
        near, far, row = others[one[there]], others[two[there]], ends[there]
        fraction = (elapsed[row] - elapsed[near]) / (elapsed[far] - elapsed[near])
        lead = np.clip(fraction, -_LONGEST_LEAD, 0.0)
        expected = sclerp(pose[near], pose[far], lead)
        # A body that speeds up may be as far from there as it is led to go.
        off[there] |= (
            angle_between(pose[row], expected)
            > np.maximum(_SENTINEL_TURN, -lead * angle_between(pose[near], pose[far]))
        ) | (
            origin_distance(pose[row], expected)
            > np.maximum(_SENTINEL_DISTANCE_M, -lead * origin_distance(pose[near], pose[far]))
        )
    rows = identity[off[np.searchsorted(lasts, identity)]]
    if not rows.size:
        return body
    message = (
        f"body {body.name!r} has no rotation at all, out of its motion, in {frames_of(rows, recording)}: taken as lost"
    )
    warnings.append(frames_warning("identity-pose", message, rows, recording))
    return as_lost(body, rows, TrackingLoss.ZERO)


def _without_frozen(body: RigidBody, recording: Recording, warnings: list[QualityWarning]) -> RigidBody:
    """Take out poses that repeat the one before.

    A tracked body does not repeat a pose to the last digit, not even at rest: a pose that repeats the one before (up
    to the sign of its quaternion) is lost tracking, and the first of such a run is its last measurement. A body with
    one and the same pose in every frame is a fixed reference and kept, unless that pose is no rotation at the very
    origin, which is what is written for a body that was never solved.
    """
    pose = body.dual_quat_lab_body
    known = np.flatnonzero(body.tracked)
    if known.size < 2:
        return body
    poses = poses_at(pose, known)
    same = is_same_pose(poses[1:], poses[:-1])
    if same.all():
        if (pose[known[0], 1:] == 0.0).all():
            message = (
                f"body {body.name!r} stands exactly at the origin without rotation in every frame, like a body that "
                "was never solved: taken as not tracked (--frozen keep takes it as it is)"
            )
            warnings.append(QualityWarning(code="never-solved", message=message))
            return as_lost(body, known, TrackingLoss.ZERO)
        message = f"body {body.name!r} has the same pose in every frame: taken as a fixed reference"
        warnings.append(QualityWarning(code="fixed-body", message=message))
        return body
    rows = known[1:][same & (np.diff(known) == 1)]
    if not rows.size:
        return body
    step_m = body.coarse_step or _coarse_step_of_pose(body)
    if step_m is not None:
        message = (
            f"body {body.name!r} repeats its pose in {frames_of(rows, recording)}, and its positions come in steps of "
            f"{in_digits(1000.0 * step_m, 3)} mm: taken as stillness; lost tracking would not be seen"
        )
        warnings.append(frames_warning("coarse-numbers", message, rows, recording))
        return body
    message = (
        f"body {body.name!r} repeats its pose to the last digit in {frames_of(rows, recording)}: taken as lost "
        "tracking (--frozen keep turns this off)"
    )
    warnings.append(frames_warning("frozen", message, rows, recording))
    return as_lost(body, rows, TrackingLoss.FROZEN)


def _coarse_step_of_pose(body: RigidBody) -> float | None:
    rotation, position = pose_from_dual_quat(body.dual_quat_lab_body)
    turned = (rotation[1:] != rotation[:-1]).any(axis=1) & (rotation[1:] != -rotation[:-1]).any(axis=1)
    return coarse_step(position, turned)
