"""Which bodies are the joint's: by name, by id, or by names that speak; never by a guess."""

from __future__ import annotations

import difflib
from typing import Final, NamedTuple

from elbowscrew.choices import JOINT_NAMES
from elbowscrew.errors import SettingError
from elbowscrew.joints import GENERIC, Joint, joint_between, joints_of, segment_of, side_of
from elbowscrew.model import QualityWarning, Recording, RigidBody
from elbowscrew.settings import STILL

# Alone in a file, an upper arm or a thigh is more often the first body of two than the second.
_SELDOM_ALONE: Final = ("shoulder", "hip")


class ChosenBodies(NamedTuple):
    """The joint's two bodies, what it is called, and what is doubtful about the choice.

    The proximal body is None where it stands still: asked for, or only one body in the file (the paper's case).
    """

    proximal: RigidBody | None
    distal: RigidBody
    joint: Joint
    warnings: tuple[QualityWarning, ...] = ()


def choose_bodies(
    recording: Recording, proximal: str | None, distal: str | None, joint: str | None = None
) -> ChosenBodies:
    """Choose the two bodies of the joint.

    Parameters
    ----------
    recording : Recording
    proximal, distal : str or None
        Name or id; None to go by the order of two files, or by the names in one, and "none" for a proximal
        body that stands still.
    joint : str or None
        Name of the joint; None to go by the names of the bodies.

    Raises
    ------
    SettingError
        If a name is not in the file or stands there twice, if the choice is not clear, or if names that speak are of
        different sides; the bodies are listed.
    """
    bodies = recording.bodies
    still = proximal is not None and proximal.casefold() == STILL and not _named(bodies, proximal)
    first = _find(recording, proximal, "proximal") if proximal is not None and not still else None
    second = _find(recording, distal, "distal") if distal is not None else None
    if proximal is None and len(bodies) == 1 and bodies[0].name in bones_of(recording):
        msg = (
            f"bone {bodies[0].name!r} is one of a skeleton: name both bones, by --proximal and --distal (--proximal "
            f"{STILL} for its motion in the laboratory)"
        )
        raise SettingError(msg)
    if still or (proximal is None and len(bodies) == 1):
        second = second or _alone(bodies, joint)
        return ChosenBodies(None, second, _joint_above(second, joint))
    if recording.ordered and proximal is None and distal is None:
        first, second = bodies
    elif first is None or second is None:
        first, second = _speaking_pair(bodies, first, second, joint)
    if first is second:
        msg = f"body {first.name!r} is named both as proximal and as distal; the file has {_listed(bodies)}"
        raise SettingError(msg)
    warnings = []
    if recording.ordered and joint_between(second.name, first.name) is not GENERIC:
        named = f"{first.name!r} is given as the proximal body and {second.name!r} as the distal one"
        message = f"{named}: their names speak of the reverse"
        warnings.append(QualityWarning(code="order-differs", message=message))
    if _sides_differ(first, second):
        sides = f"{first.name!r} is {side_of(first.name)} and {second.name!r} is {side_of(second.name)}"
        if not recording.ordered and (proximal is None or distal is None):
            msg = f"the bodies are of different sides: {sides}; give both --proximal and --distal if that is meant"
            raise SettingError(msg)
        warnings.append(QualityWarning(code="sides-differ", message=f"the bodies are of different sides: {sides}"))
    spoken = joint_between(first.name, second.name)
    if joint is not None and spoken not in (GENERIC, *joints_of(joint)):
        message = f"--joint {joint}, but the bodies {first.name!r} and {second.name!r} speak of the {spoken.name}"
        warnings.append(QualityWarning(code="joint-differs", message=message))
    return ChosenBodies(first, second, joint_between(first.name, second.name, joint), tuple(warnings))


def _alone(bodies: tuple[RigidBody, ...], joint: str | None) -> RigidBody:
    """Give the only body that may be the distal one beside a proximal one that stands still."""
    if len(bodies) == 1:
        body, segment = bodies[0], segment_of(bodies[0].name)
        distal_of = {one.name for one in joints_of(joint) if one.distal == segment}
        proximal_of = {one.name for one in joints_of(joint) if one.proximal == segment}
        if proximal_of and not distal_of - (set(_SELDOM_ALONE) if joint is None else set()):
            msg = f"the only body in the file is {body.name!r}: give --distal {body.name!r} if it is the distal one"
            raise SettingError(msg)
        return body
    found = [body for body in bodies if _speaks_as_distal(body, joint)]
    if len(found) != 1:
        ends = {one.distal for one in joints_of(joint)} & {segment_of(body.name) for body in bodies}
        raise SettingError(_unclear(bodies, "distal", [repr(body.name) for body in found], joint, len(ends) > 1))
    return found[0]


def _joint_above(distal: RigidBody, name: str | None) -> Joint:
    """Say which joint ends in a body, where the other body stands still."""
    segment = segment_of(distal.name)
    spoken = [one for one in joints_of(name) if one.distal == segment and (name or one.name not in _SELDOM_ALONE)]
    return spoken[0] if spoken else joint_between("", "", name)


def _speaks_as_distal(body: RigidBody, joint: str | None) -> bool:
    segment = segment_of(body.name)
    return segment is not None and any(
        one.distal == segment and (joint is not None or one.name not in _SELDOM_ALONE) for one in joints_of(joint)
    )


def _speaking_pair(
    bodies: tuple[RigidBody, ...], first: RigidBody | None, second: RigidBody | None, name: str | None
) -> tuple[RigidBody, RigidBody]:
    """Find the bodies whose names speak of the two segments of one joint, one of which may be given."""
    spoken = {body.name: segment_of(body.name) for body in bodies}
    # Bodies that are called proximal and distal themselves speak of any joint.
    pairs = [
        (joint, one, other)
        for joint in (*joints_of(name), GENERIC)
        for one in ([first] if first is not None else bodies)
        for other in ([second] if second is not None else bodies)
        if one is not other
        # The name of a body that was given by name need not speak.
        and (spoken[one.name] == joint.proximal or (one is first and spoken[one.name] is None))
        and (spoken[other.name] == joint.distal or (other is second and spoken[other.name] is None))
    ]
    agreeing = [pair for pair in pairs if not _sides_differ(pair[1], pair[2])] or pairs
    ends = list(dict.fromkeys((id(one), id(other)) for _, one, other in agreeing))
    if len(ends) == 1:
        return agreeing[0][1], agreeing[0][2]
    names = list(dict.fromkeys(joint.name for joint, _, _ in agreeing))
    if len(names) > 1 and first is None and second is None:
        told = "; ".join(f"{joint.name}: {one.name!r} and {other.name!r}" for joint, one, other in agreeing)
        msg = f"the bodies' names fit several joints ({told}): give --joint NAME, or --proximal NAME and --distal NAME"
        raise SettingError(msg)
    role = "distal" if first is not None else "proximal"
    choices = [f"{one.name!r} and {other.name!r}" for _, one, other in agreeing]
    raise SettingError(_unclear(bodies, role, list(dict.fromkeys(choices)), name, len(names) > 1))


def _sides_differ(first: RigidBody, second: RigidBody) -> bool:
    sides = side_of(first.name), side_of(second.name)
    return None not in sides and sides[0] != sides[1]


def _unclear(
    bodies: tuple[RigidBody, ...], role: str, choices: list[str], joint: str | None, several_joints: bool
) -> str:
    """Say that the names do not tell, which choices they leave, and what helps: --joint only between several joints."""
    if choices:
        why = f"the names allow {len(choices)} choices ({'; '.join(choices)})"
    else:
        why = f"no names speak of the {joint}" if joint is not None else "no names say which"
    return (
        f"which body is the {role} one? {why}; the file has {_listed(bodies)}: give --proximal NAME and --distal NAME "
        f"(--proximal {STILL} for one that stands still and is not in the file)"
        + (f", or --joint {', '.join(JOINT_NAMES)}" if several_joints else "")
    )


def _named(bodies: tuple[RigidBody, ...], wanted: str) -> list[RigidBody]:
    """Find the bodies meant: exact name first, then id, then name in any case."""
    key = wanted.strip().casefold()
    return (
        [body for body in bodies if body.name == wanted]
        or [body for body in bodies if body.identifier and _same_id(body.identifier, key)]
        or [body for body in bodies if body.name.strip().casefold() == key]
        or [body for number, body in enumerate(bodies, 1) if key == f"#{number}"]
    )


def _same_id(identifier: str, key: str) -> bool:
    # Motive drops a leading zero of its 32 hexadecimal digits.
    return identifier.casefold() == key or (len(key) > 8 and identifier.casefold().lstrip("0") == key.lstrip("0"))


def bones_of(recording: Recording) -> tuple[str, ...]:
    """Names of the bones of skeletons in the file, of which those that were named are read as bodies."""
    return () if recording.source is None else recording.source.bones


def _find(recording: Recording, wanted: str, role: str) -> RigidBody:
    bodies = recording.bodies
    found = _named(bodies, wanted)
    if len(found) == 1:
        return found[0]
    if found:
        ids = " or ".join(repr(body.identifier) for body in found)
        msg = f"--{role} {wanted!r}: {len(found)} bodies have that name; give the id instead: {ids}"
        raise SettingError(msg)
    names = {name.casefold(): name for name in (*(body.name for body in bodies), *bones_of(recording))}
    near = [repr(names[one]) for one in difflib.get_close_matches(wanted.strip().casefold(), names)]
    mean = f"; did you mean {' or '.join(near)}?" if near else ""
    msg = f"--{role} {wanted!r}: no such body{mean}; the file has {_listed(bodies)}"
    raise SettingError(msg)


def _listed(bodies: tuple[RigidBody, ...]) -> str:
    return ", ".join(f"{body.name!r}" + (f" (id {body.identifier})" if body.identifier else "") for body in bodies)
