"""What an analysis makes of the sense of theta: angle, axes, model, speeds, summary and warnings."""

from __future__ import annotations

import numpy as np
import pytest
from sense_motions import conjugate, product, rotation, smooth, strokes, unit

from elbowscrew import Analysis, ComparisonPlan, Recording, RigidBody, Settings, analyze, compare
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import dual_quat_from_pose
from elbowscrew.motion.interpolation.rebuilding import interpolate, keyframes_of
from elbowscrew.results.summary import summary_from_analysis

AXIS = unit(np.array([1.0, 0.2, -0.1]))
ACROSS = unit(np.cross(AXIS, [0.0, 0.0, 1.0]))
ARM = np.array([0.1, 0.2, 0.3])


def recording_of(quat: Float, rate_hz: float = 100.0) -> Recording:
    """A body that turns about a fixed point 0.2 m from its origin."""
    lever = np.array([0.0, -0.2, 0.0])
    turned = product(product(quat, np.tile(np.concatenate([[0.0], lever]), (len(quat), 1))), conjugate(quat))[:, 1:]
    pose = dual_quat_from_pose(quat, ARM - turned)
    body = RigidBody(name="b", dual_quat_lab_body=pose, loss=np.zeros(len(quat), dtype=np.uint8))
    return Recording.from_bodies([body], rate_hz=rate_hz)


def beside_the_reference() -> Float:
    """Four strokes of 85 deg that pass beside the reference, on either side of it in turn, as strokes_sign.csv."""
    x = strokes(np.full(4, 85.0), 50)
    frame = np.arange(x.size)
    aside = sum(way * 12.0 * np.exp(-(((frame - turn) / 10.0) ** 2)) for turn, way in ((100, 1), (200, -1), (300, 1)))
    return product(rotation(np.radians(x), AXIS), rotation(np.radians(aside), ACROSS))


def ball() -> Float:
    random = np.random.default_rng(4)
    vector = np.radians(40.0) * np.column_stack([smooth(600, 25.0, random) for _ in range(3)])
    size = np.linalg.norm(vector, axis=1)
    quat = rotation(size, vector / size[:, None])
    return product(conjugate(quat[:1]), quat)


def codes(analysis: Analysis) -> set[str]:
    return {warning.code for warning in analysis.warnings}


@pytest.fixture(scope="module")
def unsigned() -> Analysis:
    return analyze(recording_of(ball()))


def test_strokes_beside_the_reference_are_alike() -> None:
    analysis = analyze(recording_of(beside_the_reference(), 50.0))
    summary = summary_from_analysis(analysis)
    motion, model = summary["motion"], summary["interpolation"]
    assert np.degrees(analysis.screw.angle[50::100]) == pytest.approx(np.full(4, 85.0), abs=0.1)
    assert np.degrees(analysis.screw.angle.min()) > -1e-9
    assert motion["signed"]
    assert motion["dominant_axis"]["ratio"] < 0.02
    assert motion["dominant_axis"]["direction"] == pytest.approx(AXIS, abs=0.02)
    assert analysis.mean_axis.direction == pytest.approx(AXIS, abs=0.03)
    assert motion["largest_jump_deg"] < 1.0
    assert motion["axis_dispersion_weighted_deg"] is not None
    assert motion["axis_dispersion_weighted_deg"] < 10.0
    # The model's theta is off by what the model is off.
    off, off_in_all = model["rmse_theta_deg"], model["rms_angle_error_deg"]
    assert off is not None
    assert off_in_all is not None
    assert off < off_in_all + 1.0
    assert model["covered_share"] == 1.0
    assert not codes(analysis) & {"unsigned", "sense-doubtful", "sense-tied", "theta-jumps"}


def test_the_axes_of_the_screw_describe_the_pose_whatever_the_sense() -> None:
    for quat in (beside_the_reference(), ball()):
        screw = analyze(recording_of(quat)).screw
        known = screw.axis_known
        again = rotation(screw.angle[known], screw.axis_direction[known])
        assert np.abs(np.sum(again * screw.euler_parameters[known], axis=1)) == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("express_in", ["distal", "proximal", "lab"])
def test_theta_is_the_same_in_every_frame_and_its_axis_turns_with_it(express_in: str) -> None:
    turned = product(rotation(np.array([1.0]), ACROSS), beside_the_reference())
    settings = Settings.model_validate({"express_in": express_in})
    analysis = analyze(recording_of(turned), settings)
    assert analysis.screw.angle == pytest.approx(analyze(recording_of(beside_the_reference())).screw.angle, abs=1e-7)
    assert analysis.sense.direction @ analysis.mean_axis.direction == pytest.approx(1.0, abs=1e-3)


def test_the_model_of_a_crank_begins_where_the_motion_does() -> None:
    x = strokes(np.array([900.0]), 400)[:401]
    analysis = analyze(recording_of(rotation(np.radians(x), AXIS)))
    rows = analysis.keyframes.row
    assert np.degrees(analysis.screw.angle[rows]) == pytest.approx(x[rows], abs=1e-6)
    assert np.degrees(analysis.interpolated.angle[rows]) == pytest.approx(x[rows], abs=1e-6)


def test_without_a_sense_what_carries_one_is_empty(unsigned: Analysis) -> None:
    motion = summary_from_analysis(unsigned)["motion"]
    assert "unsigned" in codes(unsigned)
    assert not motion["signed"]
    assert motion["dominant_axis"]["ratio"] > 0.25
    angle = unsigned.screw.angle
    assert (angle >= 0.0).all()
    assert (angle <= np.pi).all()
    assert np.nanmin(unsigned.instantaneous.angular_velocity) >= 0.0
    assert np.isnan(unsigned.repetitions.outward_speed).all()
    assert np.isnan(unsigned.repetitions.back_speed).all()
    assert np.nanmax(unsigned.interpolated.axis_error) <= 0.5 * np.pi
    assert np.nanmin(unsigned.interpolated.angle) >= 0.0


def test_the_models_of_a_comparison_are_measured_as_lines_where_there_is_no_sense() -> None:
    plan = ComparisonPlan(methods=("sclerp",), laws=("linear",), counts=(3,), data=("raw",))
    models = compare(recording_of(ball()), plan=plan).models
    assert np.nanmax(models.max_axis_error) <= 0.5 * np.pi


@pytest.mark.parametrize("quat", [beside_the_reference(), ball()], ids=["signed", "unsigned"])
def test_a_motion_rebuilt_from_its_keyframes_has_the_sense_of_theirs(quat: Float) -> None:
    keyframes = keyframes_of(analyze(recording_of(quat)))
    motion = interpolate(keyframes, 501)
    nearest = np.abs(motion.time_s[:, None] - keyframes.time_s).argmin(axis=0)
    assert motion.angle[nearest] == pytest.approx(keyframes.angle, abs=0.2)


def test_the_setting_decides_and_is_not_doubted() -> None:
    forced = analyze(recording_of(ball()), Settings(signed="yes"))
    assert forced.sense.signed
    assert not codes(forced) & {"unsigned", "sense-doubtful"}
    assert np.isfinite(forced.repetitions.outward_speed).all()
    flat = analyze(recording_of(beside_the_reference()), Settings(signed="no"))
    assert not flat.sense.signed
    assert "unsigned" not in codes(flat)


def test_a_sense_that_hangs_on_the_reference_is_told() -> None:
    random = np.random.default_rng(2)
    one, other = 60.0 * smooth(800, 20.0, random), 26.0 * smooth(800, 20.0, random)
    analysis = analyze(recording_of(product(rotation(np.radians(one), AXIS), rotation(np.radians(other), ACROSS))))
    assert 0.15 < analysis.sense.ratio < 0.25
    (message,) = (warning.message for warning in analysis.warnings if warning.code == "sense-doubtful")
    assert "--signed" in message
    assert "--reference" in message


def test_equal_excursions_are_told() -> None:
    x = 60.0 * np.sin(np.linspace(0.0, 6.0 * np.pi, 600))
    assert "sense-tied" in codes(analyze(recording_of(rotation(np.radians(x), AXIS))))


def test_a_leap_of_theta_is_told_with_its_frame() -> None:
    swing = np.linspace(0.0, np.pi, 60)
    way = np.concatenate([np.linspace(0.0, 90.0, 120), np.linspace(90.0, 25.0, 80)])
    axis = np.cos(swing)[:, None] * AXIS + np.sin(swing)[:, None] * ACROSS
    parts = [rotation(np.radians(way), AXIS), rotation(np.radians(np.full(60, 25.0)), axis)]
    quat = np.concatenate([*parts, rotation(np.radians(-way[::-1]), AXIS)])
    analysis = analyze(recording_of(quat))
    (message,) = (warning.message for warning in analysis.warnings if warning.code == "theta-jumps")
    assert f"after frame {analysis.sense.jump_row}" in message


def test_a_rest_does_not_rule_the_dispersion() -> None:
    """The axis is off where the joint rests: ten times as long a rest is all that the plain median sees."""
    x = strokes(np.array([120.0]), 150)
    rest = 14.0 + 0.2 * np.sin(np.arange(3000.0))
    x = np.concatenate([x[:30], rest, x[30:]])
    off = np.where(x < 16.0, 0.3, 0.05 * np.sin(np.radians(3.0 * x)))
    axis = np.cos(off)[:, None] * AXIS + np.sin(off)[:, None] * ACROSS
    quat = rotation(np.radians(x), axis)
    moving = np.ones(x.size, dtype=np.bool_)
    moving[30:3030] = False
    whole, alone = (summary_from_analysis(analyze(recording_of(one)))["motion"] for one in (quat, quat[moving]))
    assert whole["axis_frames"] > alone["axis_frames"] + 2900
    assert whole["axis_dispersion_deg"] == pytest.approx(alone["axis_dispersion_deg"], abs=0.1)
    of_frames = np.array([one["axis_dispersion_all_frames_deg"] for one in (whole, alone)], dtype=np.float64)
    assert abs(np.diff(of_frames)) > 0.5


def swing(top_deg: float) -> Recording:
    """A hinge out to an angle and back, minimum jerk, once."""
    share = 1.0 - np.abs(np.linspace(-1.0, 1.0, 301))
    angle = np.radians(top_deg * share**3 * (10.0 - 15.0 * share + 6.0 * share**2))
    return recording_of(rotation(angle, AXIS))


@pytest.mark.parametrize(
    ("top_deg", "method", "told"),
    [
        (170.0, "dlb", False),
        (200.0, "dlb", True),
        (355.0, "sdlb", True),
        (355.0, "sclerp", False),
        (355.0, "joint", False),
    ],
)
def test_a_blend_over_more_than_half_a_turn_is_told_with_what_helps(top_deg: float, method: str, told: bool) -> None:
    found = analyze(swing(top_deg), Settings.model_validate({"method": method}))
    messages = [one.message for one in found.warnings if one.code == "keyframes-too-far-apart"]
    assert bool(messages) == told
    if told:
        assert f"turns by {top_deg:.0f} deg" in messages[0]
        assert "--method sclerp or joint; or keyframes less than half a turn apart (--keyframes" in messages[0]
    else:
        assert np.degrees(np.nanmax(found.interpolated.angle_error)) < 15.0


@pytest.mark.parametrize("method", ["dlb", "sclerp", "joint"])
def test_whole_turns_between_keyframes_are_told_of_by_every_method(method: str) -> None:
    crank = recording_of(rotation(np.radians(np.linspace(0.0, 1500.0, 301)), AXIS))
    (message,) = (
        one.message
        for one in analyze(crank, Settings.model_validate({"method": method})).warnings
        if one.code == "keyframes-too-far-apart"
    )
    assert "turns by 1500 deg, more than a whole turn" in message
    close = analyze(crank, Settings(keyframes=tuple(range(0, 301, 20)), law="linear"))
    assert "keyframes-too-far-apart" not in {one.code for one in close.warnings}
    assert np.degrees(np.nanmax(close.interpolated.angle_error)) < 5.0
