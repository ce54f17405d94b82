"""Modules that lie in the current folder, beside the recordings, are run by no process of the program."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from elbowscrew import _search_path

CONSOLE_SCRIPT = "import sys\nfrom elbowscrew.cli import command\nif __name__ == '__main__':\n    sys.exit(command())\n"
LIBRARIES = ("ezc3d", "numpy", "matplotlib", "pandas", "scipy", "pydantic", "orjson", "PIL", "distributed", "dask")
# What `python -m` loads before any line of ours is run: nothing can be done about these there.
OF_THE_START = frozenset(
    "__future__ abc codecs collections contextlib copyreg encodings enum functools genericpath importlib io keyword "
    "operator os pkgutil posixpath ntpath re reprlib runpy site sitecustomize stat types usercustomize warnings "
    "typing weakref ast dis inspect opcode linecache tokenize token zipimport".split()
)
NAMES = [*LIBRARIES, *(name for name in sys.stdlib_module_names if name not in sys.builtin_module_names)]

Run = Callable[..., str]


@pytest.fixture
def data(tmp_path: Path, samples: Path) -> Path:
    """A folder of recordings, and beside them a module for every name that might be looked for."""
    folder = tmp_path / "data"
    folder.mkdir()
    (folder / "take.csv").write_bytes((samples / "elbow_paper.csv").read_bytes())
    for name in NAMES:
        (folder / f"{name}.py").write_text(f"import os\nos.write(2, b'RUN {name};')\nos._exit(99)\n")
    return folder


@pytest.fixture
def run(tmp_path: Path, data: Path) -> Run:
    script = tmp_path / "bin" / "elbowscrew"
    script.parent.mkdir()
    script.write_text(CONSOLE_SCRIPT)

    def start(*arguments: object, module: bool = False, **environment: str) -> str:
        start = ["-m", "elbowscrew"] if module else [str(script)]
        done = subprocess.run(
            [sys.executable, *start, *map(str, arguments)],
            cwd=data, env={**os.environ, **environment}, capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert "RUN" not in done.stderr
        assert done.returncode == 0, done.stderr
        return done.stdout

    return start


def test_no_command_runs_a_module_of_the_current_folder(run: Run) -> None:
    run("info", "take.csv")
    run("analyze", "take.csv", "--figure-format", "none")
    run("report", "take_elbowscrew")
    run("compare", "take.csv", "--methods", "dlb", "--laws", "linear", "--counts", "2", "--data", "raw",
        "--figure-format", "png")  # fmt: skip
    run("batch", "take.csv", "--figure-format", "none", "--workers", 2)


def test_nor_does_the_process_that_opens_a_c3d_file(run: Run, data: Path, real_data: Path) -> None:
    pytest.importorskip("ezc3d")
    (data / "take.c3d").write_bytes((real_data / "cases" / "c3d_ok.c3d").read_bytes())
    assert "C3D" in run("info", "take.c3d")


def test_nor_do_the_workers_of_a_cluster(run: Run) -> None:
    pytest.importorskip("distributed")
    run("batch", "take.csv", "--figure-format", "none", "--scheduler", "local-cluster", "--workers", 1)


@pytest.mark.parametrize("way", [{"module": True}, {"PYTHONPATH": ""}])
def test_a_start_that_puts_the_folder_first_is_mended_at_once(run: Run, data: Path, way: dict[str, object]) -> None:
    """``python -m`` looks in the current folder first, and so does an empty part of ``PYTHONPATH``."""
    for name in OF_THE_START:
        (data / f"{name}.py").unlink(missing_ok=True)
    ours = [str(Path(_search_path.__file__).parents[1]), *filter(None, os.environ.get("PYTHONPATH", "").split(":"))]
    given = {**way, "PYTHONPATH": os.pathsep.join([*ours, ""])} if "PYTHONPATH" in way else way
    run("batch", "take.csv", "--figure-format", "none", "--workers", 1, **given)


def test_the_environment_is_as_it_was_behind_the_block(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("PYTHONSAFEPATH", raising=False)
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(["", str(Path.cwd())]))
    before = dict(os.environ)
    with _search_path.CurrentFolderLeftOut():
        assert os.environ["PYTHONSAFEPATH"] == "1"
        assert os.environ["PYTHONPATH"] == ""
    assert dict(os.environ) == before


def test_a_program_in_the_current_folder_itself_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    own = Path(_search_path.__file__).parents[1]
    monkeypatch.chdir(own)
    monkeypatch.setattr(sys, "path", ["", str(own), *sys.path])
    monkeypatch.setenv("PYTHONSAFEPATH", "")
    _search_path.leave_out_current_folder()
    assert sys.path[:2] == ["", str(own)]
