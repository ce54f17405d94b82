"""Frames of a recording that are no measurements: how they are taken out of a body, and told."""

from __future__ import annotations

from dataclasses import replace
from typing import Final, Literal

import numpy as np

from elbowscrew.geometry.arrays import Float, Index
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


def poses_at(pose: Float, rows: Index) -> Float:
    """Poses of increasing rows; a view where none is left out, as in most recordings."""
    if rows.size and rows[-1] - rows[0] == rows.size - 1:
        return pose[rows[0] : rows[-1] + 1]
    return pose[rows]
