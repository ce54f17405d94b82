"""Cells of text: one line, and nothing a spreadsheet would run."""

from __future__ import annotations

import csv
import io

import pytest
from hypothesis import given
from hypothesis import strategies as st

from elbowscrew.results.table_text import safe_cell


@pytest.mark.parametrize(
    "text",
    ["=1+1", "+cmd|' /C calc'!A0", "-2+3", "@SUM(A1)", "\t=1", "\r=1", "\n=1", " =1", "＝1+1", "＋1x", "-", "=", "- 5"],
)
def test_what_begins_a_formula_gets_an_apostrophe(text: str) -> None:
    assert safe_cell(text).startswith("'")


@pytest.mark.parametrize("text", ["-5", "+3.5", "-1e-3", "-0,5", "12", "trial 1", "a=b", "", "x-y", "P01/-3.csv"])
def test_numbers_and_harmless_text_stay(text: str) -> None:
    assert safe_cell(text) == text


@given(text=st.text())
def test_any_text_is_one_cell_on_one_line_that_no_spreadsheet_runs(text: str) -> None:
    cell = safe_cell(text)
    assert cell.isprintable()
    assert len(cell.splitlines()) <= 1
    stream = io.StringIO()
    csv.writer(stream, lineterminator="\n").writerow([cell, "x"])
    assert next(csv.reader([stream.getvalue()])) == [cell, "x"]
    if cell.strip()[:1] in tuple("=+-@"):
        float(cell.strip().replace(",", "."))
