"""Tables on disk."""

from __future__ import annotations

import csv
import struct
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from elbowscrew import (
    ComparisonPlan,
    analyze,
    compare_trials,
    interpolate,
    keyframes_of,
    save_comparison,
    save_motion,
    save_simulation,
    simulate_trial,
)
from elbowscrew.results.writing import write_csv, write_table, write_tables

SCREW_NAMES = (
    "frame time_s valid theta_deg slide_mm axis_x axis_y axis_z point_x_mm point_y_mm point_z_mm "
    "e0 e1 e2 e3 d_x_mm d_y_mm d_z_mm filled proximal_loss distal_loss "
    "theta_sd_deg slide_sd_mm axis_sd_deg point_sd_mm axis_cone95_deg point_radius95_mm"
).split()
INTERPOLATION_NAMES = (
    "frame time_s phase t theta_deg slide_mm e0 e1 e2 e3 d_x_mm d_y_mm d_z_mm "
    "angle_error_deg translation_error_mm rms_displacement_mm axis_error_deg axis_distance_mm"
).split()


@example(values=[struct.unpack("d", struct.pack("Q", 0x7FF5C8156B897724))[0]])  # a signaling NaN
@given(values=st.lists(st.floats(allow_nan=True, allow_infinity=True), min_size=1, max_size=20))
def test_numbers_read_back_as_the_same_float(tmp_path_factory: pytest.TempPathFactory, values: list[float]) -> None:
    path = tmp_path_factory.mktemp("csv") / "t.csv"
    write_csv(path, [{"value": np.array(values), "n": np.arange(len(values))}])
    with path.open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    for row, value in zip(rows, values, strict=True):
        assert row["value"] == "" if np.isnan(value) else float(row["value"]) == value


def test_every_kind_of_cell_and_block(tmp_path: Path) -> None:
    count = 9000
    number = np.linspace(-1e-7, 1e17, count)
    number[::7] = np.nan
    number[:3] = (-0.0, 5e-324, 123.0)
    phase = np.ma.array(np.arange(count), mask=np.arange(count) % 5 == 0)
    flag = np.arange(count) % 2 == 0
    word = np.where(flag, "blank", "")
    columns = {"x": number, "phase": phase, "flag": flag.astype(np.int64), "word": word}
    blocks = (slice(0, 4096), slice(4096, 4096), slice(4096, count))
    write_csv(tmp_path / "t.csv", ({name: values[rows] for name, values in columns.items()} for rows in blocks))
    lines = (tmp_path / "t.csv").read_bytes().split(b"\n")
    assert lines[0] == b"x,phase,flag,word"
    assert lines[1] == b"0.0,,1,blank"
    assert lines[-1] == b""
    rows = [line.decode().split(",") for line in lines[1:-1]]
    assert len(rows) == count
    numbers = np.array([float(row[0] or "nan") for row in rows])
    assert np.array_equal(numbers, number, equal_nan=True)
    assert [row[1] for row in rows] == ["" if k % 5 == 0 else str(k) for k in range(count)]
    assert [row[2:] for row in rows] == [["1", "blank"] if on else ["0", ""] for on in flag]


def test_the_columns_are_the_contract(tmp_path: Path) -> None:
    analysis = analyze(simulate_trial(frames=60, inversion=30, gaps=2, gap_frames=12).recording)
    write_tables(tmp_path, analysis)
    for name, expected in (("screw.csv", SCREW_NAMES), ("interpolation.csv", INTERPOLATION_NAMES)):
        lines = (tmp_path / name).read_text().splitlines()
        assert lines[0].split(",") == expected
        assert len(lines) == 61
    frame = analysis.screw.to_frame()
    assert list(frame.columns) == SCREW_NAMES
    assert list(analysis.interpolated.to_frame().columns) == INTERPOLATION_NAMES
    lost = frame["valid"] == 0
    assert lost.sum() == 24
    assert frame.loc[lost, "theta_deg"].isna().all()
    assert (frame["distal_loss"] == np.where(lost, "blank", "")).all()
    assert (frame["proximal_loss"] == "").all()


def test_units_change_names_and_values_together(tmp_path: Path) -> None:
    analysis = analyze(simulate_trial(frames=60, inversion=30).recording)
    default = analysis.screw.columns()
    si = analysis.screw.columns("rad", "m")
    assert np.degrees(si["theta_rad"]) == pytest.approx(default["theta_deg"], nan_ok=True)
    for name in ("slide", "point_x", "d_z"):
        assert 1000 * si[f"{name}_m"] == pytest.approx(default[f"{name}_mm"], nan_ok=True)
    assert list(analysis.interpolated.to_frame("rad", "m").columns[-5:]) == [
        "angle_error_rad", "translation_error_m", "rms_displacement_m", "axis_error_rad", "axis_distance_m",
    ]  # fmt: skip


def test_frames_outside_the_keyframes_have_no_phase(tmp_path: Path) -> None:
    from elbowscrew import Settings

    analysis = analyze(
        simulate_trial(frames=60, inversion=30).recording, Settings(keyframes=(10, 30, 50), inversion=30)
    )
    write_tables(tmp_path, analysis)
    rows = [line.split(",") for line in (tmp_path / "interpolation.csv").read_text().splitlines()[1:]]
    assert [row[2] for row in rows] == [""] * 10 + ["1"] * 20 + ["2"] * 21 + [""] * 9
    assert all(cell == "" for row in rows[:10] for cell in row[2:])
    phases = analysis.interpolated.to_frame()["phase"]
    assert phases.isna().sum() == 19


def test_what_is_not_known_of_compared_models_is_empty(tmp_path: Path) -> None:
    trial = tmp_path / "trial.csv"
    save_simulation(simulate_trial(frames=60, inversion=30), trial)
    plan = ComparisonPlan(laws=("linear",), methods=("sclerp",), counts=(2,), data=("raw",))
    save_comparison(compare_trials([trial], plan=plan), tmp_path / "found", figure_formats=())
    with (tmp_path / "found" / "compare.csv").open(newline="") as stream:
        (row,) = csv.DictReader(stream)
    assert float(row["rms_displacement_mean_mm"]) > 0.0
    assert row["rms_displacement_sd_mm"] == row["ns_per_frame_sd"] == ""  # a single trial has no deviation


def test_a_motion_is_written_without_a_temporary_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    keyframes = keyframes_of(analyze(simulate_trial(frames=60, inversion=30).recording))
    motion = interpolate(keyframes, 20)
    write_table(tmp_path / "table.csv", motion, "deg", "mm")
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "missing"))
    assert save_motion(motion, tmp_path / "motion.csv").read_bytes() == (tmp_path / "table.csv").read_bytes()
