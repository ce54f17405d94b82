"""Tables read back: a long one, by pandas, gives what a short one gives, and is refused where that one is."""

from __future__ import annotations

from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from elbowscrew.errors import ResultError
from elbowscrew.quantities import Quantity
from elbowscrew.results import table_reading
from elbowscrew.results.proof import ProvedFile
from elbowscrew.results.table_reading import read_columns
from elbowscrew.tables import Column

TABLE = tuple(
    Column(name=name, attribute=name, quantity=quantity)
    for name, quantity in (
        ("frame", Quantity.INTEGER),
        ("valid", Quantity.FLAG),
        ("phase", Quantity.MASKED_INTEGER),
        ("theta", Quantity.NUMBER),
        ("share", Quantity.NUMBER),
    )
)
HEADER = "frame,valid,loss,phase,theta,share"
ROWS = ["0,1,,,1.5,", "1,0,lost,2,-0.0,1e-300", "2,1,,3,5.186680881225908e-16,0.1", "3,1,,3,,123456789.12345678"]


def read(path: Path, rows: list[str], *, long: bool, end: str = "\n") -> dict[str, np.ndarray[Any, Any]]:
    path.write_text(HEADER + "\n" + "\n".join(rows) + end)
    source = ProvedFile(path, sha256(path.read_bytes()).hexdigest())
    with pytest.MonkeyPatch.context() as patch:
        if long:
            patch.setattr(table_reading, "_BLOCK_BYTES", 16)
        return read_columns(source, TABLE, "deg", "mm")


def is_same(one: np.ndarray[Any, Any], other: np.ndarray[Any, Any]) -> bool:
    """Equal to the last bit, in type and in what is masked."""
    if isinstance(one, np.ma.MaskedArray) != isinstance(other, np.ma.MaskedArray) or one.dtype != other.dtype:
        return False
    masks = np.array_equal(np.ma.getmaskarray(one), np.ma.getmaskarray(other))
    return masks and np.ma.getdata(one).tobytes() == np.ma.getdata(other).tobytes()


FLOATS = st.floats(allow_infinity=False, min_value=-1e100, max_value=1e100)


@given(values=st.lists(st.tuples(FLOATS, st.one_of(st.none(), st.integers(0, 2**53))), min_size=3, max_size=8))
def test_a_long_table_gives_the_digits_of_a_short_one(
    values: list[tuple[float, int | None]], tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = tmp_path_factory.getbasetemp() / "table.csv"
    cells = [("" if np.isnan(x) else repr(x), "" if n is None else str(n)) for x, n in values]
    rows = [*ROWS, *(f"{k},1,,{n},{x},{x}" for k, (x, n) in enumerate(cells))]
    long, short = read(path, rows, long=True), read(path, rows, long=False)
    assert long.keys() == short.keys()
    assert all(is_same(long[name], short[name]) for name in short)
    written = np.array([x for x, _ in values])
    assert np.array_equal(long["theta"][len(ROWS) :], written, equal_nan=True)


def test_pandas_reads_the_long_table(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(table_reading, "_cell_by_cell", None)  # which would be called for what pandas does not take
    assert read(tmp_path / "t.csv", ROWS, long=True)["frame"].tolist() == [0, 1, 2, 3]


@pytest.mark.parametrize("long", [False, True], ids=["short", "long"])
@pytest.mark.parametrize(
    "row",
    [
        "4,1,,3,0.5", "4,1,,3,0.5,0.5,0.5", "4,1,,3,word,0.5", "4.5,1,,3,0.5,0.5", "4,1,,3.5,0.5,0.5",
        "4,1,,3,True,0.5", "4,1,,3,0x1,0.5", "4,1,,3,0.5,1e101", "4,1,,3,0.5,inf", "4,1,,3,-inf,0.5",
        "4,1,,3,null,0.5", "4,word,,3,0.5,0.5", "",
    ],
)  # fmt: skip
def test_a_row_that_was_not_written_is_refused(row: str, long: bool, tmp_path: Path) -> None:
    with pytest.raises(ResultError, match="not the table that was written"):
        read(tmp_path / "t.csv", [*ROWS, row, *ROWS], long=long)


@pytest.mark.parametrize("long", [False, True], ids=["short", "long"])
def test_a_table_whose_last_line_is_cut_is_refused(long: bool, tmp_path: Path) -> None:
    with pytest.raises(ResultError, match="last line is cut"):
        read(tmp_path / "t.csv", ROWS, long=long, end="")


@pytest.mark.parametrize("threads", ["1", "2"], ids=["one core", "spare cores"])
def test_blocks_keep_their_order_whoever_parses_them(
    threads: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("OMP_NUM_THREADS", threads)
    rows = [f"{k},1,,{k},{k}.25," for k in range(300)]
    found = read(tmp_path / "t.csv", rows, long=True)
    assert found["frame"].tolist() == found["phase"].tolist() == list(range(300))
    assert found["theta"].tolist() == [k + 0.25 for k in range(300)]


@pytest.mark.parametrize("threads", ["1", "2"], ids=["one core", "spare cores"])
def test_the_first_fault_is_told(threads: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OMP_NUM_THREADS", threads)
    with pytest.raises(ResultError, match="word"):
        read(tmp_path / "t.csv", ["0,1,,3,word,0.5", *ROWS, *ROWS], long=True, end="")
