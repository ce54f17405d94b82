"""Synthetic trials of a joint whose type, axes or center, and angles are known."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Final, Literal, NamedTuple

import numpy as np

from elbowscrew.choices import JOINT_NAMES, JointName, SimulatedJointType, SimulatedLaw
from elbowscrew.errors import UsageError
from elbowscrew.geometry import pose_from_points, quaternion
from elbowscrew.geometry.arrays import Bool, Float
from elbowscrew.geometry.dual_quaternion import dual_quat_from_pose, multiply, transform_points
from elbowscrew.joints import joints_of
from elbowscrew.model import Landmarks, MarkerMotion, Recording, RigidBody, TrackingLoss
from elbowscrew.model.anatomy import LANDMARKS_OF
from elbowscrew.motion.interpolation.laws import LAWS
from elbowscrew.simulated_joint import (
    Geometry,
    JointCourse,
    ball,
    landmarks_of,
    mirrors,
    odd_course,
    one_axis,
    two_axes,
)

_ARM_POSITION: Final = np.array([0.31, 1.24, -0.18])
_ARM_TURN: Final = np.array([0.12, 0.55, -0.2])
_MOST_FRAMES: Final = 10_000_000
_SLIDE_MM: Final = 3.0
_PRONATION_DEG: Final = 60.0
_SKIN_COURSES: Final[dict[str, Callable[[Float], Float]]] = {
    "u": lambda u: u,
    "sin(pi u/2)": lambda u: np.sin(0.5 * np.pi * u),
    "u^2": lambda u: u**2,
    "sin(pi u)": lambda u: np.sin(np.pi * u),
}
"""How markers may move with flexion, u being the share of the largest angle."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Simulation:
    """What to simulate.

    Attributes
    ----------
    joint : {"elbow", "wrist", "knee", "ankle", "hip", "shoulder", "finger"}
        Names the bodies, and sets how long the segments are.
    side : {"left", "right"} or None
        Goes into the bodies' names; a left joint's motion is the mirror image of a right one's.
    frames : int
        Frames of one repetition, from the start to the end of its movement.
    rate_hz : float
        Frames per second.
    top_deg : float
        Largest angle of the joint.
    inversion : int
        Frame of the repetition at which the angle is largest.
    joint_type : {"hinge", "screw-hinge", "two-axes", "ball"}
        How the segments move against each other. A ball turns about its other directions by half and a third of the
        top as well.
    slide_mm : float, optional
        Translation along a screw-hinge's axis at the top; it grows with the angle. 3 mm by default.
    pronation_deg : float, optional
        Range of the rotation about the second of two axes, from one side to the other and back while the first angle
        rises and falls. 60 deg by default.
    law : {"minimum-jerk", ...}
        Law of motion out and back; minimum jerk, or one of the model's laws.
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
    skin_mm : float
        How far each marker moves on its bone with flexion, each in its own direction and by its own course, drawn from
        the seed.
    wander_deg : float
        Tilt of the joint's (first) line at the top against that at the start; it grows with the angle.
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
    joint_type: SimulatedJointType = "screw-hinge"
    slide_mm: float | None = None
    pronation_deg: float | None = None
    law: SimulatedLaw = "minimum-jerk"
    marker_noise_mm: float = 0.2
    gaps: int = 0
    gap_frames: int = 5
    sign_flips: bool = False
    proximal: Literal["moving", "still"] = "still"
    repetitions: int = 1
    rest_before_s: float = 0.0
    hold_s: float = 0.0
    rest_after_s: float = 0.0
    skin_mm: float = 0.0
    wander_deg: float = 0.0
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
            "slide": abs(self.slide_mm or 0.0) <= 1e5,
            "pronation": self.pronation_deg is None or 0.0 < self.pronation_deg <= 180.0,
            "marker-noise": 0.0 <= self.marker_noise_mm <= 1e5,
            "gaps": self.gaps >= 0 and self.gaps * (self.gap_frames + 2) <= self.total_frames - 2,
            "gap-frames": self.gap_frames >= 1,
            "repetitions": self.repetitions >= 1,
            "rest-before": 0.0 <= self.rest_before_s * self.rate_hz < _MOST_FRAMES,
            "hold": 0.0 <= self.hold_s * self.rate_hz < _MOST_FRAMES,
            "rest-after": 0.0 <= self.rest_after_s * self.rate_hz < _MOST_FRAMES,
            "skin": 0.0 <= self.skin_mm <= 1e3,
            "wander": abs(self.wander_deg) <= 90.0,
            "tremor": 0.0 <= self.tremor_deg <= 90.0,
            "tremor-hz": self.tremor_deg == 0.0 or 0.0 < self.tremor_hz <= 0.5 * self.rate_hz,
            "seed": self.seed >= 0,
        }
        bad = [name for name, good in checks.items() if not good]
        if bad:
            names = ", ".join(f"--{name}" for name in bad)
            msg = (
                f"simulate: impossible value of {names}: the inversion must lie inside the frames, the top between 0 "
                f"and 360 deg, pronation up to 180 deg, the gaps must fit into the trial, frames are {_MOST_FRAMES} at "
                "most, and nothing may be negative"
            )
            raise UsageError(msg)
        for option, given, owners in (
            ("slide", self.slide_mm, ("screw-hinge",)),
            ("pronation", self.pronation_deg, ("two-axes",)),
            ("wander", self.wander_deg, ("hinge", "screw-hinge", "two-axes")),
        ):
            if given and self.joint_type not in owners:
                msg = f"simulate: --{option} is of {' and '.join(owners)}, and --joint-type is {self.joint_type}"
                raise UsageError(msg)

    @property
    def slide(self) -> float:
        """Slide at the top, m."""
        if self.joint_type != "screw-hinge":
            return 0.0
        return 1e-3 * (_SLIDE_MM if self.slide_mm is None else self.slide_mm)

    @property
    def total_frames(self) -> int:
        """Frames of the whole trial, rests included."""
        before, hold, after = (
            round(rest * self.rate_hz) if 0.0 <= rest * self.rate_hz < _MOST_FRAMES else 0
            for rest in (self.rest_before_s, self.hold_s, self.rest_after_s)
        )
        return self.repetitions * (self.frames - 1 + hold) + 1 + before + after


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class SimulatedTrial:
    """A synthetic recording, its markers as seen, and the truth about it.

    Attributes
    ----------
    recording : Recording
        The poses, fitted to the markers as seen, and how these move among themselves: as a saved trial is read.
    markers : mapping of str to ndarray, shape (N, M, 3)
        The markers of each body, by the body's name, in the laboratory, meters; NaN where not seen.
    truth : dict
        The joint's type, axes or center, and angles, ready for JSON; units in the names (`docs/reference/simulate.md`).
    landmarks : Landmarks or None
        Of an elbow or a knee: where its bones are.
    """

    recording: Recording
    markers: Mapping[str, Float]
    truth: dict[str, Any]
    landmarks: Landmarks | None = None

    def __repr__(self) -> str:
        markers = ", ".join(f"{one.shape[1]} of {name!r}" for name, one in self.markers.items())
        return f"SimulatedTrial({self.recording!r}; markers {markers}; truth {', '.join(self.truth)})"


def simulate_trial(simulation: Simulation | None = None, **settings: Any) -> SimulatedTrial:
    """Simulate a joint of a known type; see `elbowscrew.simulate_trial`.

    Raises
    ------
    UsageError
        If a value is not a possible one.
    """
    for former, name in (("arm", "proximal"), ("axis_drift_deg", "wander_deg")):  # what they were called before
        if former in settings:
            settings[name] = settings.pop(former)
    wanted = replace(simulation or Simulation(), **settings)
    rng = np.random.default_rng(wanted.seed)
    progress, returns, inversions = _progress(wanted)
    time_s = np.arange(progress.size) / wanted.rate_hz
    fading = 4.0 * progress * (1.0 - progress)
    angle = np.radians(wanted.top_deg) * progress
    angle = angle + np.radians(wanted.tremor_deg) * fading * np.sin(2.0 * np.pi * wanted.tremor_hz * time_s)
    geometry = Geometry.of(wanted.joint, wanted.side)
    proximal_pose = _proximal_poses(time_s, wanted)
    course = _course(wanted, geometry, angle, progress, returns, proximal_pose[0])
    distal_pose = multiply(proximal_pose, course.pose)
    lost = _lost_frames(wanted, progress.size, rng)
    named, side = joints_of(wanted.joint)[0], "" if wanted.side is None else f"{wanted.side.title()} "
    names = [f"{side}{segment.name.title()}" for segment in (named.proximal, named.distal)]
    skin = _skin(wanted, progress, geometry)
    bodies, markers = [], {}
    for name, identifier, offsets, moved, pose, gone in (
        (names[0], "5C0E1B7A90D311EDA1EB0242AC120002", geometry.proximal_markers, skin[0], proximal_pose, None),
        (names[1], "5C0E1DB490D311EDA1EB0242AC120003", geometry.distal_markers, skin[1], distal_pose, lost),
    ):
        body, seen = _observed(name, identifier, offsets - offsets.mean(axis=0), moved, pose, gone, wanted, rng)
        bodies.append(body)
        markers[name] = seen
    recording = Recording.from_bodies(bodies, rate_hz=wanted.rate_hz)
    truth = {
        "settings": {name: getattr(wanted, name) for name in Simulation.__dataclass_fields__},
        **course.truth,
        "inversion_frames": inversions,
        "lost_frames": np.flatnonzero(lost).tolist(),
        "theta_deg": np.degrees(course.theta).tolist(),
    }
    if np.isfinite(course.slide).all():
        truth["slide_mm"] = (1000.0 * course.slide).tolist()
    if wanted.skin_mm > 0.0:
        truth["skin"] = {name: moved.truth for name, moved in zip(names, skin, strict=True)}
    landmarks = next((landmarks_of(one, wanted.side or "right") for one in LANDMARKS_OF if one == wanted.joint), None)
    return SimulatedTrial(recording=recording, markers=markers, truth=truth, landmarks=landmarks)


def _course(
    wanted: Simulation, geometry: Geometry, angle: Float, progress: Float, returns: Bool, lab: Float
) -> JointCourse:
    tilt = np.radians(wanted.wander_deg) * progress
    if wanted.joint_type == "two-axes":
        pronation = np.radians(_PRONATION_DEG if wanted.pronation_deg is None else wanted.pronation_deg)
        return two_axes(geometry, angle, pronation * odd_course(progress, returns), tilt, lab)
    if wanted.joint_type == "ball":
        return ball(geometry, angle, progress, returns)
    # In a mirror a right-handed screw is a left-handed one.
    slide = -wanted.slide if wanted.side == "left" else wanted.slide
    return one_axis(geometry, angle, slide * progress, tilt, lab)


def _progress(wanted: Simulation) -> tuple[Float, Bool, list[int]]:
    """Return the share of the full motion in every frame, 0 to 1 and back, where it returns, and its tops' frames."""
    law = LAWS["polynomial-345" if wanted.law == "minimum-jerk" else wanted.law]
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
    progress = np.concatenate([before, movement, after])
    within = (np.arange(progress.size) - before.size) % (wanted.frames - 1 + hold)
    return progress, within >= wanted.inversion, tops


class _Skin(NamedTuple):
    """How far markers are from their positions on the bone, (N, M, 3) or none, and by what."""

    shift: Float | None
    truth: list[dict[str, Any]]


def _skin(wanted: Simulation, progress: Float, geometry: Geometry) -> tuple[_Skin, _Skin]:
    """Give each marker a direction and a course of its own; a left joint's are those of the right one in a mirror."""
    if wanted.skin_mm <= 0.0:
        return _Skin(None, []), _Skin(None, [])
    rng = np.random.default_rng([wanted.seed, len(_SKIN_COURSES)])  # beside that of the noise, which stays the same
    found = []
    for markers in (geometry.proximal_markers, geometry.distal_markers):
        direction = rng.normal(size=markers.shape)
        direction = mirrors(wanted.side)[0] * direction / np.sqrt(np.sum(direction**2, axis=1))[:, None]
        names = rng.choice(list(_SKIN_COURSES), size=len(markers)).tolist()
        courses = np.stack([_SKIN_COURSES[name](progress) for name in names], axis=1)
        shift = 1e-3 * wanted.skin_mm * courses[:, :, None] * direction
        truth = [{"direction": h.tolist(), "course": name} for h, name in zip(direction, names, strict=True)]
        found.append(_Skin(shift, truth))
    return found[0], found[1]


def _proximal_poses(time_s: Float, wanted: Simulation) -> Float:
    sway = np.zeros((time_s.size, 3))
    shift = np.zeros((time_s.size, 3))
    if wanted.proximal == "moving":
        phase = 2.0 * np.pi * time_s[:, None] * np.array([0.31, 0.23, 0.17])
        sway = np.array([0.10, 0.16, 0.07]) * np.sin(phase)
        shift = np.array([0.03, 0.02, 0.04]) * np.sin(1.3 * phase)
    mirror, axial = mirrors(wanted.side)
    turn = quaternion.multiply(
        quaternion.quat_from_rotation_vector(axial * sway), quaternion.quat_from_rotation_vector(axial * _ARM_TURN)
    )
    return dual_quat_from_pose(turn, mirror * (_ARM_POSITION + shift))


def _lost_frames(wanted: Simulation, frames: int, rng: np.random.Generator) -> Bool:
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
    moved: _Skin,
    pose: Float,
    lost: Bool | None,
    wanted: Simulation,
    rng: np.random.Generator,
) -> tuple[RigidBody, Float]:
    seen = transform_points(pose[:, None, :], offsets if moved.shift is None else offsets + moved.shift)
    if wanted.marker_noise_mm > 0.0:
        seen = seen + rng.normal(scale=1e-3 * wanted.marker_noise_mm, size=seen.shape)
    erring = wanted.marker_noise_mm > 0.0 or moved.shift is not None
    if erring:
        pose = pose_from_points(offsets, seen)
    if wanted.sign_flips:
        pose = pose * np.where(rng.random(len(pose)) < 0.5, -1.0, 1.0)[:, None]
    loss = np.zeros(len(pose), dtype=np.uint8)
    if lost is not None:
        loss[lost] = TrackingLoss.BLANK
        pose = np.where(lost[:, None], np.nan, pose)
        seen = np.where(lost[:, None, None], np.nan, seen)
    body = RigidBody(name=name, identifier=identifier, dual_quat_lab_body=pose, loss=loss, marker_offsets=offsets)
    if erring:  # exact markers tell of no noise
        off = seen - transform_points(pose[:, None, :], offsets)
        residual = np.sqrt(np.mean(np.sum(off**2, axis=2), axis=1))
        motion = MarkerMotion.of_markers(pose, seen, offsets, own_shape=False)
        body = replace(body, marker_residual=residual, marker_motion=motion)
    return body, seen
