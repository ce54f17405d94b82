"""Reading and writing beside pandas, polars and a copy of the same bytes: ``python benchmarks/tables.py``."""

from __future__ import annotations

import shutil
import tempfile
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from rows import Row, alternate, clean_environment, share, table
from trial import long_export

from elbowscrew import read_recording
from elbowscrew.results.writing import BLOCK_ROWS, write_csv

HEADER_LINES = 7
USED = list(range(18))
COLUMNS = 20

polars: Any = import_module("polars")


def reading(folder: Path, frames: int, rounds: int) -> list[Row]:
    """Read the 18 of 50 columns that hold two bodies' poses."""
    path = long_export(folder, frames)
    times = alternate(
        {
            "ours": lambda: read_recording(path),
            "pandas with usecols": lambda: pd.read_csv(path, header=None, skiprows=HEADER_LINES, usecols=USED),
            "polars with columns": lambda: polars.read_csv(
                path, has_header=False, skip_rows=HEADER_LINES, columns=USED
            ),
            "a copy of the file": lambda: shutil.copyfile(path, folder / "copy.csv"),
        },
        rounds,
    )
    what = f"reading {frames:,} frames, with checks, digest and poses"
    return [share(what, times, name) for name in times if name != "ours"]


def writing(folder: Path, frames: int, rounds: int) -> list[Row]:
    """Write 20 columns of numbers that read back as the same."""
    rng = np.random.default_rng(4)
    columns = {f"c{k}": rng.normal(size=frames) for k in range(COLUMNS)}
    frame, polar = pd.DataFrame(columns), polars.DataFrame(columns)

    def ours() -> None:
        starts = range(0, frames, BLOCK_ROWS)
        blocks = ({name: values[k : k + BLOCK_ROWS] for name, values in columns.items()} for k in starts)
        (folder / "ours.csv").unlink(missing_ok=True)
        write_csv(folder / "ours.csv", blocks)

    ours()
    times = alternate(
        {
            "ours": ours,
            "pandas": lambda: frame.to_csv(folder / "pandas.csv", index=False),
            "polars": lambda: polar.write_csv(folder / "polars.csv"),
            "a copy of the file": lambda: shutil.copyfile(folder / "ours.csv", folder / "copy.csv"),
        },
        rounds,
    )
    what = f"writing {frames:,} rows of {COLUMNS} columns"
    return [share(what, times, name) for name in times if name != "ours"]


def measure(folder: Path, *, quick: bool) -> list[Row]:
    """Measure both, long and short."""
    found = []
    for frames, rounds in ((450, 15), (100_000 if quick else 1_000_000, 3)):
        found += [*reading(folder, frames, rounds), *writing(folder, frames, rounds)]
    return found


if __name__ == "__main__":
    clean_environment()
    with tempfile.TemporaryDirectory() as temporary:
        print(table(measure(Path(temporary), quick=False)))
