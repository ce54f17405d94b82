"""Captions say what their figures show, with the trial's own numbers."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from drawn_trials import KINDS, drawn_trial
from plain_pages import plain

from elbowscrew import analyze, save_analysis, simulate_trial
from elbowscrew.plots import FIGURES
from elbowscrew.report.captions import caption_of
from elbowscrew.report.trial_page import write_trial_page
from elbowscrew.results.proof import proof_of
from elbowscrew.view.figure_names import FIGURE_ENTRIES, has_figure
from elbowscrew.view.long_trials import shown_part


@pytest.mark.parametrize("name", FIGURE_ENTRIES)
def test_every_figure_has_a_caption_of_plain_sentences(name: str) -> None:
    for kind in KINDS:
        view = drawn_trial(kind)
        if has_figure(name, view):
            text = caption_of(name, view)
            assert text.endswith(f"{view.frame.size} frames at 100 Hz."), text
            assert text == " ".join(text.split())
            assert not re.search(r"nan|inf|None|[{}]|\.\.|\.,", text), text


def test_the_interval_is_told_and_the_band_where_there_is_one() -> None:
    view = drawn_trial("multi-cycle")
    for sd, told in ((0.002, "too narrow to be drawn"), (0.02, "orange band")):
        shown = replace(view, angle_sd=np.full(view.frame.size, sd))
        half = np.degrees(1.959964 * sd)
        assert f"95 % interval of θ by the noise of the poses: ±{half:.2g} deg (median; {told})" in caption_of(
            "theta", shown
        )
        labels = [label for ax in FIGURES["theta"](shown).axes for label in ax.get_legend_handles_labels()[1]]
        assert ("95 % interval" in labels) == (told == "orange band")
    unknown = replace(view, angle_sd=np.full(view.frame.size, np.nan))
    assert "The uncertainty of θ is not known." in caption_of("theta", unknown)


def test_the_deviation_of_cycles_is_drawn_where_it_can_be_seen_and_told_where_it_cannot() -> None:
    view = drawn_trial("multi-cycle")
    curve = view.repetition_curve
    assert curve is not None
    narrow = "the standard deviation is 0.057 deg at most"
    for sd, told in (
        (0.001, f"of each other, and {narrow}."),
        (0.1, "one standard deviation to either side (grey band)"),
    ):
        shown = replace(view, repetition_curve={**curve, "theta_sd": np.full(101, sd)})
        assert told in caption_of("cycles", shown)
        labels = [label for ax in FIGURES["cycles"](shown).axes for label in ax.get_legend_handles_labels()[1]]
        assert ("± standard deviation" in labels) == (sd == 0.1)


def test_cycles_that_the_mean_would_hide_are_told_by_what_they_span() -> None:
    view = drawn_trial("multi-cycle")
    curves = np.degrees(view.extra["cycles"]["angle"].reshape(-1, 101))
    most = f"{np.ptp(curves, axis=0).max():.2g}"
    text = caption_of("cycles", view)
    assert f"time: mean (black). Too narrow to be drawn: all cycles lie within {most} deg of each other, and" in text
    apart = view.extra["cycles"]["angle"] + 0.1 * (view.extra["cycles"]["cycle"] == 1)
    spread = replace(view, extra={**view.extra, "cycles": {**view.extra["cycles"], "angle": apart}})
    assert "time: each (thin grey), mean (black). Too narrow to be drawn: the" in caption_of("cycles", spread)


def test_captions_of_a_long_trial_count_what_its_stretch_has() -> None:
    view = drawn_trial("long")
    shown, stretch = shown_part(view)
    assert stretch is not None
    lost = int((~shown.valid & ~shown.filled).sum())
    assert 0 < lost < int((~view.valid & ~view.filled).sum())
    for name in ("theta", "euler_parameters", "velocity", "anatomy", "joint_angles", "fig7"):
        assert f"not tracked ({lost} frames)" in caption_of(name, view), name
    assert f"not tracked ({int((~view.valid & ~view.filled).sum())} frames)" in caption_of("error", view)
    # A band that is seen beside the stretch, whose uncertainty is known there alone.
    sd = np.full(view.frame.size, 1e-9)
    sd[stretch.first : stretch.end] = 0.02
    assert f"±{np.degrees(1.959964 * 0.02):.2g} deg (median; orange band)" in caption_of(
        "theta", replace(view, angle_sd=sd)
    )


@pytest.mark.parametrize("kind", KINDS)
def test_captions_name_the_letters_that_the_panels_have(kind: str) -> None:
    view = drawn_trial(kind)
    for name in ("velocity", "quality", "joint_angles", "anatomy", "fig7", "fig10", "error", "joint"):
        if has_figure(name, view):
            letters = {ax.get_title(loc="left") for ax in FIGURES[name](view, width_mm=85.0).axes} - {""}
            named = set(re.findall(r"[a-h]", " ".join(re.findall(r"\(([a-h](?:, [a-h])*)\)", caption_of(name, view)))))
            assert named == ({"a"} if letters and name.startswith("fig") else letters), name


def test_each_of_the_joints_angles_has_its_own_interval() -> None:
    view = drawn_trial("two axes")
    assert view.joint_angles is not None
    angle = view.joint_angles.angle * [1.0, 0.02]  # the second is flat beside the first
    sd = np.full(angle.shape, [0.001, 0.002])
    shown = replace(view, joint_angles=replace(view.joint_angles, angle=angle, angle_sd=sd))
    halves = [f"{np.degrees(1.959964 * one):.2g} deg" for one in (0.001, 0.002)]
    assert (
        f"95 % intervals (median): Angle 1 ±{halves[0]} (too narrow to be drawn), "
        f"Angle 2 ±{halves[1]} (too narrow to be drawn)."
    ) in caption_of("joint_angles", shown)
    bands = [label for ax in FIGURES["joint_angles"](shown).axes for label in ax.get_legend_handles_labels()[1]]
    assert "95 % interval" not in bands
    sd[:, 1] = np.nan
    shown = replace(view, joint_angles=replace(view.joint_angles, angle_sd=np.where(np.isnan(sd), sd, 0.1)))
    assert "(orange band), Angle 2 not known." in caption_of("joint_angles", shown)


def test_what_is_not_drawn_is_not_told() -> None:
    view = drawn_trial("two axes")
    text = caption_of("joint", view)
    assert "(c) Axis 1 in the upper arm's frame and (d) axis 2 in the forearm's, with what holds 95 % (orange)," in text
    assert "origins and markers" in text
    bare = replace(view, proximal_markers=None, distal_markers=None)
    assert "markers" not in caption_of("joint", bare)
    assert "the markers of the forearm and the origins" in caption_of("joint", replace(view, proximal_markers=None))
    two: Any = {**view.joint_summary["two_axes"]}  # type: ignore[dict-item]
    for unknown, told in ((["axis1"], "(orange where it is known)"), (["axis1", "axis2"], "no 95 % interval is known")):
        lines = {name: {**two[name], "cone95_deg": None} for name in unknown}
        summary: Any = {**view.joint_summary, "two_axes": {**two, **lines}}
        assert told in caption_of("joint", replace(view, joint_summary=summary))
    assert "grey" in caption_of("joint_axis", view)
    assert "grey" not in caption_of("joint_axis", replace(view, spread95=(np.nan, np.nan)))


def test_velocities_have_a_sense_where_theta_has_one() -> None:
    view = drawn_trial("two axes")
    assert "positive as θ grows, and (b) velocity along it" in caption_of("velocity", view)
    assert "No velocity along it is given below 0.25 rad/s." in caption_of("velocity", view)
    summary: Any = {**view.summary, "motion": {**view.summary["motion"], "signed": False}}
    assert "positive" not in caption_of("velocity", replace(view, summary=summary))
    turning = caption_of("velocity", drawn_trial("orientations"))
    assert "along" not in turning
    assert "rad/s" not in turning


def test_captions_stand_beside_the_figures_and_on_the_page(tmp_path: Path) -> None:
    analysis = analyze(simulate_trial(frames=80, inversion=40).recording)
    folder = save_analysis(analysis, tmp_path / "r", figure_formats=("svg",))
    text = (folder / "figures" / "theta.caption.txt").read_text(encoding="utf-8")
    assert text.startswith("Rotation angle θ of the forearm")
    assert proof_of(folder).has("figures/theta.caption.txt")
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert text.strip() in plain(page)
    write_trial_page(folder)
    assert (folder / "report.html").read_text(encoding="utf-8") == page
    bare = save_analysis(analysis, tmp_path / "bare", figure_formats=())
    assert not (bare / "figures").exists()
    assert text.strip() not in plain((bare / "report.html").read_text(encoding="utf-8"))


def test_frames_and_a_single_angle_are_named_in_the_joints_words() -> None:
    for kind, told in (
        ("short", "the forearm's frame at the reference"),
        ("wandering", "the upper arm's frame"),
        ("multi-cycle", "the laboratory frame, upper arm as at the reference"),
    ):
        for name in ("axis", "instantaneous_axes", "joint_axis"):
            assert f"in {told}: (a) in space" in caption_of(name, drawn_trial(kind))
    view = drawn_trial("short")
    assert "Joint angle ±" in caption_of("joint_angles", view)
    assert FIGURES["joint_angles"](view).axes[0].get_ylabel() == "Joint angle (deg)"
