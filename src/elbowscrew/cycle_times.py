"""Cycles whose times somebody else knows, out of a CSV file."""

from __future__ import annotations

import csv
import math
from pathlib import Path
from typing import Final

from elbowscrew.errors import unreadable
from elbowscrew.opening import open_text

_COLUMNS: Final = ("start_time_s", "end_time_s")


def read_cycle_times(path: Path) -> list[tuple[float, float]]:
    """Read start and end times of cycles from a CSV file with the columns ``start_time_s`` and ``end_time_s``.

    Raises
    ------
    ValueError
        If the file cannot be read, a column is missing, there is no cycle, or a cycle does not begin before it ends.
    """
    try:
        with open_text(path, encoding="utf-8-sig", newline="") as stream:
            times = _times(csv.DictReader(stream), path)
    except OSError as error:
        raise unreadable(path, "a file of cycles", error, ValueError) from error
    except (csv.Error, UnicodeDecodeError) as error:
        msg = f"{path}: not a CSV file in UTF-8: {error}"
        raise ValueError(msg) from error
    if not times:
        msg = f"{path}: there is no cycle in it"
        raise ValueError(msg)
    return times


def _times(table: csv.DictReader[str], path: Path) -> list[tuple[float, float]]:
    missing = [name for name in _COLUMNS if name not in (table.fieldnames or ())]
    if missing:
        msg = f"{path}: expected the columns start_time_s and end_time_s, without {' and '.join(missing)}"
        raise ValueError(msg)
    times = []
    for row in table:
        texts = [row[name] or "" for name in _COLUMNS]
        start, end = (_seconds(text) for text in texts)
        if not start < end:  # neither of them nan
            msg = (
                f"{path}:{table.line_num}: expected a start in seconds and an end after it, not {' and '.join(texts)!r}"
            )
            raise ValueError(msg)
        times.append((start, end))
    return times


def _seconds(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        return math.nan
    return value if math.isfinite(value) else math.nan
