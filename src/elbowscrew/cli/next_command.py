"""The command to type after ``info``."""

from __future__ import annotations

import re
import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from elbowscrew.model.summary_types import FileSummary

_PLACEHOLDERS = {"units": "UNIT", "rotation": "ORDER", "rate": "HZ"}
_FEWEST_MARKERS = 3


def next_command(files: list[Path], given: Mapping[str, Any], summary: FileSummary) -> tuple[str, bool]:
    """Give the line that analyzes a file, ready for a shell, and whether the order of the bodies in it is a guess.

    Words in capitals stand for what is not known.

    Parameters
    ----------
    files : list of Path
        As they were named.
    given : mapping
        Options that were given, by their names.
    summary : FileSummary
    """
    words = ["elbowscrew", "analyze", *(f"./{one}" if str(one).startswith("-") else str(one) for one in files)]
    for option, value in given.items():
        if value is not None:
            words += [f"--{option.replace('_', '-')}", f"{value:g}" if isinstance(value, float) else str(value)]
    missing = [one["option"] for one in summary["missing"]]
    for option in missing:
        if option in _PLACEHOLDERS:
            words += [f"--{option}", _PLACEHOLDERS[option]]
    bodies, guessed = _bodies(summary, missing)
    return shlex.join([*words, *bodies]), guessed


def too_seldom_tracked(summary: FileSummary, least_percent: float) -> list[str]:
    """Names of the joint's bodies, as far as they are known, that are tracked in too few frames to be analyzed.

    Parameters
    ----------
    summary : FileSummary
    least_percent : float
        The least share of tracked frames.
    """
    shares = {body["name"]: body["tracked_share"] for body in summary["trial"]["bodies"]}
    roles = summary["roles"]
    meant = [roles["proximal"], roles["distal"]] if roles["distal"] is not None else list(shares)
    seldom = [name for name in meant if name in shares and 100.0 * shares[name] < least_percent]
    return seldom if roles["distal"] is not None or len(shares) - len(seldom) < min(2, len(shares)) else []


def _bodies(summary: FileSummary, missing: list[str]) -> tuple[list[str], bool]:
    rigid = [body["name"] for body in summary["trial"]["bodies"] if body["name"] not in summary["bones"]]
    roles = summary["roles"]
    if roles["distal"] is not None:
        bones = not rigid and roles["proximal"] is not None  # these are read only by name
        return (["--proximal", str(roles["proximal"]), "--distal", roles["distal"]] if bones else []), False
    if "proximal-markers" in missing:
        groups = _groups([marker["name"] for marker in summary["markers"]])
        two = len(groups) == 2
        first, second = groups if two else ("NAMES", "NAMES")
        return ["--proximal-markers", first, "--distal-markers", second], two
    if len(rigid) == 1:
        return ["--distal", "#1"], False
    two = len(rigid) == 2
    first, second = ("#1", "#2") if two else ("NAME", "NAME")
    return ["--proximal", first, "--distal", second], two


def _groups(names: list[str]) -> list[str]:
    """Patterns of the markers whose names differ in their last number alone, where these are no others' as well."""
    stems: dict[str, int] = {}
    for name in names:
        stem = re.sub(r"\d+$", "", name)
        stems[stem] = stems.get(stem, 0) + 1
    whole = all(count >= _FEWEST_MARKERS and stem for stem, count in stems.items())
    apart = not any(one != other and one.startswith(other) for one in stems for other in stems)
    return [f"{stem}*" for stem in stems] if whole and apart and not re.search(r"[*?\[\],]", "".join(stems)) else []
