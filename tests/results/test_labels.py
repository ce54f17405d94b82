"""Labels are written whole and read back the same, whatever is in them."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from elbowscrew.opening import sha256_of
from elbowscrew.quantities import Quantity
from elbowscrew.results.proof import ProvedFile
from elbowscrew.results.table_reading import read_columns
from elbowscrew.results.writing import write_csv
from elbowscrew.tables import Column

TABLE = (
    Column(name="label", attribute="label", quantity=Quantity.LABEL),
    Column(name="value", attribute="value", quantity=Quantity.NUMBER),
)
LABELS = [
    "nullable", "null", 'the "left" arm', "arm, left", "a],[b", "back\\slash", "two\nlines", "cr\rhere", '"', "plain",
    "", "Öl", "tab\there", " inf ",
]  # fmt: skip


@pytest.mark.parametrize("labels", [LABELS, *([one] for one in LABELS), ["plain"] * 5000 + LABELS, LABELS * 900])
def test_labels_come_back_whole(tmp_path: Path, labels: list[str]) -> None:
    value = np.random.default_rng(3).normal(size=len(labels)) * 10.0 ** np.linspace(-12, 20, len(labels))
    value[::7] = np.nan
    path = tmp_path / "table.csv"
    write_csv(path, [{"label": np.array(labels), "value": value}])
    with path.open(encoding="utf-8", newline="") as stream:
        rows = list(csv.reader(stream, strict=True))
    assert [row[0] for row in rows[1:]] == labels
    read = read_columns(ProvedFile(path, sha256_of(path)), TABLE, "deg", "mm")
    assert read["label"].tolist() == labels
    np.testing.assert_array_equal(read["value"], value)


def test_numbers_beside_a_quoted_label_have_the_same_text(tmp_path: Path) -> None:
    values = np.array([1e-7, 1e16, 0.1, -0.0, np.nan, np.inf, 3.0])
    for name, label in (("plain", "a"), ("quoted", "a,b")):
        write_csv(tmp_path / name, [{"value": values, "label": np.array([label] * values.size)}])
    plain = [line.split(",", 1)[0] for line in (tmp_path / "plain").read_text().splitlines()]
    assert [line.split(",", 1)[0] for line in (tmp_path / "quoted").read_text().splitlines()] == plain
