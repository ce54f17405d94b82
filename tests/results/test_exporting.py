"""Exports hold the numbers of the CSV, as other programs' own readers see them."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest
from scipy.io import loadmat

import elbowscrew
from elbowscrew import Landmark, Landmarks, Settings, save_analysis
from elbowscrew.cli import main
from elbowscrew.errors import UsageError
from elbowscrew.results import exporting
from elbowscrew.results.result_files import RESULT_FILES

ALL = ("parquet", "mat", "sto")
LANDMARKS = Landmarks(
    side="right",
    EL=Landmark(point=np.array([0.352, 1.105, -0.19]), frame="lab"),
    EM=Landmark(point=np.array([0.268, 1.11, -0.14]), frame="lab"),
    GH=Landmark(point=np.array([0.3, 1.38, -0.19]), frame="lab"),
    US=Landmark(point=np.array([-0.02, -0.15, -0.01]), frame="distal"),
    RS=Landmark(point=np.array([0.025, -0.148, 0.008]), frame="distal"),
)


@pytest.fixture(scope="module")
def analysis() -> elbowscrew.Analysis:
    trial = elbowscrew.simulate_trial(frames=80, inversion=40, gaps=1, gap_frames=15, repetitions=2, seed=5)
    return elbowscrew.analyze(trial.recording, Settings(step_deg=20.0), landmarks=LANDMARKS)


@pytest.fixture(scope="module")
def folder(analysis: elbowscrew.Analysis, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return save_analysis(analysis, tmp_path_factory.mktemp("export") / "r", figure_formats=(), exports=ALL)


def cells(path: Path) -> dict[str, list[str]]:
    with path.open(newline="", encoding="utf-8") as stream:
        rows = list(csv.reader(stream))
    return {name: [row[k] for row in rows[1:]] for k, name in enumerate(rows[0])}


def texts(values: list[Any]) -> list[str]:
    return ["" if value is None else str(value) for value in values]


def test_parquet_holds_what_the_csv_holds(folder: Path) -> None:
    tables = sorted(path.stem for path in folder.glob("*.csv"))
    assert tables == sorted(path.stem for path in folder.glob("*.parquet"))
    assert len(tables) == 10
    for name in tables:
        expected = cells(folder / f"{name}.csv")
        table = pq.read_table(folder / f"{name}.parquet")
        assert table.column_names == list(expected)
        for column, wanted in expected.items():
            values = table[column].to_pylist()
            # The same number may be written in two ways, 1e-05 and 0.00001.
            if any(isinstance(value, float) for value in values):
                assert values == [float(text) if text else None for text in wanted]
            else:
                assert texts(values) == wanted
        summary = json.loads(table.schema.metadata[b"elbowscrew"])
        assert summary["trial"]["frames"] == 159
    assert pq.read_table(folder / "screw.parquet")["theta_deg"].null_count > 0


def test_matlab_holds_what_the_csv_holds(folder: Path) -> None:
    content = loadmat(folder / "trial.mat", simplify_cells=True)
    for path in folder.glob("*.csv"):
        table = content[path.stem]
        for column, expected in cells(path).items():
            if column.endswith("_loss") or column in ("method", "blend", "law"):
                assert [str(value) if len(value) else "" for value in table[column]] == expected
            else:
                numbers = [float(text) if text else np.nan for text in expected]
                np.testing.assert_array_equal(np.atleast_1d(table[column]), numbers)
    assert json.loads(content["summary_json"])["elbowscrew"] == elbowscrew.__version__


def test_the_storage_is_as_opensim_reads_it(folder: Path, analysis: elbowscrew.Analysis) -> None:
    lines = (folder / "joint_angle.sto").read_text().splitlines()
    end = lines.index("endheader")
    header = dict(line.split("=") for line in lines[1:end])
    labels, *rows = [line.split("\t") for line in lines[end + 1 :]]
    assert header == {"version": "1", "nRows": "159", "nColumns": "6", "inDegrees": "yes"}
    assert labels == ["time", "theta", "flexion", "carrying", "pronation", "angle1"]
    assert {len(row) for row in rows} == {6}
    values = np.array(rows, dtype=np.float64)
    assert (np.diff(values[:, 0]) > 0.0).all()
    assert np.isnan(values[:, 1]).any()
    np.testing.assert_array_equal(values[:, 1], np.degrees(analysis.screw.angle))
    assert analysis.joint_angles is not None
    np.testing.assert_array_equal(values[:, 5], np.degrees(analysis.joint_angles.angle[:, 0]) + 0.0)


def test_radians_are_told_to_opensim(tmp_path: Path) -> None:
    found = elbowscrew.analyze(elbowscrew.simulate_trial(frames=60, inversion=30).recording, Settings(angle_unit="rad"))
    save_analysis(found, tmp_path / "r", figure_formats=(), exports=("sto",))
    text = (tmp_path / "r" / "joint_angle.sto").read_text()
    assert "inDegrees=no" in text
    assert max(float(line.split("\t")[1]) for line in text.splitlines()[7:]) == pytest.approx(np.radians(130), abs=0.02)


def test_the_same_analysis_gives_the_same_bytes(folder: Path, analysis: elbowscrew.Analysis, tmp_path: Path) -> None:
    again = save_analysis(analysis, tmp_path / "again", figure_formats=(), exports=ALL)
    names = sorted(path.name for path in folder.iterdir())
    assert names == sorted(path.name for path in again.iterdir())
    for name in names:
        assert (folder / name).read_bytes() == (again / name).read_bytes(), name
    assert set(names) <= set(RESULT_FILES)


def test_the_command_exports_and_replaces_what_it_exported(samples: Path, tmp_path: Path) -> None:
    arguments = [
        "analyze",
        str(samples / "elbow_paper.csv"),
        "-q",
        "-o",
        str(tmp_path / "r"),
        "--figure-format",
        "none",
    ]
    assert main([*arguments, "--export", "mat", "--export", "sto"]) == 0
    assert (tmp_path / "r" / "trial.mat").exists()
    assert main([*arguments, "--force"]) == 0
    assert not (tmp_path / "r" / "trial.mat").exists()


def test_a_missing_library_is_told_before_the_work(
    samples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(exporting, "find_spec", lambda _: None)
    code = main(["analyze", str(samples / "elbow_paper.csv"), "-o", str(tmp_path / "r"), "--export", "parquet"])
    assert code == 2
    assert "pip install pyarrow" in capsys.readouterr().err
    assert not (tmp_path / "r").exists()


def test_an_unknown_format_is_named(analysis: elbowscrew.Analysis, tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="xlsx"):
        save_analysis(analysis, tmp_path / "r", exports=("xlsx",))
