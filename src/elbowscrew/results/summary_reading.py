"""The two JSON files of a result read back and checked: each key, and what kind of value it has."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any, Final, TypeVar

from pydantic import TypeAdapter, ValidationError

from elbowscrew._version import __version__
from elbowscrew.configuring import checked_settings
from elbowscrew.errors import ResultError, UsageError
from elbowscrew.model.joint_summary_types import JointSummary
from elbowscrew.model.summary_types import Summary
from elbowscrew.results.joint_summary import preferred_fit
from elbowscrew.results.proof import Proof, ProvedFile
from elbowscrew.settings import Settings

SUMMARY: Final = "summary.json"
JOINT: Final = "joint.json"

_LONGEST_FOUND: Final = 40

LARGEST: Final = 1e100
"""No result has a number beyond it; its square is still one."""

Shape = TypeVar("Shape")


def read_summary(proof: Proof) -> Summary:
    """Read the ``summary.json`` of a result.

    Keys that it should not have are passed over.

    Returns
    -------
    Summary
        As it was written.

    Raises
    ------
    ResultError
        If there is none, it is not as it was written, or is of another version (it names the key).
    """
    return _checked(proof.folder / SUMMARY, _read_object(proof.file(SUMMARY)), _summary_adapter())


def read_joint_summary(proof: Proof) -> JointSummary:
    """Read the ``joint.json`` of a result; read ``summary.json`` first, which tells the version.

    Raises
    ------
    ResultError
        If there is none, it is not as it was written, or is of another version (it names the key).
    """
    path = proof.folder / JOINT
    joint = _checked(path, _read_object(proof.file(JOINT)), _joint_adapter())
    if joint["preferred"] is not None and preferred_fit(joint) is None:
        msg = f"{path}: {joint['preferred']}: expected the preferred fit, found null; analyze the trial again"
        raise ResultError(msg)
    return joint


def settings_in(summary: Summary, folder: Path) -> Settings:
    """Make the settings that a summary tells of.

    Raises
    ------
    ResultError
        If one of them is not a possible one; it names the key.
    """
    try:
        return checked_settings(summary["settings"], f"{folder / SUMMARY}: settings", read_back=True)
    except UsageError as error:
        msg = f"{error}; analyze the trial again"
        raise ResultError(msg) from error


@cache
def _summary_adapter() -> TypeAdapter[Summary]:
    return TypeAdapter(Summary)


@cache
def _joint_adapter() -> TypeAdapter[JointSummary]:
    return TypeAdapter(JointSummary)


def _read_object(source: ProvedFile) -> dict[str, Any]:
    path = source.path
    try:
        with source.opened() as stream:
            text = stream.read().decode("utf-8")
        content = json.loads(text, parse_float=_number, parse_constant=_number, parse_int=_whole)
        json.dumps(content, ensure_ascii=False).encode()  # half a character is no text
    except OSError as error:
        msg = (
            f"{path.parent}: holds no finished result: {path.name}: {error.strerror or error}; analyze the trial first"
        )
        raise ResultError(msg) from error
    except (ValueError, RecursionError) as error:
        msg = f"{path}: not JSON: {error}; analyze the trial again"
        raise ResultError(msg) from error
    if not isinstance(content, dict):
        msg = f"{path}: expected an object, found {_kind(content)}; analyze the trial again"
        raise ResultError(msg)
    return content


def _number(text: str) -> float:
    value = float(text)
    if not abs(value) <= LARGEST:
        msg = f"{text} is not a known number"
        raise ValueError(msg)
    return value


def _whole(text: str) -> int:
    _number(text)
    return int(text)


def _checked(path: Path, content: dict[str, Any], adapter: TypeAdapter[Shape]) -> Shape:
    try:
        return adapter.validate_python(content, strict=True)
    except ValidationError as error:
        fault = error.errors(include_url=False)[0]
        key = ".".join(map(str, fault["loc"]))
        written = content.get("elbowscrew", __version__)
        other = f" (written by elbowscrew {written}; this is {__version__})" if written != __version__ else ""
        msg = f"{path}: {key}: {_sentence(fault['type'], fault['msg'], fault['input'])}{other}; analyze the trial again"
        raise ResultError(" ".join(msg.split())) from error


def _sentence(kind: str, message: str, found: object) -> str:
    if kind == "missing":
        return "is missing"
    return f"{message.replace('Input should be', 'expected')}, found {_kind(found)}"


def _kind(found: object) -> str:
    if isinstance(found, dict | list):
        return "an object" if isinstance(found, dict) else f"a list of {len(found)}"
    text = json.dumps(found, ensure_ascii=True)
    return text if len(text) <= _LONGEST_FOUND else f"{text[:_LONGEST_FOUND]}…"
