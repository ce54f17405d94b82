"""A recording as far as its file tells it, where the file lacks a statement that nobody has given yet."""

from __future__ import annotations

import os
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import product
from typing import Any, Final

from elbowscrew.errors import Missing, MissingStatementError, NoBodiesError, SettingError
from elbowscrew.geometry.quaternion import EULER_ORDERS
from elbowscrew.model import Recording
from elbowscrew.reading.registry import read_recording
from elbowscrew.reading.scale import DOUBTFUL

# In place of what is missing: nothing that depends on it may be told.
_MADE_UP: Final[dict[str, tuple[Any, ...]]] = {"units": ("mm",), "rotation": EULER_ORDERS, "rate_hz": (1.0,)}
_ALL: Final = ("*",)


def read_what_is_stated(
    path: str | os.PathLike[str], *, markers: Sequence[str] = (), bones: Sequence[str] = (), **statements: Any
) -> tuple[Recording, tuple[Missing, ...]]:
    """Read a recording even where statements are missing, and its markers and bones where it has no rigid bodies.

    Parameters
    ----------
    path : path-like
    markers, bones : sequence of str
        As of `elbowscrew.read_recording`.
    **statements
        Its other parameters.

    Returns
    -------
    recording : Recording
        With values made up for what is missing.
    missing : tuple of Missing
        What that is.

    Raises
    ------
    RecordingError, SettingError, UsageError
        As `elbowscrew.read_recording`, for any other reason.
    """
    try:
        return _read(path, {**statements, "markers": tuple(markers), "bones": tuple(bones)})
    except NoBodiesError:
        # Its markers and bones are what there is to tell of.
        return _read(path, {**statements, "markers": tuple(markers) or _ALL, "bones": _ALL})


def _read(path: str | os.PathLike[str], options: dict[str, Any]) -> tuple[Recording, tuple[Missing, ...]]:
    try:
        return read_recording(path, **options), ()
    except MissingStatementError as error:
        names = [one.setting for one in error.missing]
        for values in product(*(_MADE_UP[name] for name in names)):
            with suppress(SettingError):
                recording = read_recording(path, **{**options, **dict(zip(names, values, strict=True))})
                told = tuple(one for one in recording.warnings if one.code != DOUBTFUL)  # nobody has given that unit
                return replace(recording, warnings=told), error.missing
        raise
