"""The paragraph for a paper's methods section, with the settings and numbers of this very result."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from elbowscrew.choices import JOINT_TYPE_WORDS
from elbowscrew.model.anatomy import BonyJoint
from elbowscrew.model.joint_summary_types import JointSummary, JointTypeSummary, NoiseOfBodies, TwoAxesSummary
from elbowscrew.model.summary_types import ModelSummary, TrialSummary
from elbowscrew.quantities import rounded
from elbowscrew.report.bones_words import bones_methods
from elbowscrew.report.facts import Facts
from elbowscrew.report.joint_words import HOLDS_IF
from elbowscrew.results.joint_summary import preferred_fit
from elbowscrew.view.trial_view import TrialView

_METHODS: Final = {
    "dlb": "dual quaternion linear blending (DLB)",
    "sclerp": "screw linear interpolation (ScLERP)",
    "sdlb": "dual quaternion linear blending of neighboring poses (sDLB)",
    "dib": "dual quaternion iterative blending (DIB)",
    "catmull-rom": "a Catmull-Rom spline of dual quaternions",
    "joint": "interpolation of {angles}",
}
_ANGLES: Final = {
    "hinge": "the hinge's angle",
    "screw_hinge": "the screw-hinge's angle",
    "two_axes": "the angles about the joint's two axes",
    "ball": "the ball joint's rotation",
}
_KNOTS: Final = {
    "law": "the law's value at its time",
    "chord": "the accumulated distance of the origins",
    "uniform": "its number, in equal steps",
    "angle": "the accumulated angle",
}
_KEYFRAMES_TOLD: Final = 12
PAPER: Final = (
    "Pennestrì E, Valentini PP. Dual quaternions as a tool for rigid body motion analysis: a tutorial with an "
    "application to biomechanics. The Archive of Mechanical Engineering 57 (2010). doi:10.2478/v10180-010-0010-2"
)

ISB: Final = (
    "Wu G, van der Helm FCT, Veeger HEJ, and others. ISB recommendation on definitions of joint coordinate systems of "
    "various joints for the reporting of human joint motion, part II: shoulder, elbow, wrist and hand. Journal of "
    "Biomechanics 38 (2005) 981-992. doi:10.1016/j.jbiomech.2004.05.042"
)
GROOD_SUNTAY: Final = (
    "Grood ES, Suntay WJ. A joint coordinate system for the clinical description of three-dimensional motions: "
    "application to the knee. Journal of Biomechanical Engineering 105 (1983) 136-144. doi:10.1115/1.3138397"
)
_OF_BONES: Final[dict[BonyJoint, str]] = {"elbow": ISB, "knee": GROOD_SUNTAY}


def methods_of(trial: TrialView) -> str:
    """Describe what was done to this trial, in sentences that can be published.

    Parameters
    ----------
    trial : TrialView

    Returns
    -------
    str
        Plain text; names in it are the file's own.
    """
    return " ".join(_sentences(trial))


def citations_of(trial: TrialView) -> tuple[str, ...]:
    """Say what to cite."""
    anatomy = trial.joint_summary["anatomy"]
    of_bones = () if anatomy is None else (_OF_BONES[anatomy["joint"]],)
    return (f"elbowscrew, version {trial.summary['elbowscrew']} (BSD-3-Clause).", PAPER, *of_bones)


def frame_words(trial: Facts) -> str:
    """Name the frame that screws are expressed in."""
    proximal, distal = trial.named_joint.proximal.name, trial.named_joint.distal.name
    frames = {
        "distal": f"the {distal}'s frame at the reference",
        "proximal": f"the {proximal}'s frame",
        "lab": f"the laboratory frame, with the {proximal} where it was at the reference",
    }
    return frames[trial.settings.express_in]


def method_words(trial: Facts) -> str:
    """Name the interpolation method of the model."""
    kind, method = trial.summary["motion"]["joint_type"], trial.settings.model_method
    angles = "the joint's own angles" if kind is None else _ANGLES.get(kind["type"], "the joint's own angles")
    return _METHODS.get(method, method).format(angles=angles)


def _sentences(trial: TrialView) -> Iterator[str]:
    settings, summary = trial.settings, trial.summary
    proximal, distal = trial.named_joint.proximal.name, trial.named_joint.distal.name
    yield from _recording(trial, summary["trial"])
    if trial.proximal_name is None:
        yield f"The {proximal} was taken to stand still, so that poses of the {distal} are relative motion."
    else:
        yield f"Motion of the {distal} relative to the {proximal} was described by unit dual quaternions."
    window = settings.reference_window
    mean = f"the mean of {window} frames from frame" if window > 1 else "frame"
    resolved = (
        "its finite helical (screw) axis, the rotation θ about it and the translation along it"
        if trial.located
        else "the direction of its axis and the rotation θ about it"
    )
    yield (
        f"The displacement from the reference pose ({mean} {summary['trial']['reference_frame']}) was resolved into "
        f"{resolved}, expressed in {frame_words(trial)}."
    )
    yield (
        (
            "The sense of θ is that of one axis for the whole trial, the leading eigenvector of the second moments of "
            "sin(θ/2) times the axes."
            if summary["motion"]["signed"]
            else "No axis dominates the motion, so that θ has no sense."
        )
        if settings.signed == "auto"
        else (
            "θ was given the sense of the leading axis." if settings.signed == "yes" else "θ was taken without a sense."
        )
    )
    if settings.axis_sd_deg is None:
        yield f"Axes are given for rotations of {settings.min_angle_deg:g}° and more."
    else:
        yield f"Axes are given where the standard deviation of their direction is {settings.axis_sd_deg:g}° or less."
    yield from _noise(trial.joint_summary["noise"], located=trial.located)
    yield from _joint_axis(trial)
    yield from bones_methods(trial)
    yield from _model(trial)
    yield f"Computations were made with elbowscrew {summary['elbowscrew']} (Pennestrì and Valentini 2010)."


def _recording(trial: TrialView, figures: TrialSummary) -> Iterator[str]:
    settings = trial.settings
    what = "Poses of the segments" if trial.located else "Orientations of the segments, and no positions,"
    if settings.resample_hz is None:
        yield f"{what} were recorded at {figures['rate_hz']:.6g} Hz."
    else:
        yield f"{what} were recorded."
    if settings.proximal_markers or settings.distal_markers:
        way = {"svd": "least squares", "dual-qr": "the dual QR decomposition"}[settings.pose_method]
        yield f"Poses were found from marker positions by {way}."
    lowpass = figures["lowpass_hz"]
    if lowpass is None:
        yield "The poses were not filtered."
    else:
        chosen = ", chosen by residual analysis (Winter 2009)" if settings.lowpass_hz == "auto" else ""
        yield (
            f"The poses were low-pass filtered at {rounded(lowpass, 3)} Hz{chosen}: second-order Butterworth, forward "
            "and backward, with the cut-off corrected for the two passes, on the components of sign-continuous dual "
            "quaternions."
        )
    if settings.resample_hz is not None:
        yield f"They were resampled to {settings.resample_hz:g} Hz by screw linear interpolation (ScLERP)."
    who = f"The {trial.named_joint.distal.name} was" if trial.proximal_name is None else "Both segments were"
    missing = f"{who} tracked in {100.0 * (1.0 - figures['missing_share']):.1f} % of {figures['frames']} frames"
    if figures["filled_frames"]:
        yield (
            f"{missing}; gaps of up to {settings.max_gap_s:g} s ({figures['filled_frames']} frames) were filled by "
            "ScLERP, and filled poses entered neither means nor errors."
        )
    else:
        yield f"{missing}; no gaps were filled."


def _noise(noise: NoiseOfBodies, *, located: bool) -> Iterator[str]:
    sources = sorted({body["source"] for body in (noise["proximal"], noise["distal"]) if body is not None})
    if sources:
        what = "angle, translation and axis" if located else "angle and axis"
        yield f"Standard deviations of {what} are propagated from the noise of the poses ({', '.join(sources)})."


def _joint_axis(trial: TrialView) -> Iterator[str]:
    joint = trial.joint_summary
    preferred, fit, screw_hinge = joint["preferred"], preferred_fit(joint), joint["screw_hinge"]
    skin = joint["skin_motion"]
    if preferred is None or fit is None:
        share = joint["unexplained_share"]
        left = (
            "more rotation than there is about it" if share is None else f"{rounded(100.0 * share)} % of its rotation"
        )
        why = f"The motion has no single axis (a hinge leaves {left} unexplained)"
        if joint["joint_type"]["status"] == "forced":
            why = (
                f"No single axis is reported, as the joint was stated ({JOINT_TYPE_WORDS[joint['joint_type']['type']]})"
            )
        yield f"{why}; the mean of the helical axes, weighted by sin²(θ/2), is given (Woltring 1994)."
        yield from _other_joint(joint, located=trial.located, robust=trial.settings.robust)
    else:
        robust = ", frames weighted by Tukey's biweight" if trial.settings.robust else ""
        if screw_hinge is None:
            why = "orientations tell of no slide"
        elif screw_hinge["pitch_sd_mm_per_rad"] is None:
            why = "no error can be given for the pitch of the screw-hinge"
        else:
            exceeds = "exceeds" if preferred == "screw_hinge" else "does not exceed"
            why = f"the pitch of the screw-hinge {exceeds} what a hinge shows by chance (99.73 %)"
        if joint["joint_type"]["status"] == "forced":
            why = "stated"
        kinds = "a hinge and as a screw-hinge" if screw_hinge is not None else "a hinge"
        yield (
            f"The joint axis was fitted to the relative poses of {fit['frames']} frames by maximum likelihood as "
            f"{kinds}{robust}; the {preferred.replace('_', '-')} is reported, as {why}."
        )
        wander, told = joint["wander"], joint["mean_axis"] or fit
        if joint["mean_axis"] is not None and wander is not None and wander["size_deg"] is not None:
            yield (
                f"As the axis turns by {rounded(wander['size_deg'])}° over the range of the angle, its mean over the "
                "range is reported."
            )
        if told["axis_cone95_deg"] is not None and not trial.located:
            yield (
                f"Its 95 % cone, {rounded(told['axis_cone95_deg'])}°, is that of the sensors' frames, "
                f"{told['interval_method']}. It holds if no sensor turns on its bone with the motion; each degree that "
                f"one does turns the axis by up to {rounded(fit['sensitivity_deg_per_deg'])}°."
            )
            if skin is not None and skin["deg"] > 0.0:
                yield f"A turn of the sensors on the bone of {skin['deg']:g}° was stated and is included."
        elif told["axis_cone95_deg"] is not None:
            yield (
                f"Its 95 % cone and radius, {rounded(told['axis_cone95_deg'])}° and "
                f"{rounded(told['point_radius95_mm'])} mm, are those of the marker clusters' frames, "
                f"{told['interval_method']}. They hold if {HOLDS_IF[joint['joint_type']['markers_told']]}; each degree "
                "that a cluster turns with the motion turns the axis by up to "
                f"{rounded(fit['sensitivity_deg_per_deg'])}°."
            )
            if skin is not None:
                turn = f" and {skin['deg']:g}°" if skin["deg"] > 0.0 else ""
                yield (
                    f"Motion of the clusters as a whole on the bone of {skin['mm']:g} mm{turn} was stated and is "
                    "included."
                )
    yield (
        "The dispersion of the helical axes is their angle to the plain mean of their directions "
        f"(median {rounded(joint['dispersion']['direction_median_deg'])}°)."
    )


def _other_joint(joint: JointSummary, *, located: bool, robust: bool) -> Iterator[str]:
    """Tell which joint it is that has no single axis, or which ones were tried where none was found."""
    kind = joint["joint_type"]
    weighed = ", frames weighted by Tukey's biweight" if robust else ""
    match kind["type"]:
        case "two_axes":
            found = "has two axes, one fixed in each segment"
        case "ball":
            found = "is a ball joint"
        case "rigid":
            found = "is rigid"
        case _:
            if kind["candidates"]:
                yield (
                    f"By maximum likelihood of all relative poses{weighed}, {_joined(_left(kind, located=located))}. "
                    f"None of them is reported ({kind['reason']})."
                )
            return
    status = "stated" if kind["status"] == "forced" else kind["status"]
    yield (
        f"By maximum likelihood of all relative poses{weighed}, the joint {found} ({status})"
        + (
            "."
            if kind["type"] == "rigid"
            else ", so that θ mixes its rotations; its own angles are given for each frame."
        )
    )
    if joint["two_axes"] is not None:
        yield from _wander_of_two(joint["two_axes"])
    if kind["interval_method"] is not None:
        whose = "marker clusters'" if located else "sensors'"
        yield f"The 95 % intervals are those of the {whose} frames, {kind['interval_method']}."


def _wander_of_two(axes: TwoAxesSummary) -> Iterator[str]:
    turns = [
        f"axis {number} turns by {rounded(wander['size_deg'])}°"
        for number, wander in enumerate((axes["axis1"]["wander"], axes["axis2"]["wander"]), start=1)
        if wander is not None and wander["significant"] and wander["size_deg"] is not None
    ]
    if turns:
        yield f"As {' and '.join(turns)} over the range of its angle, both axes are reported as they are on the mean."


def _left(kind: JointTypeSummary, *, located: bool) -> Iterator[str]:
    """Say what each type that was tried leaves."""
    for one in kind["candidates"]:
        name, verb = JOINT_TYPE_WORDS[one["type"]], "leave" if one["type"] == "two_axes" else "leaves"
        rotation, shift = one["residual_deg"], one["residual_mm"]
        left = "" if rotation is None else f"{rounded(rotation, 3)}°"
        if located and shift is not None:
            left += f" and {rounded(shift, 3)} mm"
        yield f"{name} {verb} {left} RMS" + ("" if one["valid"] else " (not determined by the motion)")


def _joined(parts: Iterator[str]) -> str:
    *first, last = parts
    return f"{', '.join(first)}, and {last}" if first else last


def _model(trial: TrialView) -> Iterator[str]:
    settings, model = trial.settings, trial.summary["interpolation"]
    keyframes = model["keyframes"]
    listed = f"frames {', '.join(map(str, keyframes))}" if len(keyframes) <= _KEYFRAMES_TOLD else "keyframes.csv"
    pieces = "phase by phase" if settings.blend == "piecewise" else "all poses at once"
    yield (f"The motion was modeled by {method_words(trial)} of {len(keyframes)} keyframe poses ({listed}), {pieces}.")
    if settings.tolerance_mm is not None:
        selection = model["selection"]
        if selection is None or selection["tolerance_deg"] is None:
            within = f"the RMS displacement stays within {settings.tolerance_mm:g} mm"
        else:
            within = f"the angle to the measured orientation stays within {selection['tolerance_deg']:g}°"
        yield (
            f"The keyframes are the fewest measured poses between which {within} in every frame, found by dynamic "
            "programming."
        )
    elif len(keyframes) > model["phases"] + 1:
        yield f"The parameter of each keyframe is {_KNOTS.get(settings.knots, f'by {settings.knots}')}."
    yield from _laws(trial, model)
    if not trial.located:
        yield "The model's error is the angle between modeled and measured orientation."
        return
    points = model["points"]
    over = (
        f"the {trial.named_joint.distal.name}'s markers"
        if points["from"] == "markers"
        else f"points with a radius of gyration of {rounded(points['radius_of_gyration_mm'], 3)} mm"
    )
    yield (
        f"The model's error is the angle between modeled and measured orientation, and the RMS displacement of {over}."
    )


def _laws(trial: TrialView, model: ModelSummary) -> Iterator[str]:
    """Tell phases and laws; which law a best fit chose stands in the summary."""
    settings, phases = trial.settings, model["phases"]
    count = f"{phases} phase{'s' if phases > 1 else ''}"
    if settings.tolerance_mm is not None or settings.keyframes is not None:
        between = count
    elif settings.inversion is not None:
        between = f"{count}, with the inversion at frame {settings.inversion}"
    elif settings.phases == "whole" or not trial.summary["motion"]["movements"]:
        between = f"{count} between start, inversion and end of the recording"
    else:
        between = f"{count} between reversals and rests of the joint"
    match settings.model_law:
        case "best":
            found = ", ".join(dict.fromkeys(law["law"] for law in model["phase_laws"]))
            law = f"of the known laws of motion each phase follows the one nearest the measurement ({found})"
        case "empirical":
            law = "the time course in each phase is the recording's own"
        case name:
            law = f"the law of motion is the {name} one"
    peak = "" if settings.law_peak is None else f", with its highest velocity at {settings.law_peak:g} of the phase"
    yield f"There {'is' if phases == 1 else 'are'} {between}; {law}{peak}."
