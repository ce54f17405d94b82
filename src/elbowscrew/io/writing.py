"""Tables as CSV, with digits that read back as the same float64."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowscrew import tables
from elbowscrew.model import Analysis
from elbowscrew.motion.rebuilding import keyframes_of

_BLOCK_ROWS = 4096


def write_tables(folder: Path, analysis: Analysis) -> None:
    """Write ``screw.csv``, ``interpolation.csv`` and what else was asked for, in the units of the settings."""
    units = analysis.settings.angle_unit, analysis.settings.length_unit
    several = analysis.repetitions.number.size > 1
    for name, result, table in (
        ("screw", analysis.screw, tables.SCREW_COLUMNS),
        ("interpolation", analysis.interpolated, tables.INTERPOLATION_COLUMNS),
        ("keyframes", keyframes_of(analysis), tables.KEYFRAME_COLUMNS),
        ("instantaneous", analysis.instantaneous, tables.INSTANTANEOUS_COLUMNS),
        ("repetitions", analysis.repetitions, tables.REPETITION_COLUMNS),
        ("repetition_curve", analysis.repeatability if several else None, tables.CURVE_COLUMNS),
        ("steps", analysis.steps, tables.STEP_COLUMNS),
        ("anatomy", analysis.anatomy, tables.ANATOMY_COLUMNS),
    ):
        if result is not None:
            write_csv(folder / f"{name}.csv", tables.columns(result, table, *units))


def write_csv(path: Path, columns: dict[str, NDArray[Any]]) -> None:
    """Write columns of equal length; NaN and masked values become empty cells."""
    rows = len(next(iter(columns.values())))
    with path.open("w", encoding="utf-8", newline="") as stream:
        stream.write(",".join(columns) + "\n")
        for start in range(0, rows, _BLOCK_ROWS):
            block = [_texts(values[start : start + _BLOCK_ROWS]) for values in columns.values()]
            stream.writelines(",".join(cells) + "\n" for cells in zip(*block, strict=True))


def _texts(values: NDArray[Any]) -> list[str]:
    if isinstance(values, np.ma.MaskedArray):
        return ["" if value is None else str(value) for value in values.tolist()]
    if values.dtype.kind == "i":
        return [str(value) for value in values.tolist()]
    if values.dtype.kind == "U":
        return list(values.tolist())
    # Adding 0.0 turns -0.0 into 0.0; repr is the shortest text that reads back as the same number.
    with np.errstate(invalid="ignore"):  # a NaN may be a signaling one
        plain = values + 0.0
    return ["" if value != value else repr(value) for value in plain.tolist()]
