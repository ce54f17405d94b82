"""What is told of keyframes that would lie among lost frames: that the model's error there is not the model's."""

from __future__ import annotations

import numpy as np
import pytest

from elbowscrew import Analysis, Recording, RigidBody, Settings, analyze, compare
from elbowscrew.geometry import dual_quat_from_screw
from elbowscrew.geometry.arrays import Float
from elbowscrew.model import QualityWarning, TrackingLoss
from elbowscrew.motion.interpolation.keyframe_sources import ComparisonPlan

RATE = 100.0
TOP = 90.0


def strokes(stroke_s: float = 1.0) -> Float:
    """Twice out and back by minimum jerk, with rests of half a second, degrees; the tops are corners of no rest."""
    out = np.arange(1, round(stroke_s * RATE) + 1) / round(stroke_s * RATE)
    law = TOP * (10.0 * out**3 - 15.0 * out**4 + 6.0 * out**5)
    rest = np.zeros(50)
    return np.concatenate([rest, law, TOP - law, rest, law, TOP - law, rest])


def taken(angle_deg: Float, lost: slice) -> Recording:
    noisy = angle_deg + np.random.default_rng(1).normal(0.0, 0.05, angle_deg.size)
    pose = dual_quat_from_screw(np.radians(noisy), 0.0 * noisy, [0.0, 0.6, 0.8], [0.1, 0.0, 0.0])
    loss = np.zeros(noisy.size, dtype=np.uint8)
    pose[lost], loss[lost] = np.nan, TrackingLoss.ABSENT
    return Recording.from_bodies([RigidBody(name="b", dual_quat_lab_body=pose, loss=loss)], rate_hz=RATE)


def told(warnings: tuple[QualityWarning, ...]) -> list[str]:
    return [warning.message for warning in warnings if warning.code == "keyframe-at-gap"]


def rms_error(analysis: Analysis) -> float:
    return float(np.degrees(np.sqrt(np.nanmean(analysis.interpolated.angle_error**2))))


@pytest.mark.parametrize("max_gap_s", [0.1, 0.5])
@pytest.mark.parametrize("lost", [slice(135, 166), slice(145, 156)])
def test_a_top_among_lost_frames_is_told_with_the_gap_and_the_size(lost: slice, max_gap_s: float) -> None:
    settings = Settings(max_gap_s=max_gap_s)
    whole, parted = (analyze(taken(strokes(), one), settings) for one in (slice(0), lost))
    assert not told(whole.warnings)
    (message,) = told(parted.warnings)
    assert max_gap_s > 0.1 or rms_error(parted) > 1.5 * rms_error(whole)
    assert f"frames {lost.start} to {lost.stop - 1}" in message
    turn = int(parted.keyframes.frame[1])
    assert f"keyframe {turn} " in message
    if "may go farther" in message:
        known = np.degrees(parted.screw.angle[turn])
        assert TOP - known - 0.2 <= float(message.split("up to ")[1].split()[0].strip("."))
    else:
        assert "s (sd)" in message


def test_a_fast_top_in_a_short_gap_is_told_with_its_height() -> None:
    angle = strokes(0.15)
    lost = slice(61, 70)
    analysis = analyze(taken(angle, lost), Settings(max_gap_s=0.0))
    (message,) = told(analysis.warnings)
    hidden = TOP - float(np.degrees(analysis.screw.angle[analysis.keyframes.frame[1]]))
    assert hidden > 5.0
    about, most = (float(message.split(words)[1].split()[0].strip(".")) for words in ("by about ", "and up to "))
    assert hidden <= about <= 2.5 * hidden
    assert hidden <= most


def test_an_onset_that_is_told_from_lost_frames_is_told() -> None:
    analysis = analyze(taken(strokes(), slice(40, 81)))
    (message,) = told(analysis.warnings)
    assert f"the time of keyframe {analysis.keyframes.frame[0]} is told from frames 40 to 80" in message


def test_gaps_that_move_no_keyframe_are_not_told() -> None:
    recording = taken(strokes(), slice(90, 105))  # half-way up
    assert not told(analyze(taken(strokes(), slice(256, 290))).warnings)  # at rest in the valley
    at_top = taken(strokes(), slice(135, 166))
    assert not told(analyze(at_top, Settings(keyframes=(50, 130, 250))).warnings)  # somebody else's
    assert not told(analyze(recording, Settings(phases="whole")).warnings)


def test_a_comparison_tells_it_too() -> None:
    plan = ComparisonPlan(methods=("sclerp",), laws=("polynomial-345",), counts=(2,), data=("raw",))
    assert told(compare(taken(strokes(), slice(135, 166)), plan=plan).warnings)
