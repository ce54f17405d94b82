"""Synthetic trials of a joint whose joint line, angle and slide are known."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Final, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowscrew.errors import UsageError
from elbowscrew.geometry import dual_quat_from_screw, line_through, point_nearest_origin, pose_from_points, quaternion
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import (
    conjugate,
    dual_quat_from_pose,
    multiply,
    transform_lines,
    transform_points,
)
from elbowscrew.joints import JOINT_NAMES, JointName, joints_of
from elbowscrew.model import Recording, RigidBody, TrackingLoss
from elbowscrew.motion.interpolation.laws import cycloidal
from elbowscrew.motion.screws.relative import IDENTITY

# An adult's arm: the line through the elbow in the arm's frame, tilted as the trochlea is; the segments' markers.
_JOINT_POINT: Final = np.array([0.004, -0.132, 0.011])
_JOINT_DIRECTION: Final = np.array([0.986, 0.104, -0.131])
_DRIFT_ACROSS: Final = np.array([0.0, 1.0, 0.0])
_FOREARM_CENTER: Final = np.array([0.018, -0.251, 0.037])
_FOREARM_TURN: Final = np.array([0.09, 0.21, -0.06])
_ARM_PLACE: Final = np.array([0.31, 1.24, -0.18])
_SIZES: Final = {
    "elbow": 1.0, "wrist": 0.8, "knee": 1.6, "ankle": 1.5, "hip": 1.5, "shoulder": 1.1, "finger": 0.3,
}  # fmt: skip
"""Lengths of the segments beside an arm's; the clusters of markers of smaller ones are smaller, too."""
_ACROSS_MIRRORED: Final = np.array([-1.0, 1.0, 1.0])
"""A left joint is the mirror image of a right one in the plane across x, which the joint's line lies near."""
_MOST_FRAMES: Final = 10_000_000
_ARM_TURN: Final = np.array([0.12, 0.55, -0.2])
_ARM_MARKERS: Final = np.array([[38, 12, 31], [-41, 27, 8], [9, -44, -28], [-6, 5, -47]]) * 1e-3
_FOREARM_MARKERS: Final = np.array([[35, 33, -9], [-37, 14, 25], [-11, -45, 19], [28, -21, -38]]) * 1e-3


@dataclass(frozen=True, slots=True, kw_only=True)
class Simulation:
    """What to simulate.

    Attributes
    ----------
    joint : {"elbow", "wrist", "knee", "ankle", "hip", "shoulder", "finger"}
        Names the bodies, and sets how long the segments are.
    side : {"left", "right"} or None
        Goes into the bodies' names; a left joint's geometry is the mirror image of a right one's.
    frames : int
        Frames of one repetition, from the start to the end of its movement.
    rate_hz : float
        Frames per second.
    top_deg : float
        Largest angle of the joint.
    inversion : int
        Frame of the repetition at which the angle is largest.
    slide_mm : float
        Translation along the axis at the top; it grows with the angle.
    law : {"minimum-jerk", "cycloidal"}
        Law of motion out and back.
    marker_noise_mm : float
        Standard deviation of each coordinate of each marker; the poses are fitted to the noisy markers.
    gaps, gap_frames : int
        How many times the distal body is lost, and for how many frames each time.
    sign_flips : bool
        Flip the sign of the quaternions at random, as exports do.
    proximal : {"moving", "still"}
        Whether the proximal body sways in the laboratory.
    repetitions : int
        How many times the movement is done.
    rest_before_s, hold_s, rest_after_s : float
        Rest before the movement, at every top, and after the movement, seconds.
    axis_drift_deg : float
        Tilt of the joint's line at the top against that at the start; it grows with the angle.
    tremor_deg, tremor_hz : float
        Amplitude and frequency of a tremor of the angle, which fades towards rest and top.
    seed : int
        Of all random numbers; the same seed gives the same trial.
    """

    joint: JointName = "elbow"
    side: Literal["left", "right"] | None = None
    frames: int = 450
    rate_hz: float = 100.0
    top_deg: float = 130.0
    inversion: int = 211
    slide_mm: float = 3.0
    law: Literal["minimum-jerk", "cycloidal"] = "minimum-jerk"
    marker_noise_mm: float = 0.2
    gaps: int = 0
    gap_frames: int = 5
    sign_flips: bool = False
    proximal: Literal["moving", "still"] = "still"
    repetitions: int = 1
    rest_before_s: float = 0.0
    hold_s: float = 0.0
    rest_after_s: float = 0.0
    axis_drift_deg: float = 0.0
    tremor_deg: float = 0.0
    tremor_hz: float = 6.0
    seed: int = 0

    def __post_init__(self) -> None:
        """Check what the types cannot.

        Raises
        ------
        UsageError
            Naming the option.
        """
        checks = {
            "joint": self.joint in JOINT_NAMES,
            "side": self.side in (None, "left", "right"),
            "frames": self.frames >= 3 and self.total_frames <= _MOST_FRAMES,
            "inversion": 0 < self.inversion < self.frames - 1,
            "rate": 1e-3 <= self.rate_hz <= 1e6,
            "top": 0.0 < self.top_deg < 360.0,
            "slide": abs(self.slide_mm) <= 1e5,
            "marker-noise": 0.0 <= self.marker_noise_mm <= 1e5,
            "gaps": self.gaps >= 0 and self.gaps * (self.gap_frames + 2) <= self.total_frames - 2,
            "gap-frames": self.gap_frames >= 1,
            "repetitions": self.repetitions >= 1,
            "rest-before": 0.0 <= self.rest_before_s * self.rate_hz < _MOST_FRAMES,
            "hold": 0.0 <= self.hold_s * self.rate_hz < _MOST_FRAMES,
            "rest-after": 0.0 <= self.rest_after_s * self.rate_hz < _MOST_FRAMES,
            "axis-drift": abs(self.axis_drift_deg) <= 90.0,
            "tremor": 0.0 <= self.tremor_deg <= 90.0,
            "tremor-hz": self.tremor_deg == 0.0 or 0.0 < self.tremor_hz <= 0.5 * self.rate_hz,
            "seed": self.seed >= 0,
        }
        bad = [name for name, good in checks.items() if not good]
        if bad:
            names = ", ".join(f"--{name}" for name in bad)
            msg = (
                f"simulate: impossible value of {names}: the inversion must lie inside the frames, the top between 0 "
                f"and 360 deg, the gaps must fit into the trial, frames are {_MOST_FRAMES} at most, and nothing may be "
                "negative"
            )
            raise UsageError(msg)

    @property
    def total_frames(self) -> int:
        """Frames of the whole trial, rests included."""
        before, hold, after = (
            round(rest * self.rate_hz) if 0.0 <= rest * self.rate_hz < _MOST_FRAMES else 0
            for rest in (self.rest_before_s, self.hold_s, self.rest_after_s)
        )
        return self.repetitions * (self.frames - 1 + hold) + 1 + before + after


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulatedTrial:
    """A synthetic recording, its markers as seen, and the truth about it.

    Attributes
    ----------
    recording : Recording
        The poses, fitted to the markers as seen.
    markers : mapping of str to ndarray, shape (N, M, 3)
        The markers of each body, by the body's name, in the laboratory, meters; NaN where not seen.
    truth : dict
        Joint line, angles and slides, ready for JSON; units in the names.
    """

    recording: Recording
    markers: Mapping[str, Float]
    truth: dict[str, Any]


def simulate_trial(simulation: Simulation | None = None, **settings: Any) -> SimulatedTrial:
    """Simulate a joint that turns about and slides along one line.

    Parameters
    ----------
    simulation : Simulation, optional
        An elbow's plain flexion and extension by default.
    **settings
        Fields of `Simulation` to change.

    Returns
    -------
    SimulatedTrial
        With bodies named as the joint's segments, such as Upper Arm and Forearm.

    Raises
    ------
    UsageError
        If a value is not a possible one.

    Examples
    --------
    >>> trial = simulate_trial(top_deg=142, seed=3)
    >>> [body.name for body in trial.recording.bodies], trial.recording.frame.size
    (['Upper Arm', 'Forearm'], 450)
    """
    if "arm" in settings:  # what an elbow's proximal body was called before
        settings["proximal"] = settings.pop("arm")
    wanted = replace(simulation or Simulation(), **settings)
    rng = np.random.default_rng(wanted.seed)
    progress, inversions = _progress(wanted)
    time_s = np.arange(progress.size) / wanted.rate_hz
    angle, slide = np.radians(wanted.top_deg) * progress, 1e-3 * wanted.slide_mm * progress
    fading = 4.0 * progress * (1.0 - progress)
    angle = angle + np.radians(wanted.tremor_deg) * fading * np.sin(2.0 * np.pi * wanted.tremor_hz * time_s)
    geometry = _geometry(wanted)
    line = line_through(geometry.point, geometry.direction)
    lines = _drifting(line, geometry, np.radians(wanted.axis_drift_deg) * progress)
    start = dual_quat_from_pose(quaternion.quat_from_rotation_vector(geometry.distal_turn), geometry.distal_center)
    proximal_pose = _proximal_poses(time_s, wanted)
    joint = multiply(dual_quat_from_screw(angle, slide, lines[:, :3], lines[:, 3:]), start)
    distal_pose = multiply(proximal_pose, joint)
    lost = _lost_frames(wanted, progress.size, rng)
    named, side = joints_of(wanted.joint)[0], "" if wanted.side is None else f"{wanted.side.title()} "
    names = [f"{side}{segment.name.title()}" for segment in (named.proximal, named.distal)]
    bodies, markers = [], {}
    for name, identifier, offsets, pose, gone in (
        (names[0], "5C0E1B7A90D311EDA1EB0242AC120002", geometry.proximal_markers, proximal_pose, None),
        (names[1], "5C0E1DB490D311EDA1EB0242AC120003", geometry.distal_markers, distal_pose, lost),
    ):
        body, seen = _observed(name, identifier, offsets - offsets.mean(axis=0), pose, gone, wanted, rng)
        bodies.append(body)
        markers[name] = seen
    recording = Recording.from_bodies(bodies, rate_hz=wanted.rate_hz)
    truth = {
        "settings": {name: getattr(wanted, name) for name in Simulation.__dataclass_fields__},
        "axis": {
            frame: _line_truth(transform_lines(change, line))
            for frame, change in (("distal", conjugate(start)), ("proximal", IDENTITY), ("lab", proximal_pose[0]))
        },
        "inversion_frames": inversions,
        "lost_frames": np.flatnonzero(lost).tolist(),
        "theta_deg": np.degrees(angle).tolist(),
        "slide_mm": (1000.0 * slide).tolist(),
    }
    return SimulatedTrial(recording=recording, markers=markers, truth=truth)


def _progress(wanted: Simulation) -> tuple[Float, list[int]]:
    """Return the share of the full motion in every frame, 0 to 1 and back, and the frames of its tops."""
    law = cycloidal if wanted.law == "cycloidal" else _minimum_jerk
    frame = np.arange(wanted.frames)
    flexion = law(frame[: wanted.inversion] / wanted.inversion)
    extension = law((wanted.frames - 1 - frame[wanted.inversion :]) / (wanted.frames - 1 - wanted.inversion))
    repetition = np.concatenate([flexion, extension])
    before, after = (np.zeros(round(rest * wanted.rate_hz)) for rest in (wanted.rest_before_s, wanted.rest_after_s))
    # The end of one repetition is the start of the next.
    hold = round(wanted.hold_s * wanted.rate_hz)
    repetition = np.insert(repetition, wanted.inversion, np.full(hold, repetition[wanted.inversion]))
    movement = np.concatenate([repetition, *([repetition[1:]] * (wanted.repetitions - 1))])
    first = before.size + wanted.inversion + hold // 2
    tops = [first + k * (wanted.frames - 1 + hold) for k in range(wanted.repetitions)]
    return np.concatenate([before, movement, after]), tops


class _Geometry(NamedTuple):
    """The joint's line in the proximal body, the distal body's pose there at angle 0, and the clusters; meters."""

    point: Float
    direction: Float
    across: Float
    distal_center: Float
    distal_turn: Float
    proximal_markers: Float
    distal_markers: Float


def _geometry(wanted: Simulation) -> _Geometry:
    size = _SIZES[wanted.joint]
    cluster = min(size, 1.0)
    mirror, axial = _mirrors(wanted)
    return _Geometry(
        point=size * mirror * _JOINT_POINT,
        direction=axial * _JOINT_DIRECTION,
        across=axial * _DRIFT_ACROSS,
        distal_center=size * mirror * _FOREARM_CENTER,
        distal_turn=axial * _FOREARM_TURN,
        proximal_markers=cluster * mirror * _ARM_MARKERS,
        distal_markers=cluster * mirror * _FOREARM_MARKERS,
    )


def _mirrors(wanted: Simulation) -> tuple[Float, Float]:
    """Factors (3,) of points and of axes of rotation: these are axial vectors and turn round in a mirror as well."""
    if wanted.side == "left":
        return _ACROSS_MIRRORED, -_ACROSS_MIRRORED
    return np.ones(3), np.ones(3)


def _drifting(line: Float, geometry: _Geometry, tilt: Float) -> Float:
    """Lines (N, 6) through a line's point, tilted by angles (N,) in a plane through it."""
    direction, across = line[:3], geometry.across - (geometry.across @ line[:3]) * line[:3]
    across = across / np.sqrt(across @ across)
    tilted = np.cos(tilt)[:, None] * direction + np.sin(tilt)[:, None] * across
    return np.concatenate([tilted, np.cross(geometry.point, tilted)], axis=1)


def _minimum_jerk(tau: Float) -> Float:
    return tau**3 * (10.0 - 15.0 * tau + 6.0 * tau**2)


def _proximal_poses(time_s: Float, wanted: Simulation) -> Float:
    sway = np.zeros((time_s.size, 3))
    shift = np.zeros((time_s.size, 3))
    if wanted.proximal == "moving":
        phase = 2.0 * np.pi * time_s[:, None] * np.array([0.31, 0.23, 0.17])
        sway = np.array([0.10, 0.16, 0.07]) * np.sin(phase)
        shift = np.array([0.03, 0.02, 0.04]) * np.sin(1.3 * phase)
    mirror, axial = _mirrors(wanted)
    turn = quaternion.multiply(
        quaternion.quat_from_rotation_vector(axial * sway), quaternion.quat_from_rotation_vector(axial * _ARM_TURN)
    )
    return dual_quat_from_pose(turn, mirror * (_ARM_PLACE + shift))


def _lost_frames(wanted: Simulation, frames: int, rng: np.random.Generator) -> NDArray[np.bool_]:
    lost = np.zeros(frames, dtype=np.bool_)
    if wanted.gaps:
        # One gap somewhere in each of equal stretches, never at the trial's first or last frame.
        stretches = np.array_split(np.arange(1, frames - 1), wanted.gaps)
        for stretch in stretches:
            first = int(rng.integers(stretch[0], stretch[-1] - wanted.gap_frames + 1))
            lost[first : first + wanted.gap_frames] = True
    return lost


def _observed(
    name: str,
    identifier: str,
    offsets: Float,
    pose: Float,
    lost: NDArray[np.bool_] | None,
    wanted: Simulation,
    rng: np.random.Generator,
) -> tuple[RigidBody, Float]:
    seen = transform_points(pose[:, None, :], offsets)
    if wanted.marker_noise_mm > 0.0:
        seen = seen + rng.normal(scale=1e-3 * wanted.marker_noise_mm, size=seen.shape)
        pose = pose_from_points(offsets, seen)
    if wanted.sign_flips:
        pose = pose * np.where(rng.random(len(pose)) < 0.5, -1.0, 1.0)[:, None]
    loss = np.zeros(len(pose), dtype=np.uint8)
    if lost is not None:
        loss[lost] = TrackingLoss.BLANK
        pose = np.where(lost[:, None], np.nan, pose)
        seen = np.where(lost[:, None, None], np.nan, seen)
    body = RigidBody(name=name, identifier=identifier, dual_quat_lab_body=pose, loss=loss, marker_offsets=offsets)
    return body, seen


def _line_truth(line: Float) -> dict[str, list[float]]:
    return {"direction": line[:3].tolist(), "point_mm": (1000.0 * point_nearest_origin(line)).tolist()}
