"""Which body is the arm and which the forearm: by name, by id, or by names that speak; never by a guess."""

from __future__ import annotations

import itertools
import re
from typing import Final

from elbowscrew.errors import SettingError
from elbowscrew.model import Recording, RigidBody
from elbowscrew.settings import STILL_ARM

_SIDES: Final = ("left", "right")
_FOREARM: Final = {"forearm", "lowerarm", "ulna", "radius"}
_UPPER_ARM: Final = {"arm", "upperarm", "humerus"}


def choose_bodies(recording: Recording, arm: str | None, forearm: str | None) -> tuple[RigidBody | None, RigidBody]:
    """Choose the two bodies of the joint.

    Parameters
    ----------
    recording : Recording
    arm, forearm : str or None
        Name or id; None to go by the names in the file, and "none" as the arm for an arm that stands still.

    Returns
    -------
    arm : RigidBody or None
        None where the arm stands still: asked for, or only one body in the file (the paper's case).
    forearm : RigidBody

    Raises
    ------
    SettingError
        If a name is not in the file or stands there twice, or if the choice is not clear; the bodies are listed.
    """
    bodies = recording.bodies
    still = arm is not None and arm.casefold() == STILL_ARM and not _named(bodies, arm)
    if len(bodies) == 1 and arm is None:
        name = bodies[0].name
        if forearm is None and segment_of(name) == "arm":
            msg = f"the only body in the file is {name!r}: give --forearm {name!r} if it is the forearm nevertheless"
            raise SettingError(msg)
        return None, bodies[0] if forearm is None else _find(bodies, forearm, "forearm")
    distal = _find(bodies, forearm, "forearm") if forearm is not None else None
    proximal = _find(bodies, arm, "arm") if arm is not None and not still else None
    if distal is None:
        distal = _speaking(bodies, "forearm", taken=proximal)
    if proximal is None and not still:
        proximal = _speaking(bodies, "arm", taken=distal)
    if proximal is not None and arm is None and forearm is None:
        _check_sides(proximal, distal)
    if proximal is distal:
        msg = f"body {distal.name!r} is named both as arm and as forearm; the file has {_listed(bodies)}"
        raise SettingError(msg)
    return proximal, distal


def segment_of(name: str) -> str | None:
    """Say which segment a body's name speaks of: "arm", "forearm", or None.

    Any case, any separators, a side or a number beside it: ``Right_Upper-Arm 2`` is an arm.

    Examples
    --------
    >>> segment_of("L ForeArm"), segment_of("Humerus_01"), segment_of("alarm")
    ('forearm', 'arm', None)
    """
    spaced = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name)
    words = [_without_side(word) for word in re.findall(r"[a-z]+", spaced.casefold())]
    pairs = {first + second for first, second in itertools.pairwise(words)}
    if _FOREARM & (pairs | set(words)):
        return "forearm"
    return "arm" if _UPPER_ARM & (pairs | set(words)) else None


def _check_sides(proximal: RigidBody, distal: RigidBody) -> None:
    sides = [{side for side in _SIDES if side in body.name.casefold()} for body in (proximal, distal)]
    if all(sides) and not sides[0] & sides[1]:
        msg = f"{proximal.name!r} and {distal.name!r} are of different sides; give --arm NAME and --forearm NAME"
        raise SettingError(msg)


def _without_side(word: str) -> str:
    for side in _SIDES:
        if word.startswith(side) and word != side:
            return word.removeprefix(side)
    return word


def _named(bodies: tuple[RigidBody, ...], wanted: str) -> list[RigidBody]:
    """Find the bodies meant: exact name first, then id, then name in any case."""
    key = wanted.strip().casefold()
    return (
        [body for body in bodies if body.name == wanted]
        or [body for body in bodies if body.identifier and _same_id(body.identifier, key)]
        or [body for body in bodies if body.name.strip().casefold() == key]
    )


def _same_id(identifier: str, key: str) -> bool:
    # Motive drops a leading zero of its 32 hexadecimal digits.
    return identifier.casefold() == key or (len(key) > 8 and identifier.casefold().lstrip("0") == key.lstrip("0"))


def _find(bodies: tuple[RigidBody, ...], wanted: str, role: str) -> RigidBody:
    found = _named(bodies, wanted)
    if len(found) == 1:
        return found[0]
    if found:
        ids = " or ".join(repr(body.identifier) for body in found)
        msg = f"--{role} {wanted!r}: {len(found)} bodies have that name; give the id instead: {ids}"
        raise SettingError(msg)
    msg = f"--{role} {wanted!r}: no such body; the file has {_listed(bodies)}"
    raise SettingError(msg)


def _speaking(bodies: tuple[RigidBody, ...], role: str, taken: RigidBody | None) -> RigidBody:
    found = [body for body in bodies if segment_of(body.name) == role and body is not taken]
    if len(found) == 1:
        return found[0]
    why = "no name says which" if not found else f"{len(found)} names say so"
    msg = (
        f"which body is the {role}? {why}; the file has {_listed(bodies)}: give --arm NAME and --forearm NAME "
        f"(--arm {STILL_ARM} for an arm that stands still and is not in the file)"
    )
    raise SettingError(msg)


def _listed(bodies: tuple[RigidBody, ...]) -> str:
    return ", ".join(f"{body.name!r}" + (f" (id {body.identifier})" if body.identifier else "") for body in bodies)
