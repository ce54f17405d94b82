from __future__ import annotations

from pathlib import Path

import pytest
from finished_results import HOSTILE, ball, hostile_recording, write_rows

from elbowscrew import Settings, analyze, save_analysis, simulate_trial
from elbowscrew.report import write_study_page


@pytest.fixture(scope="session")
def result(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A finished result of 450 frames, with everything a page may show but anatomy."""
    recording = simulate_trial(frames=226, inversion=106, proximal="moving", gaps=2, repetitions=2, seed=1).recording
    return save_analysis(analyze(recording, Settings()), tmp_path_factory.mktemp("trial") / "r", figure_formats=())


@pytest.fixture(scope="session")
def hostile(tmp_path_factory: pytest.TempPathFactory) -> Path:
    recording = hostile_recording()
    settings = Settings(proximal=recording.bodies[0].name, distal=recording.bodies[1].name)
    return save_analysis(analyze(recording, settings), tmp_path_factory.mktemp("hostile") / "r", figure_formats=())


@pytest.fixture(scope="session")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A batch's folder: nine trials in three conditions, one of them far off, and two failures."""
    folder = tmp_path_factory.mktemp("study") / "my study"
    rows = []
    for k in range(18):
        recording = simulate_trial(frames=80, inversion=40, top_deg=175.0 if k == 5 else 120.0 + k, seed=k).recording
        name = f"trial {k}" if k != 7 else "trial #7 <b>%41</b>"
        save_analysis(analyze(recording), folder / name, figure_formats=(), report=k != 3)
        rows.append([name, f"s{k % 2}", ("slow", "fast")[k % 2], str(100.0 + k)])
    write_rows(folder / "summary.csv", [["trial", "subject", "condition", "theta_max_deg"], *rows])
    failures = [["data/broken.csv", "RecordingError", f"data/broken.csv:3: {HOSTILE}"], ["gone.csv", "OSError", "gone"]]
    write_rows(folder / "failures.csv", [["path", "error class", "message"], *failures])
    write_study_page(folder)
    return folder


@pytest.fixture(scope="session")
def ball_result(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return save_analysis(analyze(ball()), tmp_path_factory.mktemp("ball") / "r", figure_formats=(), report=False)
