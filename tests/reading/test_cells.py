"""Numbers out of lines of text: the same value whichever way they are read, and nothing else taken for one."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from elbowscrew import read_recording
from elbowscrew.errors import RecordingError
from elbowscrew.reading.cells import read_blocks
from elbowscrew.reading.source import TextSource

DIGITS = st.text("0123456789", min_size=1, max_size=25)
SIGN = st.sampled_from(["", "-", "+"])
EXPONENT = st.one_of(st.just(""), st.integers(-330, 270).map("e{}".format), st.integers(0, 20).map("E+{}".format))
NUMBER = st.builds(
    "{}{}{}{}{}".format, SIGN, DIGITS, st.sampled_from(["", "."]), st.one_of(st.just(""), DIGITS), EXPONENT
)


def read(path: Path, lines: list[str], columns: list[int], *, width: int, group: int = 0) -> np.ndarray:
    path.write_text("".join(line + "\n" for line in lines))
    source = TextSource(path=path, sha256="", ends_with_newline=True, delimiter=",")
    return np.concatenate(list(read_blocks(source, 0, columns, width, group=group)))


@given(rows=st.lists(st.tuples(NUMBER, NUMBER, NUMBER), min_size=1, max_size=5))
def test_every_number_is_the_nearest_there_is_with_its_sign(
    rows: list[tuple[str, str, str]], tmp_path_factory: pytest.TempPathFactory
) -> None:
    """Python's own conversion, which rounds correctly, is the oracle; the sign of a zero counts."""
    path = tmp_path_factory.getbasetemp() / "numbers.csv"
    for columns in ([0, 1, 2], [1], [2, 0]):
        found = read(path, [",".join(row) for row in rows], columns, width=3)
        exact = np.array([[float(row[column]) for column in columns] for row in rows])
        np.testing.assert_array_equal(found, exact)
        np.testing.assert_array_equal(np.signbit(found), np.signbit(exact))


@pytest.mark.parametrize("word", ["true", "false", "null", "[]", "{}", '"1"', "1,2", "NaN", "0x1"])
def test_what_is_no_number_to_a_person_is_none(word: str, tmp_path: Path) -> None:
    if word == '"1"':  # quotes of CSV
        assert read(tmp_path / "a.csv", ["0.5,1.5", f"0.5,{word}"], [1], width=2).tolist() == [[1.5], [1.0]]
        return
    with pytest.raises(RecordingError, match=r"a\.csv:2"):
        read(tmp_path / "a.csv", ["0.5,1.5", f"0.5,{word}"], [1], width=2)


def test_lines_of_several_lengths_keep_their_columns(tmp_path: Path) -> None:
    """Two cells more in one line must not shift the next, nor fill up what another lacks."""
    lines = ["1,2,3", "4,5,6,7,8", "9,10,11"]
    assert read(tmp_path / "a.csv", lines, [0, 2], width=3, group=2).tolist() == [[1, 3], [4, 6], [9, 11]]
    assert read(tmp_path / "b.csv", lines, [0, 1], width=3, group=2).tolist() == [[1, 2], [4, 5], [9, 10]]


def table_of(tmp_path: Path, *rows: str) -> Path:
    """A plain table of one body and a marker, whose last cells are not seen in the second frame."""
    names = [*(f"a_e{k}" for k in range(4)), *(f"{name}_{axis}_m" for name in ("a", "b") for axis in "xyz")]
    path = tmp_path / "t.csv"
    whole = ["0,0.00,1,0,0,0,1,2,3,7,8,9", "1,0.01,1,0,0,0,1,2,3,,,", "2,0.02,1,0,0,0,1,2,3,7,8,9"]
    path.write_text("\n".join([",".join(["frame,time_s", *names]), *(rows or whole)]) + "\n")
    return path


def test_a_cell_too_many_before_blank_ones_shifts_nothing_in_silence(tmp_path: Path) -> None:
    read = read_recording(table_of(tmp_path), markers="b")
    assert np.isnan(read.markers[0].position[1]).all()
    for shifted in ("1,0.01,1,0,0,0,1,5,2,3,,,", "1,0.01,1,0,0,0,1,2,3,,,,"):  # as a decimal comma, 1,5, does
        with pytest.raises(RecordingError, match=r"t\.csv:3: expected 12 cells, found 13"):
            read_recording(table_of(tmp_path, "0,0.00,1,0,0,0,1,2,3,7,8,9", shifted), markers="b")


TRC = """PathFileType\t4\t(X/Y/Z)\tt.trc
DataRate\tUnits
100\tmm
Frame#\tTime\tA\t\t\tB\t\t
\t\tX1\tY1\tZ1\tX2\tY2\tZ2
"""


@pytest.mark.parametrize("end", ["", "\t", "\t\t\t", "\t\t\t\t"])
def test_tabs_at_the_end_of_lines_are_as_many_or_shift_nothing(tmp_path: Path, end: str) -> None:
    path = tmp_path / "t.trc"
    whole = ["1\t0\t10\t20\t30\t40\t50\t60", "2\t.01\t10\t20\t30\t\t\t", "3\t.02\t10\t20\t30\t41\t51\t61"]
    path.write_text(TRC + "\n".join(row + end for row in whole))
    (b,) = read_recording(path, markers="B").markers
    assert b.position[[0, 2]] == pytest.approx(np.array([[0.04, 0.05, 0.06], [0.041, 0.051, 0.061]]))
    assert np.isnan(b.position[1]).all()
    path.write_text(
        TRC + "\n".join([whole[0] + end, whole[1], whole[2] + "\t"])
    )  # not as many: nothing else can be meant
    assert np.array_equal(read_recording(path, markers="B").markers[0].position, b.position, equal_nan=True)
    for shifted in (whole[1].replace("\t10", "\t1\t10"), whole[1].replace("\t10", "")):
        path.write_text(TRC + "\n".join([whole[0] + end, shifted + end, whole[2] + end]))
        with pytest.raises(RecordingError, match=r"t\.trc:7: expected \d+ cells, found \d+"):
            read_recording(path, markers="B")


def test_cells_without_a_title_are_no_numbers_of_another(tmp_path: Path) -> None:
    """As tables with row names and no title above these, in which all titles stand one cell too early."""
    path = table_of(tmp_path, "9,0,0.00,1,0,0,0,1,2,3,7,8,9", "9,1,0.01,1,0,0,0,1,2,3,7,8,9")
    with pytest.raises(RecordingError, match=r"t\.csv:2: expected 12 cells, found 13"):
        read_recording(path, markers="b")
    path = table_of(
        tmp_path, "0,0.00,1,0,0,0,1,2,3,7,8,9,,", "1,0.01,1,0,0,0,1,2,3,,,,,", "2,0.02,1,0,0,0,1,2,3,7,8,9,,"
    )
    assert np.isnan(read_recording(path, markers="b").markers[0].position[:, 0]).tolist() == [False, True, False]
