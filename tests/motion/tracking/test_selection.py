"""Which body is arm and which forearm: never by a guess."""

from __future__ import annotations

import numpy as np
import pytest

from elbowscrew import Recording, RigidBody
from elbowscrew.errors import SettingError
from elbowscrew.joints import segment_of, side_between, side_of
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


@pytest.mark.parametrize(
    ("proximal", "distal", "joint", "side"),
    [
        ("UA_R", "FA_R", "elbow", "right"),
        ("r_uarm_4X4", "r_larm_4X4", "elbow", "right"),
        ("LUArm", "LFArm", "elbow", "left"),
        ("Oberarm rechts", "Unterarm rechts", "elbow", "right"),
        ("Bras G", "Avant-bras G", "elbow", "left"),
        ("Forearm L", "Hand L", "wrist", "left"),
        ("Avant-bras", "Main", "wrist", None),
        ("R_Thigh", "R_Shank", "knee", "right"),
        ("femur_l", "tibia_l", "knee", "left"),
        ("Oberschenkel", "Unterschenkel", "knee", None),
        ("Cuisse", "Jambe", "knee", None),
        ("Tibia", "Calcaneus", "ankle", None),
        ("Unterschenkel links", "Fuß links", "ankle", "left"),
        ("Pelvis", "Femur_R", "hip", "right"),
        ("Becken", "Oberschenkel", "hip", None),
        ("Scapula", "Humerus", "shoulder", None),
        ("Tronc", "Bras", "shoulder", None),
        ("Proximal Phalanx", "Distal Phalanx", "finger", None),
        ("Phalanx proximalis", "Phalanx media", "finger", None),
        ("Grundglied", "Endglied", "finger", None),
    ],
)
def test_joints_by_the_names_of_their_bodies(proximal: str, distal: str, joint: str, side: str | None) -> None:
    chosen = choose_bodies(recording("Tool", distal, proximal), None, None)
    assert chosen.proximal is not None
    assert (chosen.proximal.name, chosen.distal.name, chosen.joint.name) == (proximal, distal, joint)
    assert side_between(proximal, distal) == side


@pytest.mark.parametrize(
    "name",
    [
        "Hand tool",
        "main camera",
        "pied camera",
        "armrest",
        "larm",
        "leftover",
        "radius gauge",
    ],
)
def test_false_friends_do_not_speak(name: str) -> None:
    assert segment_of(name) is None


@pytest.mark.parametrize("name", ["re-test arm", "leftover", "alarm", "Forearm D", "Arm L or R"])
def test_names_that_say_no_side(name: str) -> None:
    assert side_of(name) is None


def test_a_robot_arm_beside_an_upper_arm_is_no_silent_choice() -> None:
    with pytest.raises(SettingError, match="'robot arm'"):
        choose_bodies(recording("robot arm", "Upper Arm", "Forearm"), None, None)


def test_bodies_of_different_sides() -> None:
    bodies = recording("Upper Arm L", "Forearm R")
    with pytest.raises(SettingError) as caught:
        choose_bodies(bodies, None, None)
    for word in ("'Upper Arm L'", "'Forearm R'", "left", "right", "--proximal", "--distal"):
        assert word in str(caught.value)
    assert [one.code for one in choose_bodies(bodies, "#1", "#2").warnings] == ["sides-differ"]


def test_several_joints_are_listed_and_joint_decides() -> None:
    bodies = recording("Upper Arm", "Forearm", "Hand")
    with pytest.raises(SettingError, match=r"elbow: .*wrist: .*--joint"):
        choose_bodies(bodies, None, None)
    assert choose_bodies(bodies, None, None, "elbow").distal.name == "Forearm"
    assert choose_bodies(bodies, None, None, "wrist").distal.name == "Hand"


@pytest.mark.parametrize(
    ("names", "joint", "why"),
    [
        (("Rigid Body 1", "Rigid Body 2"), None, "no names say which"),
        (("Rigid Body 1", "Rigid Body 2"), "knee", "no names speak of the knee"),
        (("Thigh", "Shank"), "elbow", "no names speak of the elbow"),
        (
            ("L Thigh", "L Shank", "R Thigh", "R Shank"),
            None,
            r"2 choices \('L Thigh' and 'L Shank'; 'R Thigh' and 'R Shank'\)",
        ),
    ],
)
def test_a_joint_is_not_advised_where_it_decides_nothing(names: tuple[str, ...], joint: str | None, why: str) -> None:
    with pytest.raises(SettingError, match=why) as caught:
        choose_bodies(recording(*names), None, None, joint)
    assert "--joint" not in str(caught.value)
    assert "--proximal NAME and --distal NAME" in str(caught.value)


@pytest.mark.parametrize("given", [("none", None), ("Plate", None)])
def test_a_joint_is_advised_where_it_decides(given: tuple[str, None]) -> None:
    bodies = recording("Plate", "Forearm", "Hand")
    with pytest.raises(SettingError, match=r"2 choices .*--joint elbow"):
        choose_bodies(bodies, *given)
    assert choose_bodies(bodies, *given, "wrist").distal.name == "Hand"


def test_a_joint_that_the_names_contradict_is_warned_of() -> None:
    chosen = choose_bodies(recording("Upper Arm", "Forearm"), "#1", "#2", "knee")
    assert [one.code for one in chosen.warnings] == ["joint-differs"]


def test_a_name_that_is_nearly_a_bodys_is_asked_back() -> None:
    bodies = [RigidBody.from_quaternions(name, [[1.0, 0, 0, 0]], np.zeros((1, 3))) for name in ("Upper Arm", "Forearm")]
    recording = Recording.from_bodies(bodies, rate_hz=100.0)
    with pytest.raises(SettingError, match="no such body; did you mean 'Forearm'\\?"):
        choose_bodies(recording, None, "forarm")
