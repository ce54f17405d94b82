from __future__ import annotations

from pathlib import Path

import pytest

import elbowscrew
from elbowscrew import Analysis


@pytest.fixture(scope="session")
def elbow(samples: Path) -> Analysis:
    """An elbow that flexes and pronates, analyzed once for all tests of the Python interface."""
    recording = elbowscrew.read_recording(samples / "elbow_natural.csv")
    return elbowscrew.analyze(recording, elbowscrew.Settings(step_deg=10))
