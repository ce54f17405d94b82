from __future__ import annotations

import os
from pathlib import Path

import matplotlib as mpl
import pytest

mpl.use("Agg")

ROOT = Path(__file__).parent.parent


@pytest.fixture(scope="session")
def root() -> Path:
    """The project's folder."""
    return ROOT


@pytest.fixture(scope="session")
def samples() -> Path:
    return ROOT / "sample_data"


@pytest.fixture(scope="session")
def real_data() -> Path:
    """Folder of the real recordings, which are not part of the project."""
    folder = os.environ.get("ELBOWSCREW_REAL_DATA", "")
    if not folder or not Path(folder).is_dir():
        pytest.skip("ELBOWSCREW_REAL_DATA names no folder")
    return Path(folder)
