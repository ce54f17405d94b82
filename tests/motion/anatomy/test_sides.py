"""Landmarks of one side with bodies of the other: the signs of the angles hang on it, so that it is said."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from elbowscrew import Recording, Settings, analyze, simulate_trial
from elbowscrew.errors import SettingError
from elbowscrew.model.anatomy import Landmark, LandmarkFrame, Landmarks, Side

PLACES: dict[str, tuple[LandmarkFrame, list[float]]] = {
    "GH": ("proximal", [0.0, 0.16, 0.0]),
    "EL": ("proximal", [0.04, -0.13, 0.01]),
    "EM": ("proximal", [-0.03, -0.13, 0.02]),
    "US": ("distal", [-0.02, -0.12, 0.0]),
    "RS": ("distal", [0.03, -0.12, 0.0]),
}


def landmarks(side: Side) -> Landmarks:
    marks: dict[str, Any] = {
        name: Landmark(point=np.array(point), frame=frame) for name, (frame, point) in PLACES.items()
    }
    return Landmarks(side=side, source="arm.toml", **marks)


def recording(side: Side | None, **changes: Any) -> Recording:
    return simulate_trial(side=side, frames=80, inversion=40, seed=1, **changes).recording


@pytest.mark.parametrize("side", ["left", "right"])
def test_landmarks_of_the_other_side_are_refused_with_both_sides(side: Side) -> None:
    other: Side = "right" if side == "left" else "left"
    with pytest.raises(SettingError, match="proximal and distal") as caught:
        analyze(recording(side), landmarks=landmarks(other))
    told = str(caught.value)
    assert caught.value.exit_code == 4
    assert f"the landmarks are of the {other} side" in told
    assert f"'{side.title()} Upper Arm' and '{side.title()} Forearm' of the {side} one" in told
    assert f'side = "{side}"' in told
    assert "\n" not in told


def test_bodies_named_by_options_are_taken_with_a_warning() -> None:
    settings = Settings(proximal="Left Upper Arm", distal="Left Forearm")
    analysis = analyze(recording("left"), settings, landmarks=landmarks("right"))
    found = [warning for warning in analysis.warnings if warning.code == "landmarks-side"]
    assert len(found) == 1
    assert found[0].severity == "warning"
    assert "right side" in found[0].message
    with pytest.raises(SettingError, match="landmarks are of the right side"):
        analyze(recording("left"), Settings(distal="Left Forearm"), landmarks=landmarks("right"))


def test_beside_a_still_body_the_distal_one_tells_the_side() -> None:
    still = Settings(proximal="none")
    with pytest.raises(SettingError, match="give distal if that is meant"):
        analyze(recording("left"), still, landmarks=landmarks("right"))
    named = Settings(proximal="none", distal="Left Forearm")
    codes = [warning.code for warning in analyze(recording("left"), named, landmarks=landmarks("right")).warnings]
    assert codes.count("landmarks-side") == 1


@pytest.mark.parametrize("side", ["left", "right"])
def test_sides_that_agree_or_are_not_told_are_left_alone(side: Side) -> None:
    plain = recording(None)
    nameless = replace(plain, bodies=tuple(replace(body, name=f"RB {k}") for k, body in enumerate(plain.bodies, 1)))
    for one, settings in ((recording(side), Settings()), (nameless, Settings(proximal="RB 1", distal="RB 2"))):
        analysis = analyze(one, settings, landmarks=landmarks(side))
        assert "landmarks-side" not in [warning.code for warning in analysis.warnings]


def test_landmarks_of_an_elbow_are_refused_with_a_knee() -> None:
    with pytest.raises(SettingError, match="landmarks are for the elbow, and the joint is the knee") as caught:
        analyze(recording("right", joint="knee"), landmarks=landmarks("right"))
    assert caught.value.exit_code == 4
    assert "or give FLE, FME, HC, LC, MC, LM, MM" in str(caught.value)
    knee = simulate_trial(joint="knee", frames=80, inversion=40).landmarks
    with pytest.raises(SettingError, match="landmarks are for the knee, and the joint is the elbow"):
        analyze(recording("right"), landmarks=knee)
