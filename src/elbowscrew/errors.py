"""Everything that can go wrong for a reason outside the program.

::

    ElbowscrewError
    ├── UsageError       2  a setting is not a possible one, whatever the recording
    ├── RecordingError   3  the recording cannot be read, or the disk does not give what stands beside it
    │   ├── NoBodiesError   it has no rigid bodies, but maybe markers
    │   └── ResultError     a folder that should hold a finished result does not, or a damaged one
    │       └── NotKeptError   what is asked of a result is not in its files
    ├── SettingError     4  a setting does not fit this recording
    │   └── MissingStatementError   the file lacks a statement that an option must supply
    ├── AnalysisError    5  the recording can be read but not analyzed
    └── OutputError      6  the output cannot be written, or exists

The number is the exit code of the command line. A message is one line and says the place, what was expected, what was
found and what to do next.
"""

from __future__ import annotations

import difflib
import errno
import os
from collections.abc import Iterable, Sequence
from contextlib import suppress
from typing import NamedTuple

_LONGEST_VALUE = 80
_LONGEST_MESSAGE = 2000
_NAMES_TOLD = 24
_OF_THE_SYSTEM = frozenset({errno.EIO, errno.ENOSPC, errno.ENOMEM, errno.EMFILE, errno.ENFILE})
"""Errors that no other name or file would have spared."""


def shown(value: object) -> str:
    """Representation of a value that is at fault, for a message: in brief, and whatever it is."""
    try:
        text = repr(value)
    except (ValueError, RecursionError):  # a whole number of more digits than Python writes, or lists without end
        return f"a {type(value).__name__} too large to be shown"
    return text if len(text) <= _LONGEST_VALUE else f"{text[:_LONGEST_VALUE]}…"


def shortened(message: str) -> str:
    """Cut a message that names something without end: its begin tells the place, its end what to do."""
    if len(message) <= _LONGEST_MESSAGE:
        return message
    return f"{message[: _LONGEST_MESSAGE * 3 // 4]} … {message[-_LONGEST_MESSAGE // 4 :]}"


def did_you_mean(wanted: object, names: Sequence[str]) -> str:
    """Ask back by the names that are nearly the one wanted, in any case of letters; empty if there is none."""
    if not isinstance(wanted, str):
        return ""
    known = {name.casefold(): name for name in names}
    near = [known[name] for name in difflib.get_close_matches(wanted.casefold(), known, n=3)]
    return f"; did you mean {' or '.join(map(repr, near))}?" if near else ""


def asked_back(wanted: object, choices: Iterable[str]) -> str:
    """Ask back where one or several values with commas are none of some choices; each that is none is asked back."""
    known = tuple(choices)
    given = [text.strip() for text in wanted.split(",")] if isinstance(wanted, str) else []
    near = [nearest(one, known) for one in given if one not in known]
    found = [repr(one) for one in dict.fromkeys(near) if one is not None]
    return f"; did you mean {' and '.join(found)}?" if found else ""


def nearest(wanted: str, choices: Sequence[str]) -> str | None:
    """Give the choice that is meant, whatever its case and hyphens, or begun alone; None if none is near."""
    known = {_letters(choice): choice for choice in choices}
    letters = _letters(wanted)
    begun = [choice for choice in known if len(letters) > 1 and choice.startswith(letters)]
    close = begun if len(begun) == 1 else difflib.get_close_matches(letters, known, n=1)
    return known[close[0]] if close else None


def _letters(name: str) -> str:
    return name.casefold().replace("-", "").replace("_", "").replace(" ", "")


def why_unreadable(path: str | os.PathLike[str], error: OSError) -> str:
    """Say why a file cannot be opened; of one that is not there, ask back by names that are nearly its own."""
    reason = str(error.strerror or error)
    return f"{reason}{files_beside(path)}" if isinstance(error, FileNotFoundError) else reason


def files_beside(path: str | os.PathLike[str], *, folders: bool = False) -> str:
    """Ask back by the names in a file's folder that are nearly its own, or by folders alone; empty if there is none."""
    folder, name = os.path.split(os.fspath(path))
    with suppress(OSError, ValueError):
        return did_you_mean(name, [one.name for one in os.scandir(folder or os.curdir) if one.is_dir() or not folders])
    return ""


def told_names(names: Sequence[str]) -> str:
    """Names with commas, of many the first."""
    more = f" and {len(names) - _NAMES_TOLD} more" if len(names) > _NAMES_TOLD else ""
    return ", ".join(names[:_NAMES_TOLD]) + more


class Missing(NamedTuple):
    """A statement that a file lacks.

    Attributes
    ----------
    setting : str
        The field of `elbowscrew.Settings` that supplies it.
    lacks, give : str
        In words, as in "does not state its unit of length" and "--units m, cm or mm".
    """

    setting: str
    lacks: str
    give: str


class ElbowscrewError(Exception):
    """Base of all errors that a file, a setting or a disk can cause.

    Attributes
    ----------
    exit_code : int
        What the command line exits with.
    """

    exit_code = 1


class UsageError(ElbowscrewError):
    """A setting that cannot hold for any recording: an unknown key, a negative angle."""

    exit_code = 2


class RecordingError(ElbowscrewError):
    """The file is missing, damaged, or not a recording that can be read safely.

    Attributes
    ----------
    exit_code : int
        What the command line exits with.
    """

    exit_code = 3


class NoBodiesError(RecordingError):
    """The file has no rigid bodies; it may have markers, which can be asked for."""


class ResultError(RecordingError):
    """A folder holds no finished result, or one that cannot be read: what was to be read is at fault, as in a file."""


class NotKeptError(ResultError, AttributeError):
    """Something that an analysis has in memory, and the files of its result do not hold."""


class SettingError(ElbowscrewError):
    """A setting that does not fit this recording: a body or a frame that is not in it."""

    exit_code = 4


class MissingStatementError(SettingError):
    """The file lacks statements that options must supply.

    Attributes
    ----------
    missing : tuple of Missing
        All of them, so that they are asked for at once.
    """

    def __init__(self, message: str, *missing: Missing) -> None:
        super().__init__(message)
        self.missing = missing

    @classmethod
    def of(cls, path: object, *missing: Missing) -> MissingStatementError:
        """Say what a file lacks and what gives it."""
        lacks, give = ([one[k] for one in missing] for k in (1, 2))
        return cls(f"{path}: the file {' and '.join(lacks)}; give {', and '.join(give)}", *missing)


def unreadable(path: object, wanted: str, error: OSError, wrong: type[Exception] = UsageError) -> Exception:
    """Say that a file beside the recording cannot be read: a wrong one was given, or the disk does not give it."""
    told = RecordingError if error.errno in _OF_THE_SYSTEM else wrong
    return told(f"{path}: cannot be read as {wanted}: {why_unreadable(str(path), error)}")


class AnalysisError(ElbowscrewError):
    """The recording holds too little tracking or too little rotation for an axis."""

    exit_code = 5


class OutputError(ElbowscrewError):
    """The result exists already, or the disk does not take it."""

    exit_code = 6
