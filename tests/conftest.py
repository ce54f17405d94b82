from __future__ import annotations

import os
from pathlib import Path

import matplotlib as mpl
import pytest
from hypothesis import settings

mpl.use("Agg")
# How long an example takes hangs on the machine: a deadline would be an assertion about time.
settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")

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
