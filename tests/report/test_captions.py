"""Captions say what their figures show, with the trial's own numbers."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from drawn_trials import KINDS, drawn_trial

from elbowscrew import analyze, save_analysis, simulate_trial
from elbowscrew.plots import FIGURES
from elbowscrew.report.captions import caption_of
from elbowscrew.report.trial_page import write_trial_page
from elbowscrew.results.proof import proof_of
from elbowscrew.view.figure_names import FIGURE_ENTRIES, has_figure


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


def test_captions_stand_beside_the_figures_and_on_the_page(tmp_path: Path) -> None:
    analysis = analyze(simulate_trial(frames=80, inversion=40).recording)
    folder = save_analysis(analysis, tmp_path / "r", figure_formats=("svg",))
    text = (folder / "figures" / "theta.caption.txt").read_text(encoding="utf-8")
    assert text.startswith("Rotation angle θ of the forearm")
    assert proof_of(folder).has("figures/theta.caption.txt")
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert text.strip() in page
    write_trial_page(folder)
    assert (folder / "report.html").read_text(encoding="utf-8") == page
    bare = save_analysis(analysis, tmp_path / "bare", figure_formats=())
    assert not (bare / "figures").exists()
    assert text.strip() not in (bare / "report.html").read_text(encoding="utf-8")
