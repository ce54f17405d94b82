"""A little of `benchmarks/fuzz_results.py`: what somebody, or a disk, has edited ends in no traceback."""

from __future__ import annotations

import importlib.util
import math
from pathlib import Path


def test_edited_files_are_read_or_refused(root: Path) -> None:
    found = importlib.util.spec_from_file_location("fuzz_results", root / "benchmarks" / "fuzz_results.py")
    assert found is not None
    assert found.loader is not None
    fuzz = importlib.util.module_from_spec(found)
    found.loader.exec_module(fuzz)
    outcomes = fuzz.run(100, 100, longest_s=math.inf)
    assert sum(outcomes.values()) == 100
    assert any(name.endswith("refused") for name in outcomes)
    assert any(name.endswith("read") for name in outcomes)
