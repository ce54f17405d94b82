"""The joints by their own words: what their two segments are called, and which names of bodies speak of them.

Inside the program the segments are proximal and distal; what a reader sees takes its words from here.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final, Literal

JointName = Literal["elbow", "wrist", "knee", "ankle", "hip", "shoulder", "finger"]
"""Names of the joints in `JOINTS`, for type checkers; a test holds the two together."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Segment:
    """A segment of the body.

    Attributes
    ----------
    name : str
        Its name in running text.
    short : str
        The one word it is called by on the command line and in file formats.
    spoken : frozenset of str
        Words, or two words joined, by which a body's name says that it is this segment; lower case.
    """

    name: str
    short: str
    spoken: frozenset[str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Joint:
    """A joint: its name, its two segments, and what its anatomical angles are called.

    Attributes
    ----------
    name : str
        As given to ``--joint``.
    proximal, distal : Segment
    angles : tuple of str
        Names of the rotations about the first, second and third axis of its anatomical sequence.
    """

    name: str
    proximal: Segment
    distal: Segment
    angles: tuple[str, str, str]


def _segment(name: str, *spoken: str, short: str = "") -> Segment:
    return Segment(name=name, short=short or name, spoken=frozenset(spoken))


# English, German and French; Latin bones are the same in all three. Names are looked up without accents.
_TRUNK: Final = _segment("trunk", "trunk", "torso", "thorax", "chest", "rumpf", "brustkorb", "tronc")
_SCAPULA: Final = _segment("scapula", "scapula", "shoulderblade", "schulterblatt", "omoplate")
_UPPER_ARM: Final = _segment(
    "upper arm", "arm", "upperarm", "humerus", "uarm", "ua", "oberarm", "bras", "hautbras", short="arm"
)
_FOREARM: Final = _segment(
    "forearm", "forearm", "lowerarm", "ulna", "radius", "larm", "fa", "unterarm", "vorderarm", "avantbras"
)
_HAND: Final = _segment("hand", "hand", "metacarpus", "carpus", "main")
_PELVIS: Final = _segment("pelvis", "pelvis", "sacrum", "becken", "bassin")
_THIGH: Final = _segment("thigh", "thigh", "femur", "upperleg", "uleg", "oberschenkel", "cuisse")
_SHANK: Final = _segment(
    "shank", "shank", "tibia", "lowerleg", "lleg", "calf", "fibula", "unterschenkel", "schienbein", "jambe"
)
_FOOT: Final = _segment("foot", "foot", "calcaneus", "talus", "hindfoot", "rearfoot", "heel", "fuss", "pied")
_METACARPAL: Final = _segment("metacarpal", "metacarpal", "mittelhand", "metacarpien")
_PROXIMAL_PHALANX: Final = _segment("proximal phalanx", "proximalphalanx", "phalanxproximal", "phalanxproximalis", "pp")
_MIDDLE_PHALANX: Final = _segment(
    "middle phalanx", "middlephalanx", "phalanxmiddle", "phalanxmedia", "intermediatephalanx"
)
_DISTAL_PHALANX: Final = _segment("distal phalanx", "distalphalanx", "phalanxdistal", "phalanxdistalis", "dp")
_PROXIMAL: Final = _segment("proximal segment", "proximal", short="proximal")
_DISTAL: Final = _segment("distal segment", "distal", short="distal")

GENERIC: Final = Joint(name="joint", proximal=_PROXIMAL, distal=_DISTAL, angles=("first", "second", "third"))
"""A joint that neither a name nor a setting says more of."""

_LEG_ANGLES: Final = ("flexion", "adduction", "internal rotation")
_SHOULDER_ANGLES: Final = ("plane of elevation", "elevation", "axial rotation")
_FINGER_ANGLES: Final = ("flexion", "abduction", "axial rotation")

JOINTS: Final = tuple(
    Joint(name=name, proximal=proximal, distal=distal, angles=angles)
    for name, proximal, distal, angles in (
        ("elbow", _UPPER_ARM, _FOREARM, ("flexion", "carrying angle", "pronation")),
        ("wrist", _FOREARM, _HAND, ("flexion", "ulnar deviation", "pronation")),
        ("knee", _THIGH, _SHANK, _LEG_ANGLES),
        ("ankle", _SHANK, _FOOT, ("dorsiflexion", "inversion", "internal rotation")),
        ("hip", _PELVIS, _THIGH, _LEG_ANGLES),
        ("shoulder", _SCAPULA, _UPPER_ARM, _SHOULDER_ANGLES),
        ("shoulder", _TRUNK, _UPPER_ARM, _SHOULDER_ANGLES),
        ("finger", _PROXIMAL_PHALANX, _DISTAL_PHALANX, _FINGER_ANGLES),
        ("finger", _PROXIMAL_PHALANX, _MIDDLE_PHALANX, _FINGER_ANGLES),
        ("finger", _MIDDLE_PHALANX, _DISTAL_PHALANX, _FINGER_ANGLES),
        ("finger", _METACARPAL, _PROXIMAL_PHALANX, _FINGER_ANGLES),
    )
)
"""Every joint; one with several pairs of segments stands once for each, the common one first."""

JOINT_NAMES: Final = tuple(dict.fromkeys(joint.name for joint in JOINTS))
"""What ``--joint`` takes."""

SEGMENTS: Final = tuple(
    dict.fromkeys(segment for joint in (*JOINTS, GENERIC) for segment in (joint.proximal, joint.distal))
)

_SIDES: Final = {
    "left": "left", "l": "left", "links": "left", "linker": "left", "linke": "left", "gauche": "left", "li": "left",
    "right": "right", "r": "right", "rechts": "right", "rechter": "right", "rechte": "right", "droit": "right",
    "droite": "right", "re": "right",
}  # fmt: skip
_LONG_SIDES: Final = ("left", "right")
_ACCENTS: Final = str.maketrans({"é": "e", "è": "e", "ê": "e", "ß": "ss", "ü": "u", "ö": "o", "ä": "a"})


def segment_of(name: str) -> Segment | None:
    """Say which segment a body's name speaks of, None where it does not.

    Any case, any separators, a side or a number beside it: ``Right_Upper-Arm 2`` is an upper arm. Two words say more
    than one: a ``proximal phalanx`` is no proximal segment.

    Examples
    --------
    >>> [found and found.name for found in map(segment_of, ("L ForeArm", "Humerus_01", "RThigh", "alarm"))]
    ['forearm', 'upper arm', 'thigh', None]
    """
    words = [_without_side(word) for word in _words(name)]
    pairs = {first + second for first, second in itertools.pairwise(words)}
    for spoken in (pairs, set(words)):
        found = [segment for segment in SEGMENTS if segment.spoken & spoken]
        if found:
            return found[0] if len(found) == 1 else None
    return None


def side_of(name: str) -> str | None:
    """Say which side a body's name speaks of, "left" or "right", None where it says none or both.

    Examples
    --------
    >>> side_of("Upper Arm L"), side_of("rightThigh"), side_of("Oberarm links"), side_of("shank")
    ('left', 'right', 'left', None)
    """
    found = set()
    for word in _words(name):
        if word in _SIDES:
            found.add(_SIDES[word])
        else:
            found |= {side for side in _LONG_SIDES if word.startswith(side)}
    return found.pop() if len(found) == 1 else None


def joints_of(name: str | None) -> tuple[Joint, ...]:
    """Joints of a name, all of them for None."""
    return tuple(joint for joint in JOINTS if name in (None, joint.name))


def joint_between(proximal: str, distal: str, name: str | None = None) -> Joint:
    """Say which joint lies between two bodies, by the name given for it, else by the bodies' own names.

    Examples
    --------
    >>> joint_between("R_Thigh", "R_Shank").name, joint_between("Body 1", "Body 2").name
    ('knee', 'joint')
    """
    ends = segment_of(proximal), segment_of(distal)
    spoken = [joint for joint in joints_of(name) if (joint.proximal, joint.distal) == ends]
    return spoken[0] if spoken else GENERIC if name is None else joints_of(name)[0]


def ends_called(word: str, joints: Iterable[Joint] = JOINTS) -> set[Literal["proximal", "distal"]]:
    """Say which end of these joints a segment's word means: none, one, or both where joints differ.

    Examples
    --------
    >>> ends_called("femur", joints_of("knee")), sorted(ends_called("thigh")), ends_called("thing")
    ({'proximal'}, ['distal', 'proximal'], set())
    """
    joined = "".join(_words(word))
    found: set[Literal["proximal", "distal"]] = set()
    for joint in joints:
        if joined in joint.proximal.spoken:
            found.add("proximal")
        if joined in joint.distal.spoken:
            found.add("distal")
    return found


def _words(name: str) -> list[str]:
    spaced = re.sub(r"(?<=[^\W\d_])(?=[A-Z][a-z])", " ", re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name))
    return [word.translate(_ACCENTS) for word in re.findall(r"[^\W\d_]+", spaced.casefold())]


def _without_side(word: str) -> str:
    for side in _LONG_SIDES:
        if word.startswith(side) and word != side:
            return word.removeprefix(side)
    return word
