from __future__ import annotations

from pathlib import Path

import pytest

import elbowscrew
from elbowscrew import Analysis


@pytest.fixture(scope="session")
def elbow(samples: Path) -> Analysis:
    """An elbow that flexes and pronates, analyzed once for all tests of the Python interface."""
    return elbowscrew.analyze(samples / "elbow_natural.csv", step_deg=10)


@pytest.fixture(scope="session")
def read_back(elbow: Analysis, tmp_path_factory: pytest.TempPathFactory) -> Analysis:
    """The same from the files of its result."""
    folder = tmp_path_factory.mktemp("interface") / "result"
    return elbowscrew.read_result(elbowscrew.save_analysis(elbow, folder, figure_formats=(), report=False))
