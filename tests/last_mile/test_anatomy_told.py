"""What is said of the bones: on the page, in the methods and on the terminal, in each outcome, from the numbers."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from elbowscrew import Landmark, Recording, Settings, analyze, simulate_trial
from elbowscrew.cli.render import analysis_table
from elbowscrew.model import Landmarks, Marker
from elbowscrew.report.bones_words import bones_sentences
from elbowscrew.report.methods import citations_of, methods_of
from elbowscrew.results.summary import summary_from_analysis
from elbowscrew.results.trial_views import view_of

SHORT: dict[str, Any] = {"frames": 90, "inversion": 40, "seed": 3}


class Told(NamedTuple):
    """What an analysis says of the bones, and its own numbers."""

    anatomy: Any
    page: tuple[str, ...]
    methods: str
    citations: tuple[str, ...]
    terminal: dict[str, str]


def told(recording: Recording, landmarks: Landmarks | None, **settings: Any) -> Told:
    analysis = analyze(recording, Settings(**settings), landmarks=landmarks)
    view, summary = view_of(analysis), summary_from_analysis(analysis)
    lines: list[str] = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("COLUMNS", "1000")
        patch.setattr("elbowscrew.cli.render.emit", lines.append)
        analysis_table(summary, Path("out"))
    terminal = {line[:13].strip(): line[13:].strip() for line in "".join(lines).splitlines()}
    return Told(summary["motion"]["anatomy"], bones_sentences(view), methods_of(view), citations_of(view), terminal)


@pytest.fixture(scope="module")
def hinge() -> Told:
    trial = simulate_trial(side="left", joint_type="hinge", proximal="moving", **SHORT)
    return told(trial.recording, trial.landmarks)


def test_an_axis_is_told_with_its_limits_everywhere(hinge: Told) -> None:
    found = hinge.anatomy
    # Limits of a few hundredths of a degree: they lie about the value, and are not alike.
    assert found["axis_angle_deg_low"] < found["axis_angle_deg"] < found["axis_angle_deg_high"]
    angle, distance = (
        tuple(found[f"{name}{end}"] for end in ("", "_low", "_high")) for name in ("axis_angle_deg", "axis_distance_mm")
    )
    assert hinge.page[0] == (
        f"The joint axis lies {angle[0]:.2f} deg ({angle[1]:.2f} to {angle[2]:.2f}) off the line of the epicondyles "
        f"and passes {distance[0]:.2f} mm ({distance[1]:.2f} to {distance[2]:.2f}) from the joint’s center."
    )
    turn = math.degrees(1.0 / math.dist((37.6, -128.1, 7.5), (-25.6, -130.9, 17.5)))
    assert hinge.page[1].startswith("In brackets stand 95 % limits for the clusters’ frames, from the residuals of the")
    assert hinge.page[1].endswith(
        "the error of the landmarks themselves is not included: each millimeter by which one epicondyle is off turns "
        f"their line by up to {turn:.2f} deg."
    )
    middle = np.mean([[37.6, -128.1, 7.5], [-25.6, -130.9, 17.5]], axis=0) * [-1.0, 1.0, 1.0]
    inside = ", ".join(f"{value:.1f}" for value in middle).replace("-", "−")
    assert f"({inside}) mm in the frame of the upper arm, and" in hinge.page[2]
    assert (
        "were computed by the sequence Z-X-Y of the International Society of Biomechanics (Wu and others 2005) from "
        "landmarks of the left arm (EL, EM, US, RS, GH by coordinates); signs mean the same on both sides."
    ) in hinge.methods
    assert (
        f"The joint axis lies {angle[0]:.2f}° (95 % interval {angle[1]:.2f} to {angle[2]:.2f}°) off the line of the "
        f"epicondyles and passes {distance[0]:.2f} mm (95 % interval {distance[1]:.2f} to {distance[2]:.2f} mm) from "
        "the point midway between them, without the error of the landmarks."
    ) in hinge.methods
    assert hinge.terminal["Epicondyles"].startswith(f"the joint axis is {angle[0]:.2f} deg (")
    assert hinge.terminal["Epicondyles"].endswith(
        "(95 %, for the clusters' frames, without the error of the landmarks: each mm that one of them is off turns "
        f"the line by up to {turn:.2g} deg)"
    )
    assert hinge.terminal["Anatomy"].startswith("left side: flexion ")
    assert sum("Wu G" in citation for citation in hinge.citations) == 1


def test_of_two_axes_the_first_is_named_and_landmarks_of_markers_are_told(hinge: Told) -> None:
    trial = simulate_trial(joint_type="two-axes", proximal="moving", marker_noise_mm=0.1, **SHORT)
    assert trial.landmarks is not None
    arm = trial.recording.bodies[0]
    marker = Marker(name="lateral", position=trial.markers[arm.name][:, 0])
    recording = Recording(**{**vars_of(trial.recording), "markers": (marker,)})
    given: dict[str, Any] = dict(trial.landmarks.by_name)
    said = told(recording, Landmarks(side="right", **{**given, "EL": Landmark(markers=("lateral",))}))
    assert said.anatomy["axis"] == "axis1"
    assert said.page[0].startswith("The first of the two axes lies ")
    assert "(EL from markers; EM, US, RS, GH by coordinates)" in said.methods
    assert "The first of the two axes lies " in said.methods
    assert said.terminal["Epicondyles"].startswith("the first of the two axes is ")


def vars_of(record: Any) -> dict[str, Any]:
    return {name: getattr(record, name) for name in type(record).__dataclass_fields__}


def test_without_an_axis_or_an_interval_this_is_said(hinge: Told) -> None:
    trial = simulate_trial(joint_type="ball", top_deg=70.0, **SHORT)
    ball = told(trial.recording, trial.landmarks)
    assert ball.anatomy["axis"] is None
    assert ball.page[0] == "The motion shows no axis to hold against the line of the epicondyles."
    assert len(ball.page) == len(hinge.page) - 1
    assert "off the line of the epicondyles" not in ball.methods
    assert "from landmarks of the right arm" in ball.methods
    assert ball.terminal["Epicondyles"] == "the motion shows no axis to hold against their line"
    few = simulate_trial(frames=5, inversion=2, rate_hz=2.0, joint_type="hinge", marker_noise_mm=0.3)
    bare = Recording.from_bodies([without_markers(body) for body in few.recording.bodies], rate_hz=2.0)
    unsure = told(bare, few.landmarks, noise="none")
    assert unsure.anatomy["axis"] == "joint_axis"
    assert unsure.anatomy["axis_angle_deg_low"] is None
    assert "(" not in unsure.page[0]
    assert unsure.page[1].startswith("No interval can be given; the error of the landmarks")
    assert "95 % interval" not in unsure.methods
    assert "from the point midway between them." in unsure.methods
    assert "(no interval can be given, without the error" in unsure.terminal["Epicondyles"]


def without_markers(body: Any) -> Any:
    return type(body)(**{**vars_of(body), "marker_offsets": None, "marker_residual": None, "marker_motion": None})


def test_without_landmarks_nothing_is_said_of_bones() -> None:
    said = told(simulate_trial(**SHORT).recording, None)
    assert said.anatomy is None
    assert said.page == ()
    assert "landmarks" not in said.methods
    assert not {"Anatomy", "Epicondyles"} & set(said.terminal)
    assert not any("Wu G" in citation for citation in said.citations)
