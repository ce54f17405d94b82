"""A few points of what `benchmarks/faults.py` does at every call; a command that nobody disturbs fails it, too."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

# Where there is no compiler the script disturbs Python's own functions: both ways are tried where there is one.
WAYS = [["--python"]] if shutil.which("cc") is None else [[], ["--python"]]


@pytest.mark.skipif(sys.platform == "win32", reason="processes are forked")
@pytest.mark.parametrize("way", WAYS, ids=lambda way: "Python" if way else "shim")
def test_whatever_fails_or_dies_results_are_whole(root: Path, way: list[str], tmp_path: Path) -> None:
    names = ["analyze --force", "simulate --force"] if way else []
    done = subprocess.run(
        [sys.executable, str(root / "benchmarks" / "faults.py"), "--quick", *way, *names],
        capture_output=True, text=True, check=False, cwd=tmp_path, env={**os.environ, "TMPDIR": str(tmp_path)},
    )  # fmt: skip
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    points = re.search(r"^(\d+) points, 0 wrong", done.stdout, re.M)
    assert points is not None
    assert int(points[1]) > (20 if way else 100)
    assert list(tmp_path.iterdir()) == []
