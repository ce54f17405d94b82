"""The printed numbers and the list of equations."""

from __future__ import annotations

import importlib
import json
import re
from pathlib import Path

import pytest

from elbowscrew import paper
from elbowscrew.cli import main


def test_every_printed_number_is_met() -> None:
    found = paper.comparisons()
    assert [one for one in found if not one.agrees] == []
    known = [one for one in found if one.rounded != one.printed]
    assert {one.printed for one in known} == {"1.999999", "4.000002", "5.999998", "8.000001", "0.628318"}
    assert all(one.note == paper.KNOWN_DIFFERENCE for one in known)
    assert len(found) == 88


def test_a_number_that_differs_is_noticed() -> None:
    wrong = paper.PrintedValue(place="here", quantity="d", printed="2.036640", computed=2.036641)
    assert not wrong.agrees
    assert not paper.PrintedValue(
        place="x", quantity="d", printed="1.999999", computed=2.1, note=paper.KNOWN_DIFFERENCE
    ).agrees
    assert paper.PrintedValue(place="x", quantity="d", printed="0", computed=-1e-17).rounded == "0"


def test_the_command_says_so(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    assert main(["paper"]) == 0
    assert "88 numbers agree, 0 differ" in capsys.readouterr().out
    assert main(["paper", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["differ"] == 0
    wrong = paper.PrintedValue(place="here", quantity="d", printed="1", computed=2.0)
    monkeypatch.setattr(paper, "comparisons", lambda: (wrong,))
    assert main(["paper"]) == 1
    assert "DIFFERS" in capsys.readouterr().out


def test_the_counterparts_of_its_figures_are_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["paper", "--figures", str(tmp_path / "f")]) == 0
    assert sorted(path.name for path in (tmp_path / "f").iterdir()) == ["figures_7_and_8.png", "figures_9_and_10.png"]
    assert main(["paper", "--figures", str(tmp_path / "f")]) == 6
    assert "exists already" in capsys.readouterr().err


def test_no_equation_is_missing_and_every_function_is_there(root: Path) -> None:
    numbers = set()
    for line in (
        (root / "docs" / "reference" / "equations.md")
        .read_text(encoding="utf-8")
        .partition("## Misprints")[0]
        .splitlines()
    ):
        if not line.startswith("| ") or line.startswith(("| equation", "| ---")):
            continue
        equation, _, functions = (cell.strip() for cell in line.strip("| ").split(" | "))
        if re.match(r"P \d", equation):
            numbers |= {int(number) for number in re.findall(r"\d+", equation)}
        names = re.findall(r"`([\w.]+)`", functions)
        assert names, line
        for name in names:
            place, _, last = name.rpartition(".")
            if not name.startswith("elbowscrew"):
                place = f"elbowscrew.geometry.{place}" if place else "elbowscrew.geometry"
            assert callable(getattr(importlib.import_module(place), last)), name
    assert numbers == set(range(1, 49))
