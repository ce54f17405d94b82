"""What is handed on: the wheel, the source distribution, the recipe and what says how to cite it."""

from __future__ import annotations

import re
import runpy
import shutil
import subprocess
import tarfile
import tomllib
import zipfile
from email.message import Message
from email.parser import Parser
from pathlib import Path
from typing import Any

import pytest
from hatchling.builders.sdist import SdistBuilder
from hatchling.builders.wheel import WheelBuilder

from elbowscrew import __version__
from elbowscrew.cli.examples import EXAMPLES
from elbowscrew.settings import SETTINGS

RELATIVE = re.compile(r"\]\((?!https?:|#)")


@pytest.fixture(scope="module")
def project(root: Path) -> dict[str, Any]:
    found: dict[str, Any] = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return found


@pytest.fixture(scope="module")
def wheel(root: Path, tmp_path_factory: pytest.TempPathFactory) -> zipfile.ZipFile:
    made = next(WheelBuilder(str(root)).build(directory=str(tmp_path_factory.mktemp("wheel")), versions=["standard"]))
    return zipfile.ZipFile(made)


@pytest.fixture(scope="module")
def metadata(wheel: zipfile.ZipFile) -> Message:
    name = next(name for name in wheel.namelist() if name.endswith(".dist-info/METADATA"))
    return Parser().parsestr(wheel.read(name).decode("utf-8"))


def test_the_wheel_holds_the_package_and_nothing_else(root: Path, wheel: zipfile.ZipFile) -> None:
    inside = {name for name in wheel.namelist() if ".dist-info/" not in name}
    there = {
        path.relative_to(root / "src").as_posix()
        for path in (root / "src" / "elbowscrew").rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    inside -= {name for name in inside if name.endswith(".data/data/share/man/man1/elbowscrew.1")}
    samples = {f"elbowscrew/{path.relative_to(root).as_posix()}" for path in (root / "sample_data").rglob("*.*")}
    assert inside == there | samples
    assert {"elbowscrew/py.typed", "elbowscrew/matplotlibrc", "elbowscrew/report/templates/trial.html"} <= inside
    assert any(name.endswith("licenses/LICENSE") for name in wheel.namelist())


def test_an_index_can_show_the_description(metadata: Message) -> None:
    text = metadata.get_payload()
    assert metadata["Description-Content-Type"].startswith("text/markdown")
    assert isinstance(text, str)
    assert text.startswith("# elbowscrew")
    assert not RELATIVE.search(text)


def test_pictures_and_links_lead_to_the_source_where_it_has_an_address(root: Path) -> None:
    namespace = runpy.run_path(str(root / "hatch_build.py"))
    readme = (root / "README.md").read_text(encoding="utf-8")
    text = namespace["described"](readme, "https://example.org/elbowscrew")
    assert (
        "![Measured and modeled angle over time](https://example.org/elbowscrew/raw/HEAD/docs/images/theta.png)" in text
    )
    assert "(https://example.org/elbowscrew/blob/HEAD/CHANGELOG.md)" in text
    assert not RELATIVE.search(text)
    assert text.count("](") == readme.count("](")


def test_the_metadata_tell_who_what_and_for_whom(metadata: Message, project: dict[str, Any]) -> None:
    assert metadata["Name"] == "elbowscrew"
    assert metadata["Version"] == __version__
    assert metadata["License-Expression"] == "BSD-3-Clause"
    assert metadata["Author"] == project["authors"][0]["name"]
    kinds = metadata.get_all("Classifier")
    assert kinds is not None
    assert "Programming Language :: Python :: 3.11" in kinds
    assert "Operating System :: Microsoft :: Windows" in kinds


def test_the_source_distribution_has_what_its_tests_and_its_build_need(
    root: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    made = next(SdistBuilder(str(root)).build(directory=str(tmp_path_factory.mktemp("sdist")), versions=["standard"]))
    with tarfile.open(made) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    assert {
        "hatch_build.py", "README.md", "LICENSE", "CITATION.cff", "pyproject.toml", "tests/conftest.py", "docs/conf.py",
        "sample_data/elbow_paper.csv", "constraints-floor.txt",
    } <= names  # fmt: skip
    assert not [name for name in names if "__pycache__" in name or name.startswith(("build/", "docs/_made/"))]


def test_the_recipe_asks_for_what_the_project_asks_for(root: Path, project: dict[str, Any]) -> None:
    text = (root / "packaging" / "conda" / "recipe.yaml").read_text(encoding="utf-8")
    run = text.partition("  run:\n")[2].partition("\n\n")[0]
    asked = {line.strip(" -").replace(" ", "") for line in run.splitlines()} - {"python>=3.11"}
    assert asked == {one.replace("matplotlib>", "matplotlib-base>") for one in project["dependencies"]}
    assert f'version: "{__version__}"' in text
    assert project["requires-python"] == ">=3.11"
    assert project["scripts"]["elbowscrew"] in text


def test_the_man_page_is_that_of_the_program(root: Path, wheel: zipfile.ZipFile) -> None:
    made = runpy.run_path(str(root / "docs" / "make_man.py"))["page"]()
    place = f"elbowscrew-{__version__}.data/data/share/man/man1/elbowscrew.1"
    assert wheel.read(place).decode("utf-8") == made
    told = {word for line in made.splitlines() for word in re.findall(r"\\fB(.+?)\\fR", line)}
    assert {f"--{one.option}".replace("-", r"\-") for one in SETTINGS} <= told
    for name in EXAMPLES:
        assert f"\n.SH {name.upper()}\n" in made


@pytest.mark.skipif(shutil.which("groff") is None, reason="no groff here")
def test_the_man_page_is_set_without_a_warning(root: Path) -> None:
    page = root / "packaging" / "elbowscrew.1"
    found = subprocess.run(
        ["groff", "-man", "-ww", "-Tutf8", "-Kutf8", str(page)], capture_output=True, text=True, encoding="utf-8"
    )
    assert not found.stderr
    assert "ELBOWSCREW(1)" in found.stdout
    assert "elbowscrew samples --copy elbowscrew_samples" in found.stdout


def test_the_image_takes_extras_that_there_are(root: Path, project: dict[str, Any]) -> None:
    text = (root / "Dockerfile").read_text(encoding="utf-8")
    extras = {extra for found in re.findall(r"\[([\w,]+)\]\"", text) for extra in found.split(",")}
    assert extras
    assert extras <= set(project["optional-dependencies"])


def test_the_article_cites_what_is_in_its_list(root: Path) -> None:
    cited = set(re.findall(r"@(\w+)", (root / "paper" / "paper.md").read_text(encoding="utf-8")))
    listed = set(re.findall(r"^@\w+\{(\w+),", (root / "paper" / "paper.bib").read_text(encoding="utf-8"), re.M))
    assert cited == listed
