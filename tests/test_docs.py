"""The documents say what the program does."""

from __future__ import annotations

import csv
import re
import runpy
import subprocess
import sys
from pathlib import Path

import pytest

from elbowscrew import __version__
from elbowscrew.choices import BLEND_NAMES, CLOSED_LAWS, KEYFRAME_SOURCES, KNOT_NAMES, METHOD_NAMES
from elbowscrew.cli.app import app
from elbowscrew.study_columns import FAILURE_COLUMNS, study_header
from elbowscrew.tables import COMPARISON_COLUMNS, INTERPOLATION_COLUMNS, KEYFRAME_COLUMNS, SCREW_COLUMNS
from elbowscrew.view.figure_names import FIGURE_ENTRIES

LINK = re.compile(r"!?\[[^\]]*\]\(([^)#]*)(?:#([^)]+))?\)")
HEADING = re.compile(r"^#+ (.+)$", re.M)


def documents(root: Path) -> list[Path]:
    pages = [root / name for name in ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "benchmarks/README.md")]
    return [*pages, *sorted((root / "docs").rglob("*.md"))]


def test_links_lead_somewhere(root: Path) -> None:
    for document in documents(root):
        for target, section in LINK.findall(document.read_text(encoding="utf-8")):
            if target.startswith("http"):
                continue
            page = document.parent / target if target else document
            assert page.exists(), f"{document.name}: {target}"
            if section:
                assert section in sections(page), f"{document.name}: {target}#{section}"


def sections(page: Path) -> set[str]:
    """What a page's headings are called in links: small letters, hyphens for blanks, no other punctuation."""
    headings = HEADING.findall(page.read_text(encoding="utf-8"))
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def test_the_readme_names_every_command(root: Path) -> None:
    readme = (root / "README.md").read_text(encoding="utf-8")
    commands = [command.name for command in app.registered_commands if command.name]
    assert len(commands) >= 3
    for name in commands:
        assert f"elbowscrew {name}" in readme


def test_the_readmes_first_two_shell_blocks_are_one_command_line_each(root: Path) -> None:
    blocks = re.findall(r"^```sh\n(.*?)^```", (root / "README.md").read_text(encoding="utf-8"), re.M | re.S)
    assert len(blocks) == 2
    assert all(block.count("\n") == 1 for block in blocks)
    assert "elbowscrew analyze sample_data/" in blocks[0]
    assert "pytest" in blocks[1]


def test_the_notebook_example_runs(root: Path, tmp_path: Path) -> None:
    blocks = re.findall(r"^```python\n(.*?)^```", (root / "README.md").read_text(encoding="utf-8"), re.M | re.S)
    code = "\n".join(blocks).replace("sample_data/", f"{root.as_posix()}/sample_data/")
    subprocess.run([sys.executable, "-W", "error", "-c", code], cwd=tmp_path, check=True)
    with (tmp_path / "result" / "screw.csv").open(newline="") as stream:
        assert len(list(csv.reader(stream))) == 451


def test_every_column_is_documented(root: Path) -> None:
    text = (root / "docs" / "reference" / "outputs.md").read_text(encoding="utf-8")
    for column in (*SCREW_COLUMNS, *INTERPOLATION_COLUMNS):
        stem = column.name.rstrip("0123") if re.fullmatch(r"e\d", column.name) else column.name
        assert re.search(rf"`{re.escape(stem.removesuffix('_x').removesuffix('_y').removesuffix('_z'))}", text), column


def test_every_column_of_a_study_is_documented(root: Path) -> None:
    text = (root / "docs" / "reference" / "batch.md").read_text(encoding="utf-8")
    header = study_header("deg", "mm")
    for column in [*header, *FAILURE_COLUMNS]:
        told = re.sub(r"_y(_mm)?$", r"_x\1", column)  # of three components the first and the last are named
        assert f"`{told}`" in text, column


def test_laws_and_columns_of_a_comparison_are_documented(root: Path) -> None:
    text = (root / "docs" / "reference" / "compare.md").read_text(encoding="utf-8")
    laws = text[text.index("## Laws") : text.index("## Phases")]
    told = re.findall(r"`([a-z][a-z0-9-]+)`", laws[: laws.index("`--law-peak")])
    assert sorted(told) == sorted(CLOSED_LAWS)
    assert {"best", "empirical"} <= set(re.findall(r"`([a-z]+)`", laws))
    words = set(re.findall(r"`(\w+?)(?:_deg|_mm)?`", text))
    for column in (*COMPARISON_COLUMNS, *KEYFRAME_COLUMNS):
        stem = re.sub(r"^(rms|max)_(?!displacement)", "", column.name)
        ends = (stem, re.sub(r"\d$", "0", stem), re.sub(r"_[yz]$", "_x", stem))
        assert words.intersection(ends), column.name
    for name in (*METHOD_NAMES, *KNOT_NAMES, *BLEND_NAMES, *KEYFRAME_SOURCES):
        assert f"`{name}`" in text, name


def test_the_version_stands_in_changelog_and_citation(root: Path) -> None:
    assert f"## {__version__}" in (root / "CHANGELOG.md").read_text(encoding="utf-8")
    assert f"version: {__version__}" in (root / "CITATION.cff").read_text(encoding="utf-8")


def test_the_architecture_names_every_module_of_the_top_level(root: Path) -> None:
    text = (root / "docs" / "explanation" / "architecture.md").read_text(encoding="utf-8")
    for path in (root / "src" / "elbowscrew").iterdir():
        if path.is_dir() and path.name != "__pycache__":
            assert f"`{path.name}/`" in text, path.name
        elif path.suffix == ".py" and not path.name.startswith("_"):
            assert f"`{path.name}`" in text, path.name


def test_lower_bounds_are_the_versions_tested(root: Path) -> None:
    floors = dict(
        line.split("==")
        for line in (root / "constraints-floor.txt").read_text().splitlines()
        if line and not line.startswith("#")
    )
    project = (root / "pyproject.toml").read_text()
    for name, version in floors.items():
        bound = re.search(rf'"{re.escape(name)}>=([\d.]+)"', project)
        assert bound, name
        assert version == bound[1] or version.removesuffix(".0") == bound[1], name


def test_the_readmes_pictures_are_figures_of_a_result(root: Path) -> None:
    readme = (root / "README.md").read_text(encoding="utf-8")
    pictures = re.findall(r"!\[[^\]]+\]\(docs/images/(\w+)\.png\)", readme)
    assert len(pictures) == 2
    assert set(pictures) <= set(FIGURE_ENTRIES)
    for name in pictures:
        assert (root / "docs" / "images" / f"{name}.png").read_bytes().startswith(b"\x89PNG")


def test_the_table_of_settings_is_current(root: Path) -> None:
    made = runpy.run_path(str(root / "docs" / "make_settings.py"))["page"]()
    assert (root / "docs" / "reference" / "settings.md").read_text(encoding="utf-8") == made


def test_the_drawing_of_the_cycles_is_current(root: Path) -> None:
    """It shows four cycles, the first incomplete, with two rests, and a hesitation that is no inversion."""
    drawn = runpy.run_path(str(root / "docs" / "make_cycles_figure.py"))["figure"]()
    whole, feet = drawn.axes
    words = [text.get_text() for text in whole.texts]
    assert words.count("rest") == 2
    assert [word for word in words if word.startswith("cycle")] == [
        "cycle 1, incomplete",
        "cycle 2",
        "cycle 3",
        "cycle 4",
    ]
    tops = next(line for line in whole.lines if str(line.get_label()).startswith("inversion")).get_xdata()
    assert tops == pytest.approx([0.43, 2.2, 3.8, 7.9], abs=0.02)
    lines = [
        float(line.get_xdata()[0])
        for line in feet.lines
        if len(set(line.get_xdata())) == 1 and line.get_marker() == "None"
    ]
    assert lines == pytest.approx([1.3, 1.4], abs=0.03)
    shown = (root / "docs" / "images" / "cycles.svg").read_text(encoding="utf-8")
    assert all(word in shown for word in words if word and "\n" not in word)
