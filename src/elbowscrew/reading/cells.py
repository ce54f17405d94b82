"""Numbers out of lines of text: only the columns in use, blank cells as NaN, anything else an error."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import orjson
from numpy.typing import NDArray

from elbowscrew.errors import RecordingError
from elbowscrew.reading.source import TextSource

# What JSON allows in a list beside numbers: blanks, words, text, and more lists.
_NO_JSON_NUMBER: Final = (*" \t\r\n", *"tfn", '"', "[", "{")
# Cells that somebody may have put into a line, or taken out of it.
_MOST_SHIFTED: Final = 2
_NUMBER: Final = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?", re.ASCII)


def parse_number(text: str, *, nan_word: bool = False) -> float:
    """Read the number in a cell, NaN for a blank cell, and with `nan_word` for the word "nan".

    Raises
    ------
    ValueError
        For anything else, other words and values beyond the range of a float included.
    """
    stripped = text.strip()
    if not stripped or (nan_word and stripped.casefold() == "nan"):
        return float("nan")
    if _NUMBER.fullmatch(stripped):
        value = float(stripped)
        if np.isfinite(value):
            return value
    msg = f"expected a number, found {text.strip()[:40]!r}"
    raise ValueError(msg)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Shape:
    """What lines may be: see `read_blocks`."""

    width: int
    exact: bool
    group: int
    nan_word: bool
    blank_rows: bool
    spare: int | None = None

    def allows(self, count: int) -> bool:
        """Whether a line may have so many cells."""
        if self.group:
            return count >= self.width and (count - self.width) % self.group == 0
        return count == self.width or (count > self.width and not self.exact)

    def trimmed(self, cells: list[str]) -> tuple[_Shape, list[str]]:
        """Leave out the blank cells behind a whole line, as delimiters at its end make them.

        A line that has a cell too many and ends with blank ones looks the same, and all its cells are shifted. So lines
        must agree in how many blank cells there are, but for more than anybody shifts by; or, in groups, each group
        must be whole or blank.
        """
        more = len(cells) - self.width
        spare = more % self.group if self.group else more
        if more < 0 or not (self.exact or self.group):
            return self, cells
        habit = spare if self.spare is None else self.spare
        if spare != habit:
            if self.group:
                parts = range(self.width % self.group, self.width, self.group)
                agrees = all(len({not cell.strip() for cell in cells[k : k + self.group]}) == 1 for k in parts)
            else:
                agrees = 0 in (spare, habit) and spare + habit > _MOST_SHIFTED
            if not agrees:
                return self, []
        while len(cells) > self.width and not cells[-1].strip():
            cells = cells[:-1]
        return (replace(self, spare=habit) if self.allows(len(cells)) else self), cells


def read_blocks(
    source: TextSource,
    first_line: int,
    columns: Sequence[int],
    width: int,
    *,
    exact: bool = False,
    group: int = 0,
    nan_word: bool = False,
    blank_rows: bool = False,
) -> Iterator[NDArray[np.float64]]:
    """Read some columns of the lines from `first_line` on, many lines at a time.

    Parameters
    ----------
    source : TextSource
    first_line : int
        Lines to skip.
    columns : sequence of int
        Counted from 0.
    width : int
        Cells a whole line has ...
    exact : bool
        ... and no more; else at the least, as behind a header that a spreadsheet cut.
    group : int
        If not 0, any line may have more, in groups of so many cells.
    nan_word : bool
        Whether the word "nan" is a blank cell.
    blank_rows : bool
        Whether lines without any content count as rows of blanks, as they must where rows are the clock; empty lines at
        the end do not.

    Yields
    ------
    ndarray, shape (rows, len(columns))
        Lines without any content are left out, unless they count.

    Raises
    ------
    RecordingError
        For a cell that is neither blank nor a number, or a line that has been cut; with line and column.
    """
    number = first_line + 1
    shape = _Shape(width=width, exact=exact, group=group, nan_word=nan_word, blank_rows=blank_rows)
    held: list[str] = []
    for lines in source.blocks(first_line):
        block = held + lines
        held = []
        while blank_rows and block and not block[-1].strip():
            held.append(block.pop())
        shape, values = _parse_block(source, block, number, columns, shape)
        yield values
        number += len(block)


def _parse_block(
    source: TextSource, block: list[str], number: int, columns: Sequence[int], shape: _Shape
) -> tuple[_Shape, NDArray[np.float64]]:
    """Parse a block at once where all its cells are plain numbers, else cell by cell; give the width found, too.

    A cell more or less would shift all that follow it: every line must have as many as the first, and that at least
    as many as the header.
    """
    delimiter = source.delimiter
    text = "\n".join(block)
    quoted, commas = '"' in text, source.decimal_comma and "," in text
    counts = {line.count(delimiter) + 1 for line in block}
    mixed = commas and "." in text
    spare = _spare_in_all(block, delimiter, counts, shape)
    whole = (len(counts) == 1 or shape.group) and all(map(shape.allows, counts))
    if not quoted and not mixed and (whole or spare):
        plain = text.replace(",", ".").split("\n") if commas else block
        values = _json_numbers(plain, delimiter, counts, columns)
        if values is None:
            # A blank or a faulty cell is an error: the slow way tells which.
            with suppress(ValueError):
                values = np.loadtxt(plain, delimiter=delimiter, usecols=columns, comments=None, ndmin=2)
        if values is not None and values.shape[0] == len(block) and np.isfinite(values).all():
            found = shape if shape.group or spare else replace(shape, width=counts.pop(), exact=True)
            return replace(found, spare=spare), np.asarray(values, dtype=np.float64)
    rows = []
    marks: set[str] = set()
    for offset, line in enumerate(block):
        location = f"{source.path}:{number + offset}"
        try:
            cells = source.cells(line) if quoted else line.split(delimiter)
        except csv.Error as error:
            msg = f"{location}: not a line of a CSV file: {error}; export the take again"
            raise RecordingError(msg) from error
        if not any(cell.strip() for cell in cells):
            if shape.blank_rows:
                rows.append([float("nan")] * len(columns))
            continue
        count = len(cells)
        shape, cells = shape.trimmed(cells)
        if not shape.allows(len(cells)):
            expected = shape.width + (shape.spare or 0)
            msg = (
                f"{location}: expected {expected} cells, found {count}: the line is cut or its cells are shifted, or "
                "titles are missing above them; export the take again, or delete the line"
            )
            raise RecordingError(msg)
        if not shape.group:
            shape = replace(shape, width=len(cells), exact=True, spare=shape.spare or 0)
        rows.append(_numbers(source, cells, columns, location, nan_word=shape.nan_word))
        if source.decimal_comma:
            marks |= {mark for column in columns for mark in ",." if mark in cells[column]}
            if len(marks) > 1:
                msg = f"{location}: numbers have both commas and points: the decimal mark is ambiguous; save again"
                raise RecordingError(msg)
    return shape, np.array(rows, dtype=np.float64).reshape(len(rows), len(columns))


def _spare_in_all(block: list[str], delimiter: str, counts: set[int], shape: _Shape) -> int:
    """Blank cells behind all of the lines, where these have as many; 0 where that is not so."""
    spare = min(counts, default=0) - shape.width
    same = len(counts) == 1 and shape.exact and spare > 0 and shape.spare in (None, spare)
    return spare if same and all(line.endswith(delimiter * spare) for line in block) else 0


def _json_numbers(
    lines: list[str], delimiter: str, counts: set[int], columns: Sequence[int]
) -> NDArray[np.float64] | None:
    """Numbers of some columns, shape (rows, columns), by a reader of JSON, in half the time of `np.loadtxt`.

    None where the first cells of the lines, so many as are needed, are not all numbers as JSON writes them.

    Parameters
    ----------
    lines : list of str
    delimiter : str
        What separates their cells.
    counts : set of int
        Of the cells that there are in a line.
    columns : sequence of int
    """
    needed = max(columns) + 1
    if not lines:
        return None
    if min(counts) > needed:
        behind = min(counts) - needed
        if len(counts) == 1 and behind < needed:
            lines = [line.rsplit(delimiter, behind)[0] for line in lines]
        else:
            lines = [line[: -1 - len(line.split(delimiter, needed)[needed])] for line in lines]
    elif len(counts) > 1:
        return None
    text = delimiter.join(lines)
    if delimiter != ",":
        if "," in text:
            return None
        text = text.replace(delimiter, ",")
    # JSON has no integer -0.
    if any(mark in text for mark in _NO_JSON_NUMBER) or "-0," in text or text.endswith("-0"):
        return None
    try:
        cells = orjson.loads(f"[{text}]")
    except orjson.JSONDecodeError:
        return None
    return np.fromiter(cells, dtype=np.float64, count=len(cells)).reshape(len(lines), -1)[:, columns]


def _numbers(
    source: TextSource, cells: list[str], columns: Sequence[int], location: str, *, nan_word: bool
) -> list[float]:
    row = []
    for column in columns:
        text = cells[column].replace(",", ".") if source.decimal_comma else cells[column]
        try:
            row.append(parse_number(text, nan_word=nan_word))
        except ValueError as error:
            msg = f"{location}: column {column + 1}: {error}; export the take again, or blank the cell"
            raise RecordingError(msg) from error
    return row
