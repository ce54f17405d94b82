"""Which poses the motion starts from, and what is said where there are none, with the way on."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from elbowscrew import RigidBody, Settings, analyze, simulate_trial
from elbowscrew.errors import AnalysisError, SettingError
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Float
from elbowscrew.model import JointMotion
from elbowscrew.motion.screws.relative import IDENTITY, displacement, expressed, frame_change, joint_from_bodies

TRIAL = simulate_trial(frames=60, inversion=30, proximal="moving", seed=4).recording
ARM, FOREARM = TRIAL.bodies
FRAME = np.arange(200, 260)


def without(body: RigidBody, rows: Any) -> RigidBody:
    """The body, lost in these rows."""
    pose, loss = body.dual_quat_lab_body.copy(), body.loss.copy()
    pose[rows] = np.nan
    loss[rows] = 1
    return replace(body, dual_quat_lab_body=pose, loss=loss)


def joint(proximal: RigidBody | None, distal: RigidBody, reference: int | None = None, window: int = 1) -> JointMotion:
    return joint_from_bodies(proximal, distal, FRAME, TRIAL.time_s, TRIAL.rate_hz, reference_row=reference,
                             reference_window=window, max_gap_s=0.1)  # fmt: skip


def relative(row: int) -> Float:
    pose = dq.multiply(dq.conjugate(ARM.dual_quat_lab_body[row]), FOREARM.dual_quat_lab_body[row])
    return np.asarray(pose)


def same_pose(one: Float, other: Float) -> bool:
    return bool(min(np.abs(one - other).max(), np.abs(one + other).max()) < 1e-9)


def test_no_frame_with_both_bodies_names_what_is_missing_and_where_to_look() -> None:
    first, second = without(ARM, slice(0, 30)), without(FOREARM, slice(30, 60))
    with pytest.raises(AnalysisError) as both:
        joint(first, second)
    assert str(both.value).startswith("no frame has 'Upper Arm' and 'Forearm' both tracked: ")
    with pytest.raises(AnalysisError) as alone:
        joint(None, without(FOREARM, slice(0, 60)))
    assert str(alone.value).startswith("no frame has 'Forearm' tracked: ")
    for caught in (both, alone):
        assert "nothing to analyze" in str(caught.value)
        assert str(caught.value).endswith("see `elbowscrew info` for what the file holds")


def test_the_reference_is_the_first_frame_with_both_or_the_one_that_is_asked_for() -> None:
    late = without(ARM, slice(0, 3))
    assert joint(late, FOREARM).reference_row == 3
    assert same_pose(joint(late, FOREARM).reference, relative(3))
    assert joint(late, FOREARM, reference=7).reference_row == 7
    assert same_pose(joint(late, FOREARM, reference=7).reference, relative(7))
    with pytest.raises(SettingError) as caught:
        joint(late, FOREARM, reference=1)
    assert str(caught.value).startswith("--reference 201: ")
    assert str(caught.value).endswith("is 203")


def test_a_window_takes_measured_frames_alone_and_no_fewer() -> None:
    found = joint(without(FOREARM, [5, 7]), without(FOREARM, [5, 7]), reference=4, window=3)  # a body beside itself
    assert same_pose(found.reference, IDENTITY)
    assert joint(ARM, FOREARM, reference=57, window=3).reference_row == 57
    with pytest.raises(SettingError) as caught:
        joint(ARM, FOREARM, reference=57, window=4)
    assert str(caught.value) == "--reference-window 4: only 3 measured frames follow the reference"
    still = replace(FOREARM, dual_quat_lab_body=np.tile(relative(0), (60, 1)))
    assert same_pose(joint(None, still, window=5).reference, relative(0))


@pytest.mark.parametrize("express_in", ["distal", "proximal", "lab"])
def test_a_displacement_in_another_frame_is_the_same_motion_of_the_same_points(express_in: Any) -> None:
    """Points fixed to the distal body go where the measured poses take them, seen from the frame that is asked for."""
    found = joint(ARM, FOREARM, reference=2)
    moved = expressed(displacement(found), found, express_in)
    change = frame_change(found, express_in)
    points = np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.2, 0.05]])
    for row in (2, 20, 45):
        start = dq.transform_points(change, points)
        seen_from = {
            "distal": dq.conjugate(relative(2)),
            "proximal": IDENTITY,
            "lab": ARM.dual_quat_lab_body[2],
        }[express_in]
        wanted = dq.transform_points(dq.multiply(seen_from, relative(row)), points)
        assert dq.transform_points(moved[row], start) == pytest.approx(wanted, abs=1e-9)
    assert displacement(found)[2] == pytest.approx(IDENTITY, abs=1e-12)


def test_only_short_gaps_are_filled() -> None:
    """0.1 s is 10 frames at 100 Hz."""
    rate = TRIAL.rate_hz
    short, long = int(0.1 * rate) - 1, int(0.1 * rate) + 5
    lost = [*range(10, 10 + short), *range(25, 25 + long)]
    found = joint(ARM, without(FOREARM, lost))
    assert np.flatnonzero(found.filled).tolist() == list(range(10, 10 + short))
    assert np.flatnonzero(~found.measured).tolist() == lost


def test_a_rotation_too_small_for_an_axis_is_told_with_its_size_and_the_limit() -> None:
    recording = simulate_trial(frames=60, inversion=30, top_deg=40.0).recording
    largest = np.degrees(np.abs(analyze(recording).screw.angle)).max()
    with pytest.raises(AnalysisError) as caught:
        analyze(recording, Settings(min_angle_deg=60.0))
    text = str(caught.value)
    assert text.startswith(
        f"the largest rotation since the reference is {largest:.3g} deg, less than the 60 deg an axis needs"
    )
    assert text.endswith("(min_angle_deg sets the limit)")
