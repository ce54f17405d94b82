"""Tables of 4 x 4 matrices without a header, as biplane X-ray gives them: a row a frame, 16 numbers a body.

Each matrix is body to laboratory, row by row (the last four numbers are 0, 0, 0, 1) or column by column (every fourth
is). There is no unit, and no clock but for a first column of frame numbers, if there is one. Blanks, "nan" and zeros
are lost frames.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from elbowscrew.errors import Missing, MissingStatementError, RecordingError
from elbowscrew.geometry.arrays import Bool, Float
from elbowscrew.model import QualityWarning, Recording, Source
from elbowscrew.quantities import METERS
from elbowscrew.reading.builders import ArrayBuilder, BodyBuilder
from elbowscrew.reading.cells import parse_number, read_blocks
from elbowscrew.reading.clock import check_frames, counted_rate, cut_warnings, frames_and_times
from elbowscrew.reading.options import ASK_FOR_UNITS, ReadOptions
from elbowscrew.reading.source import TextSource

_CELLS: Final = 16
# The last row of a matrix, as it may be printed.
_BOTTOM: Final = np.array([0.0, 0.0, 0.0, 1.0])
_EXACT: Final = 1e-6


def recognizes(cells: list[str]) -> bool:
    """Tell by 16 numbers a body that end, or of which every fourth ends, as a pose's matrix does, or are blank."""
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
    scale, rate = _stated(source, options)
    width = _width(source)
    by_columns = _by_columns(source, width)
    bodies = width // _CELLS
    builders = [BodyBuilder(name) for name in _names(source, bodies)]
    frames, rows = ArrayBuilder(dtype=np.int64), 0
    for frame, block in _blocks(source, width):
        ticks = frames_and_times(frame, None, range(rows, rows + len(block)), rate)
        check_frames(source, rows, ticks)
        frames.append(ticks[:, 0].astype(np.int64))
        matrices = _matrices(block)
        if by_columns:
            matrices = _turned(matrices)
        _check(source, rows, matrices, by_columns=by_columns)
        for k, builder in enumerate(builders):
            builder.append_matrices(matrices[:, k, :3, :3], scale * matrices[:, k, :3, 3])
        rows += len(block)
    numbers = frames.finish()
    return Recording(
        bodies=tuple(builder.finish() for builder in builders),
        frame=numbers,
        time_s=numbers / rate,
        rate_hz=rate if width % _CELLS == 0 else counted_rate(source.path, numbers, numbers / rate),
        source=Source(
            path=str(source.path),
            sha256=source.sha256,
            layout="4 x 4 matrices",
            length_unit=str(options.units),
            rotation_type="matrix",
        ),
        warnings=(
            *cut_warnings(source, "", rows),
            *(warning for builder in builders for warning in builder.warnings()),
            *(_one_body(source) if bodies == 1 and options.alone else ()),
        ),
    )


def _stated(source: TextSource, options: ReadOptions) -> tuple[float, float]:
    """Give the unit in meters and the frames a second, which the file has not; ask for both at once."""
    if options.units is None or options.rate_hz is None:
        asked = [
            Missing("units", "states no unit of length", ASK_FOR_UNITS),
            Missing("rate_hz", "has no times", "--rate HZ"),
        ]
        raise MissingStatementError.of(source.path, *(one for one in asked if getattr(options, one.setting) is None))
    return METERS[options.units], options.rate_hz


def _width(source: TextSource) -> int:
    cells = source.cells(next(line for line in source.lines() if line.strip(", ;\t")))
    while not cells[-1]:
        cells.pop()
    return len(cells)


def _blocks(source: TextSource, width: int) -> Iterator[tuple[Float | None, Float]]:
    """Yield the frame numbers of many rows, None where rows are the clock, and their matrices' cells."""
    numbered = width % _CELLS == 1
    for block in read_blocks(source, 0, range(width), width, nan_word=True, blank_rows=not numbered):
        yield (block[:, 0], block[:, 1:]) if numbered else (None, block)


def _names(source: TextSource, bodies: int) -> list[str]:
    """Name one body as its file, as nothing else names it, and several by their places."""
    return [source.path.stem] if bodies == 1 else [f"body {k}" for k in range(1, bodies + 1)]


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


def _by_columns(source: TextSource, width: int) -> bool:
    """Whether the matrices stand column by column, by the first that can be so in one way only.

    Raises
    ------
    RecordingError
        If all can be either, which are different rotations: no position is other than 0.
    """
    differs = False
    for _, block in _blocks(source, width):
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


def _check(source: TextSource, rows: int, matrices: Float, *, by_columns: bool) -> None:
    bad = ~(_lost(matrices) | _ends_so(matrices))
    if bad.any():
        row, body = (int(k[0]) for k in np.nonzero(bad))
        place = "every fourth cell" if by_columns else "the last four cells"
        found = ", ".join(f"{x:g}" for x in matrices[row, body, 3])
        msg = (
            f"{source.path}:{rows + row + 1}: expected 0, 0, 0, 1 in {place} of matrix {body + 1}, as in the rows "
            f"before, found {found}; export the take again"
        )
        raise RecordingError(msg)


def _one_body(source: TextSource) -> tuple[QualityWarning]:
    name = source.path.name
    message = (
        f"the file has the matrices of one body only: its motion in the laboratory is told, not that of a joint; for a "
        f"joint give both files, the proximal body's first, as in 'analyze PROXIMAL.tra {name}'"
    )
    return (QualityWarning(code="one-body", message=message),)
