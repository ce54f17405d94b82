"""Frames that an export put in between: found, told, and of no weight for cut-offs and speeds."""

from __future__ import annotations

import numpy as np
import pytest

from elbowscrew import Analysis, Recording, RigidBody, Settings, analyze, simulate_trial
from elbowscrew.geometry import dual_quat_from_screw, sclerp
from elbowscrew.geometry.arrays import Float
from elbowscrew.motion.tracking.inserted import recorded_poses

RATE = 100.0


def strokes(stroke_s: float, rate_hz: float, noise_deg: float) -> Float:
    """Four times out and back by minimum jerk, 90 deg, between rests of half a second; poses (N, 8)."""
    time = np.arange(round((1.0 + 8.0 * stroke_s) * rate_hz)) / rate_hz
    angle = np.zeros(time.size)
    for k in range(8):
        share = np.clip((time - 0.5 - k * stroke_s) / stroke_s, 0.0, 1.0)
        angle += (-1.0) ** k * 90.0 * (10.0 * share**3 - 15.0 * share**4 + 6.0 * share**5)
    angle += np.random.default_rng(7).normal(0.0, noise_deg, time.size)
    return dual_quat_from_screw(np.radians(angle), 0.0 * angle, [0.0, 0.6, 0.8], [0.1, 0.0, 0.0])


def between(pose: Float, factor: int) -> Float:
    """The same with frames put in between on screws, as of an export at another rate."""
    at = np.arange((len(pose) - 1) * factor + 1) / factor
    before = np.minimum(at.astype(int), len(pose) - 2)
    return sclerp(pose[before], pose[before + 1], at - before)


def taken(pose: Float, rate_hz: float) -> Recording:
    body = RigidBody(name="b", dual_quat_lab_body=pose, loss=np.zeros(len(pose), dtype=np.uint8))
    return Recording.from_bodies([body], rate_hz=rate_hz)


def told(analysis: Analysis, code: str) -> list[str]:
    return [warning.message for warning in analysis.warnings if warning.code == code]


@pytest.mark.parametrize("factor", [2, 3, 4, 5, 8])
@pytest.mark.parametrize("stroke_s", [0.3, 2.0])
def test_recorded_frames_are_found_whether_others_are_interpolated_or_repeat_them(factor: int, stroke_s: float) -> None:
    pose = strokes(stroke_s, RATE, 0.1)
    for series, most in ((between(pose, factor), 0), (np.repeat(pose, factor, axis=0), 0)):
        for cut in (0, 1, factor + 1):
            found = recorded_poses(series[cut:])
            assert (found.step, (found.start + cut) % factor) == (factor, most)


def triangles(rows: int) -> Float:
    """Strokes of constant speed of so many frames each, without noise."""
    angle = np.abs((np.arange(20 * rows + 1) + rows) % (2 * rows) - rows) / rows
    return dual_quat_from_screw(angle, 0.0 * angle, [0.0, 0.6, 0.8], [0.1, 0.0, 0.0])


@pytest.mark.parametrize(
    "pose",
    [
        strokes(0.3, RATE, 0.05),
        strokes(2.0, RATE, 0.3),
        strokes(0.2, 60.0, 0.01),  # twelve frames a stroke: each third frame is like any other third
        strokes(0.2, 50.0, 0.0),
        triangles(5),
        triangles(9),
        triangles(18),
        simulate_trial().recording.bodies[0].dual_quat_lab_body,
    ],
)
def test_no_frame_that_was_recorded_counts_as_put_in(pose: Float) -> None:
    assert recorded_poses(pose).step == 1


@pytest.mark.parametrize("factor", [2, 4])
@pytest.mark.parametrize(("stroke_s", "noise_deg"), [(0.3, 0.05), (0.8, 0.05), (0.8, 0.3), (2.0, 0.3)])
def test_frames_put_in_between_change_no_cutoff_and_no_speed(factor: int, stroke_s: float, noise_deg: float) -> None:
    """Cut-offs of 28 to 57 in place of 5 to 12 Hz gave speeds up to a tenth too high, of repeated frames by half."""
    pose = strokes(stroke_s, RATE, noise_deg)
    once = analyze(taken(pose, RATE))
    found = analyze(taken(between(pose, factor), factor * RATE))
    repeated = analyze(taken(np.repeat(pose, factor, axis=0), factor * RATE), Settings(frozen="keep"))
    assert not told(once, "inserted-frames")
    peak = 1.875 * 90.0 / stroke_s
    for one, within in ((once, 0.02), (found, 0.02), (repeated, 0.03)):
        assert np.degrees(one.repetitions.outward_speed) == pytest.approx(peak, rel=within)
        assert not told(one, "speeds-off")
    assert found.instantaneous.lowpass_hz == pytest.approx(once.instantaneous.lowpass_hz, rel=0.02)
    for one in (found, repeated):
        assert f"at {RATE:g} frames per second" in told(one, "inserted-frames")[0]


def test_the_cutoff_of_lowpass_auto_is_that_of_the_recorded_frames() -> None:
    pose = strokes(0.8, RATE, 0.1)
    once, found = (
        analyze(taken(between(pose, factor), factor * RATE), Settings(lowpass_hz="auto")) for factor in (1, 4)
    )
    assert found.joint.lowpass_hz == pytest.approx(once.joint.lowpass_hz, rel=0.02)
    assert len(found.repetitions.number) == 4
