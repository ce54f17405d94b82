"""TRC files as programs of the field write them: each is a change of one file, and says the same."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from elbowscrew import read_recording
from elbowscrew.errors import NoBodiesError, RecordingError, SettingError
from elbowscrew.geometry.arrays import Float

NAMES = ("A1", "A2", "F1")
PLACES: Float = np.round(np.random.default_rng(4).uniform(0.1, 2.0, (6, 9)), 6)


def lines(unit: str = "m") -> list[str]:
    """A plain file, by the description of the format."""
    return [
        "PathFileType\t4\t(X/Y/Z)\ttrial.trc",
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames",
        f"50.00\t50.00\t6\t3\t{unit}\t50.00\t1\t6",
        "Frame#\tTime\tA1\t\t\tA2\t\t\tF1\t\t",
        "\t\tX1\tY1\tZ1\tX2\tY2\tZ2\tX3\tY3\tZ3",
        "",
        *("\t".join([str(k + 1), f"{k / 50:.3f}", *(f"{x:.6f}" for x in row)]) for k, row in enumerate(PLACES)),
    ]


def write(path: Path, rows: list[str]) -> Path:
    path.write_text("\n".join(rows) + "\n")
    return path


def opencap(rows: list[str]) -> list[str]:
    return ["PathFileType  4\t(X/Y/Z) C:\\lab,a\\PostAugmentation", *rows[1:]]


def doubled_tabs(rows: list[str]) -> list[str]:
    return [row.replace("\t", "\t\t") if 0 < k < 3 else row for k, row in enumerate(rows)]


def doubled_tabs_over_the_axes(rows: list[str]) -> list[str]:
    return [
        *rows[:3],
        "Frame#\tTime\t\tA1\t\t\t\tA2\t\tF1",
        "\t\t\t" + rows[4].strip().replace("Z1\t", "Z1\t\t"),
        *rows[5:],
    ]


def names_in_a_row(rows: list[str]) -> list[str]:
    return [*rows[:3], "Frame#\tTime\tA1\tA2\tF1", *rows[4:]]


def blanks_for_tabs(rows: list[str]) -> list[str]:
    return [row.replace("\t", "  ") if k < 3 else row for k, row in enumerate(rows)]


def commas(rows: list[str]) -> list[str]:
    return [row.replace("\t", ",") for row in rows]


def names_without_columns(rows: list[str]) -> list[str]:
    return [*rows[:3], rows[3] + "\tV_Elbow\t\t\tV_Wrist", *rows[4:6], *(row + "\t" * 6 for row in rows[6:])]


def unnamed_markers_in_some_rows(rows: list[str]) -> list[str]:
    return [row + "\t0.5\t0.6\t0.7" * (k % 3) if k > 6 else row for k, row in enumerate(rows)]


def no_blank_line(rows: list[str]) -> list[str]:
    return [*rows[:5], *rows[6:]]


def trailing_tabs(rows: list[str]) -> list[str]:
    return [row + "\t" for row in rows]


def windows(rows: list[str]) -> list[str]:
    return [row + "\r" for row in rows]


@pytest.mark.parametrize(
    "change",
    [
        opencap,
        doubled_tabs,
        doubled_tabs_over_the_axes,
        names_in_a_row,
        blanks_for_tabs,
        commas,
        names_without_columns,
        unnamed_markers_in_some_rows,
        no_blank_line,
        trailing_tabs,
        windows,
    ],
)
def test_what_programs_make_of_the_format_says_the_same(
    tmp_path: Path, change: Callable[[list[str]], list[str]]
) -> None:
    recording = read_recording(write(tmp_path / "t.trc", change(lines())), markers="*")
    assert [marker.name for marker in recording.markers] == list(NAMES)
    assert np.concatenate([marker.position for marker in recording.markers], axis=1) == pytest.approx(PLACES, abs=1e-12)
    assert recording.frame.tolist() == [1, 2, 3, 4, 5, 6]
    assert recording.rate_hz == pytest.approx(50.0)
    taken_in_order = "markers-in-order" in {warning.code for warning in recording.warnings}
    assert taken_in_order == (change in (doubled_tabs_over_the_axes, names_in_a_row))


@pytest.mark.parametrize(
    ("written", "meters"),
    [("m", 1.0), ("meters", 1.0), ("Metre", 1.0), ("mete", 1.0), ("millimetre", 1e-3), ("MM", 1e-3), ("cent", 0.01)],
)
def test_units_are_known_in_their_spellings(tmp_path: Path, written: str, meters: float) -> None:
    recording = read_recording(write(tmp_path / "t.trc", lines(written)), markers="A1")
    assert recording.markers[0].position == pytest.approx(meters * PLACES[:, :3], abs=1e-12)


@pytest.mark.parametrize("written", ["", "inch", "met", "m/s"])
def test_a_unit_that_is_not_known_is_asked_for(tmp_path: Path, written: str) -> None:
    path = write(tmp_path / "t.trc", lines(written))
    with pytest.raises(SettingError, match="give units m, cm or mm"):
        read_recording(path, markers="*")
    assert read_recording(path, markers="A1", units="cm").markers[0].position[0] == pytest.approx(0.01 * PLACES[0, :3])


@pytest.mark.parametrize("written", ["0.000000", "nan", "NaN", ""])
def test_a_marker_at_the_origin_or_not_a_number_is_not_seen(tmp_path: Path, written: str) -> None:
    rows = lines()
    rows[8] = "\t".join([*rows[8].split("\t")[:5], *[written] * 3, *rows[8].split("\t")[8:]])
    seen = read_recording(write(tmp_path / "t.trc", rows), markers="*").markers
    assert [int(np.isnan(marker.position).any(axis=1).sum()) for marker in seen] == [0, 1, 0]
    assert np.isnan(seen[1].position[2]).all()


def test_markers_of_one_name_are_told_apart(tmp_path: Path) -> None:
    path = write(tmp_path / "t.trc", [row.replace("A2\t", "A1\t") for row in lines()])
    assert [one.name for one in read_recording(path, markers="*").markers] == ["A1 (1)", "A1 (2)", "F1"]
    assert [one.name for one in read_recording(path, markers="F1").markers] == ["F1"]
    second = read_recording(path, markers="A1 (2)").markers[0]
    assert second.position == pytest.approx(PLACES[:, 3:6], abs=1e-12)
    with pytest.raises(SettingError, match=r"no marker fits A1; .*A1 \(1\), A1 \(2\), F1"):
        read_recording(path, markers="A1")


def test_what_cannot_be_told_apart_is_refused(tmp_path: Path) -> None:
    whole = lines()
    for change, says in (
        ([*whole[:3], "Frame#\tTime\tA1\tA2", *whole[4:]], "as many names as X, Y"),
        ([*whole[:9], whole[9] + "\t1.0", *whole[10:]], r"t\.trc:10: expected 11 cells, found 12"),
        ([*whole[:9], whole[9].rpartition("\t")[0], *whole[10:]], r"t\.trc:10: expected 11 cells, found 10"),
        ([*whole[:4], "\t\tX1\tZ1\tY1\tX2\tY2\tZ2\tX3\tY3\tZ3", *whole[5:]], "expected its X, Y, Z below its name"),
        (whole[:3], "the header is cut"),
        (whole[:6], "no frame follows the header"),
        ([*whole[:8], whole[8].replace("\t", "\tx", 3), *whole[9:]], "expected a number"),
    ):
        with pytest.raises(RecordingError, match=says):
            read_recording(write(tmp_path / "t.trc", change), markers="*")


def test_names_that_fit_nothing_are_answered_with_those_of_the_file(tmp_path: Path) -> None:
    path = write(tmp_path / "t.trc", lines())
    with pytest.raises(SettingError, match=r"no marker fits B\*, C; the file has A1, A2, F1"):
        read_recording(path, markers=("B*", "C"))
    with pytest.raises(NoBodiesError, match="markers: A1, A2, F1"):
        read_recording(path)


@pytest.mark.parametrize(
    "name", ["opencap_first_line", "cortex_virtual", "duplicate_unused", "commas", "zero_marker", "ok"]
)
def test_cases_are_read_as_the_control(real_data: Path, name: str) -> None:
    control = read_recording(real_data / "cases" / "trc_ok.trc", markers=("A?", "F?"))
    found = read_recording(real_data / "cases" / f"trc_{name}.trc", markers=("A?", "F?"))
    for one, other in zip(found.markers, control.markers, strict=True):
        assert one.name == other.name
        seen = np.isfinite(one.position).all(axis=1)
        assert seen.mean() == (29 / 44 if (name, one.name) == ("zero_marker", "F2") else 1.0)
        assert one.position[seen] == pytest.approx(other.position[seen], abs=2e-6)


@pytest.mark.parametrize(("factor", "doubted"), [(1.0, False), (0.001, True), (1000.0, True)])
def test_a_stated_unit_that_the_numbers_contradict_is_told(tmp_path: Path, factor: float, doubted: bool) -> None:
    path = tmp_path / "t.trc"
    rows = ["PathFileType\t4\t(X/Y/Z)\tt.trc", "DataRate\tUnits", "100\tmm", "Frame#\tTime\tA\t\t", "\t\tX1\tY1\tZ1"]
    rows += [f"{k + 1}\t{k / 100}\t{factor * (300 + k)}\t{factor * 40}\t{factor * 50}" for k in range(9)]
    path.write_text("\n".join(rows) + "\n")
    found = {one.code: one.message for one in read_recording(path, markers="*").warnings}
    assert ("units-doubtful" in found) is doubted
    assert not doubted or "the unit that is stated, mm, puts" in found["units-doubtful"]
