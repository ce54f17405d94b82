"""Keyframes, knots, laws and methods of the model."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from elbowscrew import Analysis, Recording, RigidBody, Settings, analyze
from elbowscrew.errors import SettingError
from elbowscrew.geometry import dual_quat_from_screw, line_through
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Float
from elbowscrew.model import TrackingLoss
from elbowscrew.motion.interpolation.laws import LAWS
from elbowscrew.motion.interpolation.modeling import METHODS

FRAMES, TURN = 101, 40
LINE = line_through([0.1, -0.2, 0.05], [0.2, 0.9, -0.3])


def trial(angle: Float | None = None, slide: float = 0.02) -> Recording:
    if angle is None:
        i = np.arange(FRAMES)
        angle = 2.0 * np.where(i <= TURN, i / TURN, (FRAMES - 1 - i) / (FRAMES - 1 - TURN))
    pose = dual_quat_from_screw(angle, slide * angle, LINE[:3], LINE[3:])
    return Recording.from_bodies(
        [RigidBody(name="b", dual_quat_lab_body=pose, loss=np.zeros(len(pose), dtype=np.uint8))], rate_hz=100
    )


def modeled(recording: Recording | None = None, **settings: Any) -> Analysis:
    return analyze(recording or trial(), Settings(**settings))


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS.keys())
def test_laws_run_from_rest_to_rest_and_are_symmetric(law: Any) -> None:
    tau = np.linspace(0.0, 1.0, 101)
    t = law(tau)
    assert t[[0, -1]].tolist() == [0.0, 1.0]
    assert (np.diff(t) >= 0).all()
    assert t + t[::-1] == pytest.approx(np.ones(101))


def test_the_cycloidal_law_has_no_speed_and_no_acceleration_at_its_ends() -> None:
    h = 1e-4
    t = LAWS["cycloidal"](np.array([h, 2 * h, 1 - h, 1 - 2 * h]))
    # t is (2 pi)^2 / 6 tau^3 to first order.
    assert t[0] == pytest.approx((2 * np.pi) ** 2 / 6 * h**3, rel=1e-5)
    assert 1 - t[2] == pytest.approx((2 * np.pi) ** 2 / 6 * h**3, rel=1e-3)


def test_default_keyframes_are_start_inversion_and_end() -> None:
    keyframes = modeled().keyframes
    assert keyframes.frame.tolist() == [0, TURN, FRAMES - 1]
    assert modeled().inversion_rows.tolist() == [TURN]
    assert keyframes.phase_bounds.tolist() == [0, 1, 2]


def test_linear_sclerp_of_a_uniform_screw_is_exact() -> None:
    result = modeled(method="sclerp", law="linear").interpolated
    assert np.nanmax(result.rms_displacement) < 1e-12
    assert np.nanmax(result.angle_error) < 1e-7


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("blend", ["piecewise", "global"])
@pytest.mark.parametrize("law", ["cycloidal", "linear"])
def test_with_law_knots_the_model_meets_every_keyframe_at_its_own_time(method: Any, blend: Any, law: Any) -> None:
    frames = (0, 13, TURN, 55, 80, FRAMES - 1)
    result = modeled(method=method, blend=blend, law=law, keyframes=frames).interpolated
    assert result.rms_displacement[list(frames)] == pytest.approx(np.zeros(6), abs=1e-12)
    assert result.phase.tolist() == [1] * TURN + [2] * (FRAMES - TURN)


@pytest.mark.parametrize("knots", ["chord", "uniform", "angle"])
def test_other_knots_meet_the_ends_of_the_phases(knots: Any) -> None:
    result = modeled(knots=knots, keyframes=(0, 13, TURN, 55, FRAMES - 1))
    assert result.interpolated.rms_displacement[[0, TURN, FRAMES - 1]] == pytest.approx(np.zeros(3), abs=1e-12)
    assert [knot[[0, -1]].tolist() for knot in result.keyframes.knots] == [[0.0, 1.0], [0.0, 1.0]]


def test_knots_are_what_their_names_say() -> None:
    frames = (0, 10, TURN, FRAMES - 1)
    # Uniform angle against time: 10 of 40 frames are a quarter of the turn.
    assert modeled(knots="angle", keyframes=frames).keyframes.knots[0] == pytest.approx([0, 0.25, 1])
    assert modeled(knots="uniform", keyframes=frames).keyframes.knots[0] == pytest.approx([0, 0.5, 1])
    tau = 0.25
    expected = tau - np.sin(2 * np.pi * tau) / (2 * np.pi)
    assert modeled(knots="law", keyframes=frames).keyframes.knots[0] == pytest.approx([0, expected, 1])
    both = modeled(knots="law", blend="global", keyframes=frames).keyframes.knots
    assert both[0] == pytest.approx([0, expected / 2, 0.5, 1])
    # Origin on a circle of radius r about the axis, slide s per radian.
    radius = np.linalg.norm(np.cross(LINE[:3], LINE[3:]))
    turn = np.array([0.5, 1.5])
    chords = np.hypot(2 * radius * np.sin(turn / 2), 0.02 * turn)
    found = modeled(knots="chord", keyframes=frames).keyframes.knots[0]
    assert found == pytest.approx([0, chords[0] / chords.sum(), 1])


def test_chord_knots_of_an_origin_that_does_not_move_name_the_other_choices() -> None:
    angle = np.sin(np.linspace(0, np.pi, FRAMES))
    pose = dual_quat_from_screw(angle, 0.0, [0.0, 0.0, 1.0], [0.0, 0.0, 0.0])
    still = Recording.from_bodies(
        [RigidBody(name="b", dual_quat_lab_body=pose, loss=np.zeros(FRAMES, dtype=np.uint8))], rate_hz=100
    )
    with pytest.raises(SettingError, match="law, uniform, angle"):
        modeled(still, knots="chord", keyframes=(0, 20, 50, 100))
    # Nor is the last digit of an export a motion of the origin.
    noise = np.random.default_rng(0).normal(scale=1e-6, size=(FRAMES, 3))
    jitter = dq.multiply(dq.dual_quat_from_pose([1.0, 0, 0, 0], noise), pose)
    still.bodies[0].dual_quat_lab_body[:] = jitter
    with pytest.raises(SettingError, match="law, uniform, angle"):
        modeled(still, knots="chord", keyframes=(0, 20, 50, 100))


@pytest.mark.parametrize(("frames", "largest_deg"), [(2, 2.870), (3, 1.282), (4, 0.0329), (5, 0.00582)])
def test_known_errors_of_blending_a_hinge(frames: int, largest_deg: float) -> None:
    """A hinge of 0 to 130 deg under DLB with uniform Lagrange knots, against an independent computation."""
    count = 1201
    rows = np.linspace(0, count - 1, frames).astype(int)
    result = modeled(
        trial(np.linspace(0.0, np.radians(130.0), count)), law="linear", knots="uniform", keyframes=tuple(rows.tolist())
    )
    assert np.degrees(result.interpolated.angle_error.max()) == pytest.approx(largest_deg, rel=2e-3)


def test_a_motion_that_does_not_turn_back_is_one_phase_with_a_warning() -> None:
    result = modeled(trial(np.linspace(0, 2, 50)))
    assert result.keyframes.frame.tolist() == [0, 49]
    assert "no-inversion" in [warning.code for warning in result.warnings]


def test_the_inversion_among_given_keyframes_is_the_largest_angle() -> None:
    assert modeled(keyframes=(0, 30, 50, 100)).inversion_rows.tolist() == [50]
    assert modeled(keyframes=(0, 30, 50, 100), inversion=30).inversion_rows.tolist() == [30]
    assert modeled(inversion=60).keyframes.frame.tolist() == [0, 60, 100]


@pytest.mark.parametrize(
    ("settings", "says"),
    [
        ({"reference": 101}, "reference=101: no such frame; the file has frames 0 to 100"),
        ({"inversion": -1}, "inversion=-1: no such frame"),
        ({"keyframes": (0, 40, 400)}, "keyframes=400: no such frame"),
        ({"inversion": 0}, "not between"),
        ({"inversion": 100}, "not between"),
        ({"inversion": 70}, "tracking lost"),
        ({"keyframes": (0, 70, 100)}, "tracking lost"),
        ({"reference": 70}, "reference=70: .* the first frame that has both bodies is 0"),
        ({"reference": 99, "reference_window": 5}, "only 2 measured"),
    ],
)
def test_settings_that_do_not_fit_the_recording(settings: dict[str, Any], says: str) -> None:
    recording = trial()
    recording.bodies[0].dual_quat_lab_body[60:80] = np.nan
    recording.bodies[0].loss[60:80] = TrackingLoss.BLANK
    with pytest.raises(SettingError, match=says):
        modeled(recording, **settings)


def test_a_keyframe_in_a_filled_gap_is_used_with_a_warning() -> None:
    recording = trial()
    recording.bodies[0].dual_quat_lab_body[70] = np.nan
    recording.bodies[0].loss[70] = TrackingLoss.BLANK
    result = modeled(recording, keyframes=(0, 40, 70, 100))
    assert "filled-keyframe" in [warning.code for warning in result.warnings]
    assert np.isnan(result.interpolated.rms_displacement[70])


def test_a_polynomial_through_many_poses_is_refused() -> None:
    with pytest.raises(SettingError, match="weighs them by up to"):
        modeled(keyframes=tuple(range(0, 101, 2)), knots="uniform")
    assert modeled(keyframes=tuple(range(0, 101, 2)), method="sclerp").keyframes.row.size == 51


def test_a_blend_that_cancels_is_empty_and_warned_of() -> None:
    # A full turn: the last pose is minus the first, and half way the blend is nothing.
    result = modeled(trial(np.linspace(0.0, 2.0 * np.pi, 101)), law="linear", keyframes=(0, 100))
    assert "blend-vanishes" in [warning.code for warning in result.warnings]
    assert np.isnan(result.interpolated.angle[50])
