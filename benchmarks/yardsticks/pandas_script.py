"""The script one writes instead, with pandas, scipy and pyplot: ``pandas_script.py TRIAL.csv FOLDER``.

It makes the same tables, a summary and the same five figures of a Motive export with two rigid bodies and no gaps. It
has no page, checks nothing, fits no joint axis by maximum likelihood, and takes the errors from the file's own column.
Everything is vectorized over the frames, as someone who knows the libraries writes it.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from pyplot_figures import Drawn, draw_all
from scipy.signal import butter, filtfilt, find_peaks
from scipy.spatial.transform import RigidTransform, Rotation

from elbowscrew.geometry.arrays import Float

HEADER_LINES = 7
LEAST_ANGLE = np.radians(10.0)
RADIUS_M = 0.05
CUTOFF_HZ = 6.0
LEAST_RATE = 0.25


def main(trial: Path, folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    table = pd.read_csv(trial, header=None, skiprows=HEADER_LINES, usecols=range(18))
    frame, time_s = table[0].to_numpy(), table[1].to_numpy()
    values = table.to_numpy()
    arm = RigidTransform.from_components(values[:, 6:9], Rotation.from_quat(values[:, 2:6]))
    forearm = RigidTransform.from_components(values[:, 14:17], Rotation.from_quat(values[:, 10:14]))
    joint = arm.inv() * forearm
    change = joint[0].inv() * joint
    euler, translation = components(change)
    angle, slide, direction, point = screw_of(euler, translation)
    sd = np.hypot(values[:, 9], values[:, 17]) / RADIUS_M
    spread = sd / np.sin(0.5 * np.clip(np.abs(angle), LEAST_ANGLE, None))

    keyframes = turning_points(angle)
    model_euler, model_translation, fraction, phase = dlb(euler, translation, keyframes)
    model_angle, model_slide, model_direction, model_point = screw_of(model_euler, model_translation)
    cosine = np.abs(np.sum(euler * model_euler, axis=1)).clip(max=1.0)
    angle_error = 2.0 * np.arccos(cosine)
    translation_error = np.linalg.norm(translation - model_translation, axis=1)
    displacement = np.sqrt(translation_error**2 + (2.0 * RADIUS_M * np.sin(0.5 * angle_error)) ** 2)
    axis_error = np.arccos(np.abs(np.sum(direction * model_direction, axis=1)).clip(max=1.0))
    axis_distance = np.linalg.norm(point - model_point, axis=1)

    omega, slide_rate, twist_direction, twist_point = twists(joint, time_s)
    known = np.isfinite(direction[:, 0])
    weights = np.sin(0.5 * angle[known]) ** 2
    mean_direction = weights @ direction[known]
    mean_direction /= np.linalg.norm(mean_direction)
    mean_point = weights @ point[known] / weights.sum()

    screw = {
        "frame": frame,
        "time_s": time_s,
        "valid": 1,
        "theta_deg": np.degrees(angle),
        "slide_mm": 1000.0 * slide,
        **vector("axis", direction),
        **vector("point", 1000.0 * point, "_mm"),
        **{f"e{k}": euler[:, k] for k in range(4)},
        **vector("d", 1000.0 * translation, "_mm"),
        "filled": 0,
        "arm_loss": "",
        "forearm_loss": "",
        "theta_sd_deg": np.degrees(sd),
        "slide_sd_mm": 1000.0 * RADIUS_M * sd,
        "axis_sd_deg": np.degrees(spread),
        "point_sd_mm": 1000.0 * RADIUS_M * spread,
        "axis_cone95_deg": 2.45 * np.degrees(spread),
        "point_radius95_mm": 2450.0 * RADIUS_M * spread,
    }
    model = {
        "frame": frame,
        "time_s": time_s,
        "phase": phase,
        "t": fraction,
        "theta_deg": np.degrees(model_angle),
        "slide_mm": 1000.0 * model_slide,
        **{f"e{k}": model_euler[:, k] for k in range(4)},
        **vector("d", 1000.0 * model_translation, "_mm"),
        "angle_error_deg": np.degrees(angle_error),
        "translation_error_mm": 1000.0 * translation_error,
        "rms_displacement_mm": 1000.0 * displacement,
        "axis_error_deg": np.degrees(axis_error),
        "axis_distance_mm": 1000.0 * axis_distance,
    }
    instantaneous = {
        "frame": frame,
        "time_s": time_s,
        "angular_velocity_deg_s": np.degrees(omega),
        "slide_velocity_mm_s": 1000.0 * slide_rate,
        **vector("axis", twist_direction),
        **vector("point", 1000.0 * twist_point, "_mm"),
    }
    for name, columns in (("screw", screw), ("interpolation", model), ("instantaneous", instantaneous)):
        pd.DataFrame(columns).to_csv(folder / f"{name}.csv", index=False)
    summary = {
        "frames": len(frame),
        "theta_max_deg": float(np.degrees(angle.max())),
        "theta_min_deg": float(np.degrees(angle.min())),
        "mean_axis": {"direction": mean_direction.tolist(), "point_mm": (1000.0 * mean_point).tolist()},
        "keyframes": frame[keyframes].tolist(),
        "rms_angle_error_deg": float(np.degrees(np.sqrt(np.mean(angle_error**2)))),
        "rms_displacement_mm": float(1000.0 * np.sqrt(np.mean(displacement**2))),
    }
    (folder / "summary.json").write_text(json.dumps(summary, indent=2), encoding="utf-8")
    draw_all(
        Drawn(
            time_s=time_s,
            angle=np.degrees(angle),
            angle_sd=np.degrees(sd),
            model_angle=np.degrees(model_angle),
            euler=euler,
            model_euler=model_euler,
            angle_error=np.degrees(angle_error),
            displacement=1000.0 * displacement,
            direction=direction,
            point=1000.0 * point,
            path=1000.0 * translation,
            keyframes=keyframes,
            mean_direction=mean_direction,
            mean_point=1000.0 * mean_point,
        ),
        folder / "figures",
    )


def vector(name: str, values: Float, unit: str = "") -> dict[str, Float]:
    return {f"{name}_{part}{unit}": values[:, k] for k, part in enumerate("xyz")}


def components(change: RigidTransform) -> tuple[Float, Float]:
    """Euler parameters of one sign, scalar first, and translations."""
    euler = np.roll(change.rotation.as_quat(), 1, axis=1)
    flips = np.sum(euler[1:] * euler[:-1], axis=1) < 0.0
    euler[1:][np.cumsum(flips) % 2 == 1] *= -1.0
    return euler, change.translation


def screw_of(euler: Float, translation: Float) -> tuple[Float, Float, Float, Float]:
    """Angle, slide, direction and point of the screw of every frame; no axis below the least angle."""
    length = np.linalg.norm(euler[:, 1:], axis=1)
    angle = 2.0 * np.arctan2(length, euler[:, 0])
    with np.errstate(invalid="ignore", divide="ignore"):
        direction = euler[:, 1:] / length[:, None]
        slide = np.sum(direction * translation, axis=1)
        across = translation - slide[:, None] * direction
        point = 0.5 * (across + np.cross(direction, across) / np.tan(0.5 * angle)[:, None])
    small = angle < LEAST_ANGLE
    direction[small], point[small] = np.nan, np.nan
    return angle, slide, direction, point


def turning_points(angle: Float) -> NDArray[np.int64]:
    swing = 0.3 * np.ptp(angle)
    turns = [find_peaks(sign * angle, prominence=swing)[0] for sign in (1.0, -1.0)]
    return np.unique(np.concatenate([[0], *turns, [angle.size - 1]]))


def dlb(
    euler: Float, translation: Float, keyframes: NDArray[np.int64]
) -> tuple[Float, Float, Float, NDArray[np.int64]]:
    """Dual quaternion linear blending between the keyframes under a cycloidal law."""
    rows = np.arange(len(euler))
    phase = np.searchsorted(keyframes, rows, side="right").clip(1, keyframes.size - 1)
    first, last = keyframes[phase - 1], keyframes[phase]
    tau = (rows - first) / (last - first)
    t = (tau - np.sin(2.0 * np.pi * tau) / (2.0 * np.pi))[:, None]
    dual = np.concatenate([euler, 0.5 * product(np.pad(translation, ((0, 0), (1, 0))), euler)], axis=1)
    blend = (1.0 - t) * dual[first] + t * dual[last]
    blend /= np.linalg.norm(blend[:, :4], axis=1)[:, None]
    moved = 2.0 * product(blend[:, 4:], blend[:, :4] * [1.0, -1.0, -1.0, -1.0])
    return blend[:, :4], moved[:, 1:], t[:, 0], phase


def product(a: Float, b: Float) -> Float:
    scalar = a[:, 0] * b[:, 0] - np.sum(a[:, 1:] * b[:, 1:], axis=1)
    imaginary = a[:, :1] * b[:, 1:] + b[:, :1] * a[:, 1:] + np.cross(a[:, 1:], b[:, 1:])
    return np.column_stack([scalar, imaginary])


def twists(joint: RigidTransform, time_s: Float) -> tuple[Float, Float, Float, Float]:
    """Angular velocity, slide velocity, direction and point of the instantaneous axis of filtered poses."""
    euler, position = components(joint)
    rate = (len(time_s) - 1) / (time_s[-1] - time_s[0])
    b, a = butter(2, CUTOFF_HZ / (0.5 * rate))
    rotation = Rotation.from_quat(np.roll(filtfilt(b, a, euler, axis=0), -1, axis=1))
    position = filtfilt(b, a, position, axis=0)
    step = (rotation[:-2].inv() * rotation[2:]).as_rotvec()
    omega = np.full_like(position, np.nan)
    omega[1:-1] = rotation[1:-1].apply(step) / (time_s[2:] - time_s[:-2])[:, None]
    velocity = np.gradient(position, time_s, axis=0)
    speed = np.linalg.norm(omega, axis=1)
    direction = omega / speed[:, None]
    slide = np.sum(direction * velocity, axis=1)
    point = position + np.cross(omega, velocity) / (speed**2)[:, None]
    slow = ~(speed > LEAST_RATE)
    direction[slow], point[slow] = np.nan, np.nan
    return speed, slide, direction, point


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
