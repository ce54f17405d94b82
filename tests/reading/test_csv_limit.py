"""The longest cell that `csv` reads is a setting of the process, and not ours to change."""

from __future__ import annotations

import csv
import subprocess
import sys
from pathlib import Path

import pytest

from elbowscrew.errors import ResultError
from elbowscrew.reading.source import open_source
from elbowscrew.report.study import _rows


def test_an_import_leaves_the_limit() -> None:
    code = (
        "import csv; before = csv.field_size_limit(); import elbowscrew.cli, elbowscrew.reading.source; "
        "assert csv.field_size_limit() == before"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_long_cells_are_read_and_leave_the_limit(tmp_path: Path) -> None:
    before = csv.field_size_limit(77_777)
    try:
        path = tmp_path / "long.csv"
        path.write_text("a,b\n")
        long = "x" * 200_000
        assert open_source(path).cells(f"{long},1") == [long, "1"]
        assert _rows(path) == [["a", "b"]]
        path.write_text("a," + "y" * 2_000_000 + "\n")
        with pytest.raises(ResultError, match="not a table of a batch"):
            _rows(path)
        assert csv.field_size_limit() == 77_777
    finally:
        csv.field_size_limit(before)
