"""A word for a frame means one end of the joint, and where it cannot it is said which words can."""

from __future__ import annotations

import pytest

from elbowscrew.errors import SettingError
from elbowscrew.joints import GENERIC, JOINTS, Joint, joints_of
from elbowscrew.motion.screws.frames import frame_called

KNEE = joints_of("knee")[0]


@pytest.mark.parametrize("word", ["distal", "proximal", "lab"])
def test_the_plain_words_are_themselves_in_every_joint(word: str) -> None:
    for joint in (KNEE, GENERIC):
        assert frame_called(word, joint) == (word, ())


def test_a_segment_of_another_joint_is_refused_with_this_ones() -> None:
    with pytest.raises(SettingError) as caught:
        frame_called("forearm", KNEE)
    text = str(caught.value)
    assert text.startswith("--express-in forearm: the joint is the knee, between thigh and shank; ")
    assert text.endswith("; expected one of distal, proximal, lab, thigh, shank")


@pytest.mark.parametrize("joint", JOINTS, ids=lambda joint: f"{joint.name}-{joint.proximal.short}")
def test_a_joints_own_words_are_its_ends_whatever_they_are_in_others(joint: Joint) -> None:
    assert frame_called(joint.proximal.short, joint) == ("proximal", ())
    assert frame_called(joint.distal.short, joint) == ("distal", ())


@pytest.mark.parametrize(("word", "end"), [("pelvis", "proximal"), ("foot", "distal"), ("hand", "distal")])
def test_a_word_that_is_one_end_in_every_joint_needs_no_joint(word: str, end: str) -> None:
    assert frame_called(word, GENERIC) == (end, ())


def test_a_word_of_several_joints_needs_the_joint() -> None:
    """A thigh is the hip's distal segment and the knee's proximal one."""
    with pytest.raises(SettingError) as caught:
        frame_called("thigh", GENERIC)
    assert str(caught.value).startswith("--express-in thigh: proximal in one joint and distal in another")
    assert str(caught.value).endswith("give --joint, or --express-in proximal or distal")


@pytest.mark.parametrize(("word", "end"), [("arm", "proximal"), ("forearm", "distal")])
def test_an_elbows_words_are_taken_for_an_elbows_with_a_warning(word: str, end: str) -> None:
    found, (warning,) = frame_called(word, GENERIC)
    assert found == end
    assert warning.code == "joint-not-known"
    assert warning.message.startswith(f"--express-in {word} is taken for the {end} body, as in an elbow: ")
    assert warning.message.endswith("; give --joint")
