"""What is told of cycles with frames that are lost: nothing that may lie among them."""

from __future__ import annotations

import numpy as np
import pytest

from elbowscrew import Analysis, Recording, RigidBody, analyze
from elbowscrew.geometry import dual_quat_from_screw
from elbowscrew.model import TrackingLoss

RATE = 100.0


def taken(angle_deg: np.ndarray, lost: list[tuple[float, float]]) -> Recording:
    """A hinge without a pose in some spans of time."""
    time = np.arange(angle_deg.size) / RATE
    pose = dual_quat_from_screw(np.radians(angle_deg), 0.0, [0.0, 0.6, 0.8], [0.1, 0.0, 0.0])
    loss = np.zeros(time.size, dtype=np.uint8)
    for begin, end in lost:
        loss[(time >= begin) & (time <= end)] = TrackingLoss.ABSENT
    pose[loss > 0] = np.nan
    body = RigidBody(name="b", dual_quat_lab_body=pose, loss=loss)
    return Recording.from_bodies([body], rate_hz=RATE)


def harmonic(count: int, top: float = 90.0, period_s: float = 2.0) -> np.ndarray:
    time = np.arange(round(count * period_s * RATE) + 1) / RATE
    return 0.5 * top * (1.0 - np.cos(2.0 * np.pi * time / period_s))


def told(analysis: Analysis, code: str) -> list[str]:
    return [warning.message for warning in analysis.warnings if warning.code == code]


def test_a_largest_angle_among_lost_frames_is_unknown() -> None:
    """The second of three tops is lost; beside it the joint comes to 79 deg only."""
    analysis = analyze(taken(harmonic(3), [(2.78, 3.22)]))
    top, span = np.degrees(analysis.repetitions.top_angle), np.degrees(analysis.repetitions.angle_range)
    assert top[[0, 2]] == pytest.approx(90.0)
    assert span[[0, 2]] == pytest.approx(90.0)
    assert np.isnan([top[1], span[1]]).all()
    assert "cycle 2:" in told(analysis, "angles-unknown")[0]


def test_a_largest_angle_beside_lost_frames_is_known() -> None:
    """Where the joint passes on the way, and where it hardly moves any more, nothing larger is hidden."""
    analysis = analyze(taken(harmonic(3), [(0.4, 0.6), (2.95, 3.08), (4.3, 4.6)]))
    assert np.degrees(analysis.repetitions.top_angle) == pytest.approx(90.0, rel=0.02)
    assert not told(analysis, "angles-unknown")
