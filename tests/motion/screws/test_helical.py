"""Continuity of angle and axis, and the mean axis."""

from __future__ import annotations

import numpy as np
import pytest

from elbowscrew.geometry import dual_quat_from_screw, line_through
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import continuous_signs
from elbowscrew.motion.axes.mean_axis import mean_axis_of
from elbowscrew.motion.screws.helical import HelicalSeries, helical_series
from elbowscrew.motion.screws.sense import sense_of

LINE = line_through([0.2, -0.1, 0.3], [1.0, 2.0, 2.0])
MIN_ANGLE = np.radians(10.0)


def turned(angle: Float) -> Float:
    return continuous_signs(dual_quat_from_screw(angle, 0.01 * angle, LINE[:3], LINE[3:]))


def series_of(poses: Float) -> HelicalSeries:
    sense = sense_of(poses[:, :4], np.arange(len(poses)) / 100.0, 0)
    return helical_series(poses, MIN_ANGLE, sense.angle, sense.sign)


@pytest.mark.parametrize(
    "angle",
    [
        np.linspace(0.0, 6.0, 100),
        np.linspace(0.0, 9.0, 200),  # beyond a full turn
        np.sin(np.linspace(0.0, 12.0, 300)),  # through the reference again and again
        np.concatenate([np.linspace(0, 3.5, 80), np.linspace(3.5, -3.5, 160)]),
    ],
)
def test_angle_is_continuous_and_the_axis_keeps_its_direction(angle: Float) -> None:
    series = series_of(turned(angle))
    sense = np.sign(series.angle[10] * angle[10])
    assert sense * series.angle == pytest.approx(angle, abs=1e-9)
    known = np.isfinite(series.slide)
    assert (known == (np.abs(np.sin(angle / 2)) >= np.sin(MIN_ANGLE / 2))).all()
    assert sense * series.direction[known] == pytest.approx(np.tile(LINE[:3], (known.sum(), 1)), abs=1e-9)
    assert sense * series.slide[known] == pytest.approx(0.01 * angle[known], abs=1e-9)
    assert series.point[known] == pytest.approx(np.tile(np.cross(LINE[:3], LINE[3:]), (known.sum(), 1)), abs=1e-9)


def test_gaps_do_not_break_the_continuity() -> None:
    angle = np.linspace(0.0, 4.0, 100)
    poses = turned(angle)
    poses[40:60] = np.nan
    series = series_of(continuous_signs(poses))
    known = np.isfinite(poses[:, 0])
    assert series.angle[known] == pytest.approx(angle[known], abs=1e-9)
    assert np.isnan(series.angle[~known]).all()


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_the_line_follows_the_sense_that_is_told_whatever_sign_a_pose_has(way: float) -> None:
    angle = np.linspace(3.0, 6.0, 60)  # the quaternion's scalar part goes through zero
    sign = way * np.where(angle <= np.pi, 1.0, -1.0)
    for poses in (turned(angle), -turned(angle)):
        series = helical_series(poses, MIN_ANGLE, way * angle, sign)
        assert series.angle == pytest.approx(way * angle)
        assert series.direction == pytest.approx(np.tile(way * LINE[:3], (60, 1)), abs=1e-9)
        assert series.slide == pytest.approx(way * 0.01 * angle, abs=1e-9)


def test_mean_axis_of_one_line_is_the_line() -> None:
    angle = np.linspace(0.2, 2.0, 30)
    line = np.tile(LINE, (30, 1))
    line[3] = np.nan
    mean = mean_axis_of(angle, line, np.zeros(3))
    assert mean.direction == pytest.approx(LINE[:3])
    assert mean.point == pytest.approx(np.cross(LINE[:3], LINE[3:]))
    assert np.nanmax(mean.deviation) < 1e-7
    assert np.nanmax(mean.distance) < 1e-9
    assert np.isnan(mean.deviation[3])


@pytest.mark.parametrize("cloud", ["round", "flat", "with outliers", "on a circle", "two", "one"])
def test_the_excursion_is_the_largest_of_all_distances(cloud: str) -> None:
    rng = np.random.default_rng(len(cloud))
    count = {"one": 1, "two": 2}.get(cloud, 300)
    tilt = 0.1 * rng.normal(size=(count, 2))
    if cloud == "flat":
        tilt[:, 1] *= 1e-3
    elif cloud == "with outliers":
        tilt[::40] *= 8.0
    elif cloud == "on a circle":
        tilt *= 0.3 / np.linalg.norm(tilt, axis=1)[:, None]
    directions = np.column_stack([tilt, np.ones(count)])
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    points = np.column_stack([rng.normal(size=(count, 2)), np.zeros(count)])
    lines = np.concatenate([directions, np.cross(points, directions)], axis=1)
    lines = np.insert(lines, 1, np.nan, axis=0)
    mean = mean_axis_of(np.ones(count + 1), lines, np.zeros(3))
    angles = np.arccos(np.clip(directions @ directions.T, -1.0, 1.0))
    if cloud == "one":  # which is none from itself
        assert np.isnan([mean.excursion, mean.position_excursion]).all()
        return
    assert mean.excursion == pytest.approx(angles.max(), abs=1e-7)
    # Where each pierces the plane across the mean axis at the origin.
    reach = -(points @ mean.direction) / (directions @ mean.direction)
    places = points + reach[:, None] * directions
    farthest = np.linalg.norm(places[:, None] - places[None], axis=2).max()
    assert mean.position_excursion == pytest.approx(farthest, rel=1e-9, abs=1e-12)


def test_a_rest_counts_for_the_dispersion_no_more_than_the_angle_it_is_at() -> None:
    angle = np.radians(np.concatenate([np.arange(20.0, 100.0), np.full(5000, 20.0)]) + 0.5)
    tilt = np.where(np.degrees(angle) < 40.0, 0.2, 0.01) * np.where(np.arange(angle.size) % 2, 1.0, -1.0)
    direction = np.column_stack([np.sin(tilt), np.zeros_like(tilt), np.cos(tilt)])
    mean = mean_axis_of(angle, np.concatenate([direction, np.zeros_like(direction)], axis=1), np.zeros(3))
    assert mean.dispersion < 0.02
    assert np.median(mean.deviation) == pytest.approx(0.2, abs=0.01)
    off = np.arccos(direction @ mean.direction)
    weight = np.sin(0.5 * angle) ** 2
    assert mean.weighted_dispersion == pytest.approx(np.sqrt(np.average(off**2, weights=weight)), rel=1e-6)


def test_mean_axis_of_a_cone_is_its_middle_and_the_dispersion_its_half_angle() -> None:
    around = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    half = np.radians(5.0)
    directions = np.stack(
        [np.sin(half) * np.cos(around), np.sin(half) * np.sin(around), np.full(24, np.cos(half))], axis=1
    )
    apex = np.array([0.1, 0.2, 0.0])
    lines = np.concatenate([directions, np.cross(apex, directions)], axis=1)
    mean = mean_axis_of(np.ones(24), lines, apex)
    assert mean.direction == pytest.approx([0, 0, 1], abs=1e-12)
    assert mean.point == pytest.approx(apex, abs=1e-12)
    assert mean.deviation == pytest.approx(np.full(24, half))
    assert mean.distance == pytest.approx(np.zeros(24), abs=1e-12)
    shifted = lines.copy()
    offset = np.array([0.03, 0.0, 0.0])
    shifted[0, 3:] = np.cross(apex + offset, directions[0])
    assert mean_axis_of(np.ones(24), shifted, apex).distance[0] == pytest.approx(0.03, rel=0.1)


@pytest.mark.parametrize(("apart", "told"), [(0.0, True), (70.0, True), (80.0, False), (90.0, False)])
def test_axes_nearly_in_the_plane_across_their_mean_have_no_distance_from_it(apart: float, told: bool) -> None:
    # One axis in ten is so far off, by small angles of rotation that hardly move the mean.
    tilt = np.radians(np.where(np.arange(40) % 10 == 0, apart, 0.0))
    angle = np.where(tilt > 0.0, 0.2, 2.0)
    direction = np.column_stack([np.sin(tilt), np.zeros(40), np.cos(tilt)])
    point = np.column_stack([np.zeros(40), np.full(40, 0.01), np.zeros(40)])
    mean = mean_axis_of(angle, np.concatenate([direction, np.cross(point, direction)], axis=1), np.zeros(3))
    assert np.isfinite(mean.distance).all() == told
    assert np.isfinite(mean.distance).any() == told
    assert np.isfinite(mean.position_excursion) == told
    assert np.isfinite(mean.dispersion)


def test_one_axis_in_a_hundred_across_the_mean_has_no_distance_and_takes_none_from_the_others() -> None:
    tilt = np.radians(np.where(np.arange(100) == 7, 89.9, 0.0))
    direction = np.column_stack([np.sin(tilt), np.zeros(100), np.cos(tilt)])
    point = np.column_stack([np.zeros(100), np.zeros(100), np.full(100, 0.1)])
    mean = mean_axis_of(np.ones(100), np.concatenate([direction, np.cross(point, direction)], axis=1), np.zeros(3))
    assert np.flatnonzero(np.isnan(mean.distance)).tolist() == [7]
    assert mean.position_excursion < 0.01
