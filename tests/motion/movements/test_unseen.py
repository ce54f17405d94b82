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


def test_a_largest_angle_among_frames_that_are_filled_in_is_unknown() -> None:
    """Strokes of 0.12 s: what is put in for 0.08 s goes straight on over the top of 90 deg, at 66 deg."""
    analysis = analyze(taken(harmonic(3, period_s=0.24), [(0.325, 0.395)]))
    assert analysis.screw.filled.any()
    top, span = np.degrees([analysis.repetitions.top_angle[1], analysis.repetitions.angle_range[1]])
    assert np.isnan([top, span]).all()
    assert "cycle 2:" in told(analysis, "angles-unknown")[0]


GAPS = [(center, half) for center in (2.0, 3.0, 4.0, 6.0, 7.0, 0.0, 8.0) for half in (0.07, 0.15, 0.3, 0.5, 0.8, 1.0)]


@pytest.mark.parametrize(("center", "half"), GAPS)
def test_no_cycle_is_lost_without_a_word(center: float, half: float) -> None:
    """Four cycles of two seconds; at whole seconds the joint turns back."""
    noise = np.random.default_rng(3).normal(0.0, 0.2, 801)
    analysis = analyze(taken(harmonic(4) + noise, [(center - half, center + half)]))
    found = analysis.repetitions
    if found.number.size < 4:
        assert told(analysis, "turns-in-gaps")
    if half < 0.1:
        assert found.number.size == 4
        assert not told(analysis, "turns-in-gaps")


@pytest.mark.parametrize(("half", "incomplete"), [(0.4, [False, True, True, False]), (0.6, [False, True, False])])
def test_cycles_that_meet_in_a_gap_are_incomplete(half: float, incomplete: list[bool]) -> None:
    """Two of four, or the one that a longer gap makes of them."""
    analysis = analyze(taken(harmonic(4), [(4.0 - half, 4.0 + half)]))
    assert analysis.repetitions.incomplete.tolist() == incomplete
    assert told(analysis, "turns-in-gaps")


def test_a_gap_on_the_way_or_at_rest_hides_no_turn() -> None:
    angle = np.concatenate([harmonic(2), np.zeros(200), harmonic(2)])
    analysis = analyze(taken(angle, [(0.4, 0.6), (2.35, 2.7), (4.8, 5.3)]))
    assert analysis.repetitions.number.size == 4
    assert not told(analysis, "turns-in-gaps")
    assert not analysis.repetitions.incomplete.any()
