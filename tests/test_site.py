"""The documentation's site is complete, and its commands are those of the program; `make docs` runs them."""

from __future__ import annotations

import re
import runpy
import shlex
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import typer

import elbowscrew
from elbowscrew.cli.app import app
from elbowscrew.cli.examples import EXAMPLES
from elbowscrew.tables import TABLES
from elbowscrew.view.figure_names import FIGURE_CHOICES

TOCTREE = re.compile(r"^```\{toctree\}\n(.*?)^```", re.M | re.S)
BLOCK = re.compile(r"^ *(`{3,}|:{3,})(?:sh|\{run\})?\n(.*?)^ *\1\s*$", re.M | re.S)


def pages(root: Path) -> list[Path]:
    return sorted(path for path in (root / "docs").rglob("*.md") if "generated" not in path.parts)


def listed(page: Path) -> Iterator[Path]:
    """Pages that a page's tables of contents name."""
    for block in TOCTREE.findall(page.read_text(encoding="utf-8")):
        for line in block.splitlines():
            if not line or line.startswith(":"):
                continue
            if "*" in line:
                yield from page.parent.glob(line + ".md")
            else:
                yield (page.parent / line).with_suffix(".md")


def test_every_page_is_in_the_tables_of_contents_once(root: Path) -> None:
    named = [path.resolve() for page in pages(root) for path in listed(page)]
    made = {(root / "docs" / "gallery" / "index.md").resolve()}  # the build makes it
    assert sorted(set(named) - made) == sorted(set(pages(root)) - {root / "docs" / "index.md"})
    assert len(named) == len(set(named))


def test_the_python_interface_is_documented_whole(root: Path) -> None:
    text = (root / "docs" / "reference" / "api" / "index.md").read_text(encoding="utf-8")
    told = re.findall(r"^   elbowscrew\.(\w+)$", text, re.M)
    assert sorted(told) == sorted(set(elbowscrew.__all__) - {"__version__"})


def test_every_command_is_documented(root: Path) -> None:
    text = (root / "docs" / "reference" / "cli.md").read_text(encoding="utf-8")
    assert re.findall(r"^```\{command\} (\w+)$", text, re.M) == list(group().commands)


def test_the_man_page_is_made_from_the_commands(root: Path) -> None:
    made = runpy.run_path(str(root / "docs" / "make_man.py"))["page"]()
    assert (root / "packaging" / "elbowscrew.1").read_text(encoding="utf-8") == made, "run python docs/make_man.py"


def test_every_figure_is_explained(root: Path) -> None:
    text = (root / "docs" / "reference" / "figures.md").read_text(encoding="utf-8")
    told = set(re.findall(r"`(\w+)`", " ".join(re.findall(r"^## (.*)$", text, re.M))))
    assert told >= set(FIGURE_CHOICES) - {"fig8", "fig9"} | {"compare"}  # the paper's four have one heading


def test_every_table_and_column_is_documented(root: Path) -> None:
    pages = ("reference/outputs", "reference/columns", "reference/compare", "explanation/anatomy")
    text = "".join((root / "docs" / f"{page}.md").read_text(encoding="utf-8") for page in pages)
    for name, columns in TABLES.items():
        assert f"`{name}.csv`" in text, name
        for column in columns:
            ends = {
                column.name,
                re.sub(r"_[xyz](?=$|_)", "", column.name),
                re.sub(r"\d$", "0", column.name),
                column.name.replace("2_", "1_"),
            }
            assert any(f"`{end}" in text for end in ends), f"{name}: {column.name}"


def test_every_page_of_the_report_is_explained(root: Path) -> None:
    """Each heading of the page stands in the guide to it."""
    template = (root / "src" / "elbowscrew" / "report" / "templates" / "trial.html").read_text(encoding="utf-8")
    text = (root / "docs" / "reference" / "page.md").read_text(encoding="utf-8")
    for heading in re.findall(r"<h[23][^>]*>([A-Z][^<{]*)</h[23]>", template):
        assert heading in text, heading


def test_every_command_has_examples_and_they_are_its_own() -> None:
    assert list(EXAMPLES) == list(group().commands)
    for name, lines in EXAMPLES.items():
        assert lines
        assert all(line.startswith(f"elbowscrew {name} ") or line == f"elbowscrew {name}" for line in lines)
        assert all(line in command(name).epilog for line in lines)


@cache
def group() -> Any:
    return typer.main.get_command(app)


@cache
def command(name: str) -> Any:
    return group().resolve_command(group().context_class(group(), info_name="elbowscrew"), [name])[1]


def command_lines(root: Path) -> list[tuple[str, str]]:
    """Every command line in a document, with the document's name; those that break over lines are put together."""
    found = [("the help", line) for lines in EXAMPLES.values() for line in lines]
    for page in [root / "README.md", root / "benchmarks" / "README.md", *pages(root)]:
        for _, block in BLOCK.findall(page.read_text(encoding="utf-8")):
            for line in re.sub(r" *[\\`]\n *", " ", block).splitlines():
                told = re.search(r"(?:^|\s|/)(elbowscrew [a-z].*)", re.sub(r"^\$ |^PS> ", "", line.strip()))
                if told and not line.strip().startswith(("#", "`", "from ", "import ")):
                    found.append((page.name, told[1]))
    return found


def test_commands_in_the_documents_are_those_of_the_program(root: Path) -> None:
    lines = command_lines(root)
    assert len(lines) > 30
    for page, line in lines:
        words = [word for word in shlex.split(line, comments=True)[1:] if word not in ("...", "…")]
        try:
            command(words[0]).make_context(words[0], words[1:])
        except Exception as error:
            pytest.fail(f"{page}: {line}: {error}")
