"""Numbers of the joint's type and of the laws as the summary has them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from elbowscrew import save_analysis, simulate_trial, summary_from_analysis
from elbowscrew.cli.render_joint import joint_axis_text
from elbowscrew.model import Analysis, PhaseLaw
from elbowscrew.motion.analysis import analyze
from elbowscrew.results.joint_type_summary import numbers_of_type
from elbowscrew.results.summary import law_error


@pytest.fixture(scope="module")
def elbow() -> Analysis:
    return analyze(simulate_trial(frames=200, inversion=95, joint_type="two-axes", marker_noise_mm=0.1).recording)


@pytest.mark.parametrize("cone_deg", [0.5, 8.0, 30.0, 89.9])
def test_a_cone_short_of_a_right_angle_is_told(elbow: Analysis, cone_deg: float) -> None:
    line = told_line(elbow, cone_deg)
    assert line["determined"] is True
    assert line["cone95_deg"] == pytest.approx(cone_deg)
    assert line["radius95_mm"] == pytest.approx(7.0)


@pytest.mark.parametrize("cone_deg", [90.0, 120.0, np.inf, np.nan])
def test_a_cone_of_a_right_angle_or_more_says_nothing(elbow: Analysis, cone_deg: float) -> None:
    line = told_line(elbow, cone_deg)
    assert (line["determined"], line["cone95_deg"], line["radius95_mm"]) == (False, None, None)


def test_an_open_order_is_told_wherever_the_axes_are(elbow: Analysis, tmp_path: Path) -> None:
    """On the terminal, on the page's card, and in its sentences; where the order is known nobody speaks of it."""
    found = elbow.joint_type
    assert found is not None
    assert found.two_axes is not None
    said = {}
    for known in (True, False):
        two = replace(found.two_axes, order_determined=known)
        one = replace(elbow, joint_type=replace(found, status="determined", two_axes=two))
        folder = save_analysis(one, tmp_path / str(known), figure_formats=())
        page = (folder / "report.html").read_text("utf-8")
        terminal = joint_axis_text(summary_from_analysis(one)["motion"], located=True)
        said[known] = [
            "which one is the proximal body's is open" in terminal,
            "which one is the upper arm’s is open" in page,
            "the first in the upper arm, the second in the forearm" not in page,
            "Which axis is that of the upper arm is open" in page,
        ]
    assert said == {True: [False] * 4, False: [True] * 4}


@pytest.mark.parametrize(("located", "what"), [(True, "cluster"), (False, "sensor")])
def test_the_terminal_says_what_the_intervals_of_two_axes_leave_out(elbow: Analysis, located: bool, what: str) -> None:
    told = joint_axis_text(summary_from_analysis(elbow)["motion"], located=located)
    assert f"for the {what}s' frames, " in told
    assert f"; a {what} that turns on its bone with the motion is in it only as --skin-motion states)" in told


def told_line(elbow: Analysis, cone_deg: float) -> dict[str, object]:
    """The first of two axes, as if it were known to so much and 7 mm."""
    found = elbow.joint_type
    assert found is not None
    assert found.two_axes is not None
    axis = replace(found.two_axes.axis1, determined=True, axis_cone=float(np.radians(cone_deg)), point_radius=7e-3)
    known = replace(elbow, joint_type=replace(found, two_axes=replace(found.two_axes, axis1=axis)))
    two = numbers_of_type(known)["two_axes"]
    assert two is not None
    return dict(two["axis1"])


def test_a_laws_error_is_a_length_or_an_angle() -> None:
    law = PhaseLaw("cycloidal", None, 0.02)
    assert law_error(law, as_angle=False) == {"rms_displacement_mm": pytest.approx(20.0), "rms_angle_deg": None}
    assert law_error(law, as_angle=True) == {"rms_displacement_mm": None, "rms_angle_deg": pytest.approx(3.6 / np.pi)}
