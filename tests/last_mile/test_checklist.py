"""The reporting checklist: each entry is the file's, the settings' or the tables' own; what is missing is marked."""

from __future__ import annotations

import hashlib
import re
from dataclasses import replace
from itertools import combinations
from math import dist
from typing import Any

import numpy as np
import pytest
from told_results import Told

from elbowscrew import Recording, Settings, analyze, simulate_trial
from elbowscrew.model.anatomy import LANDMARKS
from elbowscrew.report.checklist import MISSING, Entry, checklist_lines, checklist_of
from elbowscrew.results.trial_views import view_of
from elbowscrew.view.trial_view import TrialView

ALWAYS_MISSING = {
    "Participants (number, age, sex, health) and ethics approval",
    "Task, instructions, load and speed",
    "Measuring system, its calibration and accuracy",
    "How the markers or sensors were fixed to the segments",
    "Axes of the laboratory (which points up, forward)",
    "How the landmarks were found, and their error",
    "Where recording and results can be had",
}
FRAMES = {
    "proximal": "the {proximal}'s frame, which is that of a cluster and not of a bone",
    "distal": "the {distal}'s frame at the reference, which is that of a cluster and not of a bone",
    "lab": "the laboratory frame, with the {proximal} where it was at the reference",
}
BONES = {
    True: (
        "humerus and forearm by the sequence Z-X-Y of the International Society of Biomechanics (Wu and others 2005)",
        "flexion, carrying angle (varus positive) and pronation (0 in supination)",
    ),
    False: (
        "femur and tibia by the joint coordinate system of Grood and Suntay (1983)",
        "flexion, adduction (varus positive) and internal rotation",
    ),
}
METHODS = {"dlb": "(DLB)", "dib": "(DIB)", "sclerp": "(ScLERP)"}


def rows_of(told: Told) -> dict[str, str]:
    """What the page's checklist says."""
    rows = told.page.rows
    first = next(k for k, row in enumerate(rows) if row and row[0] == "To report")
    last = next(k for k, row in enumerate(rows) if row and row[0] == "Option")
    return dict(rows[first + 1 : last])


def expected_of(told: Told) -> dict[str, str]:
    """The entries, from the recording, the settings and the tables."""
    summary, screw, cycles = told.summary, told.screw, told.repetitions
    settings, words, joint, motion = summary["settings"], summary["trial"]["joint"], told.joint, summary["motion"]
    measured, filled = int(screw["valid"].sum()), int(screw["filled"].sum())
    time, frames = screw["time_s"], len(screw)
    rate = (frames - 1) / (time.iloc[-1] - time.iloc[0])
    marks = summary["landmarks"]
    found: dict[str, str] = {
        "Side": marks["side"] if marks else words["side"] or MISSING,
        "File": f"{told.source.name}, Motive columns 1.23, SHA-256 "
        f"{hashlib.sha256(told.source.read_bytes()).hexdigest()}",
        "Sampling rate and length": f"{rate:.6g} Hz, {frames} frames, {time.iloc[-1] - time.iloc[0]:.2f} s",
        "Poses": "as the measuring system gave them",
        "Missing data and gaps": f"{measured} of {frames} frames measured, "
        + (f"{filled} filled in gaps of up to 0.1 s by screw linear interpolation" if filled else "none filled")
        + f", {frames - measured - filled} lost",
        "Coordinate systems": "axes in " + FRAMES[told.frame_of_screws].format(**words)
        + (
            f"; anatomical angles between {BONES['EL' in marks][0]}"
            if marks else "; no landmarks were given"
        ),
        "Axes": f"helical axes for rotations of {settings['min-angle']:g}° and more",
        "Soft-tissue motion": MISSING,
        "Warnings": ", ".join(one["code"] for one in summary["warnings"] if one["severity"] == "warning") or "none",
    }  # fmt: skip
    duration = cycles["duration_s"]
    if "--no-cycles" in told.options:
        found["Movement cycles"] = "not looked for (--no-cycles)"
    else:
        spread = f" on average ({duration.min():.2f} to {duration.max():.2f})" if len(cycles) > 1 else ""
        found["Movement cycles"] = f"{len(cycles)}, lasting {duration.mean():.2f} s{spread}"
    stated = told.option("--reference")
    window = int(told.option("--reference-window") or 1)
    first = screw["frame"][screw["valid"] == 1].iloc[0]
    found["Reference pose"] = (
        f"frame {stated or first} ({'the first frame with all bodies' if stated is None else 'as chosen'})"
        + (f", mean of {window} frames" if window > 1 else "")
    )
    sense = "signed by the dominant axis" if motion["signed"] else "without a sense"
    found["Angles and their convention"] = f"rotation θ about the finite helical axis since the reference, {sense}" + (
        f"; {BONES['EL' in marks][1]}, by the sequence Z-X-Y" if marks else ""
    )
    bodies = {body.name: body for body in told.recording.bodies}
    still = summary["trial"]["proximal"] is None
    segments = []
    for end in ("proximal", "distal"):
        word = words[end]
        if end == "proximal" and still:
            segments.append(f"{word}: taken to stand still")
            continue
        body = bodies[summary["trial"][end]["name"]]
        segments.append(f"{word}: body {body.name!r}")
        if not body.solved.shape[1]:
            found[f"Markers, {word}"] = found[f"Marker residuals, {word}"] = MISSING
            continue
        widest = max(dist(one, other) for one, other in combinations(body.offsets, 2))
        found[f"Markers, {word}"] = f"{len(body.offsets)} markers, the farthest two {widest:.0f} mm apart"
        residual = summary["trial"][end]["marker_residual_mm"]  # recomputed by test_recomputed
        found[f"Marker residuals, {word}"] = (
            f"median {residual['median']:.2f} mm, 95 % {residual['percentile_95']:.2f}, "
            f"largest {residual['largest']:.2f} (RMS of the markers seen)"
        )
    found["Segments and bodies"] = "; ".join(segments)
    noise = sorted({one["source"] for one in joint["noise"].values() if one})
    found["Noise that error bars rest on"] = ", ".join(noise) or MISSING
    if len(cycles) > 1:
        again = joint["repeatability"]
        found["Repeatability"] = (
            f"ICC(A,1) of θ over the cycles {again['icc']:.3f}; largest θ ± {again['theta_max_sd_deg']:.2g}° (SD)"
        )
    if marks:
        found["Landmarks"] = ", ".join(mark for mark in LANDMARKS if mark in marks) + " by coordinates"
        angle, far = (
            [joint["anatomy"][f"{name}{end}"] for end in ("", "_low", "_high")]
            for name in ("axis_angle_deg", "axis_distance_mm")
        )
        found["Axis and epicondyles"] = (
            f"{angle[0]:.2f}° (95 % interval {angle[1]:.2f} to {angle[2]:.2f}°) off the line of the epicondyles and "
            f"passes {far[0]:.2f} mm (95 % interval {far[1]:.2f} to {far[2]:.2f} mm) from the point midway between "
            "them; the error of the landmarks is not included"
        )
    return found


def test_entries_are_those_of_the_recording_and_the_settings(told: Told) -> None:
    said, expected = rows_of(told), expected_of(told)
    assert {title: said.get(title) for title in expected} == expected
    for title in ALWAYS_MISSING & set(said):
        assert said[title] == MISSING, title
    by_pattern = {
        "Filter": rf"none(; for instantaneous axes and velocities {NUMBER} Hz, chosen by residual analysis)?",
        "Joint": r"(a|two) [a-z -]+ \(\w+\); .*maximum likelihood of all relative poses",
        "Interval of the joint": r"95 % for the clusters' frames, from .*",
        "Model of the motion": rf".*of {len(told.keyframes)} keyframes, [\w -]+ law of motion; error {NUMBER}° RMS",
        "Software": r"elbowscrew .*; every setting stands in summary\.json",
    }
    assert set(said) == set(expected) | set(by_pattern) | (ALWAYS_MISSING & set(said))
    for title, wanted in by_pattern.items():
        assert re.fullmatch(wanted, said[title]), said[title]
    trial, kind = told.summary["trial"], told.joint["joint_type"]
    assert (f"{trial['instantaneous_lowpass_hz']:.3g} Hz" in said["Filter"]) == (
        trial["instantaneous_lowpass_hz"] is not None
    )
    assert f"({kind['status']})" in said["Joint"]
    assert kind["interval_method"] in said["Interval of the joint"]
    radii = radii_of(told)
    assert radii
    assert said["Interval of the joint"].endswith(f": {radii}")
    model = told.summary["interpolation"]
    assert f"error {np.sqrt(np.mean(told.model['angle_error_deg'] ** 2)):.2g}° RMS" in said["Model of the motion"]
    assert METHODS[model["method"]] in said["Model of the motion"]
    assert (
        f", {' and '.join(dict.fromkeys(law['law'] for law in model['phase_laws']))} law" in said["Model of the motion"]
    )
    for name, version in told.summary["versions"].items():
        assert f"{name} {version}" in said["Software"]
    assert said["Software"].startswith(f"elbowscrew {told.summary['elbowscrew']} ")


NUMBER = r"[\d.]+(?:e[+-]\d+)?"


def radii_of(told: Told) -> str:
    axis, two, ball = told.summary["motion"]["joint_axis"], told.joint["two_axes"], told.joint["ball"]
    if axis is not None:
        return f"direction within {axis['axis_cone95_deg']:.2g}°, place within {axis['point_radius95_mm']:.2g} mm"
    if two is not None:
        return "; ".join(f"axis {k} within {two[f'axis{k}']['cone95_deg']:.2g}°" for k in (1, 2))
    mantissa, _, power = f"{ball['radius95_mm']:.2g}".partition("e-")  # without noise it is very small
    raised = str(int(power or 0)).translate(str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return f"center within {mantissa}{f'·10⁻{raised}' if power else ''} mm"


def test_the_page_tells_how_many_entries_are_filled_in(told: Told) -> None:
    said = rows_of(told)
    filled = sum(value != MISSING for value in said.values())
    page = (told.folder / "report.html").read_text(encoding="utf-8")
    assert f"{filled} of {len(said)} entries are filled in" in page
    assert page.count(f'<span class="badge warn">{MISSING}</span>') == len(said) - filled
    assert 0 < filled < len(said)


def test_the_text_beside_the_page_says_the_same(told: Told) -> None:
    """Methods, references and checklist of the page, in `methods.txt`."""
    text = (told.folder / "methods.txt").read_text(encoding="utf-8")
    methods, references, checklist = re.fullmatch(
        r"Methods\n\n(.+)\n\nReferences\n\n(.+)\n\nReporting checklist\n\n(.+)\n", text, re.S
    ).groups()  # type: ignore[union-attr]
    assert methods in told.page.texts
    assert all(reference in told.page.texts for reference in references.splitlines())
    said = {title: f"[{MISSING}]" if value == MISSING else value for title, value in rows_of(told).items()}
    assert checklist.splitlines() == [f"{title}: {value}" for title, value in said.items()]


# Other outcomes, in memory.


def entries(view: TrialView) -> dict[str, str | None]:
    found = [Entry(*one) for one in checklist_of(view)]
    assert len({one.title for one in found}) == len(found)
    return dict(found)


@pytest.fixture(scope="module")
def recording() -> Recording:
    return simulate_trial(frames=120, inversion=58, joint_type="hinge", proximal="moving", seed=2).recording


def view(recording: Recording, **settings: Any) -> TrialView:
    return view_of(analyze(recording, Settings(**settings)))


def test_of_what_is_chosen_the_choice_is_told(recording: Recording) -> None:
    chosen: dict[str, Any] = {"lowpass_hz": 6.0, "resample_hz": 50.0, "skin_motion": (4.0, 3.0), "joint_type": "hinge"}
    found = entries(view(recording, **chosen, axis_sd_deg=2.0, marker_noise_mm=0.2))
    assert found["Sampling rate and length"] is None
    assert found["Resampling"] == "to 50 Hz by screw linear interpolation; 60 frames"
    assert found["Filter"] == "Butterworth of order 2, forward and backward, 6 Hz"
    stated = "motion of each cluster as a whole of 4 mm and 3° was stated and is in the intervals"
    assert found["Soft-tissue motion"] == stated
    assert found["Axes"] == "helical axes where the direction's standard deviation is 2° or less"
    assert found["Joint"] == "a hinge (stated); axis of a hinge by maximum likelihood of all relative poses"
    assert found["File"] is None
    assert found["Side"] is None
    assert "Landmarks" not in found
    assert "Axis and epicondyles" not in found
    automatic = entries(view(recording, lowpass_hz="auto", skin_motion=(4.0,), cycles=((0.0, 1.15),)))
    cutoff = r"Butterworth of order 2, forward and backward, [\d.]+ Hz, chosen by residual analysis"
    assert re.fullmatch(cutoff, str(automatic["Filter"]))
    assert automatic["Soft-tissue motion"] == stated.replace(" and 3°", "")
    assert str(automatic["Movement cycles"]).startswith("1, as given by --cycles, lasting ")


def test_of_orientations_alone_sensors_are_spoken_of(recording: Recording) -> None:
    turned = replace(recording, bodies=tuple(body.without_positions() for body in recording.bodies))
    found = entries(view(turned))
    assert found["Poses"] == "orientations alone, as the measuring system gave them"
    assert "that of a sensor" in str(found["Coordinate systems"])
    assert found["Markers, forearm"] is None
    assert found["Marker residuals, forearm"] is None
    assert found["Noise that error bars rest on"] is None
    assert str(found["Interval of the joint"]).startswith("95 % for the sensors' frames, ")
    assert "mm" not in str(found["Interval of the joint"])


def test_a_line_of_text_an_entry(recording: Recording) -> None:
    shown = view(recording)
    lines, found = checklist_lines(shown), entries(shown)
    assert len(lines) == len(found)
    for line, (title, text) in zip(lines, found.items(), strict=True):
        assert line == f"{title}: {f'[{MISSING}]' if text is None else text}"
        assert "\n" not in line
