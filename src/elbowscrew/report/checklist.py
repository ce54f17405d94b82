"""What a paper on a trial should state, filled in as far as the result knows it.

The entries follow the recommendations of the International Society of Biomechanics for the reporting of kinematic data
(Wu and Cavanagh 1995; Wu and others 2005) and what is needed to repeat an analysis.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Final, NamedTuple

import numpy as np

from elbowscrew.choices import JOINT_TYPE_WORDS
from elbowscrew.geometry.arrays import Float
from elbowscrew.model.summary_types import QualitySummary
from elbowscrew.quantities import rounded
from elbowscrew.report.bones_words import axis_against_epicondyles, bone_words, landmark_sources
from elbowscrew.report.facts import Facts
from elbowscrew.report.methods import frame_words, method_words
from elbowscrew.view.trial_view import TrialView

MISSING: Final = "not known to elbowscrew: say it yourself"


class Entry(NamedTuple):
    """One thing to report: what it is, and what this result says of it, None where only the author knows."""

    title: str
    text: str | None


def checklist_of(view: TrialView) -> tuple[Entry, ...]:
    """Fill in the checklist of a trial.

    Parameters
    ----------
    view : TrialView

    Returns
    -------
    tuple of Entry
        In the order of a methods section; entries that do not apply to the trial are left out.
    """
    return tuple(Entry(item.title(view), item.told(view)) for item in _ITEMS if item.applies(view))


def checklist_lines(view: TrialView) -> tuple[str, ...]:
    """Give the checklist as lines of text, an entry a line."""
    return tuple(f"{entry.title}: {entry.text or f'[{MISSING}]'}" for entry in checklist_of(view))


def common_of(facts: Facts) -> dict[str, str | None]:
    """Fill in, by their titles, the entries that a study's trials should have in common."""
    return {title: told(facts) for title, told in _COMMON.items()}


def _unknown(view: TrialView) -> None:
    """Nothing in a recording tells it."""


def _file(view: TrialView) -> str | None:
    source = view.summary["source"]
    if source["name"] is None:
        return None
    return f"{' '.join(source['name'].split())}, {source['layout'] or 'of unknown format'}, SHA-256 {source['sha256']}"


def _rate(view: Facts) -> str | None:
    return None if view.settings.resample_hz is not None else f"{view.summary['trial']['rate_hz']:.6g} Hz"


def _rate_and_length(view: TrialView) -> str | None:
    trial, rate = view.summary["trial"], _rate(view)
    return None if rate is None else f"{rate}, {trial['frames']} frames, {trial['duration_s']:.2f} s"


def _resampled(view: Facts) -> str:
    if view.settings.resample_hz is None:
        return "none"
    return f"to {view.summary['trial']['rate_hz']:.6g} Hz by screw linear interpolation"


def _resampling(view: TrialView) -> str:
    return f"{_resampled(view)}; {view.summary['trial']['frames']} frames"


def _side(view: Facts) -> str | None:
    bones = view.summary["motion"]["anatomy"]
    return view.summary["trial"]["joint"]["side"] if bones is None else bones["side"]


def _cycles(view: TrialView) -> str:
    if view.settings.no_cycles:
        return "not looked for (--no-cycles)"
    duration = view.repetitions.duration_s
    if not duration.size:
        return "none was found"
    given = "" if view.settings.cycles is None else ", as given by --cycles"
    spread = f" on average ({duration.min():.2f} to {duration.max():.2f})" if duration.size > 1 else ""
    return f"{duration.size}{given}, lasting {np.mean(duration):.2f} s{spread}"


def _segments(view: TrialView) -> str:
    words = view.named_joint
    proximal = "taken to stand still" if view.proximal_name is None else f"body {view.proximal_name!r}"
    return f"{words.proximal.name}: {proximal}; {words.distal.name}: body {view.distal_name!r}"


def _pose(view: Facts) -> str:
    if view.settings.proximal_markers or view.settings.distal_markers:
        way = {"svd": "least squares (singular value decomposition)", "dual-qr": "the dual QR decomposition"}
        return f"from marker positions by {way[view.settings.pose_method]}"
    what = "" if view.located else "orientations alone, "
    return f"{what}as the measuring system gave them"


def _missing(view: TrialView) -> str:
    trial = view.summary["trial"]
    lost = trial["frames"] - trial["measured_frames"] - trial["filled_frames"]
    how = f" in gaps of up to {view.settings.max_gap_s:g} s by screw linear interpolation"
    filled = f"{trial['filled_frames']} filled{how}" if trial["filled_frames"] else "none filled"
    return f"{trial['measured_frames']} of {trial['frames']} frames measured, {filled}, {lost} lost"


def _gaps(view: Facts) -> str:
    longest = view.settings.max_gap_s
    return f"filled up to {longest:g} s by screw linear interpolation" if longest > 0.0 else "none filled"


def _filter(view: Facts) -> str:
    trial = view.summary["trial"]
    cutoff, instantaneous = trial["lowpass_hz"], trial["instantaneous_lowpass_hz"]
    how = ", chosen by residual analysis" if view.settings.lowpass_hz == "auto" else ""
    poses = "none" if cutoff is None else f"Butterworth of order 2, forward and backward, {rounded(cutoff, 3)} Hz{how}"
    if cutoff is not None or instantaneous is None:
        return poses
    return f"{poses}; for instantaneous axes and velocities {rounded(instantaneous, 3)} Hz, chosen by residual analysis"


def _noise(view: TrialView) -> str | None:
    noise = view.joint_summary["noise"]
    sources = sorted({body["source"] for body in (noise["proximal"], noise["distal"]) if body is not None})
    return ", ".join(sources) or None


def _coordinates(view: Facts) -> str:
    whose = "a cluster" if view.located else "a sensor"
    told = f"axes in {frame_words(view)}"
    told += "" if view.settings.express_in == "lab" else f", which is that of {whose} and not of a bone"
    if (words := bone_words(view)) is not None:
        return f"{told}; anatomical angles between {words.proximal} and {words.distal} by {words.sequence}"
    return f"{told}; no landmarks were given"


def _reference(view: Facts) -> str:
    frame, window = view.summary["trial"]["reference_frame"], view.settings.reference_window
    chosen = "the first frame with all bodies" if view.settings.reference is None else "as chosen"
    return f"frame {frame} ({chosen})" + (f", mean of {window} frames" if window > 1 else "")


def _angles(view: Facts) -> str:
    signed = "signed by the dominant axis" if view.summary["motion"]["signed"] else "without a sense"
    told = f"rotation θ about the finite helical axis since the reference, {signed}"
    if (words := bone_words(view)) is not None:
        return f"{told}; {words.listed}, by the sequence Z-X-Y"
    return told


def _landmarks(view: TrialView) -> str:
    marks = view.summary["landmarks"]
    return "" if marks is None else landmark_sources(marks)


def _axes(view: Facts) -> str:
    if view.settings.axis_sd_deg is not None:
        return f"helical axes where the direction's standard deviation is {view.settings.axis_sd_deg:g}° or less"
    return f"helical axes for rotations of {view.settings.min_angle_deg:g}° and more"


def _joint(view: TrialView) -> str:
    joint = view.joint_summary
    kind, preferred = joint["joint_type"], joint["preferred"]
    status = "" if kind["status"] is None else f" ({'stated' if kind['status'] == 'forced' else kind['status']})"
    if preferred is not None:
        mean = "mean axis over the range of a " if joint["mean_axis"] is not None else "axis of a "
        how = f"{mean}{preferred.replace('_', '-')} by maximum likelihood of all relative poses"
    elif joint["two_axes"] is not None or joint["ball"] is not None:
        how = "by maximum likelihood of all relative poses"
    else:
        how = "no single axis: mean of the helical axes, weighted by sin²(θ/2)"
    return f"{JOINT_TYPE_WORDS[kind['type']]}{status}; {how}"


def _joint_and_type(view: Facts) -> str:
    kind = view.summary["motion"]["joint_type"]
    return f"{view.named_joint.name}, " + ("of no type" if kind is None else JOINT_TYPE_WORDS[kind["type"]])


def _format(view: Facts) -> str | None:
    return view.summary["source"]["layout"]


def _interval(view: TrialView) -> str | None:
    kind = view.joint_summary["joint_type"]
    if kind["interval_method"] is None:
        return None
    whose = "clusters'" if view.located else "sensors'"
    told = f"95 % for the {whose} frames, {kind['interval_method']}"
    within = "; ".join(_radii(view))
    return f"{told}: {within}" if within else told


def _radii(view: TrialView) -> Iterator[str]:
    """How far the axis, axes or center of the joint are known."""
    axis = view.summary["motion"]["joint_axis"]
    two, ball = view.joint_summary["two_axes"], view.joint_summary["ball"]
    if axis is not None and axis["axis_cone95_deg"] is not None:
        radius = "" if axis["point_radius95_mm"] is None else f", place within {rounded(axis['point_radius95_mm'])} mm"
        yield f"direction within {rounded(axis['axis_cone95_deg'])}°{radius}"
    for number, line in enumerate([] if two is None else [two["axis1"], two["axis2"]], start=1):
        cone = line["cone95_deg"]
        yield f"axis {number} " + ("undetermined" if cone is None else f"within {rounded(cone)}°")
    if ball is not None and ball["radius95_mm"] is not None:
        yield f"center within {rounded(ball['radius95_mm'])} mm"


def _epicondyles(view: TrialView) -> str:
    found = view.summary["motion"]["anatomy"]
    if found is None or found["axis"] is None:
        return "the motion shows no axis to hold against their line"
    return f"{axis_against_epicondyles(found)}; the error of the landmarks is not included"


def _soft_tissue(view: Facts) -> str | None:
    stated = view.settings.skin_motion
    if stated is None:
        return None
    turn = f" and {stated[1]:g}°" if len(stated) > 1 else ""
    return f"motion of each cluster as a whole of {stated[0]:g} mm{turn} was stated and is in the intervals"


def _model(view: Facts) -> str:
    model = view.summary["interpolation"]
    laws = " and ".join(dict.fromkeys(law["law"] for law in model["phase_laws"]))
    return f"{method_words(view)} of {len(model['keyframes'])} keyframes, {laws} law of motion"


def _model_and_error(view: TrialView) -> str:
    error = view.summary["interpolation"]["rms_angle_error_deg"]
    return _model(view) + ("" if error is None else f"; error {rounded(error)}° RMS")


def _repeatability(view: TrialView) -> str:
    found = view.joint_summary["repeatability"]
    icc = "not known" if found["icc"] is None else f"{found['icc']:.3f}"
    sd = found["theta_max_sd_deg"]
    return f"ICC(A,1) of θ over the cycles {icc}" + ("" if sd is None else f"; largest θ ± {rounded(sd)}° (SD)")


def _warnings(view: TrialView) -> str:
    codes = [one["code"] for one in view.summary["warnings"] if one["severity"] == "warning"]
    return ", ".join(dict.fromkeys(codes)) or "none"


def _software(view: Facts) -> str:
    versions = ", ".join(f"{name} {version}" for name, version in view.summary["versions"].items())
    return f"elbowscrew {view.summary['elbowscrew']} with {versions}; every setting stands in summary.json"


class _Item(NamedTuple):
    """One line of the checklist."""

    title: Callable[[TrialView], str]
    told: Callable[[TrialView], str | None]
    applies: Callable[[TrialView], bool]


def _always(view: TrialView) -> bool:
    return True


def _item(title: str, told: Callable[[TrialView], str | None], applies: Callable[[TrialView], bool] = _always) -> _Item:
    return _Item(lambda view: title, told, applies)


def _of_body(what: str, told: Callable[[QualitySummary, Float | None], str | None]) -> tuple[_Item, _Item]:
    """Say something of each body that is in the file."""
    return (
        _Item(
            lambda view: f"{what}, {view.named_joint.proximal.name}",
            lambda view: _told_of(view.summary["trial"]["proximal"], view.proximal_markers, told),
            lambda view: view.proximal_name is not None,
        ),
        _Item(
            lambda view: f"{what}, {view.named_joint.distal.name}",
            lambda view: _told_of(view.summary["trial"]["distal"], view.distal_markers, told),
            _always,
        ),
    )


def _told_of(
    body: QualitySummary | None, markers: Float | None, told: Callable[[QualitySummary, Float | None], str | None]
) -> str | None:
    return None if body is None else told(body, markers)


def _cluster(body: QualitySummary, markers: Float | None) -> str | None:
    if markers is None or len(markers) < 2:
        return None
    apart = np.linalg.norm(markers[:, None] - markers, axis=-1).max()
    return f"{len(markers)} markers, the farthest two {1000.0 * apart:.0f} mm apart"


def _residual(body: QualitySummary, markers: Float | None) -> str | None:
    residual, reported = body["marker_residual_mm"], body["reported_error_mm"]
    spread = residual or reported
    if spread is None or spread["largest"] == 0.0:  # a column that nobody filled in
        return None
    by = "RMS of the markers seen" if residual else "by the file's own error column"
    return (
        f"median {spread['median']:.2f} mm, 95 % {spread['percentile_95']:.2f}, largest {spread['largest']:.2f} ({by})"
    )


def _has_landmarks(view: TrialView) -> bool:
    return view.has_landmarks


_COMMON: Final[dict[str, Callable[[Facts], str | None]]] = {
    "Joint": _joint_and_type,
    "Side": _side,
    "Format of the files": _format,
    "Sampling rate": _rate,
    "Resampling": _resampled,
    "Poses": _pose,
    "Gaps": _gaps,
    "Filter": _filter,
    "Coordinate systems": _coordinates,
    "Reference pose": _reference,
    "Angles and their convention": _angles,
    "Axes": _axes,
    "Soft-tissue motion": _soft_tissue,
    "Model of the motion": _model,
    "Software": _software,
}
_ITEMS: Final = (
    _item("Participants (number, age, sex, health) and ethics approval", _unknown),
    _item("Side", _side),
    _item("Task, instructions, load and speed", _unknown),
    _item("Movement cycles", _cycles),
    _item("Measuring system, its calibration and accuracy", _unknown),
    _item("File", _file),
    _item("Sampling rate and length", _rate_and_length),
    _item("Resampling", _resampling, lambda view: view.settings.resample_hz is not None),
    _item("Segments and bodies", _segments),
    *_of_body("Markers", _cluster),
    _item("How the markers or sensors were fixed to the segments", _unknown),
    _item("Poses", _pose),
    *_of_body("Marker residuals", _residual),
    _item("Missing data and gaps", _missing),
    _item("Filter", _filter),
    _item("Noise that error bars rest on", _noise),
    _item("Axes of the laboratory (which points up, forward)", _unknown),
    _item("Coordinate systems", _coordinates),
    _item("Reference pose", _reference),
    _item("Angles and their convention", _angles),
    _item("Landmarks", _landmarks, _has_landmarks),
    _item("How the landmarks were found, and their error", _unknown, _has_landmarks),
    _item("Axes", _axes),
    _item("Joint", _joint),
    _item("Interval of the joint", _interval),
    _item("Axis and epicondyles", _epicondyles, _has_landmarks),
    _item("Soft-tissue motion", _soft_tissue),
    _item("Model of the motion", _model_and_error),
    _item("Repeatability", _repeatability, lambda view: view.repetitions.number.size > 1),
    _item("Warnings", _warnings),
    _item("Software", _software),
    _item("Where recording and results can be had", _unknown),
)
"""The checklist, an entry a line; a new one is one line here and the function that fills it in."""
