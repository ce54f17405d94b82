"""Numbers out of comma-separated lines: only the columns in use, blank cells as NaN, anything else an error."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import islice
from typing import Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew.errors import RecordingError
from elbowscrew.io.source import TextSource

_BLOCK_LINES: Final = 4096
_NUMBER: Final = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?", re.ASCII)


def parse_number(text: str) -> float:
    """Read the number in a cell, NaN for a blank cell.

    Raises
    ------
    ValueError
        For anything else, words such as "nan" and values beyond the range of a float included.
    """
    stripped = text.strip().strip('"').strip()
    if not stripped:
        return float("nan")
    if _NUMBER.fullmatch(stripped):
        value = float(stripped)
        if np.isfinite(value):
            return value
    msg = f"expected a number, found {text.strip()[:40]!r}"
    raise ValueError(msg)


def read_columns(
    source: TextSource, first_line: int, columns: Sequence[int], width: int, max_rows: int | None = None
) -> NDArray[np.float64]:
    """Read some columns of the lines from `first_line` on.

    Parameters
    ----------
    source : TextSource
    first_line : int
        Lines to skip.
    columns : sequence of int
        Counted from 0.
    width : int
        Cells a whole line has at the least.
    max_rows : int, optional
        Stop after so many lines.

    Returns
    -------
    ndarray, shape (rows, len(columns))
        Lines without any content are left out.

    Raises
    ------
    RecordingError
        For a cell that is neither blank nor a number, or a line that has been cut; with line and column.
    """
    lines = islice(source.lines(), first_line, None if max_rows is None else first_line + max_rows)
    blocks: list[NDArray[np.float64]] = []
    number = first_line + 1
    while block := list(islice(lines, _BLOCK_LINES)):
        blocks.append(_parse_block(source, block, number, columns, width))
        number += len(block)
    return np.concatenate(blocks) if blocks else np.empty((0, len(columns)))


def _parse_block(
    source: TextSource, block: list[str], number: int, columns: Sequence[int], width: int
) -> NDArray[np.float64]:
    """Parse a block at once where all its cells are plain numbers, else cell by cell."""
    if min(line.count(",") for line in block) >= width - 1:
        try:
            values = np.loadtxt(block, delimiter=",", usecols=columns, comments=None, quotechar='"', ndmin=2)
        except ValueError:
            pass  # a blank or a faulty cell: the slow way tells which
        else:
            if values.shape[0] == len(block) and np.isfinite(values).all():
                return np.asarray(values, dtype=np.float64)
    rows = []
    for offset, line in enumerate(block):
        if not line.strip(', \t"'):
            continue
        cells = line.split(",")
        if len(cells) < width:
            msg = (
                f"{source.path}:{number + offset}: expected {width} cells, found {len(cells)}: the line is cut; "
                "export the take again, or delete the line"
            )
            raise RecordingError(msg)
        try:
            rows.append([parse_number(cells[column]) for column in columns])
        except ValueError as error:
            bad = next(column for column in columns if not _is_number(cells[column]))
            msg = f"{source.path}:{number + offset}: column {bad + 1}: {error}"
            raise RecordingError(msg) from error
    return np.array(rows, dtype=np.float64).reshape(len(rows), len(columns))


def _is_number(text: str) -> bool:
    try:
        parse_number(text)
    except ValueError:
        return False
    return True
