from __future__ import annotations

import contextlib
import io
import os
from pathlib import Path

import numpy as np
import pytest
from motive_files import BodyData, write_columns
from scipy.spatial.transform import Rotation
from told_results import Told

from elbowscrew.cli import main

LANDMARKS = """side = "left"
[landmarks]
EL = { body = "lab", mm = [-352.0, 1105.0, -190.0] }
EM = { body = "lab", mm = [-268.0, 1110.0, -140.0] }
GH = { body = "lab", mm = [-300.0, 1380.0, -190.0] }
US = { body = "forearm", mm = [20.0, -150.0, -10.0] }
RS = { body = "forearm", mm = [-25.0, -148.0, 8.0] }
"""
CYCLES = ("--frames", "161", "--inversion", "80", "--repetitions", "4", "--gaps", "3", "--arm", "moving",
          "--sign-flips", "--seed", "7", "--marker-noise", "0.3")  # fmt: skip
LOST = ("--frames", "200", "--inversion", "90", "--gaps", "1", "--gap-frames", "30", "--arm", "moving", "--seed", "3",
        "--length-unit", "mm", "--top", "150")  # fmt: skip
TRIALS: dict[str, tuple[str, tuple[str, ...]]] = {
    "paper": ("elbow_paper.csv", ()),
    "left": ("elbow_left.csv", ("--landmarks", "marks.toml", "--express-in", "lab", "--keyframes", "0,70,150,230,299",
                                "--radius", "40", "--knots", "chord", "--method", "dib")),
    "knee": ("knee.csv", ("--landmarks", "knee.landmarks.toml", "--tolerance", "2mm")),
    "cycles": ("cycles.csv", ("--reference", "33", "--step", "20", "--angle-unit", "rad", "--length-unit", "m",
                              "--express-in", "proximal")),
    "lost": ("lost.csv", ("--law", "harmonic", "--phases", "whole", "--marker-noise", "0.4", "--reference", "5",
                          "--reference-window", "3", "--export", "sto")),
    "two_axes": ("two_axes.csv", ("--express-in", "proximal",)),
    "ball": ("ball.csv", ("--proximal", "none", "--distal", "Thigh", "--method", "sclerp", "--no-cycles")),
}  # fmt: skip


@pytest.fixture(scope="session")
def told(request: pytest.FixtureRequest, root: Path, tmp_path_factory: pytest.TempPathFactory) -> Told:
    """One analyzed trial, as the command line tells it."""
    source, options = TRIALS[request.param]
    folder = tmp_path_factory.mktemp(request.param)
    path = root / "sample_data" / source
    if not path.exists():
        path = folder / source
        if source in ("cycles.csv", "lost.csv"):
            said("simulate", str(path), *(CYCLES if source == "cycles.csv" else LOST))
        else:
            write_columns(path, two_axes() if source == "two_axes.csv" else ball(), header={"Take Name": source[:-4]})
    if "--landmarks" in options:
        (folder / "marks.toml").write_text(LANDMARKS, encoding="utf-8")
        places = {"marks.toml": folder, "knee.landmarks.toml": root / "sample_data"}
        options = tuple(str(places[option] / option) if option in places else option for option in options)
    out = folder / "result"
    options = ("--figure-format", "none", *options)
    return Told(out, path, options, said("analyze", str(path), "-o", str(out), *options))


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    if "told" in metafunc.fixturenames:
        metafunc.parametrize("told", list(TRIALS), indirect=True, scope="session")


def said(*arguments: str) -> str:
    """What a command writes on standard output, without line breaks inside a cell."""
    out, before = io.StringIO(), os.environ.get("COLUMNS")
    os.environ["COLUMNS"] = "1000"
    try:
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(io.StringIO()) as err:
            assert main(list(arguments)) == 0, err.getvalue()
    finally:
        if before is None:
            del os.environ["COLUMNS"]
        else:
            os.environ["COLUMNS"] = before
    return out.getvalue()


def turned(direction: list[float], degrees: np.ndarray) -> Rotation:
    axis = np.array(direction) / np.linalg.norm(direction)
    return Rotation.from_rotvec(np.radians(degrees)[:, None] * axis)


def two_axes() -> list[BodyData]:
    """Flexion and, beside it, pronation about an axis across; some noise, no markers."""
    rng = np.random.default_rng(5)
    time = np.linspace(0.0, 1.0, 240)
    flexion = turned([0.98, 0.10, 0.17], 55.0 * (1.0 - np.cos(4.0 * np.pi * time)))
    pronation = turned([0.10, -0.99, 0.05], 40.0 * (1.0 - np.cos(6.0 * np.pi * time)))
    noise = Rotation.from_rotvec(np.radians(0.1) * rng.normal(size=(240, 3)))
    # The pronation's axis goes through (10, -300, 0) mm, the flexion's through (0, -280, 10) mm of the upper arm.
    p, q, origin = np.array([0.0, -0.28, 0.01]), np.array([0.01, -0.30, 0.0]), np.array([0.02, -0.4, 0.01])
    place = flexion.apply(pronation.apply(origin - q) + q - p) + p + 2e-4 * rng.normal(size=(240, 3))
    still = BodyData("Upper Arm", "A" * 32, np.tile(np.eye(3), (240, 1, 1)), 1e-5 * rng.normal(size=(240, 3)))
    return [still, BodyData("Forearm", "B" * 32, (flexion * pronation * noise).as_matrix(), place)]


def ball() -> list[BodyData]:
    """Two rotations across each other about one point: no axis dominates."""
    turn = np.linspace(0.0, 2.0 * np.pi, 150)
    R = Rotation.from_rotvec(np.stack([np.sin(turn), np.sin(2.0 * turn), 0.3 * np.cos(turn)], axis=1))
    place = np.array([0.03, 1.2, 0.08]) + R.apply([0.0, -0.25, 0.0])
    return [BodyData("Thigh", "C" * 32, R.as_matrix(), place)]


@pytest.fixture
def two_rotations() -> list[BodyData]:
    """A body of a joint that no axis dominates."""
    return ball()
