"""The methods paragraph says what was done to this trial, and nothing that was not: every sentence, each outcome."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from finished_results import ball, flexion_only
from scipy.spatial.transform import Rotation
from told_results import Told

from elbowscrew import Recording, RigidBody, Settings, analyze, read_recording, save_analysis, simulate_trial
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.report.methods import methods_of
from elbowscrew.results.trial_views import view_of_result


def simulated(**changes: Any) -> Callable[[], Recording]:
    return lambda: (
        simulate_trial(**{"frames": 150, "inversion": 60, "proximal": "moving", "seed": 1, **changes}).recording
    )


def errors_alone() -> Recording:
    """Bodies and the column of their markers' mean errors."""
    recording = from_file()
    gone: dict[str, Any] = dict.fromkeys(("marker_offsets", "marker_residual", "marker_motion", "shape_deviation"))
    return replace(recording, bodies=tuple(replace(body, **gone) for body in recording.bodies), markers=())


def without_markers(make: Callable[[], Recording]) -> Callable[[], Recording]:
    """Only poses: no markers, no residuals and no errors."""

    def made() -> Recording:
        recording = make()
        of_markers = ("marker_offsets", "marker_residual", "marker_motion", "reported_error", "shape_deviation")
        gone: dict[str, Any] = dict.fromkeys(of_markers)
        return replace(recording, bodies=tuple(replace(body, **gone) for body in recording.bodies), markers=())

    return made


def with_markers() -> Recording:
    path = Path(__file__).parent.parent.parent / "sample_data" / "elbow_left.csv"
    return read_recording(path, markers=("Left Upper Arm:*", "Left Forearm:*"))


def two_axes_moving() -> Recording:
    """Flexion with so much pronation beside it that a hinge leaves less than a quarter, and two axes are told."""
    time = np.linspace(0.0, 1.0, 300)
    flexion = Rotation.from_rotvec(np.outer(np.radians(60.0) * (1.0 - np.cos(4.0 * np.pi * time)), [1.0, 0.0, 0.0]))
    pronation = Rotation.from_rotvec(
        np.outer(np.radians(PRONATION) * (1.0 - np.cos(6.0 * np.pi * time)), [0.0, 1.0, 0.0])
    )
    turn = flexion * pronation
    place = turn.apply([0.02, -0.2, 0.0]) + np.array([0.3, 1.2, 0.1])
    body = RigidBody.from_quaternions("Forearm", turn.as_quat()[:, [3, 0, 1, 2]], place)
    return Recording.from_bodies([body], rate_hz=100.0)


def ball_joint() -> Recording:
    """Rotations about one point, no axis before another."""
    turn = np.linspace(0.0, 2.0 * np.pi, 150)
    R = Rotation.from_rotvec(np.stack([np.sin(turn), np.sin(2.0 * turn), 0.3 * np.cos(turn)], axis=1))
    place = np.array([0.03, 1.2, 0.08]) + R.apply([0.0, -0.25, 0.0])
    body = RigidBody.from_quaternions("Forearm", R.as_quat()[:, [3, 0, 1, 2]], place)
    return Recording.from_bodies([body], rate_hz=100.0)


def no_joint() -> Recording:
    """Rotations about a point that goes to and fro by 15 cm."""
    turn = np.linspace(0.0, 2.0 * np.pi, 150)
    R = Rotation.from_rotvec(np.stack([np.sin(turn), 0.4 * np.sin(2.0 * turn), 0.3 * np.cos(turn)], axis=1))
    center = 0.15 * np.stack([np.sin(2.0 * turn), np.cos(3.0 * turn), np.sin(turn + 1.0)], axis=1)
    body = RigidBody.from_quaternions("Forearm", R.as_quat()[:, [3, 0, 1, 2]], center + R.apply([0.0, -0.25, 0.0]))
    return Recording.from_bodies([body], rate_hz=100.0)


def astray() -> Recording:
    """A joint of two axes, a twelfth of whose poses are elsewhere."""
    exact = two_axes_moving().bodies[0].dual_quat_lab_body
    rng = np.random.default_rng(4)
    errors = rng.normal(size=(len(exact), 6)) * np.repeat([0.15, 0.04], 3)
    errors[rng.random(len(exact)) >= 0.08] = 0.0
    poses = dq.multiply(exact, dq.exp(0.5 * errors + rng.normal(0.0, 2e-4, errors.shape)))
    body = RigidBody(name="Forearm", dual_quat_lab_body=poses, loss=np.zeros(len(exact), dtype=np.uint8))
    return Recording.from_bodies([body], rate_hz=100.0)


def from_file() -> Recording:
    return read_recording(Path(__file__).parent.parent.parent / "sample_data" / "elbow_moving_arm_mm.csv")


PRONATION = 14.0
USUAL = simulated()
STILL = {"proximal": "none", "distal": "Forearm"}
CASES: dict[str, tuple[Callable[[], Recording], dict[str, Any]]] = {
    "default": (USUAL, {}),
    "hinge": (simulated(slide_mm=0.0), {}),
    "still": (simulated(proximal="still"), STILL),
    "gaps": (simulated(gaps=2, gap_frames=5), {"max_gap_s": 0.2}),
    "lost": (simulated(gaps=2, gap_frames=20), {}),
    "window": (USUAL, {"reference": 3, "reference_window": 4, "express_in": "proximal"}),
    "lab": (USUAL, {"express_in": "lab", "axis_sd_deg": 2.0, "marker_noise_mm": 0.2}),
    "min angle": (USUAL, {"min_angle_deg": 7.5, "method": "sclerp"}),
    "signed": (USUAL, {"signed": "yes"}),
    "unsigned": (USUAL, {"signed": "no"}),
    "ball": (ball, {}),
    "two axes": (two_axes_moving, {}),
    "two axes, one wanders": (simulated(joint_type="two-axes", wander_deg=6.0, frames=300, inversion=140), {}),
    "ball joint": (ball_joint, {}),
    "no joint": (no_joint, {}),
    "astray": (astray, {}),
    "astray, robust": (astray, {"robust": True}),
    "stated rigid": (USUAL, {"joint_type": "rigid"}),
    "stated two axes": (USUAL, {"joint_type": "two-axes"}),
    "own angles": (USUAL, {"method": "joint"}),
    "own two angles": (two_axes_moving, {"method": "joint"}),
    "stated hinge": (USUAL, {"joint_type": "hinge"}),
    "ball, signed": (ball, {"signed": "yes"}),
    "filtered": (without_markers(USUAL), {"lowpass_hz": 6.0}),
    "automatic": (USUAL, {"lowpass_hz": "auto"}),
    "resampled": (USUAL, {"resample_hz": 50.0}),
    "markers": (with_markers, {"proximal_markers": ("Left Upper Arm:*",), "distal_markers": ("Left Forearm:*",)}),
    "dual qr": (
        with_markers,
        {"proximal_markers": ("Left Upper Arm:*",), "distal_markers": ("Left Forearm:*",), "pose_method": "dual-qr"},
    ),
    "errors alone": (errors_alone, {}),
    "error column": (from_file, {"noise": "error-column"}),
    "from a file": (from_file, {}),
    "jitter": (simulated(rest_before_s=1.0), {"noise": "still"}),
    "no noise": (USUAL, {"noise": "none"}),
    "stated noise": (without_markers(USUAL), {"marker_noise_mm": 0.2, "robust": True}),
    "stated noise, short": (without_markers(simulated(frames=80, inversion=40)), {"marker_noise_mm": 0.2}),
    "wander": (without_markers(simulated(axis_drift_deg=6.0, frames=300, inversion=150)), {}),
    "skin": (USUAL, {"skin_motion": (4.0,)}),
    "skin turns": (USUAL, {"skin_motion": (4.0, 3.0)}),
    "few": (without_markers(simulated(frames=5, inversion=2, rate_hz=2.0)), {"noise": "none"}),
    "sdlb": (USUAL, {"method": "sdlb", "keyframes": (0, 30, 60, 100, 149), "knots": "chord"}),
    "dib": (USUAL, {"method": "dib", "keyframes": (0, 30, 60, 149), "knots": "uniform"}),
    "spline": (USUAL, {"method": "catmull-rom", "keyframes": (0, 30, 60, 149), "knots": "angle"}),
    "at times": (USUAL, {"keyframes": (0, 30, 60, 100, 149), "law": "polynomial-345"}),
    "global": (USUAL, {"blend": "global", "radius_mm": 40.0}),
    "many": (USUAL, {"keyframes": tuple(range(0, 149, 10)), "method": "sclerp", "law": "linear"}),
    "twelve": (USUAL, {"keyframes": tuple(range(0, 120, 10)), "method": "sclerp"}),
    "tolerance": (USUAL, {"tolerance_mm": 2.5}),
    "whole": (USUAL, {"phases": "whole", "law_peak": 0.4}),
    "inversion": (USUAL, {"inversion": 55, "law": "harmonic"}),
    "best": (USUAL, {"law": "best"}),
    "empirical": (USUAL, {"law": "empirical"}),
    "one phase": (flexion_only, {}),
    "cycles": (simulated(repetitions=2), {}),
    "knee": (simulated(joint="knee"), {}),
}


class Case(NamedTuple):
    """A result, its settings, and what its methods say."""

    told: Told
    settings: Settings
    recording: Recording
    text: str


@pytest.fixture(scope="module")
def cases(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Case]:
    made: dict[str, Case] = {}

    def case(name: str) -> Case:
        if name not in made:
            make, changes = CASES[name]
            recording, settings = make(), Settings(**changes)
            folder = save_analysis(
                analyze(recording, settings), tmp_path_factory.mktemp("case") / "r", figure_formats=(), report=False
            )
            made[name] = Case(Told(folder, folder, (), ""), settings, recording, methods_of(view_of_result(folder)))
        return made[name]

    return case


# Each: which outcome a case has, by its settings, tables and file alone, and what is said of each outcome.
Outcome = Callable[[Case], str]
Sentences = Callable[[Case], dict[str, str]]


def distal_of(case: Case) -> str:
    return str(case.told.summary["trial"]["joint"]["distal"])


def proximal_of(case: Case) -> str:
    return str(case.told.summary["trial"]["joint"]["proximal"])


def tracked(case: Case) -> str:
    screw = case.told.screw
    return f"tracked in {100.0 * screw['valid'].sum() / len(screw):.1f} % of {len(screw)} frames"


def reference(case: Case) -> str:
    screw = case.told.screw
    first = int(screw["frame"][screw["valid"] == 1].iloc[0])
    return str(first if case.settings.reference is None else case.settings.reference)


def single_axis(case: Case) -> str:
    """By how far the screw-hinge's pitch is from none."""
    fit = case.told.joint["screw_hinge"]
    stated = case.settings.joint_type
    if stated in ("rigid", "two_axes", "ball"):
        return "stated otherwise"
    if fit is None:
        return "none"
    if stated != "auto":
        return f"{case.settings.joint_type.replace('_', '-')}, stated"
    if fit["pitch_sd_mm_per_rad"] is None:
        return "hinge, unsure"
    return "screw-hinge" if abs(fit["pitch_mm_per_rad"]) > 3.5 * fit["pitch_sd_mm_per_rad"] else "hinge"


def has_one(case: Case) -> bool:
    return single_axis(case) not in ("none", "stated otherwise")


def sizes_of_wander(case: Case) -> list[float]:
    """By how much each of two axes turns that wanders, deg."""
    two = case.told.joint["two_axes"] or {"axis1": {"wander": None}, "axis2": {"wander": None}}
    wanders = [two[name]["wander"] for name in ("axis1", "axis2")]
    return [wander["size_deg"] for wander in wanders if wander is not None and wander["significant"]]


def other_joint(case: Case) -> str:
    """What the joint is that has no single axis."""
    if has_one(case):
        return "none"
    kind = case.told.joint["joint_type"]["type"]
    return "tried" if kind in ("free", "undetermined") else str(kind)


def status(case: Case) -> str:
    return "stated" if single_axis(case) == "stated otherwise" else str(case.told.joint["joint_type"]["status"])


def first_word(case: Case) -> str:
    return {"tried": "a rigid joint", "none": "?"}.get(other_joint(case), "the joint")


def tried(case: Case) -> str:
    """Each type that was fitted, and what it leaves."""
    names = {"rigid": "a rigid joint", "hinge": "a hinge", "screw_hinge": "a screw-hinge"}
    names |= {"two_axes": "two axes", "ball": "a ball joint"}
    parts = []
    for one in case.told.joint["joint_type"]["candidates"]:
        verb = "leave" if one["type"] == "two_axes" else "leaves"
        left = f"{names[one['type']]} {verb} {one['residual_deg']:.3g}° and {one['residual_mm'] or 0.0:.3g} mm RMS"
        parts.append(left + ("" if one["valid"] else " (not determined by the motion)"))
    return f"{', '.join(parts[:-1])}, and {parts[-1]}" if parts[1:] else "".join(parts)


def unexplained(case: Case) -> str:
    share = case.told.joint["unexplained_share"]
    return "more rotation than there is about it" if share is None else f"{100.0 * share:.2g} % of its rotation"


def interval(case: Case) -> str:
    fit = case.told.joint["mean_axis"] or reported(case)
    return "none" if fit is None or fit["decided_by"] is None else str(fit["decided_by"])


def reported(case: Case) -> Any:
    """The fit that should be reported, None where there is no single axis."""
    return case.told.joint.get(single_axis(case).split(",")[0].replace("-", "_"))


def interval_texts(case: Case) -> dict[str, str]:
    fit = case.told.joint["mean_axis"] or reported(case)
    if fit is None or fit["axis_cone95_deg"] is None:
        radii = "no radii"
    else:
        radii = f"Its 95 % cone and radius, {fit['axis_cone95_deg']:.2g}° and {fit['point_radius95_mm']:.2g} mm, are "
    of = "those of the marker clusters' frames, from"
    by_errors = "the errors that the file states of its markers and how they go with the motion"
    by_markers = by_errors if markers_in(case) == "errors" else "the markers' motion among themselves"
    left_out = ", for bodies that are rigid on their bones, as the file tells nothing of markers"
    end = "." if markers_in(case) != "nothing" else f"{left_out}."
    return {
        "A": f"{radii}{of} {by_markers}.",
        "B": f"{radii}{of} the residuals of the joint's model and how they go together in time{end}",
        "J": f"{radii}{of} blocks of the motion{end}",
    }


def markers_in(case: Case) -> str:
    """What the bodies that were analyzed tell of their markers; chosen markers tell all."""
    if case.settings.distal_markers:
        return "motion"
    told = {
        "motion" if one.marker_offsets is not None else "nothing" if one.reported_error is None else "errors"
        for one in case.recording.bodies
        if not np.ptp(one.dual_quat_lab_body[np.isfinite(one.dual_quat_lab_body[:, 0])], axis=0).max() < 1e-9
    }
    return next(one for one in ("nothing", "errors", "motion") if one in told)


def holds_if(case: Case) -> str:
    fit = case.told.joint["mean_axis"] or reported(case)
    return "no radii" if fit is None or fit["axis_cone95_deg"] is None else markers_in(case)


def noise(case: Case) -> str:
    sources = {one["source"] for one in case.told.joint["noise"].values() if one is not None}
    return sources.pop() if len(sources) == 1 else "none"


def phase_count(case: Case) -> str:
    count = case.told.keyframes["phase"].max()
    return f"There is {count} phase" if count == 1 else f"There are {count} phases"


def between(case: Case) -> str:
    settings = case.settings
    if settings.tolerance_mm is not None or settings.keyframes is not None:
        return "chosen"
    if settings.inversion is not None:
        return "inversion"
    return settings.phases if case.told.summary["motion"]["movements"] else "whole"


def said_by_rms(case: Case) -> str:
    """The law that is nearest in each phase, as the keyframes have it."""
    return ", ".join(dict.fromkeys(case.told.keyframes["law"]))


MODEL_WORDS = {
    "dlb": "dual quaternion linear blending (DLB)",
    "sclerp": "screw linear interpolation (ScLERP)",
    "sdlb": "dual quaternion linear blending of neighboring poses (sDLB)",
    "dib": "dual quaternion iterative blending (DIB)",
    "catmull-rom": "a Catmull-Rom spline of dual quaternions",
}
OWN_ANGLES = {
    "hinge": "the hinge's angle",
    "screw_hinge": "the screw-hinge's angle",
    "two_axes": "the angles about the joint's two axes",
    "ball": "the ball joint's rotation",
}

DECISIONS: dict[str, tuple[Outcome, Sentences]] = {
    "rate": (
        lambda case: "as recorded" if case.settings.resample_hz is None else "changed",
        lambda case: {
            "as recorded": f"were recorded at {case.recording.rate_hz:.6g} Hz.",
            "changed": f"were resampled to {case.settings.resample_hz or 0.0:g} Hz by screw linear interpolation",
        },
    ),
    "poses": (
        lambda case: "as exported" if case.settings.distal_markers is None else case.settings.pose_method,
        lambda case: {
            "svd": "Poses were found from marker positions by least squares.",
            "dual-qr": "Poses were found from marker positions by the dual QR decomposition.",
        },
    ),
    "filter": (
        lambda case: {None: "none", "auto": "auto"}.get(case.settings.lowpass_hz, "stated"),  # type: ignore[arg-type]
        lambda case: {
            "none": "The poses were not filtered.",
            "auto": "Hz, chosen by residual analysis (Winter 2009): second-order Butterworth, forward and backward",
            "stated": f"low-pass filtered at {case.settings.lowpass_hz or 0:.3g} Hz: second-order Butterworth"
            if case.settings.lowpass_hz != "auto"
            else "stated",
        },
    ),
    "bodies": (
        lambda case: "one" if case.settings.proximal == "none" or len(case.recording.bodies) == 1 else "two",
        lambda case: {
            "one": f"The {proximal_of(case)} was taken to stand still, so that poses of the {distal_of(case)} are",
            "two": f"Motion of the {distal_of(case)} relative to the {proximal_of(case)} was described by",
        },
    ),
    "tracked": (
        lambda case: "one" if case.settings.proximal == "none" or len(case.recording.bodies) == 1 else "two",
        lambda case: {
            "one": f"The {distal_of(case)} was {tracked(case)}",
            "two": f"Both segments were {tracked(case)}",
        },
    ),
    "gaps": (
        lambda case: "filled" if case.told.screw["filled"].any() else "none",
        lambda case: {
            "filled": f"gaps of up to {case.settings.max_gap_s:g} s ({case.told.screw['filled'].sum()} frames) were "
            "filled by ScLERP, and filled poses entered neither means nor errors",
            "none": "no gaps were filled",
        },
    ),
    "reference": (
        lambda case: "one" if case.settings.reference_window == 1 else "mean",
        lambda case: {
            "one": f"The displacement from the reference pose (frame {reference(case)})",
            "mean": f"from the reference pose (the mean of {case.settings.reference_window} frames from frame "
            f"{reference(case)})",
        },
    ),
    "frame": (
        lambda case: str(case.settings.express_in),
        lambda case: {
            "distal": f"expressed in the {distal_of(case)}'s frame at the reference.",
            "proximal": f"expressed in the {proximal_of(case)}'s frame.",
            "lab": f"expressed in the laboratory frame, with the {proximal_of(case)} where it was at the reference.",
        },
    ),
    "sense": (
        lambda case: f"{case.settings.signed}, {case.told.summary['motion']['dominant_axis']['ratio'] <= 0.2}",
        lambda case: {
            "auto, True": "The sense of θ is that of one axis for the whole trial, the leading eigenvector",
            "auto, False": "No axis dominates the motion, so that θ has no sense.",
            **dict.fromkeys(("yes, True", "yes, False"), "θ was given the sense of the leading axis."),
            **dict.fromkeys(("no, True", "no, False"), "θ was taken without a sense."),
        },
    ),
    "axes from": (
        lambda case: "angle" if case.settings.axis_sd_deg is None else "precision",
        lambda case: {
            "angle": f"Axes are given for rotations of {case.settings.min_angle_deg:g}° and more.",
            "precision": f"standard deviation of their direction is {case.settings.axis_sd_deg or 0.0:g}° or less.",
        },
    ),
    "noise": (
        noise,
        lambda case: {
            source: f"are propagated from the noise of the poses ({source})."
            for source in (
                "marker residuals",
                "error column",
                "still stretch",
                "option",
                "option, markers assumed",
                "option, shared out as the poses jitter",
                "error column, shared out as the poses jitter",
            )
        },
    ),
    "holds": (
        holds_if,
        lambda case: {
            "motion": "They hold if the clusters move on the bone no more as a whole than their markers among "
            "themselves;",
            "errors": "They hold if the clusters move on the bone no more as a whole than the stated errors show their "
            "markers to move among themselves;",
            "nothing": "They hold if the clusters do not move on the bone with the motion, of which nothing here "
            "tells;",
        },
    ),
    "single axis": (
        single_axis,
        lambda case: {
            "screw-hinge": "; the screw-hinge is reported, as the pitch of the screw-hinge exceeds what a hinge shows "
            "by chance (99.73 %).",
            "hinge": "; the hinge is reported, as the pitch of the screw-hinge does not exceed what a hinge shows "
            "by chance (99.73 %).",
            "hinge, unsure": "; the hinge is reported, as no error can be given for the pitch of the screw-hinge.",
            "hinge, stated": "; the hinge is reported, as stated.",
            "stated otherwise": "No single axis is reported, as the joint was stated ("
            + {"rigid": "a rigid joint", "two_axes": "two axes"}.get(case.settings.joint_type, "?")
            + "); the mean of the helical axes,",
            "none": f"The motion has no single axis (a hinge leaves {unexplained(case)} unexplained)",
        },
    ),
    "wander": (
        lambda case: "wanders" if (case.told.folder / "axis_path.csv").exists() else "none",
        lambda case: {
            "wanders": f"As the axis turns by {(case.told.joint['wander'] or {}).get('size_deg') or 0.0:.2g}° over the "
            "range of the angle, its mean over the range is reported."
        },
    ),
    "wander of two": (
        lambda case: "wanders" if sizes_of_wander(case) else "none",
        lambda case: {
            "wanders": f"As axis 1 turns by {sizes_of_wander(case)[:1][0]:.2g}° over the range of its angle, both axes "
            "are reported as they are on the mean. The 95 % intervals"
        }
        if sizes_of_wander(case)
        else {},
    ),
    "other joint": (
        other_joint,
        lambda case: {
            "two_axes": "the joint has two axes, one fixed in each segment "
            f"({status(case)}), so that θ mixes its rotations",
            "ball": f"the joint is a ball joint ({status(case)}), so that θ mixes its rotations",
            "rigid": "the joint is rigid (stated). The dispersion",
            "tried": f"{tried(case)}. None of them is reported ({case.told.joint['joint_type']['reason']}). The disp",
        },
    ),
    "robust": (
        lambda case: f"{'one axis' if has_one(case) else 'another joint'}, {case.settings.robust}",
        lambda case: {
            "one axis, True": "as a hinge and as a screw-hinge, frames weighted by Tukey's biweight;",
            "one axis, False": "as a hinge and as a screw-hinge;",
            "another joint, True": "relative poses, frames weighted by Tukey's biweight, the joint has two axes",
            "another joint, False": f"By maximum likelihood of all relative poses, {first_word(case)} ",
        },
    ),
    "fitted frames": (
        lambda case: "some" if has_one(case) else "none",
        lambda case: {"some": f"to the relative poses of {int(case.told.screw['valid'].sum())} frames by maximum"},
    ),
    "interval": (interval, interval_texts),
    "skin": (
        lambda case: "none" if case.settings.skin_motion is None else str(len(case.settings.skin_motion)),
        lambda case: {
            "1": f"on the bone of {(case.settings.skin_motion or (0.0,))[0]:g} mm was stated and is included.",
            "2": "on the bone of 4 mm and 3° was stated and is included.",
        },
    ),
    "dispersion": (
        lambda case: "always",
        lambda case: {"always": f"(median {case.told.joint['dispersion']['direction_median_deg']:.2g}°)."},
    ),
    "method": (
        lambda case: str(case.told.keyframes["method"].iloc[0]),
        lambda case: {
            name: f"The motion was modeled by {words} of {len(case.told.keyframes)} keyframe poses ("
            for name, words in {
                **MODEL_WORDS,
                "joint": f"interpolation of {OWN_ANGLES.get(case.told.joint['joint_type']['type'], '?')}",
            }.items()
        },
    ),
    "listed": (
        lambda case: "listed" if len(case.told.keyframes) <= 12 else "table",
        lambda case: {
            "listed": f"(frames {', '.join(map(str, case.told.keyframes['frame']))})",
            "table": "(keyframes.csv)",
        },
    ),
    "blend": (
        lambda case: str(case.told.keyframes["blend"].iloc[0]),
        lambda case: {"piecewise": "), phase by phase.", "global": "), all poses at once."},
    ),
    "knots": (
        lambda case: "chosen"
        if case.settings.tolerance_mm is not None
        else case.settings.knots
        if len(case.told.keyframes) > case.told.keyframes["phase"].max() + 1
        else "ends",
        lambda case: {
            "chosen": "The keyframes are the fewest measured poses between which the RMS displacement stays within "
            f"{case.settings.tolerance_mm or 0.0:g} mm in every frame",
            "law": "The parameter of each keyframe is the law's value at its time.",
            "chord": "The parameter of each keyframe is the accumulated distance of the origins.",
            "uniform": "The parameter of each keyframe is its number, in equal steps.",
            "angle": "The parameter of each keyframe is the accumulated angle.",
        },
    ),
    "phases": (
        between,
        lambda case: {
            "chosen": f"{phase_count(case)};",
            "inversion": f"{phase_count(case)}, with the inversion at frame {case.settings.inversion};",
            "whole": f"{phase_count(case)} between start, inversion and end of the recording;",
            "movement": f"{phase_count(case)} between reversals and rests of the joint;",
        },
    ),
    "law": (
        lambda case: case.settings.law or "by default",
        lambda case: {
            "best": "of the known laws of motion each phase follows the one nearest the measurement "
            f"({said_by_rms(case)})",
            "empirical": "the time course in each phase is the recording's own",
            **{
                name: f"the law of motion is the {name} one"
                for name in ("linear", "cycloidal", "harmonic", "polynomial-345")
            },
            "by default": f"the law of motion is the {'linear' if case.settings.tolerance_mm else 'cycloidal'} one",
        },
    ),
    "peak": (
        lambda case: "none" if case.settings.law_peak is None else "stated",
        lambda case: {"stated": f", with its highest velocity at {case.settings.law_peak or 0.0:g} of the phase."},
    ),
    "points": (
        lambda case: "radius"
        if case.settings.radius_mm is not None or case.told.joint["bodies"]["distal_markers_mm"] is None
        else "markers",
        lambda case: {
            "markers": f"the RMS displacement of the {distal_of(case)}'s markers.",
            "radius": "the RMS displacement of points with a radius of gyration of "
            f"{case.settings.radius_mm or 50.0:.3g} mm.",
        },
    ),
    "program": (
        lambda case: "always",
        lambda case: {
            "always": f"made with elbowscrew {case.told.summary['elbowscrew']} (Pennestrì and Valentini 2010)."
        },
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_what_was_done_is_said_and_nothing_else(name: str, cases: Callable[[str], Case]) -> None:
    case = cases(name)
    for decision, (outcome_of, sentences_of) in DECISIONS.items():
        outcome, sentences = outcome_of(case), sentences_of(case)
        own = sentences.get(outcome)
        assert own is None or case.text.count(own) == 1, f"{decision}: {own!r} not in: {case.text}"
        for other, sentence in sentences.items():
            if other != outcome and sentence != own:
                assert sentence not in case.text, f"{decision}: {sentence!r} is not so: {case.text}"
        if own is None:  # an outcome of which nothing is said
            assert outcome in ("none", "as exported", "None", "ends", "no radii"), (decision, outcome)


@pytest.mark.parametrize("name", CASES)
def test_sentences_end_with_a_stop_and_begin_after_a_space(name: str, cases: Callable[[str], Case]) -> None:
    text = re.sub(r"\w+\.(csv|json|toml)|\d\.\d+\.\d+(\.dev\d+)?", "name", cases(name).text)
    assert text.endswith(".")
    assert not re.findall(r".{0,20}[.,;:)][A-Za-z].{0,20}", text)
    assert not re.findall(r".{0,20}(?:  | [.,;:)]).{0,20}", text)


def test_each_outcome_is_met(cases: Callable[[str], Case]) -> None:
    """So that no sentence goes untested."""
    for decision, (outcome_of, sentences_of) in DECISIONS.items():
        met = {outcome_of(cases(name)) for name in CASES}
        all_of = {outcome for name in CASES for outcome in sentences_of(cases(name))}
        # Of senses that are asked for the ratio does not matter.
        assert all_of - met <= {"no, False", "cycloidal"}, (decision, all_of - met)


def test_numbers_of_the_joints_axis(cases: Callable[[str], Case]) -> None:
    """With the interval comes by how much a cluster that turns misleads the axis: of the fit that is reported."""
    for name in ("default", "hinge", "wander"):
        case = cases(name)
        fit = reported(case)
        degrees = f"turns the axis by up to {fit['sensitivity_deg_per_deg']:.2g}°."
        assert f"each degree that a cluster turns with the motion {degrees}" in case.text
    few = cases("few")
    assert few.told.joint["hinge"]["axis_cone95_deg"] is None
    assert "95 % cone" not in few.text
    assert np.isfinite(few.told.screw["theta_deg"]).any()


def test_two_axes_that_leave_a_hinge_less_than_a_quarter_are_told_with_their_share(
    cases: Callable[[str], Case],
) -> None:
    share = cases("two axes").told.joint["unexplained_share"]
    assert 0.2 < share < 0.25
    assert cases("two axes").told.joint["joint_type"]["type"] == "two_axes"


def test_the_automatic_cutoff_is_the_one_used(cases: Callable[[str], Case]) -> None:
    case = cases("automatic")
    assert f"low-pass filtered at {case.told.summary['trial']['lowpass_hz']:.3g} Hz, chosen" in case.text
