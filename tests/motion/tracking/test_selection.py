"""Which body is arm and which forearm: never by a guess."""

from __future__ import annotations

import numpy as np
import pytest

from elbowscrew import Recording, RigidBody
from elbowscrew.errors import SettingError
from elbowscrew.joints import segment_of
from elbowscrew.motion.tracking.selection import choose_bodies


def recording(*names: str) -> Recording:
    quat, position = np.tile([1.0, 0, 0, 0], (3, 1)), np.zeros((3, 3))
    bodies = [
        RigidBody.from_quaternions(name, quat, position, identifier=f"0{k}ABCDEF0123456789ABCDEF01234567")
        for k, name in enumerate(names)
    ]
    return Recording.from_bodies(bodies, rate_hz=100)


@pytest.mark.parametrize(
    ("name", "segment"),
    [
        ("Upper Arm", "upper arm"), ("upperarm", "upper arm"),
        ("RIGHT_UPPER-ARM", "upper arm"), ("RightArm", "upper arm"),
        ("rightarm", "upper arm"),
        ("humerus", "upper arm"), ("L.Humerus 02", "upper arm"), ("arm", "upper arm"),
        ("Forearm", "forearm"), ("fore arm", "forearm"), ("ForeArm_L", "forearm"), ("lower-arm", "forearm"),
        ("LeftForearm", "forearm"), ("leftforearm", "forearm"), ("Ulna", "forearm"), ("RADIUS", "forearm"),
        ("alarm", None), ("charm", None), ("Rigid Body 1", None), ("farm", None), ("armadillo", None), ("", None),
    ],
)  # fmt: skip
def test_names_that_speak(name: str, segment: str | None) -> None:
    found = segment_of(name)
    assert (None if found is None else found.name) == segment


def test_names_that_speak_choose() -> None:
    proximal, distal = choose_bodies(recording("Tool", "Forearm R", "Upper Arm R"), None, None)[:2]
    assert proximal is not None
    assert (proximal.name, distal.name) == ("Upper Arm R", "Forearm R")


@pytest.mark.parametrize(
    "names",
    [
        ("Rigid Body 1", "Rigid Body 2"),
        ("Left Arm", "Right Arm", "Forearm"),
        ("Arm", "Left Forearm", "Right Forearm"),
        ("Arm", "Rigid Body 2"),
        ("Forearm", "Rigid Body 2"),
        ("Left Arm", "Right Forearm"),
    ],
)
def test_what_is_ambiguous_is_an_error_that_lists_the_bodies(names: tuple[str, ...]) -> None:
    with pytest.raises(SettingError) as caught:
        choose_bodies(recording(*names), None, None)
    assert all(repr(name) in str(caught.value) for name in names)


def test_a_single_body_is_the_forearm_of_a_still_arm() -> None:
    proximal, distal = choose_bodies(recording("Rigid Body 1"), None, None)[:2]
    assert proximal is None
    assert distal.name == "Rigid Body 1"


def test_a_single_body_that_calls_itself_arm_is_no_forearm_unasked() -> None:
    with pytest.raises(SettingError, match="--distal 'Upper Arm'"):
        choose_bodies(recording("Upper Arm"), None, None)
    assert choose_bodies(recording("Upper Arm"), None, "Upper Arm")[1].name == "Upper Arm"


def test_a_still_arm_on_request() -> None:
    proximal, distal = choose_bodies(recording("table", "Forearm"), "none", None)[:2]
    assert proximal is None
    assert distal.name == "Forearm"


def test_bodies_by_name_by_case_and_by_id() -> None:
    several = recording("A", "a", "B")
    for given in ("A", "00ABCDEF0123456789ABCDEF01234567", "abcdef0123456789abcdef01234567"):
        proximal, _ = choose_bodies(several, given, "b")[:2]
        assert proximal is several.bodies[0]


def test_names_that_stand_twice_need_the_id() -> None:
    twins = recording("Red", "Red")
    with pytest.raises(SettingError, match="give the id"):
        choose_bodies(twins, "Red", twins.bodies[1].identifier)
    proximal, distal = choose_bodies(twins, twins.bodies[1].identifier, twins.bodies[0].identifier)[:2]
    assert proximal is twins.bodies[1]
    assert distal is twins.bodies[0]


def test_unknown_bodies_and_one_body_for_both_are_errors() -> None:
    with pytest.raises(SettingError, match="no such body; the file has 'Arm'"):
        choose_bodies(recording("Arm", "Forearm"), "Leg", None)
    with pytest.raises(SettingError, match="both as proximal and as distal"):
        choose_bodies(recording("Arm", "Forearm"), "Arm", "Arm")
    with pytest.raises(SettingError, match="no such body"):
        choose_bodies(recording("Rigid Body 1"), "Arm", None)
