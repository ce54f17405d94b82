"""Which poses of a body are measurements."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from elbowscrew.geometry.dual_quaternion import align_signs
from elbowscrew.model import QualityWarning, RigidBody, TrackingLoss


def check_tracking(body: RigidBody, *, keep_frozen: bool) -> tuple[RigidBody, tuple[QualityWarning, ...]]:
    """Mark the frames in which the body's pose is no measurement.

    A tracked body does not repeat a pose to the last digit, not even at rest: a pose that repeats the one before (up
    to the sign of its quaternion) is lost tracking, and the first of such a run is its last measurement. A body with
    one and the same pose in every frame is a fixed reference and kept, unless that pose is no rotation at the very
    origin, which is what is written for a body that was never solved.

    Parameters
    ----------
    body : RigidBody
    keep_frozen : bool
        Take the poses as they stand.

    Returns
    -------
    body : RigidBody
    warnings : tuple of QualityWarning
    """
    if keep_frozen:
        return body, ()
    pose = body.dual_quat_lab_body
    known = np.flatnonzero(body.tracked)
    if known.size < 2:
        return body, ()
    aligned = align_signs(pose[known[1:]], pose[known[:-1]])
    repeats = (aligned == pose[known[:-1]]).all(axis=1) & (np.diff(known) == 1)
    loss = body.loss.copy()
    if (align_signs(pose[known], pose[known[0]]) == pose[known[0]]).all():
        if not (pose[known[0], 1:] == 0.0).all():
            message = f"body {body.name!r} has the same pose in every frame: taken as a fixed reference"
            return body, (QualityWarning(code="fixed-body", message=message),)
        loss[known] = TrackingLoss.ZERO
        message = (
            f"body {body.name!r} stands at the very origin without rotation in every frame, as a body does that was "
            "never solved: taken as not tracked (--frozen keep takes it as it is)"
        )
        return _without(body, loss), (QualityWarning(code="never-solved", message=message),)
    if not repeats.any():
        return body, ()
    loss[known[1:][repeats]] = TrackingLoss.FROZEN
    message = (
        f"body {body.name!r} repeats its pose to the last digit in {int(repeats.sum())} of {loss.size} frames: "
        "taken as lost tracking (--frozen keep turns this off)"
    )
    return _without(body, loss), (QualityWarning(code="frozen", message=message),)


def _without(body: RigidBody, loss: np.typing.NDArray[np.uint8]) -> RigidBody:
    lost = (loss != TrackingLoss.NONE)[:, None]
    return replace(body, loss=loss, dual_quat_lab_body=np.where(lost, np.nan, body.dual_quat_lab_body))
