"""Tables of 4 x 4 matrices, as biplane X-ray gives them: a row a frame, 16 numbers a body.

Each matrix is body to laboratory, row by row (the last four numbers are 0, 0, 0, 1) or column by column (every fourth
is). There is no unit, and no clock but for a first column of frame numbers, if there is one. Blanks, "nan" and zeros
are lost frames. There is no header, or that of XMALab: ``<body>_R11 , <body>_R12``, and so on, behind ``Frame``.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Final, NamedTuple

import numpy as np

from elbowscrew.errors import RecordingError
from elbowscrew.geometry.arrays import Bool, Float
from elbowscrew.model import Recording, Source
from elbowscrew.quantities import METERS
from elbowscrew.reading.builders import ArrayBuilder, BodyBuilder
from elbowscrew.reading.cells import parse_number, read_blocks
from elbowscrew.reading.clock import check_frames, counted_rate, cut_warnings, frames_and_times
from elbowscrew.reading.headerless import body_names, first_row, one_body_warnings, unit_and_rate
from elbowscrew.reading.options import ReadOptions
from elbowscrew.reading.source import TextSource

_CELLS: Final = 16
# The last row of a matrix, as it may be printed.
_BOTTOM: Final = np.array([0.0, 0.0, 0.0, 1.0])
_EXACT: Final = 1e-6
# XMALab's titles of a body's cells; it calls the last coordinate TY, too. Filtered ones have a frequency behind them.
_PARTS: Final = ("r11", "r12", "r13", "01", "r21", "r22", "r23", "02", "r31", "r32", "r33", "03", "tx", "ty", "ty", "1")
_TITLE: Final = re.compile(r"(?P<name>.+)_(?P<part>r[123]{2}|0[123]|t[xyz]|1)(?:_[\d.]+hz)?", re.ASCII | re.IGNORECASE)


class _Table(NamedTuple):
    """Lines above the numbers, cells of a row, and the bodies' names."""

    lines_above: int
    width: int
    names: list[str]

    @property
    def numbered(self) -> bool:
        """Whether frame numbers stand before the matrices."""
        return self.width % _CELLS == 1


def recognizes(cells: list[str]) -> bool:
    """Tell by XMALab's titles, or by 16 numbers a body, of which the last or every fourth end a pose, or blanks."""
    if _has_titles(cells):
        return True
    while cells and not cells[-1]:
        cells = cells[:-1]
    try:
        numbers = np.array([parse_number(cell, nan_word=True) for cell in cells])
    except ValueError:
        return False
    if len(numbers) < _CELLS or len(numbers) % _CELLS > 1 or (len(numbers) % _CELLS and numbers[0] % 1.0 != 0.0):
        return False
    matrices = _matrices(numbers[len(numbers) % _CELLS :][None])
    return bool((_lost(matrices) | _ends_so(matrices) | _ends_so(_turned(matrices))).all())


def read(source: TextSource, options: ReadOptions) -> Recording:
    """Read a table of 4 x 4 matrices; see `elbowscrew.reading.registry.read_recording`."""
    cells = first_row(source, _CELLS)
    if _has_titles([cell.casefold() for cell in cells]):
        table = _titled(source, cells)
    else:
        table = _Table(0, len(cells), body_names(source, len(cells) // _CELLS))
    unit, rate = unit_and_rate(source, options)
    by_columns = _by_columns(source, table)
    builders = [BodyBuilder(name) for name in table.names]
    frames, rows = ArrayBuilder(dtype=np.int64), 0
    for frame, block in _blocks(source, table):
        ticks = frames_and_times(frame, None, range(rows, rows + len(block)), rate)
        line = table.lines_above + rows
        check_frames(source, line, ticks)
        frames.append(ticks[:, 0].astype(np.int64))
        matrices = _matrices(block)
        if by_columns:
            matrices = _turned(matrices)
        _check(source, line, matrices, by_columns=by_columns)
        for k, builder in enumerate(builders):
            builder.append_matrices(matrices[:, k, :3, :3], METERS[unit] * matrices[:, k, :3, 3])
        rows += len(block)
    if not rows:
        msg = f"{source.path}:{table.lines_above + 1}: no frame follows the header; export the take again"
        raise RecordingError(msg)
    numbers = frames.finish()
    return Recording(
        bodies=tuple(builder.finish() for builder in builders),
        frame=numbers,
        time_s=numbers / rate,
        rate_hz=counted_rate(source.path, numbers, numbers / rate) if table.numbered else rate,
        source=Source(
            path=str(source.path),
            sha256=source.sha256,
            layout="4 x 4 matrices",
            length_unit=unit,
            rotation_type="matrix",
        ),
        warnings=(
            *cut_warnings(source, "", rows),
            *(warning for builder in builders for warning in builder.warnings()),
            *one_body_warnings(source, len(builders), options),
        ),
    )


def _has_titles(cells: list[str]) -> bool:
    title = cells[1] if len(cells) > 1 and cells[0] == "frame" else cells[0]
    return _part(title) == _PARTS[0]


def _part(title: str) -> str:
    found = _TITLE.fullmatch(title)
    return found["part"].casefold() if found else ""


def _titled(source: TextSource, titles: list[str]) -> _Table:
    """Take the names of bodies from their titles; each must have its sixteen."""
    line = source.first_filled()[0]
    own = titles[len(titles) % _CELLS :]
    found = [(_TITLE.fullmatch(title) or {"name": "", "part": ""}) for title in own]
    names = [str(one["name"]) for one in found[::_CELLS]]
    whole = len(titles) % _CELLS <= 1 and len(set(names)) == len(names)
    for k, one in enumerate(found):
        part = one["part"].casefold().replace("tz", "ty")
        whole &= (one["name"], part) == (names[k // _CELLS], _PARTS[k % _CELLS])
    if not whole:
        msg = (
            f"{source.path}:{line}: expected XMALab's titles, _R11 to _1, sixteen for each body and each body once, "
            f"found {len(own)}, of {', '.join(dict.fromkeys(names))[:60]}; export the transformations again"
        )
        raise RecordingError(msg)
    return _Table(line, len(titles), names)


def _blocks(source: TextSource, table: _Table) -> Iterator[tuple[Float | None, Float]]:
    """Yield the frame numbers of many rows, None where rows are the clock, and their matrices' cells."""
    columns, numbered, above = range(table.width), table.numbered, table.lines_above
    blocks = read_blocks(source, above, columns, table.width, exact=True, nan_word=True, blank_rows=not numbered)
    for block in blocks:
        yield (block[:, 0], block[:, 1:]) if numbered else (None, block)


def _matrices(block: Float) -> Float:
    """Matrices (n, bodies, 4, 4) of rows of cells, as if these went row by row."""
    return block.reshape(len(block), -1, 4, 4)


def _turned(matrices: Float) -> Float:
    return np.swapaxes(matrices, -1, -2)


def _lost(matrices: Float) -> Bool:
    flat = matrices.reshape(*matrices.shape[:-2], _CELLS)
    lost: Bool = ~np.isfinite(flat).all(axis=-1) | (flat[..., :15] == 0.0).all(axis=-1)
    return lost


def _ends_so(matrices: Float) -> Bool:
    so: Bool = (np.abs(matrices[..., 3, :] - _BOTTOM) < _EXACT).all(axis=-1)
    return so


def _by_columns(source: TextSource, table: _Table) -> bool:
    """Whether the matrices stand column by column, by the first that can be so in one way only.

    Raises
    ------
    RecordingError
        If all can be either, which are different rotations: no position is other than 0.
    """
    differs = False
    for _, block in _blocks(source, table):
        matrices = _matrices(block)
        known = ~_lost(matrices)
        rows, columns = _ends_so(matrices), _ends_so(_turned(matrices))
        told = known & (rows != columns)
        if told.any():
            return not bool(rows[told][0])
        R = matrices[known][:, :3, :3]
        differs = differs or bool((np.abs(R - _turned(R)) > _EXACT).any())
    if differs:
        msg = (
            f"{source.path}: all positions are 0, so nothing tells whether the matrices stand row by row or column by "
            "column, which are opposite rotations; export them with their positions"
        )
        raise RecordingError(msg)
    return False


def _check(source: TextSource, line: int, matrices: Float, *, by_columns: bool) -> None:
    bad = ~(_lost(matrices) | _ends_so(matrices))
    if bad.any():
        row, body = (int(k[0]) for k in np.nonzero(bad))
        place = "every fourth cell" if by_columns else "the last four cells"
        found = ", ".join(f"{x:g}" for x in matrices[row, body, 3])
        msg = (
            f"{source.path}:{line + row + 1}: expected 0, 0, 0, 1 in {place} of matrix {body + 1}, as in the rows "
            f"before, found {found}; export the take again"
        )
        raise RecordingError(msg)
