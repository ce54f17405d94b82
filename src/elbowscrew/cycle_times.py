"""Cycles whose times somebody else knows, out of a CSV file."""

from __future__ import annotations

import csv
import math
from pathlib import Path


def read_cycle_times(path: Path) -> list[tuple[float, float]]:
    """Read start and end times of cycles from a CSV file with the columns ``start_time_s`` and ``end_time_s``.

    Raises
    ------
    ValueError
        If the file cannot be read, a column is missing, or a cycle does not begin before it ends.
    """
    columns = ("start_time_s", "end_time_s")
    try:
        with path.open(encoding="utf-8-sig", newline="") as stream:
            table = csv.DictReader(stream)
            missing = [name for name in columns if name not in (table.fieldnames or ())]
            if missing:
                msg = f"{path}: expected the columns start_time_s and end_time_s, found no {' and no '.join(missing)}"
                raise ValueError(msg)
            times = []
            for row in table:
                start, end = (float(row[name] or "nan") for name in columns)
                if not (math.isfinite(start) and math.isfinite(end) and start < end):
                    msg = f"{path}:{table.line_num}: expected a start before its end, found {row['start_time_s']} and "
                    raise ValueError(msg + f"{row['end_time_s']}")
                times.append((start, end))
    except OSError as error:
        msg = f"{path}: cannot be read as a file of cycles: {error.strerror}"
        raise ValueError(msg) from error
    except csv.Error as error:
        msg = f"{path}: not a CSV file: {error}"
        raise ValueError(msg) from error
    return times
