"""Every number of a result once more, from the tables beside it and the file it was made of, without the package."""

from __future__ import annotations

import hashlib
import itertools
import platform
import tomllib
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.linalg import expm, logm
from scipy.spatial.distance import pdist
from scipy.spatial.transform import Rotation
from told_results import Body, Float, Told

XYZ = ("x", "y", "z")
POSE = ["e0", "e1", "e2", "e3", "d_x_mm", "d_y_mm", "d_z_mm"]


class Poses:
    """Displacements of a table: rotation matrices and shifts (mm); NaN where there is none."""

    def __init__(self, table: pd.DataFrame) -> None:
        self.quat = table[["e0", "e1", "e2", "e3"]].to_numpy(float)
        self.d = table[["d_x_mm", "d_y_mm", "d_z_mm"]].to_numpy(float)
        self.known = np.isfinite(self.quat).all(axis=1)
        self.R = np.full((len(self.d), 3, 3), np.nan)
        self.R[self.known] = Rotation.from_quat(self.quat[self.known][:, [1, 2, 3, 0]]).as_matrix()

    @property
    def angle(self) -> Float:
        """Unsigned rotation, degrees."""
        return np.asarray(
            np.degrees(2.0 * np.arctan2(np.linalg.norm(self.quat[:, 1:], axis=1), np.abs(self.quat[:, 0])))
        )

    def placed(self, points: Float) -> Float:
        """Where points (M, 3) of the moving body are taken, (N, M, 3)."""
        return np.asarray(np.einsum("nij,mj->nmi", self.R, points) + self.d[:, None])

    def screws(self, theta: Float) -> tuple[Float, Float, Float]:
        """Direction, point nearest the origin and slide of the screw that turns by theta (degrees)."""
        half = np.radians(0.5 * theta)
        sign = np.where(self.quat[:, 0] * np.cos(half) < 0.0, -1.0, 1.0)
        axis = sign[:, None] * self.quat[:, 1:] / np.sin(half)[:, None]
        axis /= np.linalg.norm(axis, axis=1, keepdims=True)
        slide = np.sum(axis * self.d, axis=1)
        across = self.d - slide[:, None] * axis
        return axis, 0.5 * (across + np.cross(axis, across) / np.tan(half)[:, None]), slide


def vectors(table: pd.DataFrame, stem: str, unit: str = "") -> Float:
    return table[[f"{stem}_{letter}{unit}" for letter in XYZ]].to_numpy(float)


def rms(values: Any) -> float:
    known = np.asarray(values, float)
    known = known[np.isfinite(known)]
    return float(np.sqrt(np.mean(known**2))) if known.size else float("nan")


def most(values: Any) -> float:
    known = np.asarray(values, float)
    return float(np.nanmax(known)) if np.isfinite(known).any() else float("nan")


def where_most(frame: NDArray[np.int64], values: Any) -> int:
    return int(frame[int(np.nanargmax(np.asarray(values, float)))])


def median(values: Any) -> float:
    known = np.asarray(values, float)
    return float(np.nanmedian(known)) if np.isfinite(known).any() else float("nan")


def angle_between(a: Float, b: Float) -> Float:
    """Degrees, exact for small angles."""
    return np.asarray(np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), np.sum(a * b, axis=-1))))


def pierced(direction: Float, point: Float, across: Float, at: Float) -> Float:
    """Where lines pierce the plane across a direction through a point."""
    with np.errstate(divide="ignore", invalid="ignore"):
        way = np.sum((at - point) * across, axis=-1) / np.sum(direction * across, axis=-1)
        return np.asarray(point + way[..., None] * direction)


def change_of(told: Told) -> tuple[Float, Float]:
    """Pose of the distal body at the reference in the frame that screws are expressed in."""
    bodies = told.joint["bodies"]
    J = pose_of(bodies["distal_in_proximal"])
    if told.frame_of_screws == "distal":
        return np.eye(3), np.zeros(3)
    if told.frame_of_screws == "proximal":
        return J
    return composed(pose_of(bodies["proximal_in_lab"]), J)


def pose_of(value: Any) -> tuple[Float, Float]:
    w, x, y, z = value["quaternion"]
    return Rotation.from_quat([x, y, z, w]).as_matrix(), np.array(value["position_mm"])


def composed(a: tuple[Float, Float], b: tuple[Float, Float]) -> tuple[Float, Float]:
    return a[0] @ b[0], a[0] @ b[1] + a[1]


def relative_poses(told: Told) -> tuple[Float, Float]:
    """Distal body in the proximal one in every measured frame, from the displacements and the reference."""
    poses = Poses(told.screw)
    rows = told.screw["valid"] == 1
    R, d = poses.R[rows], poses.d[rows]
    C, c = change_of(told)
    # Expressed in another frame: back into the distal one, then onto the reference.
    R, d = C.T @ R @ C, (R @ c + d - c) @ C
    J, j = pose_of(told.joint["bodies"]["distal_in_proximal"])
    return J @ R, d @ J.T + j


# ---------------------------------------------------------------- summary.json


def summary_of(told: Told) -> dict[str, Any]:
    """What `summary.json` should say."""
    return {
        "source": _source(told),
        "settings": _settings(told),
        "landmarks": _landmarks(told),
        "versions": {
            "python": platform.python_version(),
            **{name: version(name) for name in ("numpy", "scipy", "matplotlib", "pandas", "pydantic")},
        },
        "trial": _trial(told),
        "motion": _motion(told),
        "interpolation": _interpolation(told),
    }


USUAL: dict[str, Any] = {
    "pose-method": "svd", "reference-window": 1, "express-in": "distal", "max-gap": 0.1, "frozen": "lost",
    "max-turn": 3000.0, "max-speed": 15.0, "min-tracked": 50.0, "min-rate": 0.25, "min-angle": 10.0, "noise": "auto",
    "signed": "auto", "joint-type": "auto", "robust": False, "no-cycles": False, "phases": "movement",
    "blend": "piecewise", "knots": "law", "angle-unit": "deg", "length-unit": "mm", "figure-format": ["png"],
    "export": [],
}  # fmt: skip
"""Settings as the documentation states them, but for those that are found from the recording."""


def _settings(told: Told) -> dict[str, Any]:
    """Every setting as it was given, or as it is by default."""
    found = dict.fromkeys(told.summary["settings"]) | USUAL
    found |= {"method": "sclerp", "law": "linear"} if "--tolerance" in told.options else {}
    for option, value in itertools.pairwise((*told.options, "")):
        name = option.removeprefix("--")
        if not option.startswith("--") or name == "landmarks":
            continue
        if value.startswith("--") or not value:
            found[name] = True
        elif name in ("keyframes", "export", "figure-format"):
            found[name] = [int(part) if part.isdigit() else part for part in value.split(",")]
        else:
            number = value.removesuffix("mm")
            found[name] = float(number) if number.replace(".", "").isdigit() else value
    return {
        "method": "dlb",
        "law": "cycloidal",
        **{key: value for key, value in found.items() if value is not None},
    } | {key: None for key, value in found.items() if value is None and key not in ("method", "law")}


def _landmarks(told: Told) -> dict[str, Any] | None:
    path = told.option("--landmarks")
    if path is None:
        return None
    given = tomllib.loads(Path(path).read_text(encoding="utf-8"))
    called = {"arm": "proximal", "forearm": "distal", "thigh": "proximal", "shank": "distal"}
    return {
        "side": given["side"],
        **{name: {**mark, "body": called.get(mark["body"], mark["body"])} for name, mark in given["landmarks"].items()},
    }


def _source(told: Told) -> dict[str, Any]:
    header = told.recording.header
    return {
        "name": told.source.name,
        "sha256": hashlib.sha256(told.source.read_bytes()).hexdigest(),
        "layout": f"Motive columns {header['Format Version']}",
        "take": header["Take Name"],
        "length_unit": {"Meters": "m", "Centimeters": "cm", "Millimeters": "mm"}[header["Length Units"]],
        "distal_file": None,
        "columns_file": None,
        "rotation": header["Rotation Type"].lower(),
    }


def two_bodies(told: Told) -> tuple[Body | None, Body]:
    """The proximal and the distal body of the file, as the trial names them."""
    trial = told.summary["trial"]
    named = {body.name: body for body in told.recording.bodies}
    proximal = trial["proximal"]
    return None if proximal is None else named[proximal["name"]], named[trial["distal"]["name"]]


def _trial(told: Told) -> dict[str, Any]:
    screw, recording = told.screw, told.recording
    frame, time_s = screw["frame"].to_numpy(), screw["time_s"].to_numpy(float)
    rate = float(recording.header["Export Frame Rate"])
    steps = np.diff(frame)
    proximal, distal = two_bodies(told)
    return {
        "frames": len(screw),
        "first_frame": frame[0],
        "last_frame": frame[-1],
        "rate_hz": rate,
        "duration_s": time_s[-1] - time_s[0],
        "clock": {
            "missing_frames": int(np.sum(steps[steps > 1] - 1)),
            "frame_gaps": int(np.sum(steps > 1)),
            "repeated_frames": int(np.sum(steps < 1)),
            "largest_offset_s": float(np.ptp(time_s - (frame - frame[0]) / rate)),
        },
        "bodies": [{"name": body.name, "id": body.identifier} for body in recording.bodies],
        "proximal": None if proximal is None else _quality(proximal, screw["proximal_loss"], time_s),
        "distal": _quality(distal, screw["distal_loss"], time_s),
        "measured_frames": int(screw["valid"].sum()),
        "filled_frames": int(screw["filled"].sum()),
        "missing_share": 1.0 - screw["valid"].mean(),
        "positions": True,
        "reference_frame": int(told.option("--reference") or frame[screw["valid"] == 1][0]),
        "lowpass_hz": None if told.option("--lowpass") is None else float(told.option("--lowpass") or "nan"),
    }


def _quality(body: Body, loss: pd.Series, time_s: Float) -> dict[str, Any]:
    rows = np.flatnonzero(body.tracked)
    quat = body.quat[rows]
    turn = (Rotation.from_quat(quat[:-1]).inv() * Rotation.from_quat(quat[1:])).magnitude()
    span = np.diff(time_s[rows])
    speed = np.linalg.norm(np.diff(body.p[rows], axis=0), axis=1) / span / 1000.0
    marked = body.solved.shape[1] > 0
    lost = loss.dropna().value_counts().to_dict()
    return {
        "name": body.name,
        "id": body.identifier,
        "tracked_share": float(loss.isna().mean()),
        "lost_frames": {str(reason): int(count) for reason, count in lost.items()},
        "sign_flips": int(np.sum(np.sum(quat[1:] * quat[:-1], axis=1) < 0.0)),
        "leaps": 0,  # no trial here has any
        "fastest_turn_deg_s": float(np.degrees(np.max(turn / span))),
        "fastest_speed_m_s": float(np.max(speed)),
        "marker_residual_mm": _spread(body.residual[rows]) if marked else None,
        "reported_error_mm": _spread(body.error[rows]),
        "pivot_offset_mm": float(np.linalg.norm(body.offsets.mean(axis=0))) if marked else None,
        "shape_deviation": None,  # no export of columns has it
        "markers": body.solved.shape[1],
    }


def _spread(values: Float) -> dict[str, float]:
    ordered = pd.Series(values)
    return {
        "median": float(ordered.median()),
        "percentile_95": float(ordered.quantile(0.95)),
        "largest": float(ordered.max()),
    }


def dominant_axis(told: Told) -> tuple[Float, float]:
    """Leading direction of ``sum v v^T`` less the noise's share, and second eigenvalue over first."""
    vector = Poses(told.screw).quat[:, 1:]
    vector = vector[np.isfinite(vector).all(axis=1)]
    moments = vector.T @ vector - 0.25 * rotation_sigma(told) ** 2 * len(vector) * np.eye(3)
    values, directions = np.linalg.eigh(moments)
    return directions[:, -1], max(values[-2], 0.0) / values[-1]


def rotation_sigma(told: Told) -> float:
    """Noise of a component of the relative rotation, radians: that of both bodies, or from third differences."""
    noise = told.joint["noise"]
    moving = [noise["distal"], *([noise["proximal"]] if told.summary["trial"]["proximal"] is not None else [])]
    if all(one is not None for one in moving):
        return float(np.sqrt(sum(np.sum(np.radians(one["rotation_sd_deg"]) ** 2) for one in moving) / 3.0))
    quat = Poses(told.screw).quat
    for k in range(1, len(quat)):
        if np.nansum(quat[k] * quat[k - 1]) < 0.0:
            quat[k:] *= -1.0
    third = np.linalg.norm(np.diff(quat, 3, axis=0), axis=1)
    # 20 = 1 + 9 + 9 + 1; a component of the rotation is twice that of the quaternion; median of chi-square of three.
    return float(2.0 * np.nanmedian(third) / np.sqrt(20.0 * 2.366))


def axes_one_way(told: Told) -> tuple[Float, Float, Float]:
    """Direction, point and angle (degrees) of every measured frame that has an axis, turned along the dominant one."""
    screw = told.screw
    axis = vectors(screw, "axis")
    rows = (screw["valid"] == 1).to_numpy() & np.isfinite(axis).all(axis=1)
    axis, point, theta = axis[rows], vectors(screw, "point", "_mm")[rows], screw["theta_deg"].to_numpy(float)[rows]
    leading = np.array(told.summary["motion"]["dominant_axis"]["direction"])
    return np.where((axis @ leading < 0.0)[:, None], -axis, axis), point, theta


def mean_axis(told: Told) -> tuple[Float, Float]:
    """Mean of the lines as dual vectors, weighted by sin^2(theta/2): direction and point nearest the origin."""
    axis, point, theta = axes_one_way(told)
    weight = np.sin(np.radians(0.5 * theta)) ** 2
    real, dual = weight @ axis, weight @ np.cross(point, axis)
    size = np.linalg.norm(real)
    return real / size, np.cross(real, dual) / size**2


def dispersion_by_angle(axis: Float, theta: Float) -> float:
    """Weighted median of the deviations from the weighted mean; each degree of the motion weighs as much as another."""
    bins = pd.Series(np.floor(theta - theta.min()).astype(int))
    weight = (1.0 / bins.map(bins.value_counts())).to_numpy(float)
    off = angle_between(axis, np.broadcast_to(weight @ axis, axis.shape))
    order = np.argsort(off)
    total = np.cumsum(weight[order])
    half = 0.5 * total[-1]
    lower = off[order][np.argmax(total >= half * (1.0 - 1e-9))]
    upper = off[order][np.argmax(total >= half * (1.0 + 1e-9))]
    return float(0.5 * (lower + upper))


def deviations(told: Told) -> tuple[Float, Float]:
    """Angle of the frames' axes to the plain mean direction, and how far from the mean axis they pass the distal body.

    Degrees and millimeters; the distance is taken in the plane across the mean axis through the distal body's origin
    at the reference.
    """
    axis, point, _ = axes_one_way(told)
    direction, middle = mean_axis(told)
    near = change_of(told)[1]
    center = middle + ((near - middle) @ direction) * direction
    off = angle_between(axis, np.broadcast_to(axis.mean(axis=0), axis.shape))
    return off, _told_positions(told) * np.linalg.norm(pierced(axis, point, direction, center) - center, axis=1)


def _told_positions(told: Told) -> Float:
    """Which axes have a position: none over 75 deg from the mean, and none at all where over 5 % are."""
    axis, _, _ = axes_one_way(told)
    direction, _ = mean_axis(told)
    far = np.abs(axis @ direction) < np.cos(np.radians(75.0))
    return np.where(far | (far.mean() > 0.05), np.nan, 1.0)


def _motion(told: Told) -> dict[str, Any]:
    screw = told.screw
    valid = screw[screw["valid"] == 1]
    axis, _, theta = axes_one_way(told)
    weight = np.sin(np.radians(0.5 * theta)) ** 2
    direction, point = mean_axis(told)
    off = angle_between(axis, np.broadcast_to(direction, axis.shape))
    deviation, distance = deviations(told)
    leading, ratio = dominant_axis(told)
    joint = told.joint
    best = None if joint["preferred"] is None else joint[joint["preferred"]]
    return {
        "theta_max_deg": valid["theta_deg"].max(),
        "theta_min_deg": valid["theta_deg"].min(),
        "theta_max_frame": where_most(valid["frame"].to_numpy(), valid["theta_deg"]),
        "signed": {"auto": ratio <= 0.2, "yes": True, "no": False}[told.option("--signed") or "auto"],
        "dominant_axis": {"direction": np.sign(leading @ direction) * leading, "ratio": ratio},
        "largest_jump_deg": _largest_jump(told),
        "slide_median_mm": valid["slide_mm"].median(),
        "slide_min_mm": valid["slide_mm"].min(),
        "slide_max_mm": valid["slide_mm"].max(),
        "repetitions": len(told.repetitions),
        "expressed_in": told.frame_of_screws,
        "axis_frames": len(axis),
        "mean_axis": {"direction": direction, "point_mm": point},
        "axis_dispersion_deg": dispersion_by_angle(axis, theta),
        "axis_dispersion_all_frames_deg": np.median(deviation),
        "axis_dispersion_weighted_deg": np.sqrt(weight @ off**2 / weight.sum()),
        "axis_dispersion_rms_deg": rms(deviation),
        "axis_dispersion_max_deg": deviation.max(),
        "axis_distance_rms_mm": rms(distance),
        "single_axis": joint["single_axis"],
        "joint_type": joint["joint_type"],
        "joint_numbers": {name: joint[name] for name in ("two_axes", "ball", "second_rotation", "wander")},
        "anatomy": _angles_of_bones(told),
        "joint_axis": None
        if best is None
        else {
            "model": joint["preferred"],
            "is_mean": joint["mean_axis"] is not None,
            **{
                name: (best if joint["mean_axis"] is None else best | joint["mean_axis"])[name]
                for name in (
                    "direction",
                    "point_mm",
                    "axis_cone95_deg",
                    "point_radius95_mm",
                    "pitch_mm_per_rad",
                    "interval_method",
                    "sensitivity_deg_per_deg",
                )
            },
        },
    }


def _largest_jump(told: Told) -> float:
    """By how much theta changes more between adjacent frames than the rotation that leads from one to the other."""
    poses, theta = Poses(told.screw), told.screw["theta_deg"].to_numpy(float)
    dot = np.abs(np.sum(poses.quat[1:] * poses.quat[:-1], axis=1))
    shortest = np.degrees(2.0 * np.arccos(np.minimum(dot, 1.0)))
    beyond = most(np.abs(np.diff(theta)) - shortest)
    return beyond if beyond > 1e-4 else 0.0


def distal_points(told: Told) -> Float:
    """The points (M, 3), mm, in the frame of the screws, over which the RMS displacement is taken."""
    markers, radius = told.joint["bodies"]["distal_markers_mm"], told.option("--radius")
    if markers and radius is None:
        points = np.array(markers)
    else:
        # Six points on the axes at this distance have that radius of gyration and no direction of their own.
        points = float(radius or 50.0) * np.concatenate([np.eye(3), -np.eye(3)])
    C, c = change_of(told)
    return points @ C.T + c


def model_errors(told: Told) -> pd.DataFrame:
    """Errors of the model in every frame, from the measured and modeled displacements."""
    measured, modeled = Poses(told.screw), Poses(told.model)
    c = change_of(told)[1]
    valid = (told.screw["valid"] == 1).to_numpy()
    both = measured.known & modeled.known & valid
    turn = np.full(len(valid), np.nan)
    turn[both] = (Rotation.from_matrix(measured.R[both]).inv() * Rotation.from_matrix(modeled.R[both])).magnitude()
    origin = np.linalg.norm(measured.placed(c[None]) - modeled.placed(c[None]), axis=2)[:, 0]
    points = distal_points(told)
    square = np.sum((measured.placed(points) - modeled.placed(points)) ** 2, axis=2)
    direction, point = vectors(told.screw, "axis"), vectors(told.screw, "point", "_mm")
    with np.errstate(divide="ignore", invalid="ignore"):
        other, place, _ = modeled.screws(told.model["theta_deg"].to_numpy(float))
    other[told.model["slide_mm"].isna()] = np.nan
    off = angle_between(direction, other)
    if not told.summary["motion"]["signed"]:
        off = np.minimum(off, 180.0 - off)
    center = point + np.sum((c - point) * direction, axis=1, keepdims=True) * direction
    table = pd.DataFrame(
        {
            "angle_error_deg": np.degrees(turn),
            "translation_error_mm": origin,
            "rms_displacement_mm": np.sqrt(np.mean(square, axis=1)),
            "axis_error_deg": off,
            "axis_distance_mm": np.linalg.norm(pierced(other, place, direction, center) - center, axis=1),
        }
    )
    table[~both] = np.nan
    return table


def _interpolation(told: Told) -> dict[str, Any]:
    frame, errors = told.screw["frame"].to_numpy(), model_errors(told)
    theta = (told.model["theta_deg"] - told.screw["theta_deg"]).where(told.screw["valid"] == 1).abs()
    keyframes = told.keyframes
    (method,), (blend,) = keyframes["method"].unique(), keyframes["blend"].unique()
    tolerance = told.option("--tolerance")
    points = distal_points(told)
    C, c = change_of(told)
    found: dict[str, Any] = {
        "method": method,
        "blend": blend,
        "law": told.option("--law") or ("linear" if tolerance else "cycloidal"),
        "knots": told.option("--knots") or "law",
        "keyframes": keyframes["frame"].tolist(),
        "phases": int(keyframes["phase"].max()),
        "phase_laws": _phase_laws(told),
        "selection": None if tolerance is None else _selection(told, float(tolerance.removesuffix("mm"))),
        "covered_share": told.model["theta_deg"].notna().mean(),
        "rmse_theta_deg": rms(theta),
        "max_theta_error_deg": most(theta),
        "max_theta_error_frame": where_most(frame, theta),
        "points": {
            "from": "markers"
            if told.joint["bodies"]["distal_markers_mm"] and not told.option("--radius")
            else "radius",
            "centroid_mm": (points.mean(axis=0) - c) @ C,
            "radius_of_gyration_mm": np.sqrt(np.mean(np.sum((points - points.mean(axis=0)) ** 2, axis=1))),
        },
    }
    for column in errors:
        name, unit = str(column).rsplit("_", 1)
        stem = name if name == "rms_displacement" else f"rms_{name}"
        found[f"{stem}_{unit}"] = rms(errors[column])
        found[f"max_{name}_{unit}"] = most(errors[column])
        found[f"max_{name}_frame"] = where_most(frame, errors[column])
    return found


LAWS = {
    "linear": lambda x: x,
    "cycloidal": lambda x: x - np.sin(2.0 * np.pi * x) / (2.0 * np.pi),
    "harmonic": lambda x: 0.5 - 0.5 * np.cos(np.pi * x),
    "polynomial-345": lambda x: x**3 * (10.0 - 15.0 * x + 6.0 * x**2),
}


def _phase_laws(told: Told) -> list[dict[str, Any]]:
    """Law and frames of each phase, and how far the screw motion under it is from the poses measured in it."""
    screw, keyframes = told.screw, told.keyframes
    time_s, frame = screw["time_s"].to_numpy(float), screw["frame"].to_numpy()
    poses, points = Poses(screw), distal_points(told)
    found = []
    for phase in range(1, int(keyframes["phase"].max()) + 1):
        own = keyframes[keyframes["phase"] == phase]
        next_one = keyframes[keyframes["phase"] == phase + 1]
        law, peak = own["law"].iloc[0], own["law_peak"].iloc[0]
        start, end = (int(np.argmin(np.abs(time_s - own[f"law_{k}_s"].iloc[0]))) for k in ("start", "end"))
        # A keyframe between two phases counts with the later one.
        ends = own["frame"].iloc[0], (own["frame"].iloc[-1] if next_one.empty else next_one["frame"].iloc[0])
        first, last = (transform(poses, int(np.flatnonzero(frame == k)[0])) for k in ends)
        rows = np.arange(start, end + 1)
        rows = rows[(screw["valid"] == 1).to_numpy()[rows]]
        step = np.real(logm(np.linalg.inv(first) @ last))
        share = LAWS[law](shifted((time_s[rows] - time_s[start]) / (time_s[end] - time_s[start]), peak))
        modeled = first @ expm(share[:, None, None] * step)
        there = points @ np.swapaxes(modeled[:, :3, :3], 1, 2) + modeled[:, None, :3, 3]
        square = np.sum((there - poses.placed(points)[rows]) ** 2, axis=2)
        found.append(
            {
                "law": law,
                "peak": None if pd.isna(peak) else peak,
                "peak_sd": None,
                "start_frame": frame[start],
                "end_frame": frame[end],
                "rms_displacement_mm": np.sqrt(np.mean(square)),
                "rms_angle_deg": None,
            }
        )
    return found


def shifted(x: Float, peak: float) -> Float:
    """Not known here but for laws that are fastest in the middle."""
    assert pd.isna(peak), peak
    return x


def transform(poses: Poses, row: int) -> Float:
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = poses.R[row], poses.d[row]
    return T


def _selection(told: Told, tolerance: float) -> dict[str, Any]:
    count, frames = len(told.keyframes), int(told.model["theta_deg"].notna().sum())
    return {
        "tolerance_mm": tolerance,
        "tolerance_deg": None,
        "frames": frames,
        "keyframes": count,
        "keyframe_frames": told.keyframes["frame"].tolist(),
        "compression_ratio": frames / count,
    }


# ---------------------------------------------------------------- joint.json


def joint_of(told: Told) -> dict[str, Any]:
    """What `joint.json` should say, as far as tables, the file and short formulas go."""
    joint = told.joint
    direction, point = mean_axis(told)
    found: dict[str, Any] = {
        "expressed_in": told.frame_of_screws,
        "weighted_mean": in_all_frames(told, direction, point),
        "sara": _sara(told),
        "dispersion": _dispersion(told),
        "noise": {
            name: _noise(told, body)
            for name, body in zip(("proximal", "distal"), two_bodies(told), strict=True)
            if body is None or body.solved.size
        },
        "repeatability": _repeatability(told),
        "bodies": _bodies(told),
    }
    if joint["hinge"] is not None:
        share = _unexplained(told)
        found |= {"unexplained_share": share, "single_axis": share <= 0.25}
        for name in ("hinge", "screw_hinge"):
            fit = joint[name]
            found[name] = {
                **as_shown(told, fit),
                **_residuals(told, fit),
                "frames": int(told.screw["valid"].sum()),
                "outlier_share": 0.0,  # all frames weigh alike without --robust
                **({} if name == "screw_hinge" else {"pitch_mm_per_rad": 0.0, "pitch_sd_mm_per_rad": 0.0}),
            }
    else:
        found |= {"hinge": None, "screw_hinge": None, "preferred": None, "single_axis": False}
    axes = joint["two_axes"]
    if axes is not None:
        found["joint_type"] = {"type": "two_axes"}
        found["two_axes"] = _two_axes(axes) | {
            f"axis{k}": as_shown(told, axes[f"axis{k}"], nearest=False) for k in (1, 2)
        }
    best = None if joint["preferred"] is None else joint[joint["preferred"]]
    found["sensitivity_deg_per_deg"] = None if best is None else best["sensitivity_deg_per_deg"]
    found["skin_motion"] = None
    found["anatomy"] = None if joint["anatomy"] is None else _anatomy(told)
    return found


def _two_axes(axes: Any) -> dict[str, float]:
    """Angle and signed distance between the axes, and where the common normal meets each, from their own numbers."""
    n, m = (np.array(axes[f"axis{k}"]["direction_in_proximal"]) for k in (1, 2))
    p, q = (np.array(axes[f"axis{k}"]["point_in_proximal_mm"]) for k in (1, 2))
    normal = np.cross(n, m) / np.linalg.norm(np.cross(n, m))
    between = float(angle_between(n, m))
    second = axes["axis2"]
    return {
        "angle_between_deg": min(between, 180.0 - between),
        "distance_mm": float((q - p) @ normal),
        "foot1_mm": float(p @ n),
        "foot2_mm": float(np.dot(second["point_in_distal_mm"], second["direction_in_distal"])),
    }


def in_all_frames(told: Told, direction: Float, point: Float) -> dict[str, Any]:
    """Write a line of the screws' frame in both bodies at the reference, each with its point nearest the origin."""
    C, c = change_of(told)
    J, j = pose_of(told.joint["bodies"]["distal_in_proximal"])
    distal, place = C.T @ direction, C.T @ (point - c)
    lines = {"": (direction, point), "_in_proximal": (J @ distal, J @ place + j), "_in_distal": (distal, place)}
    found: dict[str, Float] = {}
    for where, (n, p) in lines.items():
        found[f"direction{where}"] = n
        found[f"point{where}_mm"] = p - (p @ n) * n
    return found


def as_shown(told: Told, line: Any, *, nearest: bool = True) -> dict[str, Any]:
    """Direction and point of a line in the frame of the screws: as in that body, or carried by the proximal one."""
    body = "distal" if told.frame_of_screws == "distal" else "proximal"
    n, p = np.array(line[f"direction_in_{body}"]), np.array(line[f"point_in_{body}_mm"])
    if told.frame_of_screws == "lab":
        R, t = pose_of(told.joint["bodies"]["proximal_in_lab"])
        n, p = R @ n, R @ p + t
    return {"direction": n, "point_mm": p - (p @ n) * n if nearest else p}


def _sara(told: Told) -> dict[str, Any]:
    """Symmetrical axis: where ``R c - C = -t`` leaves the two points free, by the whole system's SVD."""
    R, t = relative_poses(told)
    system = np.concatenate([np.concatenate([one, -np.eye(3)], axis=1) for one in R])
    _, values, rows = np.linalg.svd(system, full_matrices=False)
    solution = rows[:-1].T @ ((rows[:-1] @ (system.T @ -t.ravel())) / values[:-1] ** 2)
    found: dict[str, Float] = {}
    for body, part in (("distal", slice(0, 3)), ("proximal", slice(3, 6))):
        n, p = rows[-1][part] / np.linalg.norm(rows[-1][part]), solution[part]
        n = np.sign(n @ np.array(told.joint["weighted_mean"][f"direction_in_{body}"])) * n
        found |= {f"direction_in_{body}": n, f"point_in_{body}_mm": p - (p @ n) * n}
    return {**found, **as_shown(told, found)}


def about_line(told: Told, fit: Any) -> tuple[Float, Float, Float, Float]:
    """Angle (rad, unwrapped) about a line of both bodies, tilt (rad) and shift (mm) that remain, and slide (mm)."""
    R, t = relative_poses(told)
    a, b = np.array(fit["direction_in_proximal"]), np.array(fit["direction_in_distal"])
    seen = R @ b
    tilt = np.radians(angle_between(seen, np.broadcast_to(a, seen.shape)))
    quat = Rotation.from_matrix(R @ turn_onto(b, a).T).as_quat()
    angle = 2.0 * np.unwrap(np.arctan2(quat[:, :3] @ a, quat[:, 3]), period=np.pi)
    p, q = np.array(fit["point_in_proximal_mm"]), np.array(fit["point_in_distal_mm"])
    near = pose_of(told.joint["bodies"]["distal_in_proximal"])[1]
    p = p + ((near - p) @ a) * a  # where the fit's own origin is
    middle = len(R) // 2
    q = q + ((R[middle].T @ (p - t[middle]) - q) @ b) * b
    apart = R @ q + t - p
    slide = apart @ a
    return angle, tilt, apart - slide[:, None] * a, slide


def turn_onto(a: Float, b: Float) -> Float:
    """Rotation matrix of the shortest way from one direction to another."""
    v, w = np.cross(a, b), 1.0 + a @ b
    return np.asarray(Rotation.from_quat([*v, w]).as_matrix())


def _residuals(told: Told, fit: Any) -> dict[str, float]:
    angle, tilt, across, slide = about_line(told, fit)
    along = slide - fit["pitch_mm_per_rad"] * angle
    pitch = {} if fit["pitch_mm_per_rad"] == 0.0 else {"pitch_mm_per_rad": np.polyfit(angle, slide, 1)[0]}
    return {
        **pitch,
        "residual_rotation_deg": np.degrees(rms(tilt)),
        "residual_translation_mm": np.sqrt(np.mean(np.sum(across**2, axis=1)) + np.var(along)),
        "sensitivity_deg_per_deg": _sensitivity(angle),
    }


def _unexplained(told: Told) -> float:
    angle, tilt, _, _ = about_line(told, told.joint["hinge"])
    return rms(tilt) / float(np.std(angle))


def _sensitivity(angle: Float) -> float:
    """By how much a hinge turns with a cluster that turns as sin(theta/2), ``|cov(f, e)| / (1 - |mean e|^2)``."""
    f = np.sin(0.5 * np.minimum(angle - angle.min(), np.pi))
    f = f / f.max()
    e = np.exp(1j * angle)
    return float(abs(np.mean((f - f.mean()) * e)) / (1.0 - abs(e.mean()) ** 2))


def _dispersion(told: Told) -> dict[str, float]:
    off, distance = deviations(told)
    axis, point, _ = axes_one_way(told)
    direction, middle = mean_axis(told)
    near = change_of(told)[1]
    place = pierced(axis, point, direction, middle + ((near - middle) @ direction) * direction)
    place = _told_positions(told)[:, None] * place
    place = place[np.isfinite(place).all(axis=1)]
    return {
        "direction_median_deg": median(off),
        "direction_rms_deg": rms(off),
        "direction_95_deg": float(np.percentile(off, 95)),
        "direction_max_deg": most(off),
        "direction_excursion_deg": float(2.0 * np.degrees(np.arcsin(0.5 * pdist(axis).max()))),
        "position_median_mm": median(distance),
        "position_rms_mm": rms(distance),
        "position_95_mm": float(np.percentile(distance[np.isfinite(distance)], 95)) if len(place) else float("nan"),
        "position_max_mm": most(distance),
        "position_excursion_mm": float(pdist(place).max()) if len(place) else float("nan"),
    }


def _noise(told: Told, body: Body | None) -> dict[str, Any] | None:
    """Noise of a body's poses from its markers' residuals, or as it was stated."""
    if body is None:
        return None
    markers, stated = body.offsets, told.option("--marker-noise")
    count = len(markers)
    freedom = 3 * count - 6
    usual = (1.0 - 2.0 / (9.0 * freedom)) ** 3 * freedom  # median of chi-square, Wilson and Hilferty
    sigma = np.sqrt(count * np.median(body.residual[body.tracked] ** 2) / usual)
    sigma = sigma if stated is None else float(stated)
    covariance = marker_covariance(markers, sigma)
    deviation = np.sqrt(np.diag(covariance))
    return {
        "source": "marker residuals" if stated is None else "option",
        "marker_noise_mm": sigma,
        "rotation_sd_deg": np.degrees(deviation[:3]),
        "position_sd_mm": deviation[3:],
    }


def cross_matrix(v: Float) -> Float:
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


def marker_covariance(markers: Float, sigma: float) -> Float:
    """Covariance (6, 6) of a pose fitted to markers: rotation vector (rad), then shift (mm), in the body's frame."""
    rows = [np.concatenate([-cross_matrix(x), np.eye(3)], axis=1) for x in markers]
    return np.asarray(sigma**2 * np.linalg.inv(sum(J.T @ J for J in rows)))


def adjoint(R: Float, p: Float) -> Float:
    """How small twists, rotation first, go from the frame of a pose to the one it is seen from."""
    found = np.zeros((6, 6))
    found[:3, :3] = found[3:, 3:] = R
    found[3:, :3] = cross_matrix(p) @ R
    return found


def screw_errors(told: Told, reference_frames: int) -> pd.DataFrame:
    """Standard deviations of angle, slide and direction in every measured frame, by central differences.

    The noise of both bodies' markers goes through the poses of the frame and of the reference, which is a mean of so
    many, and through the screw of the displacement.
    """
    bodies, noise = told.joint["bodies"], told.joint["noise"]
    J0, j0 = pose_of(bodies["distal_in_proximal"])
    S = {
        name: marker_covariance(np.array(bodies[f"{name}_markers_mm"]), noise[name]["marker_noise_mm"])
        for name in ("proximal", "distal")
    }

    def relative(R: Float, p: Float) -> Float:
        lever = adjoint(R.T, -R.T @ p)
        return np.asarray(S["distal"] + lever @ S["proximal"] @ lever.T)

    rows = np.flatnonzero(told.screw["valid"] == 1)
    R, p = relative_poses(told)
    found = np.full((len(told.screw), 3), np.nan)
    theta = told.screw["theta_deg"].to_numpy(float)[rows]
    D, d = J0.T @ R, (p - j0) @ J0
    covariance = np.stack(
        [
            adjoint(D[k], d[k]) @ relative(R[k], p[k]) @ adjoint(D[k], d[k]).T + relative(J0, j0) / reference_frames
            for k in range(len(rows))
        ]
    )
    steps = np.diag([1e-5] * 3 + [1e-4] * 3)
    slopes = np.zeros((len(rows), 5, 6))
    for k, step in enumerate(steps):
        ends = []
        for sign in (1.0, -1.0):
            turn = Rotation.from_rotvec(sign * step[:3]).as_matrix()
            quat = Rotation.from_matrix(turn @ D).as_quat()[:, [3, 0, 1, 2]]
            moved = Poses(pd.DataFrame(np.column_stack([quat, d @ turn.T + sign * step[3:]]), columns=POSE))
            angle = np.where(theta < 0.0, -1.0, 1.0) * moved.angle
            axis, _, slide = moved.screws(angle)
            ends.append(np.column_stack([angle, slide, axis]))
        slopes[:, :, k] = (ends[0] - ends[1]) / (2.0 * step.max())
    spread = slopes @ covariance @ np.swapaxes(slopes, 1, 2)
    found[rows, 0], found[rows, 1] = np.sqrt(spread[:, 0, 0]), np.sqrt(spread[:, 1, 1])
    found[rows, 2] = np.degrees(np.sqrt(np.trace(spread[:, 2:, 2:], axis1=1, axis2=2)))
    return pd.DataFrame(found, columns=["theta_sd_deg", "slide_sd_mm", "axis_sd_deg"])


def curves_of(told: Told) -> Float:
    """Angle of each cycle (rows) over its own time (columns), degrees."""
    cycles = told.table("cycles")
    return np.asarray(cycles["theta_deg"].to_numpy(float).reshape(cycles["cycle"].nunique(), -1))


def _repeatability(told: Told) -> dict[str, Any]:
    table = told.repetitions
    found: dict[str, Any] = dict.fromkeys(("icc", "cmc", "axis_sd_deg", "point_sd_mm", "theta_max_sd_deg"))
    found["repetitions"] = len(table)
    if len(table) < 2:
        return found
    curves = curves_of(told)
    whole = curves[:, np.isfinite(curves).all(axis=0)]
    # Two-way analysis of variance: rows are points of time, columns repetitions (McGraw and Wong 1996, case A,1).
    x = whole.T
    n, k = x.shape
    rows = k * np.var(x.mean(axis=1), ddof=1)
    columns = n * np.var(x.mean(axis=0), ddof=1)
    rest = x - x.mean(axis=1, keepdims=True) - x.mean(axis=0) + x.mean()
    rest = np.sum(rest**2) / ((n - 1) * (k - 1))
    found["icc"] = (rows - rest) / (rows + (k - 1) * rest + k * (columns - rest) / n)
    within = np.sum(np.var(whole, axis=0, ddof=1)) / n
    found["cmc"] = np.sqrt(1.0 - within / np.var(whole, ddof=1))
    axis, point = vectors(table, "axis"), vectors(table, "point", "_mm")
    known = np.isfinite(axis).all(axis=1)
    axis, point = axis[known], point[known]
    middle = axis.mean(axis=0) / np.linalg.norm(axis.mean(axis=0))
    off = angle_between(axis, np.broadcast_to(middle, axis.shape))
    place = pierced(axis, point, middle, change_of(told)[1])
    found["axis_sd_deg"] = np.sqrt(np.sum(off**2) / (len(off) - 1))
    found["point_sd_mm"] = np.sqrt(np.sum(np.var(place, axis=0, ddof=1)))
    found["theta_max_sd_deg"] = table["theta_max_deg"].std()
    return found


def times(a: Float, b: Float) -> Float:
    """Hamilton's product of quaternions, scalar first."""
    return np.array([a[0] * b[0] - a[1:] @ b[1:], *(a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:]))])


def mean_pose(R: Float, p: Float) -> tuple[Float, Float]:
    """Mean of poses as dual quaternions, made one of unit length again."""
    quat = Rotation.from_matrix(R).as_quat()[:, [3, 0, 1, 2]]
    quat = np.sign(quat @ quat[0])[:, None] * quat
    real = quat.mean(axis=0)
    dual = np.mean([times(np.array([0.0, *place]), q) for place, q in zip(p, quat, strict=True)], axis=0)
    back = times(dual, real * [1.0, -1.0, -1.0, -1.0]) / (real @ real)
    return Rotation.from_quat(real[[1, 2, 3, 0]]).as_matrix(), back[1:]


def _bodies(told: Told) -> dict[str, Any]:
    proximal, distal = two_bodies(told)
    first = int(np.flatnonzero(told.recording.frame == told.summary["trial"]["reference_frame"])[0])
    measured = np.flatnonzero(told.screw["valid"] == 1)
    rows = measured[measured >= first][: int(told.option("--reference-window") or 1)]
    count = len(told.screw)
    here = (np.tile(np.eye(3), (count, 1, 1)), np.zeros((count, 3))) if proximal is None else (proximal.R, proximal.p)
    back = np.swapaxes(here[0], 1, 2)
    A, a = mean_pose(here[0][rows], here[1][rows])
    between = (back @ distal.R)[rows], np.einsum("nij,nj->ni", back, distal.p - here[1])[rows]
    J, j = mean_pose(*between)

    def written(name: str, R: Float, p: Float) -> dict[str, Any]:
        x, y, z, w = Rotation.from_matrix(R).as_quat()
        quat = np.array([w, x, y, z])
        stated = told.joint["bodies"][name]["quaternion"]  # of either sign
        return {"quaternion": np.sign(quat @ stated) * quat, "position_mm": p}

    return {
        "distal_in_proximal": written("distal_in_proximal", J, j),
        "proximal_in_lab": written("proximal_in_lab", A, a),
        "proximal_markers_mm": None if proximal is None or not proximal.solved.shape[1] else proximal.offsets.tolist(),
        "distal_markers_mm": distal.offsets.tolist() if distal.solved.shape[1] else None,
    }


ON_PROXIMAL = ("EL", "EM", "GH", "FLE", "FME", "HC")
ANGLES = {
    "flexion": "flexion", "carrying_angle": "carrying", "pronation": "pronation", "adduction": "adduction",
    "internal_rotation": "internal_rotation",
}  # fmt: skip


def _anatomy(told: Told) -> dict[str, Any]:
    """Epicondyles and the joint's axis: the angle between the lines, and how far it passes from the middle."""
    joint, marks = told.joint, told.summary["landmarks"]
    R, t = pose_of(joint["bodies"]["proximal_in_lab"])
    places = {}
    for name in set(marks) - {"side"}:
        place, own = np.array(marks[name]["mm"]), "proximal" if name in ON_PROXIMAL else "distal"
        assert marks[name]["body"] in ("lab", own)
        places[name] = R.T @ (place - t) if marks[name]["body"] == "lab" else place
    lateral, medial = (places[name] for name in (("EL", "EM") if "EL" in places else ("FLE", "FME")))
    line = (lateral - medial) / np.linalg.norm(lateral - medial)
    middle = 0.5 * (lateral + medial)
    fit = joint["mean_axis"] or joint[joint["preferred"]]
    n, p = np.array(fit["direction_in_proximal"]), np.array(fit["point_in_proximal_mm"])
    off = float(angle_between(n, line))
    J, j = pose_of(joint["bodies"]["distal_in_proximal"])
    return {
        "joint": "elbow" if "EL" in places else "knee",
        "side": marks["side"],
        "axis": "joint_axis",
        "axis_angle_deg": min(off, 180.0 - off),
        "axis_distance_mm": float(np.linalg.norm(np.cross(middle - p, n))),
        "landmark_sensitivity_deg_per_mm": float(np.degrees(1.0 / np.linalg.norm(lateral - medial))),
        "joint_center_in_proximal_mm": middle,
        "joint_center_in_distal_mm": J.T @ (middle - j),
        "epicondyle_direction_in_proximal": line,
        "landmarks_mm": places,
    }


def _angles_of_bones(told: Told) -> dict[str, Any] | None:
    """Ranges of the anatomical angles over the measured frames; the axis against the bones is that of joint.json."""
    found = told.joint["anatomy"]
    if found is None:
        return None
    table = told.table("anatomy")[told.screw["valid"] == 1]
    ranges: dict[str, Any] = {}
    for name, column in ANGLES.items():
        if f"{column}_deg" not in table:
            ranges[name] = None
            continue
        angle = table[f"{column}_deg"].dropna()
        low, high = angle.min(), angle.max()
        ranges[name] = {"start_deg": angle.iloc[0], "min_deg": low, "max_deg": high, "range_deg": high - low}
    own = ("epicondyle_direction_in_proximal", "landmarks_mm")
    return {**{key: value for key, value in found.items() if key not in own}, **ranges}
