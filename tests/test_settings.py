"""Settings: defaults, then the file, then options; a bad key is named."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from elbowscrew import Settings
from elbowscrew.cli.options import comparison_plan
from elbowscrew.configuring import settings_from
from elbowscrew.declaring import option_name
from elbowscrew.errors import SettingError, UsageError
from elbowscrew.joints import GENERIC, joints_of
from elbowscrew.motion.screws.frames import frame_called


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
        ("min-angle = 5\nmin_angle_deg = 6", "twice, under two spellings"),
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


def test_a_users_script_is_typed_without_a_plugin(root: Path, tmp_path: Path, request: pytest.FixtureRequest) -> None:
    api = pytest.importorskip("mypy.api")
    nothing = tmp_path / "mypy.ini"
    nothing.write_text("[mypy]\nignore_missing_imports = True\n")
    script = root / "tests" / "typing" / "notebook.py"
    kept = getattr(request.config, "cache", None)  # mypy looks itself at what has changed since
    cache = f"--cache-dir={tmp_path / 'cache' if kept is None else kept.mkdir('mypy')}"
    told, faults, code = api.run(
        ["--strict", f"--config-file={nothing}", "--follow-imports=silent", cache, str(script)]
    )
    assert (code, faults) == (0, ""), told


def test_the_former_names_are_the_bodies_own() -> None:
    settings = Settings(arm="A", forearm="B", arm_markers=("a",), forearm_markers=("b",))
    assert (settings.proximal, settings.distal, settings.arm, settings.forearm) == ("A", "B", "A", "B")
    assert (settings.proximal_markers, settings.distal_markers) == (("a",), ("b",))
    with pytest.raises(UsageError, match="twice"):
        Settings(arm="A", proximal="B")


@pytest.mark.parametrize(
    ("word", "joint", "end"),
    [("shank", "knee", "distal"), ("femur", "knee", "proximal"), ("shank", "ankle", "proximal"),
     ("forearm", "wrist", "proximal"), ("forearm", "elbow", "distal"), ("arm", "shoulder", "distal"),
     ("lab", "hip", "lab")],
)  # fmt: skip
def test_a_segments_word_is_an_end_of_the_joint(word: str, joint: str, end: str) -> None:
    assert frame_called(word, joints_of(joint)[0]) == (end, ())


def test_a_word_that_may_be_either_end_is_never_taken_in_silence() -> None:
    with pytest.raises(SettingError, match="give --joint"):
        frame_called("thigh", GENERIC)
    frame, warnings = frame_called("forearm", GENERIC)
    assert frame == "distal"
    assert [warning.code for warning in warnings] == ["joint-not-known"]
    with pytest.raises(SettingError, match="the joint is the elbow"):
        frame_called("thigh", joints_of("elbow")[0])
    with pytest.raises(UsageError, match="no segment of --joint knee"):
        settings_from(None, {"joint": "knee", "express-in": "forearm"})


@pytest.mark.parametrize("given", [["dlb,sclerp"], ["dlb", "sclerp"], ["dlb, sclerp", "dlb"]])
def test_a_list_keeps_all_it_is_given(given: list[str]) -> None:
    plan = comparison_plan({"methods": given, "laws": None}, {"counts": ["2", "3,4"]})
    assert (plan.methods, plan.counts) == (("dlb", "sclerp"), (2, 3, 4))
