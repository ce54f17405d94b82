"""Frames of a recording that are no measurements: how they are taken out of a body, and told."""

from __future__ import annotations

from dataclasses import replace
from typing import Final, Literal

import numpy as np

from elbowscrew.geometry import _rows
from elbowscrew.geometry._blocks import in_blocks
from elbowscrew.geometry.arrays import Bool, Float, Index
from elbowscrew.model import QualityWarning, Recording, RigidBody, TrackingLoss

_FRAMES_TOLD: Final = 10


def as_lost(body: RigidBody, rows: Index, reason: TrackingLoss) -> RigidBody:
    """Give the body without its poses in some rows, lost for this reason."""
    if not rows.size and body.tracked.all():
        return body  # as most are, and no copy is needed
    loss = body.loss.copy()
    loss[rows] = reason
    lost = (loss != TrackingLoss.NONE)[:, None]
    return replace(body, loss=loss, dual_quat_lab_body=np.where(lost, np.nan, body.dual_quat_lab_body))


def frames_warning(
    code: str, message: str, rows: Index, recording: Recording, severity: Literal["warning", "note"] = "warning"
) -> QualityWarning:
    """Build a warning about some rows of a recording."""
    told = tuple(recording.frame[rows[:_FRAMES_TOLD]].tolist())
    return QualityWarning(code=code, message=message, severity=severity, frames=told, count=int(rows.size))


def frames_of(rows: Index, recording: Recording) -> str:
    """Say how many frames some rows are, and where they begin."""
    first = recording.frame[rows[0]]
    return f"frame {first}" if rows.size == 1 else f"{rows.size} of {recording.frame.size} frames (first {first})"


def is_same_pose(pose: Float, other: Float) -> Bool:
    """Whether poses (N, 8) are the same to the last digit, up to the signs of their quaternions."""

    def kernel(Q: _rows.Rows, R: _rows.Rows) -> list[Float]:
        sign = _rows.sign_towards(Q, R)
        return [np.logical_and.reduce([sign * q == r for q, r in zip(Q, R, strict=True)])]

    found: Bool = in_blocks(kernel, pose, other, width=1)[..., 0] == 1.0
    return found


def poses_at(pose: Float, rows: Index) -> Float:
    """Poses of increasing rows; a view where none is left out, as in most recordings."""
    if rows.size and rows[-1] - rows[0] == rows.size - 1:
        return pose[rows[0] : rows[-1] + 1]
    return pose[rows]
