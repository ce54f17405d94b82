"""What the structure promises."""

from __future__ import annotations

import inspect
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, get_args

import pytest

from elbowscrew.cli import options
from elbowscrew.cli.analyze import analyze
from elbowscrew.cli.batch import batch
from elbowscrew.errors import ElbowscrewError
from elbowscrew.motion.interpolation.laws import LAWS
from elbowscrew.motion.interpolation.modeling import METHODS
from elbowscrew.settings import Settings, option_name

_FORMER = {"arm", "forearm"}  # words that are still taken for proximal and distal
HEAVY = ("numpy", "pandas", "matplotlib", "scipy")


def loaded_after(code: str) -> set[str]:
    script = f"import sys\n{code}\nprint(*sorted({{name.split('.')[0] for name in sys.modules}}), file=sys.stderr)"
    result = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    return set(result.stderr.split())


@pytest.mark.parametrize(
    "arguments",
    [
        ["--help"],
        ["analyze", "--help"],
        ["batch", "--help"],
        ["report", "--help"],
        ["simulate", "--help"],
        ["--version"],
    ],
)
def test_help_and_version_load_no_heavy_library(arguments: list[str]) -> None:
    loaded = loaded_after(f"from elbowscrew.cli import main\nassert main({arguments!r}) == 0")
    assert not loaded & set(HEAVY)


def test_the_commands_version_loads_next_to_nothing() -> None:
    told = subprocess.run(
        [sys.executable, "-X", "importtime", "-m", "elbowscrew", "--version"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert told.stdout.startswith("elbowscrew ")
    loaded = {line.rpartition("|")[2].strip() for line in told.stderr.splitlines()}
    ours = {name for name in loaded if name.startswith("elbowscrew")}
    assert ours <= {"elbowscrew", "elbowscrew._version", "elbowscrew.cli"}
    assert not loaded & {*HEAVY, "typer", "typing"}


def test_importing_the_package_loads_no_heavy_library() -> None:
    assert not loaded_after("import elbowscrew\nelbowscrew.__version__\ndir(elbowscrew)") & set(HEAVY)


def test_analyzing_without_figures_needs_neither_pandas_nor_matplotlib(samples: Path, tmp_path: Path) -> None:
    arguments = ["analyze", str(samples / "elbow_paper.csv"), "-o", str(tmp_path / "o"), "--figure-format", "none"]
    loaded = loaded_after(f"from elbowscrew.cli import main\nassert main({arguments!r}) == 0")
    assert not loaded & {"pandas", "matplotlib", "scipy"}


@pytest.mark.parametrize("command", [analyze, batch])
def test_every_setting_is_an_option_and_offers_the_same_choices(command: Callable[..., None]) -> None:
    parameters = inspect.signature(command, eval_str=True).parameters
    given = {name.replace("_", "-"): parameter for name, parameter in parameters.items()}
    for name, field in Settings.model_fields.items():
        option = given[option_name(name)]
        wanted = _choices(field.annotation)
        if wanted and not {int, float} & set(get_args(field.annotation)):  # a number or a word is text in the shell
            assert _choices(option.annotation) - _FORMER == wanted, name


def _choices(annotation: Any) -> set[str]:
    """Literals anywhere inside a type; those of an enumeration by their values."""
    if annotation in (options.FigureFormat, options.ExportFormat):
        return {kind.value for kind in annotation}
    found = set()
    for part in get_args(annotation):
        if isinstance(part, str):
            found.add(part)
        else:
            found |= _choices(part)
    return found


def test_registries_and_settings_name_the_same_things() -> None:
    assert set(METHODS) == _choices(Settings.model_fields["method"].annotation)
    assert {*LAWS, "empirical", "best"} == _choices(Settings.model_fields["law"].annotation)


def test_every_error_has_its_own_exit_code() -> None:
    codes = [kind.exit_code for kind in ElbowscrewError.__subclasses__()]
    assert sorted(codes) == [2, 3, 4, 5, 6]
