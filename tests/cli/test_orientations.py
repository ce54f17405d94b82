"""Trials without positions through every command: said in words, drawn where it can be, and empty where it is."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles import known_trial
from plain_pages import plain

from elbowscrew.cli import main
from elbowscrew.geometry.quaternion import quat_from_rotation_matrix

TRIAL = known_trial(100.0, frames=120, inversion=60, slide=0.0, seed=4, gentle=True)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two trials of inertial sensors with a little noise."""
    root = tmp_path_factory.mktemp("study") / "sensors"
    root.mkdir()
    for seed in (1, 2):
        rng = np.random.default_rng(seed)
        quats = [
            quat_from_rotation_matrix(np.array(R)) + 2e-4 * rng.normal(size=(120, 4))
            for R in (TRIAL.proximal_R, TRIAL.distal_R)
        ]
        rows = ["DataRate=100.0", "DataType=Quaternion", "endheader", "time\thumerus_r_imu\tulna_r_imu"]
        for k in range(120):
            cells = [",".join(f"{x:.8f}" for x in quat[k] / np.linalg.norm(quat[k])) for quat in quats]
            rows.append("\t".join([f"{k / 100:.3f}", *cells]))
        (root / f"take{seed}.sto").write_text("\n".join(rows) + "\n")
    return root


@pytest.fixture(scope="module")
def result(folder: Path) -> Path:
    target = folder.parent / "result"
    options = ["--export", "sto", "--export", "mat", "--export", "parquet", "--step", "10", "--tolerance", "2deg"]
    assert main(["analyze", str(folder / "take1.sto"), "-o", str(target), "--method", "joint", *options]) == 0
    return target


def test_the_terminal_says_once_that_there_are_no_positions(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert (
        main(["analyze", str(folder / "take1.sto"), "-o", str(folder.parent / "said"), "--figure-format", "none"]) == 0
    )
    out, err = capsys.readouterr()
    assert err.count("[no-positions]") == 1
    assert "Slide        not known, as all places: there are orientations and no positions" in " ".join(
        out.splitlines()
    )
    assert "for the sensors' frames" in " ".join(out.split())
    assert not re.search(r"\bmm\b", out)
    assert "nan" not in out


def test_info_says_that_bodies_have_no_positions(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["info", str(folder / "take1.sto")]) == 0
    out = capsys.readouterr().out
    assert "OpenSim storage, quaternion, no positions" in out
    assert len(re.findall(r"deg/s, no\b", out)) == 2


def test_tables_leave_places_empty(result: Path) -> None:
    empty = {"screw.csv": 17, "interpolation.csv": 7, "keyframes.csv": 9, "steps.csv": 7, "instantaneous.csv": 4}
    for name, least in empty.items():
        with (result / name).open(newline="") as stream:
            rows = list(csv.DictReader(stream))
        lengths = [column for column in rows[0] if column.endswith(("_mm", "_mm_s"))]
        assert len(lengths) >= min(least, 4)
        assert all(row[column] == "" for row in rows for column in lengths)
        assert "nan" not in (result / name).read_text()


def test_pages_and_figures_leave_out_what_needs_places_and_say_why(result: Path) -> None:
    figures = {path.name for path in (result / "figures").glob("*.png")}
    assert figures == {"theta.png", "euler_parameters.png", "error.png"}
    assert "displacement" not in (result / "figures" / "error.caption.txt").read_text()
    page = (result / "report.html").read_text()
    assert "There are orientations and no positions" in page
    assert "the view in space, the pictures of the axes, and all numbers of places and lengths are left out" in page
    assert 'id="viewer"' not in page
    assert "Orientations of the segments, and no positions, were recorded at 100 Hz." in plain(page)
    assert "the angle to the measured orientation stays within 2°" in page
    assert not re.search(r"\bnan\b|>None<", page)
    assert main(["report", str(result)]) == 0
    assert (result / "report.html").read_text() == page


def test_figures_for_publication_are_those_that_can_be_drawn(
    result: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert (
        main(["report", str(result), "--figures", "theta,axis,joint_angles,velocity", "-o", str(tmp_path / "figures")])
        == 0
    )
    drawn = {path.name for path in (tmp_path / "figures").glob("*.pdf")}
    assert drawn == {"theta.pdf", "joint_angles.pdf", "velocity.pdf"}
    assert "has nothing for the figure axis, which is left out" in capsys.readouterr().err


def test_keyframes_are_read_back_without_places(result: Path, tmp_path: Path) -> None:
    target = tmp_path / "motion.csv"
    assert main(["interpolate", str(result / "keyframes.csv"), "--frames", "120", "-o", str(target)]) == 0
    with target.open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    with (result / "interpolation.csv").open(newline="") as stream:
        modeled = list(csv.DictReader(stream))
    for row, model in zip(rows, modeled, strict=True):
        assert abs(float(row["theta_deg"])) == pytest.approx(abs(float(model["theta_deg"])), abs=1e-6)
        assert {row[name] for name in ("slide_mm", "d_x_mm", "d_y_mm", "d_z_mm")} == {""}


def test_exports_hold_what_is_known(result: Path) -> None:
    from scipy.io import loadmat

    screw = loadmat(result / "trial.mat")["screw"][0, 0]
    assert np.isnan(screw["slide_mm"]).all()
    assert np.isfinite(screw["theta_deg"]).all()
    assert (result / "joint_angle.sto").read_text().count("\n") == 120 + 7


def test_a_batch_takes_them_from_folders(folder: Path, tmp_path: Path) -> None:
    target = tmp_path / "study"
    assert main(["batch", str(folder), "-o", str(target), "--figure-format", "none"]) == 0
    with (target / "summary.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [row["path"] for row in rows] == ["take1.sto", "take2.sto"]
    for row in rows:
        assert row["joint_type"] == "hinge"
        assert float(row["theta_max_deg"]) == pytest.approx(100.0, abs=0.5)
        assert {row[name] for name in row if name.endswith(("_mm", "_mm_per_rad"))} == {""}
        assert "no-positions" in row["warnings"]
    index = (target / "index.html").read_text()
    assert not re.search(r"\bnan\b", index.casefold())


@pytest.mark.parametrize("trials", [1, 2])
def test_comparisons_are_of_angles(folder: Path, tmp_path: Path, capsys: Any, trials: int) -> None:
    path = folder / "take1.sto" if trials == 1 else folder
    plan = ["--laws", "linear,polynomial-345", "--counts", "2,3", "--data", "raw", "--methods", "dlb,sclerp"]
    assert main(["compare", str(path), *plan, "-o", str(tmp_path / "compared")]) == 0
    out = capsys.readouterr().out
    assert "RMS, deg" in out
    found = json.loads((tmp_path / "compared" / "compare.json").read_text())
    best = found["best"]
    key = "rms_angle_error_deg" if trials == 1 else "rms_angle_error_mean_deg"
    assert [one[key] for one in best] == sorted(one[key] for one in best)
    assert best[0]["law"] == "polynomial-345"
    selection = (found if trials == 1 else found["trials"][0])["selections"]["sclerp"]
    assert selection["tolerance_deg"] == pytest.approx(2.0)
    assert selection["tolerance_mm"] is None
    assert selection["curve"][-1]["max_angle_deg"] <= 2.0
    assert (tmp_path / "compared" / "figures" / "compare.png").is_file()


def test_what_does_not_fit_ends_with_exit_code_4(folder: Path, tmp_path: Path, capsys: Any) -> None:
    for option in (["--marker-noise", "1"], ["--joint-type", "screw-hinge"]):
        assert main(["analyze", str(folder / "take1.sto"), "-o", str(tmp_path / "none"), *option]) == 4
        assert capsys.readouterr().err.count("\n") == 1
