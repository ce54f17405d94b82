"""Every number of `summary.json` and `joint.json` is what the tables beside them and the file say."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from recomputed import joint_of, summary_of
from told_results import Told, leaves, pattern

HERE = "tests/last_mile/test_recomputed.py"
# Keys that the tables do not tell, and the test that looks at each.
NOT_IN_TABLES = {
    r"elbowscrew": f"{HERE}::test_names",
    r"trial\.joint\..*": f"{HERE}::test_names",
    # Of the unfiltered twist, between frames, and by a search for the filter.
    r"trial\.instantaneous_lowpass_hz": "tests/motion/smoothing/test_smoothing.py::test_a_fast_motion_keeps_its_speed",
    r"motion\.inversion_frames": f"{HERE}::test_cuts",
    r"motion\.movements.*": f"{HERE}::test_cuts",
    # Texts, each with its own test.
    r"warnings(\..*)?": f"{HERE}::test_warnings",
    # Keyframes that were not chosen.
    r"interpolation\.selection\.(complete|curve\..*)": f"{HERE}::test_the_curve_of_a_selection",
}
NOT_IN_TABLES_OF_JOINT = {
    # Lines in both bodies: the residual, which is recomputed, is that of these two.
    r"(screw_)?hinge\.(direction|point)_in_(proximal|distal)(_mm)?": f"{HERE}::test_joint",
    r"single_axis|preferred": f"{HERE}::test_the_preferred_model",
    # Intervals: what they cover is counted over many trials.
    r"(screw_)?hinge\.(axis|point)_(sd|cone95|radius95)_(deg|mm)": "tests/motion/joint/test_interval.py",
    r"(screw_)?hinge\.(decided_by|interval_method)": f"{HERE}::test_intervals_name_their_source",
    r"(screw_)?hinge\.(noise_ratio|frames_that_count_as_one)": "tests/motion/joint/test_joint_axis.py",
    r"screw_hinge\.pitch_sd_mm_per_rad": "tests/motion/joint/test_interval.py",
    # Fits of other joints than hinges: recovered from motions that were made so.
    r"joint_type\.(type|status|reason|candidates.*)|two_axes|ball|second_rotation.*": (
        "tests/motion/joint/test_joint_type.py"
    ),
    r"joint_type\.(decided_by|interval_method|markers_told)": f"{HERE}::test_intervals_name_their_source",
    r"two_axes\.axis.*": f"{HERE}::test_two_axes_are_those_of_the_motion",
    r"two_axes\..*_(low|high)": f"{HERE}::test_two_axes_are_those_of_the_motion",
    r"two_axes\.(parallel_offset_mm|order_determined)": "tests/motion/joint/test_joint_type.py",
    r"ball\..*": f"{HERE}::test_the_center_of_a_ball",
    # Of bodies without markers.
    r"noise\.(proximal|distal)(\..*)?": (
        "tests/motion/screws/test_uncertainty.py::test_each_source_finds_the_noise_there_is"
    ),
    r"anatomy\.axis_(angle_deg|distance_mm)_(low|high)": "tests/motion/anatomy/test_functional_axis.py",
    r"unexplained_share": "tests/motion/joint/test_joint_axis.py",
    r"wander(\..*)?|mean_axis(\..*)?": "tests/motion/joint/test_told_wander.py",
}
# Where the file's markers are read otherwise, or a fit weighs translations, too, by which it stands on.
CLOSE = {
    r"trial\..*\.(marker_residual_mm\..*|pivot_offset_mm)": 1e-4,
    r"noise\..*|bodies\..*_markers_mm.*": 1e-4,
    r"(screw_)?hinge\.residual_rotation_deg": 1e-5,
    r"(screw_)?hinge\.(residual_translation_mm|sensitivity_deg_per_deg|pitch_mm_per_rad)|unexplained_share": 1e-2,
    # Each axis is told in the other body by the reference pose, noise and all.
    r"two_axes\.(angle_between_deg|distance_mm)": 1e-2,
}
NAMES = {
    "paper": ("elbow", "upper arm", "forearm", None),
    "left": ("elbow", "upper arm", "forearm", "left"),
    "knee": ("knee", "thigh", "shank", None),
    "cycles": ("elbow", "upper arm", "forearm", None),
    "lost": ("elbow", "upper arm", "forearm", None),
    "two_axes": ("elbow", "upper arm", "forearm", None),
    "ball": ("joint", "proximal segment", "distal segment", None),
}


def compared(stated: Any, found: Any, elsewhere: dict[str, str]) -> list[str]:
    """What is stated otherwise than found, and what is stated and neither found nor tested elsewhere."""
    said, mine = leaves(stated), leaves(found)
    faults = [f"{'.'.join(path)}: not stated" for path in mine if path not in said and mine[path] != {}]
    for path, value in said.items():
        name = pattern(path)
        if path in mine:
            relative = next((value for key, value in CLOSE.items() if re.fullmatch(key, name)), 1e-9)
            if not same(value, mine[path], relative):
                faults.append(f"{'.'.join(path)}: {value!r}, and here {mine[path]!r}")
        elif not any(re.fullmatch(key, name) for key in elsewhere):
            faults.append(f"{'.'.join(path)}: a key that is neither recomputed nor named as tested elsewhere")
    return faults


def same(one: Any, other: Any, relative: float) -> bool:
    if one is None:
        return other is None or (isinstance(other, float) and bool(np.isnan(other)))
    if other is None or isinstance(one, str | bool | dict) or isinstance(other, str):
        return bool(one == other)
    if isinstance(one, list) and any(isinstance(part, str) for part in one):
        return bool(one == other)
    a, b = np.asarray(one, float), np.asarray(other, float)
    return a.shape == b.shape and np.allclose(a, b, rtol=relative, atol=max(1e-8, relative))


def test_summary(told: Told) -> None:
    faults = compared(told.summary, summary_of(told), NOT_IN_TABLES)
    assert not faults, "\n".join(faults)


def test_joint(told: Told) -> None:
    faults = compared(told.joint, joint_of(told), NOT_IN_TABLES_OF_JOINT)
    assert not faults, "\n".join(faults)


def test_a_key_that_nobody_looks_at_is_a_fault() -> None:
    (fault,) = compared({"motion": {"theta_max_deg": 3.0, "new_deg": 1.0}}, {"motion": {"theta_max_deg": 3.0}}, {})
    assert fault.startswith("motion.new_deg")
    assert compared({"theta": 3.0}, {"theta": 3.1}, {})
    assert compared({"theta": None}, {"theta": 3.1}, {})
    assert not compared({"theta": None}, {"theta": float("nan")}, {})


@pytest.mark.parametrize("place", sorted({*NOT_IN_TABLES.values(), *NOT_IN_TABLES_OF_JOINT.values()}))
def test_what_is_tested_elsewhere_is(root: Path, place: str) -> None:
    file, _, name = place.partition("::")
    assert f"def {name or 'test_'}" in (root / file).read_text(encoding="utf-8")


def test_names(told: Told, root: Path) -> None:
    words = told.summary["trial"]["joint"]
    assert tuple(words[key] for key in ("name", "proximal", "distal", "side")) == NAMES[told.folder.parent.name[:-1]]
    version = (root / "src" / "elbowscrew" / "_version.py").read_text(encoding="utf-8")
    assert f'"{told.summary["elbowscrew"]}"' in version


def test_markers_of_a_simulated_file_are_where_its_poses_put_them(told: Told) -> None:
    """The solved ones to a rounding, the seen ones within the noise, and the error column is their mean distance."""
    for body in told.recording.bodies:
        if not body.solved.size:
            continue
        rows = body.tracked
        put = (np.einsum("nij,mj->nmi", body.R, body.offsets) + body.p[:, None])[rows]
        assert np.abs(body.solved[rows] - put).max() < 0.01
        away = np.linalg.norm(body.seen[rows] - put, axis=2)
        assert 0.1 < np.median(away) < 0.6
        assert away.max() < 2.0
        assert body.error[rows] == pytest.approx(away.mean(axis=1), abs=0.01)


def test_cuts(told: Told) -> None:
    """Movements follow one another; inversions are where theta turns back, and cycles have theirs among them."""
    motion, frame = told.summary["motion"], told.screw["frame"].tolist()
    bounds = [movement[f"{end}_frame"] for movement in motion["movements"] for end in ("onset", "offset")]
    assert bounds
    assert sorted(bounds) == bounds
    assert {*bounds, *motion["inversion_frames"]} <= set(frame)
    assert all(first < last for first, last in zip(bounds[::2], bounds[1::2], strict=True))
    if not motion["signed"]:
        return
    theta = told.screw.set_index("frame")["theta_deg"]
    reach = theta.max() - theta.min()
    inversions, edges = motion["inversion_frames"], [frame[0], *motion["inversion_frames"], frame[-1]]
    assert inversions
    for k, inversion in enumerate(inversions):
        before, after = theta.loc[edges[k] : inversion], theta.loc[inversion : edges[k + 2]]
        swing = min(np.ptp(before.dropna()), np.ptp(after.dropna()))
        ends = [abs(theta.loc[inversion] - extreme) for extreme in (before.max(), before.min())]
        assert min(ends) < 0.02 * reach
        assert swing > 0.1 * reach
    if told.option("--keyframes") is None and len(told.repetitions):
        own = told.repetitions["inversion_frame"]
        assert all(min(abs(one - other) for other in inversions) <= 2 for one in own)


def test_warnings(told: Told) -> None:
    warnings, frame = told.summary["warnings"], set(told.screw["frame"])
    severity = [warning["severity"] for warning in warnings]
    assert severity == sorted(severity, reverse=True)
    for warning in warnings:
        assert set(warning["frames"]) <= frame
        assert warning["count"] >= len(warning["frames"])
        assert warning["message"].strip()


def test_the_preferred_model(told: Told) -> None:
    """A pitch many times its deviation is a screw-hinge's; the simulated trials all have one."""
    fit = told.joint["screw_hinge"]
    if fit is None:
        assert told.joint["joint_type"]["type"] in ("two_axes", "ball")
        assert not told.joint["single_axis"]
        return
    assert told.joint["preferred"] == (
        "screw_hinge" if abs(fit["pitch_mm_per_rad"]) > 3.5 * fit["pitch_sd_mm_per_rad"] else "hinge"
    )
    assert told.joint["joint_type"]["type"] == told.joint["preferred"]


def test_intervals_name_their_source(told: Told) -> None:
    for name in ("hinge", "screw_hinge"):
        fit = told.joint[name]
        if fit is not None:
            words = {"A": "markers' motion", "B": "residuals of the joint's model", "J": "blocks"}[fit["decided_by"]]
            assert words in fit["interval_method"]
            # 95 % of a normal error in two directions lies within 1.73 (alike) to 1.96 (one alone) standard deviations.
            for cone, sd in (("axis_cone95_deg", "axis_sd_deg"), ("point_radius95_mm", "point_sd_mm")):
                assert 1.73 <= fit[cone] / fit[sd] <= 1.961
    kind, head = told.joint["joint_type"], told.joint["mean_axis"]
    bodies = (told.summary["trial"][name] for name in ("proximal", "distal"))
    markers = {body["markers"] > 0 for body in bodies if body is not None}
    assert kind["markers_told"] == ("motion" if markers == {True} else None)
    if told.joint["preferred"] is not None:
        head = head or told.joint[told.joint["preferred"]]
        assert (kind["decided_by"], kind["interval_method"]) == (head["decided_by"], head["interval_method"])
    else:
        words = {"A": "markers' motion", "B": "residuals of the joint's model", "J": "blocks"}[kind["decided_by"]]
        assert words in kind["interval_method"]


def test_the_curve_of_a_selection(told: Told) -> None:
    """The more keyframes the nearer; those chosen are the first to be near enough, as the model's own error says."""
    found = told.summary["interpolation"]["selection"]
    if found is None:
        assert told.option("--tolerance") is None
        return
    assert found["complete"]
    curve = found["curve"]
    errors = {point["keyframes"]: point["max_rms_displacement_mm"] for point in curve}
    assert list(errors) == sorted(errors)
    assert list(errors.values()) == sorted(errors.values(), reverse=True)
    within = min(count for count, error in errors.items() if error <= found["tolerance_mm"])
    assert found["keyframes"] == within
    model = told.model["rms_displacement_mm"]
    assert model.max() <= found["tolerance_mm"]
    assert all(point["rms_displacement_mm"] <= point["max_rms_displacement_mm"] for point in curve)


def test_two_axes_are_those_of_the_motion(told: Told) -> None:
    """Directions, places and ranges that the motion was made with; twice the radius that holds 95 %."""
    axes = told.joint["two_axes"]
    if axes is None:
        return
    time = np.linspace(0.0, 1.0, 240)
    truth = {
        "axis1": ([0.98, 0.10, 0.17], [0.0, -280.0, 10.0], 55.0 * (1.0 - np.cos(4.0 * np.pi * time)), "proximal"),
        "axis2": ([0.10, -0.99, 0.05], [-10.0, 100.0, -10.0], 40.0 * (1.0 - np.cos(6.0 * np.pi * time)), "distal"),
    }
    for name, (direction, point, angle, body) in truth.items():
        axis, n = axes[name], np.array(direction) / np.linalg.norm(direction)
        other = np.array(axis[f"direction_in_{body}"])
        off = np.degrees(np.arcsin(np.linalg.norm(np.cross(n, other))))
        assert off < 2.0 * axis["cone95_deg"] < 0.5
        away = np.array(axis[f"point_in_{body}_mm"]) - point
        assert np.linalg.norm(away - (away @ n) * n) < 2.0 * axis["radius95_mm"] + np.radians(off) * np.linalg.norm(
            away
        )
        assert axis["range_deg"] == pytest.approx(np.ptp(np.percentile(angle, [5, 95])), abs=1.0)
        assert 0.02 < axis["angle_sd_deg"] < 0.2  # the noise is 0.1 deg in three directions, and 0.2 mm
        assert axis["determined"] is True
        assert axis["radius95_mm"] < 0.5
    # Each is also told in the other body, where it was at the reference: both frames see one angle and one distance.
    between, distance = {}, {}
    for body in ("proximal", "distal"):
        n, m = (np.array(axes[name][f"direction_in_{body}"]) for name in truth)
        p, q = (np.array(axes[name][f"point_in_{body}_mm"]) for name in truth)
        between[body], distance[body] = n @ m, (q - p) @ np.cross(n, m)
    assert between["proximal"] == pytest.approx(between["distal"], abs=1e-3)
    assert distance["proximal"] == pytest.approx(distance["distal"], abs=0.1)
    for name in ("angle_between_deg", "distance_mm", "foot1_mm", "foot2_mm"):
        assert axes[f"{name}_low"] < axes[name] < axes[f"{name}_high"]
        assert axes[f"{name}_low"] + axes[f"{name}_high"] == pytest.approx(2.0 * axes[name])
    assert axes["parallel_offset_mm"] is None


def test_the_center_of_a_ball(told: Told) -> None:
    ball = told.joint["ball"]
    if ball is not None:
        assert ball["center_in_proximal_mm"] == pytest.approx([30.0, 1200.0, 80.0], abs=1e-3)
        assert ball["center_in_distal_mm"] == pytest.approx([0.0, 250.0, 0.0], abs=1e-3)
        assert ball["radius95_mm"] is None or ball["radius95_mm"] < 1e-3
