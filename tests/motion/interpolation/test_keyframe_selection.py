"""The fewest keyframes: against brute force, and against blending and markers written out."""

from __future__ import annotations

import itertools
from typing import Any, cast

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from wandering import BETWEEN, MARKERS, POINTS, marker_errors, wandering

import elbowscrew.motion.interpolation.keyframe_selection as selection_module
from elbowscrew import Settings, analyze, simulate_trial
from elbowscrew.configuring import settings_from
from elbowscrew.errors import SettingError, UsageError
from elbowscrew.geometry import dual_quat_from_screw, sclerp
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Float
from elbowscrew.model.joint_coordinates import JointCoordinates
from elbowscrew.motion.interpolation.keyframe_selection import select_keyframes
from elbowscrew.motion.interpolation.segment_errors import BASES, JointSeries, PoseTrack
from elbowscrew.motion.joint.coordinates import joint_poses


def errors_of_sets(
    pose: Float, parameter: Float, method: str, count: int, required: tuple[int, ...] = ()
) -> list[Float]:
    """Errors of every frame, of each set of so many keyframes that there is."""
    last = len(pose) - 1
    return [
        marker_errors(pose, parameter, (0, *inner, last), method)
        for inner in itertools.combinations(range(1, last), count - 2)
        if set(required) <= set(inner) and (np.diff(parameter[[0, *inner, last]]) > 0.0).all()
    ]


def brute_force(pose: Float, parameter: Float, method: str, required: tuple[int, ...] = ()) -> dict[int, float]:
    """Least largest error of every number of keyframes."""
    best: dict[int, float] = {}
    for count in range(2, len(pose) + 1):
        errors = errors_of_sets(pose, parameter, method, count, required)
        if errors:
            best[count] = min(float(error.max()) for error in errors)
    return best


@pytest.mark.parametrize("method", BASES)
@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10_000), count=st.integers(3, 9), share=st.floats(0.02, 1.0), tied=st.booleans())
def test_no_smaller_set_and_no_better_one_of_that_size(
    method: str, seed: int, count: int, share: float, tied: bool
) -> None:
    pose = wandering(count, seed)
    parameter = np.cumsum(np.random.default_rng(seed).uniform(0.2, 1.0, count))
    if tied:
        parameter[1] = parameter[0]
    truth = brute_force(pose, parameter, method)
    tolerance = max(share * truth[2], min(truth.values())) + 1e-6
    found = select_keyframes(pose, parameter, POINTS, tolerance, method=method)
    fewest = min(number for number, error in truth.items() if error <= tolerance)
    assert found.row.size == fewest
    assert found.complete
    for number, largest in zip(found.count.tolist(), found.largest.tolist(), strict=True):
        assert largest == pytest.approx(truth[number], abs=1e-8)
    chosen = marker_errors(pose, parameter, tuple(found.row.tolist()), method)
    assert found.largest[-1] == pytest.approx(chosen.max(), abs=1e-12)
    assert found.rms[-1] == pytest.approx(np.sqrt(np.mean(chosen**2)), abs=1e-12)
    # Of sets with the same largest error, the one that is nearer on the whole.
    errors = errors_of_sets(pose, parameter, method, fewest)
    least = min(error.max() for error in errors)
    alike = [np.sqrt(np.mean(error**2)) for error in errors if error.max() <= least + 1e-9]
    assert found.rms[-1] <= min(alike) + 1e-8


@pytest.mark.parametrize("method", BASES)
@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10_000), count=st.integers(3, 9), share=st.floats(0.02, 1.0))
def test_the_search_for_long_recordings_finds_as_few(method: str, seed: int, count: int, share: float) -> None:
    pose, parameter = wandering(count, seed), np.arange(float(count))
    truth = brute_force(pose, parameter, method)
    tolerance = share * truth[2] + 1e-6
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(selection_module, "MOST_FRAMES_COMPLETE", 1)
        found = select_keyframes(pose, parameter, POINTS, tolerance, method=method)
    assert found.row.size == min(number for number, error in truth.items() if error <= tolerance)
    assert marker_errors(pose, parameter, tuple(found.row.tolist()), method).max() <= tolerance * (1 + 1e-12)
    assert not found.complete


@pytest.mark.parametrize("limit", [1, 600])
def test_both_ways_agree_on_a_whole_trial(limit: int, monkeypatch: pytest.MonkeyPatch) -> None:
    trial = simulate_trial(frames=300, inversion=140, marker_noise_mm=0.1, seed=4).recording
    sizes = [analyze(trial, Settings(tolerance_mm=size)).keyframes.row.size for size in (1.0, 4.0, 30.0)]
    monkeypatch.setattr(selection_module, "MOST_FRAMES_COMPLETE", limit)
    assert [analyze(trial, Settings(tolerance_mm=size)).keyframes.row.size for size in (1.0, 4.0, 30.0)] == sizes


def test_where_the_parameter_rests_the_motion_must() -> None:
    """A hold of five frames that wander by up to 30 mm: one keyframe at most stands there."""
    pose = wandering(9, 3)
    parameter = np.array([0.0, 1.0, 2.0, 2.0, 2.0, 2.0, 2.0, 3.0, 4.0])
    truth = brute_force(pose, parameter, "sclerp")
    least = min(truth.values())
    for limit in (1, 600):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(selection_module, "MOST_FRAMES_COMPLETE", limit)
            found = select_keyframes(pose, parameter, POINTS, 1.001 * least)
            assert found.row.size == min(number for number, error in truth.items() if error <= 1.001 * least)
            with pytest.raises(SettingError, match="where the law rests"):
                select_keyframes(pose, parameter, POINTS, 0.99 * least)


def test_rows_that_must_be_keyframes_are() -> None:
    pose, parameter = wandering(9, 3), np.arange(9.0)
    truth = brute_force(pose, parameter, "sclerp", required=(4,))
    for tolerance in (0.2 * truth[3], truth[3] * 1.01):
        found = select_keyframes(pose, parameter, POINTS, tolerance, required=np.array([4]))
        assert 4 in found.row
        assert found.row.size == min(number for number, error in truth.items() if error <= tolerance)


def test_a_steady_screw_needs_its_ends_alone() -> None:
    time = np.linspace(0.0, 3.0, 700)
    pose = dual_quat_from_screw(0.9 * time, 0.01 * time, [0, 0.6, 0.8], [0.1, 0.08, -0.06])
    assert select_keyframes(pose, time, POINTS, 1e-6).row.tolist() == [0, 699]
    assert select_keyframes(pose[:200], time[:200], POINTS, 1e-6).row.tolist() == [0, 199]


@pytest.mark.parametrize("method", BASES)
@given(seed=st.integers(0, 10_000), small=st.sampled_from([1.0, 1e-3, 1e-9, 0.0]))
def test_errors_of_segments_are_those_of_the_poses_blended(method: str, seed: int, small: float) -> None:
    rng = np.random.default_rng(seed)
    twist = rng.normal(size=(6, 6)) * np.repeat([small, 0.1], 3)
    pose = dq.multiply(wandering(1, seed, 0.5), dq.exp(twist))
    track = PoseTrack.of(pose, POINTS, method)
    share = rng.uniform(0.0, 1.0, size=(4, 2))
    segments = track.segments_from(0, [1, 2])
    seen = track.seen_from(0, slice(2, 6))
    squares = segments.squares(seen, share)
    for m, k in itertools.product(range(4), range(2)):
        model = BETWEEN[method](pose[0], pose[1 + k], share[m, k], way="as given")
        apart = dq.transform_points(pose[2 + m], MARKERS) - dq.transform_points(model, MARKERS)
        direct = np.sqrt(np.mean(np.sum(apart**2, axis=-1)))
        assert np.sqrt(squares[m, k]) == pytest.approx(direct, abs=1e-7)
        one = segments.at([k])
        assert one.displacement(seen[[m]], share[m, [k]]) == pytest.approx([direct], abs=1e-12)


@pytest.mark.parametrize("method", BASES)
@given(seed=st.integers(0, 10_000), tolerance=st.floats(1e-3, 0.08), step=st.floats(0.02, 0.6))
def test_the_screen_leaves_every_segment_that_holds(method: str, seed: int, tolerance: float, step: float) -> None:
    pose = wandering(10, seed, step)
    parameter = np.cumsum(np.random.default_rng(seed).uniform(0.3, 1.0, 10))
    track = selection_module._Track(PoseTrack.of(pose, POINTS, method), parameter, POINTS, method, np.array([0, 9]))
    screen = selection_module._Screen.of(track, tolerance)
    for first, last in itertools.combinations(range(10), 2):
        rows = np.arange(first, last + 1)
        inner = marker_errors(pose[rows], parameter[rows], (0, rows.size - 1), method)
        if inner.max() <= tolerance:
            assert screen.may_hold(track, first, np.array([last])).all()


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"method": "dlb"}, "expected sclerp, sdlb or joint"),
        ({"keyframes": (0, 10)}, "either --tolerance or --keyframes"),
        ({"law": "empirical"}, "another --law"),
        ({"knots": "chord"}, "leave --knots and --blend out"),
        ({"blend": "global"}, "leave --knots and --blend out"),
        ({"tolerance": "2in"}, "as in 2mm"),
        ({"tolerance": "-1mm"}, "greater than or equal to 0.001"),
    ],
)
def test_what_does_not_go_with_a_tolerance(options: dict[str, Any], says: str) -> None:
    with pytest.raises(UsageError, match=says):
        settings_from(None, {"tolerance": "2mm", **options})


def test_tolerances_have_units() -> None:
    assert [settings_from(None, {"tolerance": text}).tolerance_mm for text in ("2mm", "0.002m", "2")] == [2.0] * 3


@pytest.mark.parametrize("law", [None, "best", "polynomial-345"])
def test_the_model_of_an_analysis_stays_within_the_tolerance(law: Any) -> None:
    trial = simulate_trial(marker_noise_mm=0.05, gaps=2, rest_before_s=0.6, seed=1).recording
    analysis = analyze(trial, Settings(tolerance_mm=3.0, law=law))
    error = analysis.interpolated.rms_displacement
    assert np.nanmax(error) <= 3e-3 * (1 + 1e-9)
    assert analysis.selection is not None
    assert np.nanmax(error) == pytest.approx(analysis.selection.largest[-1], abs=1e-12)
    assert analysis.screw.valid[analysis.keyframes.row].all()
    assert set(analysis.keyframes.phases.bound_rows.tolist()) <= set(analysis.keyframes.row.tolist())


# In the joint's own angles.

JOINTS = ("hinge", "two_axes", "ball")


def joint_motion(kind: str, count: int, seed: int, off: float = 0.004) -> tuple[Float, JointSeries]:
    """Poses (N, 8) near those of a joint, and the joint with its angles."""
    rng = np.random.default_rng(seed)
    size = {"hinge": 1, "two_axes": 2, "ball": 3}[kind]
    axes = 0 if kind == "ball" else size
    direction = rng.normal(size=(axes, 3))
    joint = JointCoordinates(
        type=cast(Any, kind),
        axis=direction / np.linalg.norm(direction, axis=1)[:, None],
        point=rng.normal(scale=0.1, size=(max(axes, 1), 3)),
        pitch=0.0,
        end=dq.exp(rng.normal(size=6) * np.repeat([0.02, 0.003], 3)),
    )
    angle = np.cumsum(rng.normal(scale=0.2, size=(count, size)), axis=0)
    twist = rng.normal(size=(count, 6)) * np.repeat([10.0 * off, off], 3)
    pose = dq.multiply(joint_poses(joint, angle), dq.exp(0.5 * twist))
    return dq.continuous_signs(pose), JointSeries(joint, angle)


def joint_errors(pose: Float, series: JointSeries, parameter: Float, keys: tuple[int, ...]) -> Float:
    """RMS distance of the markers in every frame, by the joint at angles between those of the keyframes."""
    angle = np.stack([np.interp(parameter, parameter[list(keys)], a[list(keys)]) for a in series.angle.T], axis=1)
    model = joint_poses(series.joint, angle)
    if series.joint.type == "ball":
        ends = joint_poses(series.joint, series.angle)
        for first, last in itertools.pairwise(keys):
            rows = np.arange(first, last + 1)
            share = (parameter[rows] - parameter[first]) / (parameter[last] - parameter[first])
            model[rows] = sclerp(ends[first], ends[last], share, way="as given")
    apart = dq.transform_points(pose[:, None], MARKERS) - dq.transform_points(model[:, None], MARKERS)
    distance: Float = np.sqrt(np.mean(np.sum(apart**2, axis=-1), axis=1))
    return distance


@pytest.mark.parametrize("limit", [1, 600])
@pytest.mark.parametrize("kind", JOINTS)
@settings(max_examples=12, deadline=None)
@given(seed=st.integers(0, 10_000), count=st.integers(3, 8), share=st.floats(0.1, 1.0))
def test_no_smaller_set_in_a_joints_angles(kind: str, limit: int, seed: int, count: int, share: float) -> None:
    """Against every set there is, the keyframes' own errors among those that count."""
    pose, series = joint_motion(kind, count, seed)
    parameter = np.cumsum(np.random.default_rng(seed).uniform(0.2, 1.0, count))
    truth: dict[int, float] = {}
    for inner in itertools.chain.from_iterable(
        itertools.combinations(range(1, count - 1), k) for k in range(count - 1)
    ):
        worst = float(joint_errors(pose, series, parameter, (0, *inner, count - 1)).max())
        truth[len(inner) + 2] = min(truth.get(len(inner) + 2, np.inf), worst)
    tolerance = max(share * truth[2], min(truth.values())) + 1e-6
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(selection_module, "MOST_FRAMES_COMPLETE", limit)
        found = select_keyframes(pose, parameter, POINTS, tolerance, method="joint", series=series)
    assert found.row.size == min(number for number, error in truth.items() if error <= tolerance)
    errors = joint_errors(pose, series, parameter, tuple(found.row.tolist()))
    assert found.largest[-1] == pytest.approx(errors.max(), abs=1e-12)
    assert found.rms[-1] == pytest.approx(np.sqrt(np.mean(errors**2)), abs=1e-12)
    if limit > 1:
        for number, largest in zip(found.count.tolist(), found.largest.tolist(), strict=True):
            assert largest == pytest.approx(truth[number], abs=1e-8)


@given(seed=st.integers(0, 10_000), small=st.sampled_from([1.0, 1e-3, 0.0]))
def test_errors_about_two_axes_are_those_of_the_joints_poses(seed: int, small: float) -> None:
    pose, series = joint_motion("two_axes", 6, seed)
    series = series._replace(angle=series.angle * small)
    track = PoseTrack.of(pose, POINTS, "joint", series)
    share = np.random.default_rng(seed).uniform(0.0, 1.0, size=(4, 2))
    segments, seen = track.segments_from(0, [1, 2]), track.seen_from(0, slice(2, 6))
    squares = segments.squares(seen, share)
    for m, k in itertools.product(range(4), range(2)):
        angle = series.angle[0] + share[m, k] * (series.angle[1 + k] - series.angle[0])
        model = joint_poses(series.joint, angle[None])[0]
        apart = dq.transform_points(pose[2 + m], MARKERS) - dq.transform_points(model, MARKERS)
        direct = np.sqrt(np.mean(np.sum(apart**2, axis=-1)))
        assert np.sqrt(squares[m, k]) == pytest.approx(direct, abs=1e-7)
        assert segments.at([k]).displacement(seen[[m]], share[m, [k]]) == pytest.approx([direct], abs=1e-12)


def test_a_joint_that_leaves_more_than_the_tolerance_is_told() -> None:
    pose, series = joint_motion("two_axes", 8, 1)
    with pytest.raises(SettingError, match="the joint itself leaves up to"):
        select_keyframes(pose, np.arange(8.0), POINTS, 1e-4, method="joint", series=series)


def test_the_joints_model_of_an_analysis_stays_within_the_tolerance() -> None:
    trial = simulate_trial(
        joint_type="two-axes", marker_noise_mm=0.05, frames=200, inversion=90, gaps=1, seed=1
    ).recording
    by_joint, by_pose = (analyze(trial, Settings(tolerance_mm=2.0, method=method)) for method in ("joint", "sclerp"))
    error = by_joint.interpolated.rms_displacement
    assert by_joint.selection is not None
    assert np.nanmax(error) <= 2e-3 * (1 + 1e-9)
    assert np.nanmax(error) == pytest.approx(by_joint.selection.largest[-1], abs=1e-12)
    assert by_joint.keyframes.row.size <= by_pose.keyframes.row.size
