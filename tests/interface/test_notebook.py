"""A new user's notebook runs, cell by cell, and every cell's result can be shown."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import pytest

NOTEBOOK = Path(__file__).with_name("new_user.py")


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    monkeypatch.chdir(tmp_path)
    yield tmp_path
    plt.close("all")


def cells() -> list[str]:
    parts = NOTEBOOK.read_text(encoding="utf-8").split("# %%\n")
    return parts[1:]


def run(cell: str, names: dict[str, Any]) -> object:
    """Run a cell as a notebook does: its last expression is its result."""
    tree = ast.parse(cell)
    last = tree.body[-1]
    if not isinstance(last, ast.Expr):
        exec(compile(tree, "<cell>", "exec"), names)  # noqa: S102 - our own
        return None
    exec(compile(ast.Module(tree.body[:-1], []), "<cell>", "exec"), names)  # noqa: S102
    return eval(compile(ast.Expression(last.value), "<cell>", "eval"), names)  # noqa: S307


def test_every_cell_of_a_new_users_notebook_runs(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert len(cells()) >= 50
    names: dict[str, Any] = {"__name__": "__main__"}
    for cell in cells():
        found = run(cell, names)
        assert repr(found)
        shown = getattr(found, "_repr_html_", None)
        if shown is not None:
            assert shown().startswith("<")
    assert "no format that is read" in names["study"].failures["broken.csv"]
    assert "columns FILE.toml" in names["study"].failures["broken.csv"]
    assert names["study"].names == ("P01_1",)
    assert repr(names["compared"]).startswith(f"Comparison({len(names['compared'].models)} models: the best ")
    assert (here / "trial.nc").stat().st_size > 10_000
    assert "overwrite=True" in capsys.readouterr().out
