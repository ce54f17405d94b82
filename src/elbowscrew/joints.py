"""The joints by their own words: what their two segments are called, and which names of bodies speak of them.

Inside the program the segments are proximal and distal; what a reader sees takes its words from here.
"""

from __future__ import annotations

import itertools
import re
import unicodedata
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final, Literal


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
        As given to ``--joint``: one of `JOINT_NAMES`, or ``joint``.
    proximal, distal : Segment
    angles : tuple of str
        Names of the rotations about the first, second and third axis of its anatomical sequence.
    """

    name: str
    proximal: Segment
    distal: Segment
    angles: tuple[str, str, str]

    @property
    def angle_keys(self) -> tuple[str, ...]:
        """The angles' names as keys and attributes have them."""
        return tuple(name.replace(" ", "_") for name in self.angles)


def _segment(name: str, *spoken: str, short: str = "") -> Segment:
    return Segment(name=name, short=short or name, spoken=frozenset(spoken))


# English, German and French; Latin bones are the same in all three. Names are looked up without accents; two words
# also stand for the two written together ("upper arm", "upperarm").
_TRUNK: Final = _segment("trunk", "trunk", "torso", "thorax", "chest", "rumpf", "brustkorb", "tronc")
_SCAPULA: Final = _segment("scapula", "scapula", "shoulder blade", "schulterblatt", "omoplate")
_UPPER_ARM: Final = _segment(
    "upper arm", "arm", "upper arm", "humerus", "uarm", "ua", "oberarm", "bras", "haut bras", short="arm"
)
_FOREARM: Final = _segment(
    "forearm", "fore arm", "lower arm", "ulna", "radius", "larm", "fa", "unterarm", "vorderarm", "avant bras", "cubitus"
)
_HAND: Final = _segment("hand", "hand", "metacarpus", "carpus", "handwurzel", "main")
_PELVIS: Final = _segment("pelvis", "pelvis", "sacrum", "becken", "bassin")
_THIGH: Final = _segment("thigh", "thigh", "femur", "upper leg", "up leg", "uleg", "oberschenkel", "cuisse")
_SHANK: Final = _segment(
    "shank", "shank", "shin", "tibia", "lower leg", "lleg", "calf", "fibula", "unterschenkel", "schienbein", "wade",
    "jambe", "perone",
)  # fmt: skip
_FOOT: Final = _segment(
    "foot", "foot", "calcaneus", "talus", "hind foot", "rear foot", "heel", "fuss", "ruckfuss", "pied"
)
_METACARPAL: Final = _segment("metacarpal", "metacarpal", "mittelhand", "mittelhandknochen", "metacarpien")
_PROXIMAL_PHALANX: Final = _segment(
    "proximal phalanx", "proximal phalanx", "phalanx proximal", "phalanx proximalis", "phalange proximale",
    "grundglied", "grundphalanx", "pp",
)  # fmt: skip
_MIDDLE_PHALANX: Final = _segment(
    "middle phalanx", "middle phalanx", "phalanx middle", "phalanx media", "intermediate phalanx",
    "phalanx intermedia", "phalange intermediaire", "phalange moyenne", "mittelglied", "mittelphalanx",
)  # fmt: skip
_DISTAL_PHALANX: Final = _segment(
    "distal phalanx", "distal phalanx", "phalanx distal", "phalanx distalis", "phalange distale", "endglied",
    "endphalanx", "dp",
)  # fmt: skip
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

_SEGMENTS: Final = tuple(dict.fromkeys(segment for joint in JOINTS for segment in (joint.proximal, joint.distal)))

_SIDES: Final = {
    "left": "left", "l": "left", "links": "left", "linker": "left", "linke": "left", "gauche": "left",
    "right": "right", "r": "right", "rechts": "right", "rechter": "right", "rechte": "right", "droit": "right",
    "droite": "right",
}  # fmt: skip
_LAST_SIDES: Final = {"li": "left", "re": "right"}
"""German abbreviations, understood at the end of a name only: ``Oberarm re``, but not ``re-test``."""
_FRENCH_SIDES: Final = {"g": "left", "d": "right"}
_FRENCH: Final = frozenset(
    {"bras", "main", "pied", "jambe", "cuisse", "tronc", "bassin", "omoplate", "phalange", "metacarpien", "perone"}
)

# Words that mean something else in other company ("main camera", "hand tool", "pied" of a tripod): they
# speak of a segment only where nothing but sides, numbers, single letters and neutral words stands beside them, or
# where they end a name that says a side ("Anna left hand").
_SHY: Final = frozenset(
    {
        "ua", "fa", "bras", "radius", "hand", "main", "foot", "heel", "pied", "calf", "wade", "trunk", "chest",
        "pp", "dp", "proximal", "distal", "up leg",
    }
)  # fmt: skip
_NEUTRAL: Final = frozenset(
    {
        "cluster", "marker", "markers", "rigid", "body", "segment", "bone", "rb", "plate", "subject", "patient",
        "skeleton", "finger", "index", "thumb", "ring", "little", "proximal", "distal", "middle", "zeigefinger",
        "daumen", "pouce",
    }
)  # fmt: skip
# Needs another word for the side: alone it is the lower arm, or the left one.
_SIDED: Final = frozenset({"larm", "lleg"})
_UNCUT: Final = re.compile(r"(?<![^\W\d_])([LR])([UFL])(ARM|Arm|LEG|Leg)(?![^\W\d_])")
_UNCUT_SHORT: Final = re.compile(r"(?<![^\W\d_])([LR])(UA|FA)(?![^\W\d_])")
_LEVELS: Final = {"U": "upper", "F": "fore", "L": "lower"}


def segment_of(name: str) -> Segment | None:
    """Say which segment a body's name speaks of, None where it does not, or of more than one.

    Any case, any separators, a side or a number beside it: ``Right_Upper-Arm 2`` is an upper arm. Two words say more
    than one: a ``proximal phalanx`` is no proximal segment.

    Examples
    --------
    >>> [found and found.name for found in map(segment_of, ("L ForeArm", "Humerus_01", "RThigh", "alarm"))]
    ['forearm', 'upper arm', 'thigh', None]
    """
    words = _words(name)
    core = [word for word in words if word not in _SIDES]
    sided = len(core) < len(words)
    phrases = {f"{first} {second}" for first, second in itertools.pairwise(core)}
    joined = {_JOINED[phrase.replace(" ", "")] for phrase in phrases if phrase.replace(" ", "") in _JOINED}
    single = {
        word
        for word in core
        if (word not in _SHY or _beside_neutral(word, core) or (sided and word == core[-1]))
        and (word not in _SIDED or sided)
    }
    for spoken, segments in (
        (phrases | joined, _SEGMENTS),
        (single | {_JOINED.get(word, word) for word in single}, _SEGMENTS),
        (single, (_PROXIMAL, _DISTAL)),
    ):
        found = [segment for segment in segments if segment.spoken & spoken]
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
    words = _words(name)
    found = {_SIDES[word] for word in words if word in _SIDES}
    if words[-1:] and words[-1] in _LAST_SIDES:
        found.add(_LAST_SIDES[words[-1]])
    if _FRENCH & set(words):
        found |= {_FRENCH_SIDES[word] for word in words if word in _FRENCH_SIDES}
    return found.pop() if len(found) == 1 else None


def side_between(proximal: str, distal: str) -> str | None:
    """Say which side a joint is on by the names of its two bodies, None where they say none or disagree."""
    sides = {side for side in (side_of(proximal), side_of(distal)) if side is not None}
    return sides.pop() if len(sides) == 1 else None


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


def joint_called(name: str, proximal: str, distal: str) -> Joint:
    """Give the joint with the words that stand in a result; one that is not known here keeps its words.

    Examples
    --------
    >>> joint_called("knee", "thigh", "shank") in JOINTS
    True
    """
    words = name, proximal, distal
    for joint in (*JOINTS, GENERIC):
        if (joint.name, joint.proximal.name, joint.distal.name) == words:
            return joint
    return Joint(name=name, proximal=_segment(proximal), distal=_segment(distal), angles=GENERIC.angles)


_JOINED: Final = {
    phrase.replace(" ", ""): phrase for segment in _SEGMENTS for phrase in segment.spoken if " " in phrase
}
_SINGLE: Final = frozenset({word for segment in _SEGMENTS for word in segment.spoken if " " not in word} | set(_JOINED))
_LONG: Final = frozenset(word for word in _SINGLE if len(word) > 3) - {
    "uarm",
    "larm",
    "uleg",
    "lleg",
    "main",
    "bras",
    "pied",
    "heel",
    "wade",
    "chest",
}
"""Words that may be written together with a side: ``rthigh``, ``lefthand``."""


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
        if joined in _unspaced(joint.proximal):
            found.add("proximal")
        if joined in _unspaced(joint.distal):
            found.add("distal")
    return found


def _unspaced(segment: Segment) -> set[str]:
    return {phrase.replace(" ", "") for phrase in segment.spoken}


def _words(name: str) -> list[str]:
    """Words of a name in lower case without accents, sides apart."""
    spaced = _UNCUT.sub(lambda cut: f"{cut[1]} {_LEVELS[cut[2]]} {cut[3]}", name)
    spaced = _UNCUT_SHORT.sub(r"\1 \2", spaced)
    spaced = re.sub(r"(?<=[^\W\d_])(?=[A-Z][a-z])", " ", re.sub(r"(?<=[a-z])(?=[A-Z])", " ", spaced))
    plain = "".join(sign for sign in unicodedata.normalize("NFD", spaced.casefold()) if not unicodedata.combining(sign))
    return [part for word in re.findall(r"[^\W\d_]+", plain) for part in _apart(word)]


def _apart(word: str) -> tuple[str, ...]:
    """Cut a side off a word that is written together with it."""
    if word in _LONG:
        return (word,)
    for side in ("left", "right", "l", "r"):
        rest = word.removeprefix(side)
        if rest != word and (rest in _LONG or (len(side) > 1 and rest in _SINGLE)):
            return side, rest
    return (word,)


def _beside_neutral(word: str, core: list[str]) -> bool:
    return all(
        other == word or len(other) == 1 or other in _NEUTRAL or other in _LAST_SIDES or other in _SINGLE
        for other in core
    )
