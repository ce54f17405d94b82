"""Sense of the rotation: laws first, then motions whose truth is known from how they were made."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from sense_motions import KINDS, conjugate, made, noisy, product, rotation, share_wrong, smooth, strokes, unit

from elbowscrew.geometry.arrays import Float
from elbowscrew.model import Sense
from elbowscrew.motion.screws.sense import angle_beside, modeled_angle, rotation_noise, sense_of
from elbowscrew.motion.screws.sense_doubts import sense_warnings

AXIS = unit(np.array([1.0, 2.0, -2.0]))
ACROSS = unit(np.array([2.0, -2.0, -1.0]))
SURE_KINDS = [kind for kind in KINDS if "noisy" not in kind and "small" not in kind]


def degrees_of(quat: Float, reference: int = 0) -> Float:
    return np.degrees(sense_of(quat, np.arange(len(quat)) / 100.0, reference).angle)


def hinge(degrees: Float) -> Float:
    return rotation(np.radians(degrees), AXIS)


def found(kind: str, seed: int = 3) -> tuple[Float, Float, Sense]:
    motion = made(kind, seed)
    return motion.quat, motion.time_s, sense_of(motion.quat, motion.time_s, 0)


def aside(tops: Float) -> Float:
    """Strokes about one axis that pass beside the reference, on either side of it in turn, as strokes_sign.csv."""
    x = np.concatenate([[0.0], strokes(tops, 50)])
    side = np.concatenate([[0.0], np.repeat(np.where(np.arange(len(tops)) % 2, -12.0, 12.0), 100)])
    return product(hinge(x), rotation(np.radians(side * np.exp(-((x / 25.0) ** 2))), ACROSS))


@pytest.mark.parametrize("kind", KINDS)
def test_signs_of_the_quaternions_do_not_matter(kind: str) -> None:
    quat, time_s, sense = found(kind)
    other = sense_of(-quat, time_s, 0)
    assert other.angle == pytest.approx(sense.angle, abs=1e-9, nan_ok=True)
    assert other.twist == pytest.approx(sense.twist, abs=1e-9, nan_ok=True)
    assert (other.signed, other.counted, other.tied) == (sense.signed, sense.counted, sense.tied)


@pytest.mark.parametrize("kind", KINDS)
def test_another_frame_turns_the_axis_and_nothing_else(kind: str) -> None:
    quat, time_s, sense = found(kind)
    turn = rotation(np.array([2.0]), ACROSS)
    other = sense_of(product(product(turn, quat), conjugate(turn)), time_s, 0)
    turned = Rotation.from_quat(np.roll(turn[0], -1)).apply(sense.direction)
    assert other.angle == pytest.approx(sense.angle, abs=1e-6, nan_ok=True)
    assert other.ratio == pytest.approx(sense.ratio, abs=1e-9)
    assert other.direction == pytest.approx(turned, abs=1e-6)


@pytest.mark.parametrize("kind", KINDS)
def test_every_second_frame_has_the_angle_that_it_has_among_all(kind: str) -> None:
    quat, time_s, sense = found(kind)
    half = sense_of(quat[::2], time_s[::2], 0)
    clear = np.abs(sense.angle[::2]) > 0.7  # below, the sense may be that of noise
    assert half.angle[clear] == pytest.approx(sense.angle[::2][clear], abs=1e-9)


@pytest.mark.parametrize("kind", [kind for kind in SURE_KINDS if kind != "both_sides"])
def test_time_reversed_gives_the_same_angles(kind: str) -> None:
    quat, time_s, sense = found(kind)
    back = sense_of(quat[::-1], time_s, len(quat) - 1).angle[::-1]
    clear = np.abs(sense.angle) > 0.2
    assert back[clear] == pytest.approx(sense.angle[clear], abs=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_angle_sign_and_turns_describe_the_pose(kind: str) -> None:
    quat, _, sense = found(kind)
    known = np.isfinite(quat[:, 0])
    positive = np.where(quat[:, :1] < 0.0, -quat, quat)[known]
    axis = sense.sign[known, None] * positive[:, 1:]
    axis /= np.maximum(np.linalg.norm(axis, axis=1), 1e-300)[:, None]
    again = rotation(sense.angle[known], axis)
    assert np.abs(np.sum(again * quat[known], axis=1)) == pytest.approx(1.0, abs=1e-12)
    phi = 2.0 * np.arctan2(np.linalg.norm(positive[:, 1:], axis=1), positive[:, 0])
    assert sense.angle[known] == pytest.approx(sense.sign[known] * phi + 2.0 * np.pi * sense.turns[known], abs=1e-12)
    for values in (sense.angle, sense.sign, sense.turns, sense.twist):
        assert (np.isfinite(values) == known).all()


def test_strokes_that_pass_beside_the_reference_all_have_one_sign() -> None:
    sense = sense_of(aside(np.full(4, 85.0)), np.arange(401) / 50.0, 0)
    tops = np.degrees(sense.angle[51::100])
    assert tops == pytest.approx(np.full(4, 85.0), abs=0.1)
    assert np.degrees(np.nanmin(sense.angle)) > -1e-9
    assert sense.signed
    assert sense.ratio < 0.02
    assert np.abs(sense.direction @ AXIS) == pytest.approx(1.0, abs=1e-3)


def test_hyperextension_stays_signed_and_continuous() -> None:
    x = np.concatenate([np.linspace(0.0, -20.0, 20), strokes(np.full(3, 120.0), 60, starts=-20.0)])
    assert degrees_of(hinge(x)) == pytest.approx(x, abs=1e-9)


@pytest.mark.parametrize("top", [90.0, 179.9, 180.0, 180.1, 200.0, 335.0, 359.9, 360.0, 360.1, 720.0])
def test_tops_at_and_beyond_half_and_full_turns(top: float) -> None:
    x = strokes(np.full(3, top), 80)
    assert degrees_of(hinge(x)) == pytest.approx(x, abs=1e-6)
    noise = noisy(hinge(x), 0.2, np.random.default_rng(1))
    noise = product(conjugate(noise[:1]), noise)
    clear = x > 5.0  # nearer the reference, the sense is that of noise
    assert degrees_of(noise)[clear] == pytest.approx(x[clear], abs=3.0)


def test_whole_turns_do_not_hang_on_what_is_lost_on_the_way() -> None:
    x = strokes(np.full(4, 200.0), 60)
    quat = hinge(x)
    quat[(x > 50.0) & (x < 192.0)] = np.nan
    known = np.isfinite(quat[:, 0])
    sense = sense_of(quat, np.arange(len(quat)) / 100.0, 0)
    assert np.degrees(sense.angle[known]) == pytest.approx(x[known], abs=1e-9)
    assert not sense.counted


@pytest.mark.parametrize(("top", "lost"), [(250.0, (60.0, 190.0)), (280.0, (40.0, 150.0)), (330.0, (75.0, 220.0))])
def test_what_a_gap_passes_is_not_what_the_joint_leaves_out(top: float, lost: tuple[float, float]) -> None:
    """Though more of the circle is unseen in the gap than beyond the top."""
    angle = top * np.sin(np.linspace(0.0, 0.5 * np.pi, 301)) ** 2
    quat = hinge(angle)
    quat[(angle > lost[0]) & (angle < lost[1])] = np.nan
    known = np.isfinite(quat[:, 0])
    sense = sense_of(quat, np.arange(301) / 100.0, 0)
    assert np.degrees(sense.angle[known]) == pytest.approx(angle[known], abs=1e-6)
    assert sense.bridged_rows == ()


def test_a_gap_of_more_than_half_a_turn_is_told() -> None:
    """Where it leads to is as far the other way round."""
    angle = 330.0 * np.sin(np.linspace(0.0, 0.5 * np.pi, 301)) ** 2
    lost = (angle > 41.0) & (angle < 247.0)
    quat = hinge(angle)
    quat[lost] = np.nan
    sense = sense_of(quat, np.arange(301) / 100.0, 0)
    assert sense.bridged_rows == (int(np.flatnonzero(lost)[0]) - 1,)


def test_crank_of_several_turns_is_counted_also_over_a_gap() -> None:
    x = np.linspace(0.0, 1500.0, 400)
    quat = hinge(x)
    quat[100:180] = np.nan  # 300 deg: the shortest way across is backward
    known = np.isfinite(quat[:, 0])
    sense = sense_of(quat, np.arange(400) / 100.0, 0)
    assert sense.counted
    assert np.degrees(sense.angle[known]) == pytest.approx(x[known], abs=1e-6)
    assert np.degrees(sense.twist[known]) == pytest.approx(x[known], abs=1e-6)
    assert sense.bridged_rows == (99,)
    told = [doubt for doubt in sense_warnings(sense, np.arange(1000, 1400), "auto") if doubt.code == "turns-over-gap"]
    assert len(told) == 1
    assert "after frame 1099" in told[0].message


def test_short_gaps_of_a_crank_hide_no_turns() -> None:
    quat = hinge(np.linspace(0.0, 1500.0, 400))
    quat[100:110] = np.nan  # 41 deg
    sense = sense_of(quat, np.arange(400) / 100.0, 0)
    assert sense.counted
    assert sense.bridged_rows == ()
    assert not [doubt for doubt in sense_warnings(sense, np.arange(400), "auto") if doubt.code == "turns-over-gap"]


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_fast_cranks_are_counted_either_way_though_no_frame_lies_between_their_places(way: float) -> None:
    """24 deg a frame: the same 15 places in every turn, each gap between them wide enough for a cut."""
    x = np.linspace(0.0, 1440.0, 61)
    sense = sense_of(hinge(way * x), np.arange(61) / 100.0, 0)
    assert sense.counted
    assert np.degrees(sense.angle) == pytest.approx(x, abs=1e-6)


def test_crank_with_every_second_frame_lost_is_counted() -> None:
    x = np.linspace(0.0, 1500.0, 400)
    quat = hinge(x)
    quat[1::2] = np.nan
    quat[100:180] = np.nan
    known = np.isfinite(quat[:, 0])
    assert degrees_of(quat)[known] == pytest.approx(x[known], abs=1e-6)


def test_crank_begins_at_zero_wherever_the_reference_is() -> None:
    x = np.linspace(0.0, 1500.0, 400)
    for reference in (0, 150, 399):
        angle = degrees_of(product(conjugate(hinge(x)[reference : reference + 1]), hinge(x)), reference)
        way = np.sign(angle[-1] - angle[0])
        assert way * angle == pytest.approx(x - x[reference], abs=1e-6)


@pytest.mark.parametrize("seed", range(10))
def test_noise_of_three_degrees(seed: int) -> None:
    x = strokes(np.full(4, 100.0), 60, rest=30)
    quat = noisy(hinge(x), 3.0, np.random.default_rng(seed))
    angle = degrees_of(product(conjugate(quat[:1]), quat))
    assert (np.abs(angle - x) < 30.0).mean() >= 0.998


def test_a_ball_has_no_sense_and_says_so() -> None:
    quat, _, sense = found("ball")
    assert not sense.signed
    assert sense.angle == pytest.approx(2.0 * np.arccos(np.clip(np.abs(quat[:, 0]), 0.0, 1.0)), abs=1e-7)
    assert (sense.sign == 1.0).all()
    assert (sense.turns == 0.0).all()
    assert sense.largest_jump == 0.0


def test_the_setting_decides() -> None:
    wave = np.sin(np.linspace(0.0, 2.0 * np.pi, 200))
    quat = np.concatenate([hinge(60.0 * wave), rotation(np.radians(70.0 * wave), ACROSS)])
    time_s = np.arange(400) / 100.0
    assert not sense_of(quat, time_s, 0).signed
    forced = sense_of(quat, time_s, 0, signed="yes")
    assert forced.signed
    assert np.degrees([forced.angle.min(), forced.angle.max()]) == pytest.approx([-70.0, 70.0], abs=0.1)
    assert not sense_of(hinge(60.0 * wave), time_s[:200], 0, signed="no").signed


def test_no_rotation_has_no_sense() -> None:
    quat = np.tile([1.0, 0.0, 0.0, 0.0], (50, 1))
    sense = sense_of(quat, np.arange(50) / 100.0, 0)
    assert not sense.signed
    assert sense.ratio == 1.0
    assert (sense.angle == 0.0).all()


@pytest.mark.parametrize("count", [1, 2, 5])
def test_few_known_poses(count: int) -> None:
    quat = np.full((30, 4), np.nan)
    quat[:count] = hinge(np.linspace(0.0, 50.0, count))
    assert degrees_of(quat)[:count] == pytest.approx(np.linspace(0.0, 50.0, count))
    assert degrees_of(quat[:count]) == pytest.approx(np.linspace(0.0, 50.0, count))


def test_equal_excursions_take_the_first_for_positive() -> None:
    x = 60.0 * np.sin(np.linspace(0.0, 6.0 * np.pi, 600))
    for way in (1.0, -1.0):
        sense = sense_of(hinge(way * x), np.arange(600) / 100.0, 0)
        assert sense.tied
        assert np.degrees(sense.angle) == pytest.approx(x, abs=1e-9)
        assert sense.direction == pytest.approx(way * AXIS, abs=1e-9)
    larger = sense_of(hinge(np.where(x > 0.0, 0.5 * x, x)), np.arange(600) / 100.0, 0)
    assert not larger.tied
    assert np.degrees(larger.angle.max()) == pytest.approx(60.0, abs=0.01)


def test_of_equal_excursions_a_small_one_before_them_is_not_the_first() -> None:
    x = np.interp(np.arange(500.0), [0, 50, 100, 200, 350, 499], [0.0, -40, 0, 150, -150, 0])
    sense = sense_of(hinge(x), np.arange(500) / 100.0, 0)
    assert sense.tied
    assert np.degrees(sense.angle) == pytest.approx(x, abs=1e-9)


def test_noise_that_the_third_differences_show() -> None:
    x = strokes(np.full(4, 100.0), 60)
    quat = noisy(hinge(x), 0.5, np.random.default_rng(0))
    quat[::7] *= -1.0
    assert np.degrees(rotation_noise(quat)) == pytest.approx(0.5, rel=0.1)
    assert rotation_noise(quat[:20]) == 0.0


def test_a_jump_beyond_the_rotation_itself_is_told() -> None:
    # To 25 deg about the one axis, by the way of an axis across it to 25 deg about its opposite, and on there.
    swing = np.linspace(0.0, np.pi, 30)
    way = np.concatenate([np.linspace(0.0, 90.0, 60), np.linspace(90.0, 25.0, 40)])
    axis = np.cos(swing)[:, None] * AXIS + np.sin(swing)[:, None] * ACROSS
    quat = np.concatenate([hinge(way), rotation(np.radians(np.full(30, 25.0)), axis), hinge(-way[::-1])])
    sense = sense_of(quat, np.arange(len(quat)) / 100.0, 0, signed="yes")
    assert np.degrees(sense.largest_jump) == pytest.approx(50.0, abs=5.0)
    assert sense.jumps == 1
    assert sense.jump_row is not None
    assert 110 < sense.jump_row < 120
    assert sense_of(hinge(way), np.arange(100) / 100.0, 0).jump_row is None


def test_the_band_where_the_reference_decides() -> None:
    random = np.random.default_rng(2)
    one, other = 60.0 * smooth(800, 20.0, random), 26.0 * smooth(800, 20.0, random)
    quat = product(hinge(one), rotation(np.radians(other), ACROSS))
    sense = sense_of(quat, np.arange(800) / 100.0, 0)
    assert sense.doubtful == (0.15 < sense.ratio < 0.25)
    assert sense.doubtful
    assert not sense_of(hinge(one), np.arange(800) / 100.0, 0).doubtful


def test_the_model_goes_the_measured_way_round() -> None:
    x = np.linspace(0.0, 1500.0, 400)
    time_s = np.arange(400) / 100.0
    measured = hinge(x)
    measured[100:180] = np.nan
    sense = sense_of(measured, time_s, 0)
    wrong_by = 8.0 * np.sin(x / 100.0)
    model = product(hinge(x + wrong_by), rotation(np.radians(wrong_by), ACROSS))
    angle, sign = modeled_angle(model, measured, sense, time_s)
    away = np.abs((x + 180.0) % 360.0 - 180.0) > 20.0
    assert np.degrees(angle)[away] == pytest.approx((x + wrong_by)[away], abs=3.0)
    assert np.abs(np.degrees(angle) - x).max() < 25.0
    assert set(np.unique(sign)) == {-1.0, 1.0}
    unsigned = sense_of(measured, time_s, 0, signed="no")
    assert np.degrees(modeled_angle(model, measured, unsigned, time_s)[0]).max() <= 180.0


def test_theta_of_the_model_is_as_near_as_the_model() -> None:
    quat = aside(np.full(4, 85.0))
    time_s = np.arange(len(quat)) / 50.0
    sense = sense_of(quat, time_s, 0)
    model = product(quat, rotation(np.radians(3.0) * np.ones(len(quat)), ACROSS))
    angle, _ = modeled_angle(model, quat, sense, time_s)
    assert np.degrees(np.abs(angle - sense.angle)).max() < 10.0


def test_the_angle_nearest_one_beside_where_the_axes_part() -> None:
    quat = rotation(np.radians([50.0, 50.0]), ACROSS)
    angle, sign = angle_beside(quat, AXIS, np.radians([40.0, -40.0]))
    assert np.degrees(angle) == pytest.approx([50.0, -50.0])
    assert sign.tolist() == [1.0, -1.0]


@pytest.mark.parametrize("kind", KINDS)
def test_motions_of_every_kind(kind: str) -> None:
    """A small version of benchmarks/sense.py; of its 960 motions six are wrong, all where the truth is doubtful."""
    wrong = 0
    for seed in range(5):
        motion = made(kind, seed)
        sense = sense_of(motion.quat, motion.time_s, 0)
        assert sense.signed == motion.signed
        wrong += share_wrong(motion, sense.angle) > 0.002
    assert wrong == 0
