"""What the structure promises."""

from __future__ import annotations

import inspect
import subprocess
import sys
from pathlib import Path
from typing import Any, get_args

import pytest

from elbowscrew.choices import LawName, functions_named
from elbowscrew.cli.analyze import analyze
from elbowscrew.cli.batch import batch
from elbowscrew.errors import ElbowscrewError
from elbowscrew.joints import JOINTS
from elbowscrew.motion.interpolation.laws import LAWS
from elbowscrew.motion.interpolation.modeling import METHODS
from elbowscrew.settings import SETTINGS, Settings

HEAVY = ("numpy", "pandas", "matplotlib", "scipy")


def loaded_after(code: str) -> set[str]:
    """Modules that are loaded when the code has run, their packages among them."""
    script = f"import sys\n{code}\nprint(*sorted(sys.modules), file=sys.stderr)"
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
    assert not loaded & {"pandas", "matplotlib"}
    # The intervals stand on SciPy's special functions; its statistics take as long to load as all that is needed.
    assert not loaded & {"scipy.stats", "scipy.optimize", "scipy.spatial", "scipy.ndimage", "scipy.interpolate"}


@pytest.mark.parametrize("command", [analyze, batch])
def test_every_setting_is_an_option_with_its_choices_and_names(command: Any) -> None:
    made = inspect.signature(command.with_settings()).parameters
    for setting in SETTINGS:
        kind, option = get_args(made[setting.option.replace("-", "_")].annotation)
        names = {name for text in (option.default, *option.param_decls) for name in text.split("/")}
        assert {f"--{setting.option}", *(f"--{name}" for name in setting.former)} <= names
        if setting.choices and not setting.several:
            assert set(setting.choices) == set(get_args(get_args(kind)[0]))


def test_a_setting_takes_the_names_of_its_registry() -> None:
    choices = {setting.field: set(setting.choices) for setting in SETTINGS}
    assert {*METHODS, "joint"} == choices["method"]
    assert {Settings.model_validate({"law": name}).law for name in (*LAWS, "empirical", "best")} == {
        *get_args(LawName)
    }  # other distributions' laws are allowed beside them
    assert {joint.name for joint in JOINTS} == choices["joint"]


def test_a_name_without_its_function_is_told() -> None:
    with pytest.raises(LookupError, match="no function for"):
        functions_named(("dlb",), {"__name__": "there"})


def test_every_error_has_its_own_exit_code() -> None:
    codes = [kind.exit_code for kind in ElbowscrewError.__subclasses__()]
    assert sorted(codes) == [2, 3, 4, 5, 6]
