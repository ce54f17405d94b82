"""Phases of the model: where movements whose times are known begin, turn, rest and end."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowscrew import Recording, RigidBody, Settings, analyze, simulate_trial
from elbowscrew.errors import SettingError
from elbowscrew.geometry import dual_quat_from_screw
from elbowscrew.geometry import dual_quaternion as dq

FRAMES, TURN = 450, 211


def found(choice: Settings | None = None, **trial: Any) -> tuple[list[int], list[list[int]]]:
    analysis = analyze(simulate_trial(**trial).recording, choice)
    phases = analysis.keyframes.phases
    return phases.bound_rows.tolist(), phases.law_rows.tolist()


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("noise", [0.0, 0.2])
def test_a_take_that_is_all_movement_has_the_papers_phases(seed: int, noise: float) -> None:
    bounds, laws = found(marker_noise_mm=noise, seed=seed)
    assert bounds[0] == 0
    assert bounds[2] == FRAMES - 1
    assert abs(bounds[1] - TURN) <= (0 if noise == 0.0 else 2)
    assert laws == [[bounds[0], bounds[1]], [bounds[1], bounds[2]]]


@settings(max_examples=8, deadline=None)
@given(
    before=st.floats(0.3, 2.0),
    hold=st.floats(0.4, 2.0),
    after=st.floats(0.3, 2.0),
    frames=st.integers(150, 700),
    share=st.floats(0.35, 0.65),
)
def test_rests_before_at_the_top_and_after_are_left_out(
    before: float, hold: float, after: float, frames: int, share: float
) -> None:
    turn = round(share * frames)
    bounds, laws = found(
        frames=frames, inversion=turn, rest_before_s=before, hold_s=hold, rest_after_s=after, marker_noise_mm=0.1
    )
    start, hold_frames = round(100 * before), round(100 * hold)
    expected = [[start, start + turn], [start + turn + hold_frames, start + frames - 1 + hold_frames]]
    assert np.abs(np.array(laws) - expected).max() <= 0.04 * frames
    assert (bounds[0], bounds[2]) == (laws[0][0], laws[1][1])
    assert laws[0][1] <= bounds[1] <= laws[1][0]


def test_every_turn_and_every_pause_of_repetitions_is_a_bound() -> None:
    bounds, laws = found(repetitions=3, hold_s=0.6, rest_before_s=1.0, rest_after_s=1.0)
    period = FRAMES - 1 + 60
    tops = [100 + TURN + 30 + k * period for k in range(3)]
    feet = [100 + k * period for k in range(1, 3)]
    assert np.abs(np.array(bounds[1:-1:2]) - tops).max() <= 30
    assert np.abs(np.array(bounds[2:-1:2]) - feet).max() <= 6
    assert len(laws) == 6


def test_phases_over_the_whole_take_run_from_bound_to_bound() -> None:
    trial = simulate_trial(rest_before_s=1.0, rest_after_s=1.0, marker_noise_mm=0.01).recording
    analysis = analyze(trial, Settings(phases="whole"))
    phases, top = analysis.keyframes.phases, int(analysis.repetitions.inversion_frame[0])
    assert abs(top - (100 + TURN)) <= 1
    assert phases.bound_rows.tolist() == [0, top, FRAMES + 199]
    assert phases.law_rows.tolist() == [[0, top], [top, FRAMES + 199]]


def test_an_inversion_that_is_given_is_the_only_one() -> None:
    trial = simulate_trial(repetitions=2, rest_before_s=1.0).recording
    analysis = analyze(trial, Settings(inversion=400))
    assert analysis.inversion_rows.tolist() == [400]
    with pytest.raises(SettingError, match="not between"):
        analyze(trial, Settings(inversion=0))


def test_a_gap_is_no_rest() -> None:
    """The twist is not known about a gap, and is not needed: the angle goes on."""
    for seed in range(6):
        bounds, laws = found(gaps=5, gap_frames=6, seed=seed)
        assert laws == [[0, bounds[1]], [bounds[1], FRAMES - 1]]
        assert abs(bounds[1] - TURN) <= 3


def test_a_rest_on_the_way_parts_phases_and_is_no_inversion() -> None:
    """A hinge that flexes by 60 deg, rests, flexes by 60 more, and returns."""
    time = np.arange(900) / 100.0
    angle = np.zeros(time.size)
    for turn, begin, end in ((60.0, 0.0, 2.0), (60.0, 3.0, 5.0), (-120.0, 5.0, 8.99)):
        tau = np.clip((time - begin) / (end - begin), 0.0, 1.0)
        angle += np.radians(turn) * tau**3 * (10.0 - 15.0 * tau + 6.0 * tau**2)
    pose = dual_quat_from_screw(angle, 0.0, [0.0, 0.0, 1.0], [0.0, 0.1, 0.0])
    jitter = np.random.default_rng(0).normal(scale=1e-5, size=(time.size, 3))
    pose = dq.multiply(pose, dq.dual_quat_from_pose([1.0, 0.0, 0.0, 0.0], jitter))
    body = RigidBody(name="b", dual_quat_lab_body=pose, loss=np.zeros(time.size, dtype=np.uint8))
    analysis = analyze(Recording.from_bodies([body], rate_hz=100))
    bounds, laws = analysis.keyframes.phases.bound_rows, analysis.keyframes.phases.law_rows
    assert laws[:, 0] == pytest.approx([0, 300, 500], abs=8)
    assert laws[:, 1] == pytest.approx([200, 500, 899], abs=8)
    assert 200 < bounds[1] < 300
    assert analysis.inversion_rows.tolist() == [bounds[2]]
