"""Every column of a result's tables is what the file and the other columns say."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from numpy.typing import ArrayLike
from recomputed import (
    LAWS,
    Poses,
    about_line,
    angle_between,
    axes_one_way,
    change_of,
    composed,
    curves_of,
    model_errors,
    most,
    pierced,
    pose_of,
    relative_poses,
    screw_errors,
    two_bodies,
    vectors,
)
from scipy.spatial.transform import Rotation
from told_results import Told

from elbowscrew.geometry.arrays import Float

ERRORS = ("theta_sd_deg", "slide_sd_mm", "axis_sd_deg", "point_sd_mm", "axis_cone95_deg", "point_radius95_mm")
AXIS = ("axis_x", "axis_y", "axis_z")
POINT = ("point_x_mm", "point_y_mm", "point_z_mm")
POSE = ("e0", "e1", "e2", "e3", "d_x_mm", "d_y_mm", "d_z_mm")

# Columns that nothing here tells, and the test that looks at each.
ELSEWHERE: dict[str, dict[str, tuple[str, ...]]] = {
    "screw": {"tests/motion/screws/test_uncertainty.py": ERRORS},
    "steps": {"tests/motion/screws/test_uncertainty.py": ERRORS},
    "keyframes": {"tests/motion/interpolation/test_rebuilding.py": ("knot",)},
    "interpolation": {"tests/motion/interpolation/test_model.py": POSE},
    # Where cycles begin and end is found between frames.
    "repetitions": {
        "tests/motion/movements/test_cuts.py": (
            "start_time_s", "end_time_s", "start_time_sd_s", "end_time_sd_s", "incomplete",
        ),
    },
    "instantaneous": {
        "tests/motion/axes/test_axes.py": ("angular_velocity_deg_s", "slide_velocity_mm_s", *AXIS, *POINT),
    },
    "anatomy": {"tests/motion/anatomy/test_anatomy.py": ("flexion_deg", "carrying_deg", "pronation_deg"),
                "tests/motion/anatomy/test_knee.py": ("adduction_deg", "internal_rotation_deg")},
    "joint_angles": {
        "tests/motion/joint/test_joint_angles.py": (
            "angle1_sd_deg", "angle2_sd_deg", "rotation_x_sd_deg", "rotation_y_sd_deg", "rotation_z_sd_deg",
            "residual_deg", "residual_mm",
        ),
    },
    "axis_path": {
        "tests/motion/joint/test_told_wander.py": ("angle_deg", "axis_sd_deg", "point_sd_mm", "frames", *AXIS, *POINT),
    },
}  # fmt: skip


def near(one: pd.DataFrame, names: tuple[str, ...] | list[str], other: ArrayLike, tolerance: float = 1e-7) -> set[str]:
    """Columns are these numbers, and empty where they are NaN."""
    found = one[list(names)].to_numpy(float)
    wanted = np.asarray(other, float).reshape(found.shape)
    assert (np.isnan(found) == np.isnan(wanted)).all(), names
    assert np.allclose(found, wanted, rtol=tolerance, atol=tolerance, equal_nan=True), names
    return set(names)


def of_screw(told: Told) -> set[str]:
    screw, recording = told.screw, told.recording
    proximal, distal = two_bodies(told)
    valid = distal.tracked if proximal is None else distal.tracked & proximal.tracked
    assert (screw["frame"] == recording.frame).all()
    seen = near(screw, ["time_s"], recording.time_s) | {"frame"}
    seen |= near(screw, ["valid"], valid)
    for name, body in (("proximal_loss", proximal), ("distal_loss", distal)):
        if body is not None:
            assert (screw[name].isna() == body.tracked).all()
    R, d = np.full((len(valid), 3, 3), np.nan), np.full((len(valid), 3), np.nan)
    C, J = change_of(told), pose_of(told.joint["bodies"]["distal_in_proximal"])
    back = (J[0].T, -J[0].T @ J[1])
    for k in np.flatnonzero(valid):
        pose = (distal.R[k], distal.p[k])
        if proximal is not None:
            pose = composed((proximal.R[k].T, -proximal.R[k].T @ proximal.p[k]), pose)
        R[k], d[k] = composed(composed(C, composed(back, pose)), (C[0].T, -C[0].T @ C[1]))
    quat = np.full((len(valid), 4), np.nan)
    quat[valid] = Rotation.from_matrix(R[valid]).as_quat()[:, [3, 0, 1, 2]]
    poses = Poses(screw)
    sign = np.sign(np.sum(quat * poses.quat, axis=1, keepdims=True))
    seen |= near(screw[valid], POSE[:4], (sign * quat)[valid]) | near(screw[valid], POSE[4:], d[valid], 1e-6)
    known = poses.known
    assert (np.sum(poses.quat[1:] * poses.quat[:-1], axis=1)[known[1:] & known[:-1]] > 0.0).all()
    # Filled in: short gaps between measured frames, and nothing else.
    gap = round(0.1 * told.summary["trial"]["rate_hz"])
    runs = pd.Series(valid).ne(pd.Series(valid).shift()).cumsum()
    short = ~valid & (pd.Series(valid).groupby(runs).transform("size").to_numpy() <= gap)
    seen |= near(screw, ["filled"], short)
    assert (known == (valid | short)).all()
    # Theta: the rotation's angle, with a sense and whole turns; its screw from 10 deg on.
    theta = screw["theta_deg"].to_numpy(float)
    folded = np.abs(np.mod(theta + 180.0, 360.0) - 180.0)
    assert np.allclose(folded[known], poses.angle[known], atol=2e-6)
    with np.errstate(divide="ignore", invalid="ignore"):
        axis, point, slide = poses.screws(theta)
    axis[~(poses.angle >= 10.0)], point[~(poses.angle >= 10.0)], slide[~(poses.angle >= 10.0)] = np.nan, np.nan, np.nan
    seen |= errors_of_screw(told)
    return seen | {"theta_deg", "proximal_loss", "distal_loss"} | near(screw, AXIS, axis) | near(
        screw, POINT, point, 1e-6
    ) | near(screw, ["slide_mm"], slide, 1e-6)  # fmt: skip


def errors_of_screw(told: Told) -> set[str]:
    """Of bodies with markers: what the noise of all poses makes of angle, slide and direction."""
    screw, bodies = told.screw, told.joint["bodies"]
    if not (bodies["proximal_markers_mm"] and bodies["distal_markers_mm"]):
        return set()
    errors = screw_errors(told, int(told.option("--reference-window") or 1))
    axis = screw["axis_x"].notna()
    errors.loc[~axis, ["slide_sd_mm", "axis_sd_deg"]] = np.nan
    # An angle below five deviations is that of the noise's own rotation.
    significance = screw["theta_deg"].abs() / errors["theta_sd_deg"]
    assert (np.abs(significance - 5.0) > 1e-3).all() or significance.isna().any()
    errors.loc[~(significance >= 5.0), "theta_sd_deg"] = np.nan
    return near(screw, list(errors.columns), errors.to_numpy(float), 1e-4)


def of_interpolation(told: Told) -> set[str]:
    model, keyframes = told.model, told.keyframes
    errors = model_errors(told)
    seen = near(model, list(errors.columns), errors.to_numpy(float), 1e-6)
    seen |= near(model, ["frame", "time_s"], told.screw[["frame", "time_s"]].to_numpy(float))
    poses, theta = Poses(model), model["theta_deg"].to_numpy(float)
    folded = np.abs(np.mod(theta + 180.0, 360.0) - 180.0)
    assert np.allclose(folded[poses.known], poses.angle[poses.known], atol=2e-6)
    # The nearest way round: never more than half a turn from the measured one.
    off = (model["theta_deg"] - told.screw["theta_deg"]).abs()
    assert off.max() <= 180.0
    with np.errstate(divide="ignore", invalid="ignore"):
        slide = poses.screws(theta)[2]
    slide[~(poses.angle >= 10.0)] = np.nan
    seen |= {"theta_deg"} | near(model, ["slide_mm"], slide, 1e-6)
    # Phases begin at keyframes; before the first and after the last there is none.
    phase = np.full(len(model), np.nan)
    for k in range(1, int(keyframes["phase"].max()) + 1):
        first = keyframes["frame"][keyframes["phase"] == k].iloc[0]
        later = keyframes["frame"][keyframes["phase"] == k + 1]
        last = keyframes["frame"].iloc[-1] if later.empty else later.iloc[0]
        phase[((model["frame"] >= first) & (model["frame"] <= last)).to_numpy() & np.isnan(phase)] = k
    measured_phase = model["phase"].to_numpy(float)
    inner = ~model["frame"].isin(keyframes["frame"]).to_numpy()
    assert np.array_equal(measured_phase[inner], phase[inner], equal_nan=True)
    return seen | {"phase"} | of_fraction(told)


def of_fraction(told: Told) -> set[str]:
    """t is the law's value at the frame's share of the law's time in its phase."""
    model, keyframes = told.model, told.keyframes
    for _, key in keyframes.iterrows():
        if key["law"] in LAWS and pd.isna(key["law_peak"]):
            rows = model[(model["phase"] == key["phase"]) & ~model["frame"].isin(keyframes["frame"])]
            share = (rows["time_s"] - key["law_start_s"]) / (key["law_end_s"] - key["law_start_s"])
            assert np.allclose(rows["t"], LAWS[key["law"]](share.clip(0.0, 1.0).to_numpy(float)), atol=1e-9)
    return {"t"}


def of_keyframes(told: Told) -> set[str]:
    keyframes, screw = told.keyframes, told.screw.set_index("frame")
    own = screw.loc[keyframes["frame"]].reset_index()
    names = ["time_s", "theta_deg", *POSE]
    found, there = keyframes[names].to_numpy(float), own[names].to_numpy(float)
    # Either sign is the same pose.
    sign = np.sign(np.sum(found[:, 2:6] * there[:, 2:6], axis=1, keepdims=True))
    there[:, 2:6] *= sign
    seen = near(keyframes, names, there)
    phase = keyframes["phase"].to_numpy()
    assert phase[0] == 1
    assert set(np.diff(phase)) <= {0, 1}
    laws = told.summary["interpolation"]["phase_laws"]
    for _, key in keyframes.iterrows():
        law = laws[int(key["phase"]) - 1]
        assert key["law"] == law["law"]
        assert screw.loc[law["start_frame"], "time_s"] == pytest.approx(key["law_start_s"])
        assert screw.loc[law["end_frame"], "time_s"] == pytest.approx(key["law_end_s"])
        assert (None if pd.isna(key["law_peak"]) else key["law_peak"]) == law["peak"]
    settings = told.summary["settings"]
    assert set(keyframes["method"]) == {settings["method"]}
    assert set(keyframes["blend"]) == {settings["blend"]}
    return {*seen, "frame", "phase", "law", "law_peak", "law_start_s", "law_end_s", "method", "blend"}


LEAST = 1.5 * np.degrees(0.25)


def highest(speed: Float) -> float:
    """The highest speed of a stroke, unless a speed beside unknown ones is at least half of it, and not just slow."""
    top = most(speed)
    beside = [b if np.isnan(a) else a for a, b in pairwise(speed.tolist()) if np.isnan(a) != np.isnan(b)]
    return float("nan") if any(one >= max(0.5 * top, LEAST) for one in beside) else top


def of_repetitions(told: Told) -> set[str]:
    table, screw = told.repetitions, told.screw
    time_s, frame = screw["time_s"].to_numpy(float), screw["frame"].to_numpy()
    theta, speed = screw["theta_deg"].to_numpy(float), told.table("instantaneous")["angular_velocity_deg_s"].to_numpy()
    axis, point = vectors(screw, "axis"), vectors(screw, "point", "_mm")
    leading = np.array(told.summary["motion"]["dominant_axis"]["direction"])
    axis = np.where((axis @ leading < 0.0)[:, None], -axis, axis)
    # Without a sense there is no way out and none back.
    speed = speed if told.summary["motion"]["signed"] else np.full(len(speed), np.nan)
    seen = near(table, ["number"], np.arange(1, len(table) + 1))
    seen |= near(table, ["duration_s"], (table["end_time_s"] - table["start_time_s"]).to_numpy(float), 1e-9)
    known = np.isfinite(theta)
    # Before the first speed and after the last one nothing is lost: there the recording begins and ends.
    given = np.flatnonzero(np.isfinite(speed)) if np.isfinite(speed).any() else np.array([0])
    rows_of = []
    for _, one in table.iterrows():
        start, top, end = (
            int(np.flatnonzero(frame == one[f"{name}_frame"])[0]) for name in ("start", "inversion", "end")
        )
        for row, name in ((start, "start_time_s"), (end, "end_time_s")):
            assert np.argmin(np.abs(time_s - one[name])) == row
        rows = np.arange(start, end + 1)
        own = rows[(screw["valid"] == 1).to_numpy()[rows] & np.isfinite(axis[rows, 0])]
        weight = np.sin(np.radians(0.5 * theta[own])) ** 2
        real, dual = weight @ axis[own], weight @ np.cross(point[own], axis[own])
        size = np.linalg.norm(real)
        rows_of.append(
            [
                np.ptp(theta[rows][np.isfinite(theta[rows])]),
                np.nanmax(theta[rows]),
                screw["slide_mm"].iloc[rows].max() - screw["slide_mm"].iloc[rows].min(),
                highest(speed[max(start, given[0]) : top + 1]),
                highest(-speed[top : min(end, given[-1]) + 1]),
                np.interp(one["start_time_s"], time_s[known], theta[known]),
                *(real / size),
                *(np.cross(real, dual) / size**2),
            ]
        )
    names = [
        "theta_range_deg",
        "theta_max_deg",
        "slide_range_mm",
        "outward_speed_deg_s",
        "back_speed_deg_s",
        "theta_start_deg",
    ]
    if len(table):
        seen |= near(table, [*names, *AXIS, *POINT], np.array(rows_of), 1e-6)
    else:
        seen |= {*names, *AXIS, *POINT}
    axes = vectors(table, "axis")
    middle = axes.sum(axis=0) if len(axes) > 1 else np.full(3, np.nan)  # one axis is off from nothing
    seen |= near(table, ["axis_deviation_deg"], angle_between(axes, np.broadcast_to(middle, axes.shape)), 1e-6)
    return seen | {"start_frame", "inversion_frame", "end_frame"}


def of_cycles(told: Told) -> set[str]:
    table, screw = told.table("cycles"), told.screw
    time_s, theta = screw["time_s"].to_numpy(float), screw["theta_deg"].to_numpy(float)
    cycles = told.repetitions.set_index("number").loc[table["cycle"]]
    place = cycles["start_time_s"].to_numpy() + 0.01 * table["percent"].to_numpy() * cycles["duration_s"].to_numpy()
    known = np.isfinite(theta)
    expected = np.interp(place, time_s[known], theta[known])
    found = table["theta_deg"].to_numpy(float)
    there = np.isfinite(found)
    assert np.allclose(found[there], expected[there], atol=1e-6)
    # Nothing where a neighboring frame has no angle, and only there.
    beside = [theta[np.abs(time_s - t) < 0.999 / told.summary["trial"]["rate_hz"]] for t in place[~there]]
    assert all(np.isnan(some).any() for some in beside)
    assert np.allclose(table["percent"].to_numpy().reshape(-1, 101), np.arange(101.0))
    return {"cycle", "percent", "theta_deg"}


def of_repetition_curve(told: Told) -> set[str]:
    table, curves = told.table("repetition_curve"), pd.DataFrame(curves_of(told))
    seen = near(table, ["theta_mean_deg"], curves.mean().to_numpy())
    seen |= near(table, ["theta_sd_deg"], curves.std(ddof=1).to_numpy())
    seen |= near(table, ["count"], curves.notna().sum().to_numpy())
    return seen | near(table, ["percent"], np.arange(101.0))


def of_steps(told: Told) -> set[str]:
    """Each step leads by the settings' 20 deg from where the last has ended."""
    table, screw = told.table("steps"), told.screw.set_index("frame")
    assert (table["start_frame"].iloc[1:].to_numpy() == table["end_frame"].iloc[:-1].to_numpy()).all()
    first, last = (Poses(screw.loc[table[f"{end}_frame"]]) for end in ("start", "end"))
    R = last.R @ np.swapaxes(first.R, 1, 2)
    d = last.d - np.einsum("nij,nj->ni", R, first.d)
    quat = Rotation.from_matrix(R).as_quat(canonical=True)[:, [3, 0, 1, 2]]
    move = Poses(pd.DataFrame(np.column_stack([quat, d]), columns=list(POSE)))
    theta = table["theta_deg"].to_numpy(float)
    assert np.allclose(np.abs(theta), move.angle, atol=1e-6)
    axis, point, slide = move.screws(theta)
    assert (axis @ np.array(told.summary["motion"]["dominant_axis"]["direction"]) > 0.0).all()
    seen = near(table, AXIS, axis) | near(table, POINT, point, 1e-6) | near(table, ["slide_mm"], slide, 1e-6)
    change = (
        screw["theta_deg"].loc[table["end_frame"]].to_numpy() - screw["theta_deg"].loc[table["start_frame"]].to_numpy()
    )
    assert (np.abs(change) >= 20.0).all()
    for end in ("start", "end"):
        seen |= near(table, [f"{end}_time_s"], screw["time_s"].loc[table[f"{end}_frame"]].to_numpy())
    return seen | {"theta_deg", "start_frame", "end_frame"}


def of_instantaneous(told: Told) -> set[str]:
    table = told.table("instantaneous")
    return near(table, ["frame", "time_s"], told.screw[["frame", "time_s"]].to_numpy(float))


def of_anatomy(told: Told) -> set[str]:
    """Each frame's axis beside the epicondyles."""
    table, screw, anatomy = told.table("anatomy"), told.screw, told.joint["anatomy"]
    C, J = change_of(told), pose_of(told.joint["bodies"]["distal_in_proximal"])
    R, t = composed(J, (C[0].T, -C[0].T @ C[1]))
    axis, point = vectors(screw, "axis") @ R.T, vectors(screw, "point", "_mm") @ R.T + t
    line = np.array(anatomy["epicondyle_direction_in_proximal"])
    middle = np.array(anatomy["joint_center_in_proximal_mm"])
    off = angle_between(axis, np.broadcast_to(line, axis.shape))
    seen = near(table, ["axis_angle_deg"], np.minimum(off, 180.0 - off))
    foot = pierced(axis, point, line, middle)
    assert np.isfinite(foot).any()
    seen |= near(table, ["axis_distance_mm"], np.linalg.norm(np.cross(point - middle, axis), axis=1), 1e-6)
    return seen | near(table, ["frame", "time_s"], screw[["frame", "time_s"]].to_numpy(float))


def of_joint_angles(told: Told) -> set[str]:
    """Angles that turn the joint as it was seen to turn, zero at the reference."""
    table, screw = told.table("joint_angles"), told.screw
    kind = told.joint["joint_type"]["type"]
    valid = (screw["valid"] == 1).to_numpy()
    seen = near(table, ["frame", "time_s"], screw[["frame", "time_s"]].to_numpy(float))
    names = [name for name in table.columns if name.endswith("_deg") and "sd" not in name and "residual" not in name]
    angles = table[names].to_numpy(float)
    at = int(np.flatnonzero(table["frame"] == told.summary["trial"]["reference_frame"])[0])
    assert np.isfinite(angles[valid]).all()
    assert np.abs(angles[at]).max() < 1.0
    R, _ = relative_poses(told)
    here = int(np.flatnonzero(np.flatnonzero(valid) == at)[0])
    turned = Rotation.from_matrix(R @ R[here].T)
    if kind == "ball":
        assert np.allclose(angles[valid], np.degrees(turned.as_rotvec()), atol=1e-3)
    elif kind == "two_axes":
        axes = told.joint["two_axes"]
        directions = [np.array(axes[f"axis{k}"]["direction_in_proximal"]) for k in (1, 2)]
        about = [Rotation.from_rotvec(np.outer(np.radians(angles[:, k]), directions[k])) for k in (0, 1)]
        left = (about[0] * about[1])[valid].inv() * turned
        assert np.degrees(left.magnitude()).max() < 1.0  # of a noise of 0.1 deg, in this frame and at the reference
        assert angles[:, 0].max() > 100.0
    else:
        fit = told.joint[told.joint["preferred"]]
        angle = np.degrees(about_line(told, fit)[0])
        assert np.allclose(angles[valid, 0], angle - angle[here], atol=1.5)
    return seen | set(names)


OF: dict[str, Callable[[Told], set[str]]] = {
    "screw": of_screw,
    "interpolation": of_interpolation,
    "keyframes": of_keyframes,
    "repetitions": of_repetitions,
    "cycles": of_cycles,
    "repetition_curve": of_repetition_curve,
    "steps": of_steps,
    "instantaneous": of_instantaneous,
    "anatomy": of_anatomy,
    "axis_path": lambda told: set(),
    "joint_angles": of_joint_angles,
}


def test_tables(told: Told) -> None:
    """Every table there is, and each of its columns, here or by a test of its own."""
    for path in sorted(told.folder.glob("*.csv")):
        seen = OF[path.stem](told)
        elsewhere = {name for names in ELSEWHERE.get(path.stem, {}).values() for name in names}
        columns = set(told.table(path.stem).columns)
        assert columns <= seen | elsewhere, f"{path.name}: columns that nobody looks at: {columns - seen - elsewhere}"
        assert seen <= columns, path.name


def test_which_tables_there_are(told: Told) -> None:
    always = {"screw", "interpolation", "keyframes", "instantaneous", "repetitions", "cycles"}
    sometimes = {
        "steps": "--step" in told.options,
        "repetition_curve": len(told.repetitions) > 1,
        "anatomy": "--landmarks" in told.options,
    }
    found = {path.stem for path in told.folder.glob("*.csv")} - {"axis_path", "joint_angles"}
    if not len(told.repetitions):
        always, found = always - {"cycles"}, found - {"cycles"}
    assert found == always | {name for name, there in sometimes.items() if there}


def test_axes_point_one_way(told: Told) -> None:
    """Along the dominant axis, as theta is positive about it: that of a hinge nearly everywhere."""
    axis, _, _ = axes_one_way(told)
    leading = np.array(told.summary["motion"]["dominant_axis"]["direction"])
    if told.joint["single_axis"]:
        assert (angle_between(axis, np.broadcast_to(leading, axis.shape)) < 15.0).all()


@pytest.mark.parametrize("file", sorted({file for tests in ELSEWHERE.values() for file in tests}))
def test_what_is_tested_elsewhere_is(root: Path, file: str) -> None:
    assert (root / file).is_file()
