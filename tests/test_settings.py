"""Settings: defaults, then the file, then options; a bad key is named."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from elbowscrew import Settings
from elbowscrew.errors import UsageError
from elbowscrew.settings import option_name, settings_from


def test_options_are_stronger_than_the_file_and_the_file_than_defaults(tmp_path: Path) -> None:
    file = tmp_path / "lab.toml"
    file.write_text('min-angle = 5\nmax_gap = 0.2\narm = "A"\nkeyframes = [0, 10, 20]\nfigure-format = "pdf"\n')
    settings = settings_from(file, {"min_angle": 7.0, "arm": None})
    assert settings.min_angle_deg == 7.0
    assert settings.max_gap_s == 0.2
    assert settings.proximal == "A"
    assert settings.keyframes == (0, 10, 20)
    assert settings.figure_formats == ("pdf",)
    assert settings.method == Settings().method


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("min-angel = 5", "unknown key 'min-angel'; did you mean 'min-angle'"),
        ("zzz = 5", "unknown key 'zzz'; possible keys: joint"),
        ("min-angle = -5", "min-angle: should be greater than 0, found -5"),
        ("min-angle = nan", "min-angle: should be a finite number"),
        ('method = "magic"', "method: should be 'dlb'"),
        ("reference = 1.5", "reference"),
        ("keyframes = [10, 5]", "keyframes must increase"),
        ("keyframes = [5]", "keyframes"),
        ("= 3", "not TOML"),
        ("a = " + "[" * 20000, "not TOML"),
        ("min-angle = 5\nmin_angle_deg = 6", "twice under two spellings"),
    ],
)
def test_a_bad_setting_is_named_with_its_file(tmp_path: Path, text: str, says: str) -> None:
    file = tmp_path / "lab.toml"
    file.write_text(text)
    with pytest.raises(UsageError) as caught:
        settings_from(file)
    assert says in str(caught.value)
    assert "lab.toml" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_an_unreadable_file_is_an_error(tmp_path: Path) -> None:
    for path in (tmp_path / "none.toml", tmp_path):
        with pytest.raises(UsageError, match="cannot be read"):
            settings_from(path)
    binary = tmp_path / "b.toml"
    binary.write_bytes(b"\xff\xfe")
    with pytest.raises(UsageError, match="not TOML"):
        settings_from(binary)


@pytest.mark.parametrize("options", [{"keyframes": (0, 50, 100), "inversion": 60}, {"max_gap": float("inf")}])
def test_contradicting_options_are_refused(options: dict[str, Any]) -> None:
    with pytest.raises(UsageError):
        settings_from(None, options)


def test_option_names_leave_the_unit_out() -> None:
    assert option_name("min_angle_deg") == "min-angle"
    assert option_name("max_gap_s") == "max-gap"
    assert option_name("express_in") == "express-in"
