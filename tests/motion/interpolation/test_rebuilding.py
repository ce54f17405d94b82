"""Motions rebuilt from their keyframes: the model again, and poses of anybody's."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from elbowscrew import Settings, analyze, interpolate, keyframes_of, read_keyframes, save_analysis, simulate_trial
from elbowscrew.cli import main
from elbowscrew.errors import ElbowscrewError
from elbowscrew.geometry import dual_quat_from_screw, sclerp
from elbowscrew.geometry.dual_quaternion import dual_quat_from_pose, pose_from_dual_quat

TRIAL = simulate_trial(marker_noise_mm=0.2, proximal="moving", seed=7).recording
RESTING = simulate_trial(rest_before_s=1.0, hold_s=0.7, rest_after_s=0.8, repetitions=2, seed=3).recording
CHOICES: list[dict[str, Any]] = [
    {},
    {"method": "dib", "law": "harmonic", "law_peak": 0.4, "keyframes": (0, 60, 211, 300, 380, 449)},
    {"method": "catmull-rom", "blend": "global", "keyframes": (0, 60, 211, 300, 449), "knots": "uniform"},
    {"method": "sclerp", "blend": "global", "knots": "chord", "express_in": "proximal"},
    {"tolerance_mm": 4.0, "express_in": "lab"},
    {"tolerance_mm": 4.0, "law": "best", "method": "sdlb"},
    {"phases": "whole", "law": "best", "method": "sclerp"},
    {"method": "joint", "express_in": "proximal", "keyframes": (0, 60, 211, 300, 449)},
]


@pytest.mark.parametrize("choice", CHOICES, ids=[str(sorted(choice)) for choice in CHOICES])
@pytest.mark.parametrize("units", [("deg", "mm"), ("rad", "m")])
def test_keyframes_and_their_file_give_the_model_again(choice: dict[str, Any], units: Any, tmp_path: Path) -> None:
    analysis = analyze(TRIAL, Settings(**choice, angle_unit=units[0], length_unit=units[1], figure_format=("none",)))
    rows = np.arange(analysis.keyframes.row[0], analysis.keyframes.row[-1] + 1)
    save_analysis(analysis, tmp_path / "r")
    for keyframes in (keyframes_of(analysis), read_keyframes(tmp_path / "r" / "keyframes.csv")):
        motion = interpolate(keyframes, rows.size)
        assert motion.time_s == pytest.approx(analysis.screw.time_s[rows], abs=1e-9)
        assert motion.euler_parameters == pytest.approx(analysis.interpolated.euler_parameters[rows], abs=1e-10)
        assert motion.translation == pytest.approx(analysis.interpolated.translation[rows], abs=1e-10)
        assert motion.angle == pytest.approx(analysis.interpolated.angle[rows], abs=1e-9)
        assert motion.fraction == pytest.approx(analysis.interpolated.fraction[rows], abs=1e-9)


def test_rests_and_repetitions_are_rebuilt() -> None:
    analysis = analyze(RESTING, Settings(method="sclerp"))
    rows = np.arange(analysis.keyframes.row[0], analysis.keyframes.row[-1] + 1)
    motion = interpolate(keyframes_of(analysis), rows.size)
    assert motion.angle == pytest.approx(analysis.interpolated.angle[rows], abs=1e-9)
    assert motion.phase.max() == 4


def test_more_frames_lie_on_the_same_motion() -> None:
    keyframes = keyframes_of(analyze(TRIAL, Settings(law="best")))
    few, many = interpolate(keyframes, 90), interpolate(keyframes, 89 * 7 + 1)
    assert many.euler_parameters[::7] == pytest.approx(few.euler_parameters, abs=1e-10)


def test_poses_without_anything_else(tmp_path: Path) -> None:
    """Two poses of either sign, the shorter way, linearly by ScLERP: as the function does it."""
    start, end = dual_quat_from_screw([0.0, 1.2], [0.0, 0.03], [0.6, 0.0, 0.8], [0.0, 0.1, 0.0])
    lines = ["time_s,e0,e1,e2,e3,d_x_m,d_y_m,d_z_m"]
    for time, pose, sign in ((1.0, start, 1), (3.0, end, -1)):
        quat, place = pose_from_dual_quat(pose)
        lines.append(",".join(repr(float(value)) for value in (time, *(sign * quat), *place)))
    path = tmp_path / "poses.csv"
    path.write_text("\n".join(lines))
    motion = interpolate(read_keyframes(path, method="sclerp", law="linear"), 5)
    expected = sclerp(start, end, np.linspace(0, 1, 5))
    found = dual_quat_from_pose(motion.euler_parameters, motion.translation)
    assert found == pytest.approx(expected, abs=1e-12)
    assert motion.angle == pytest.approx(np.linspace(0.0, 1.2, 5), abs=1e-12)
    assert motion.slide[1:] == pytest.approx(np.linspace(0.0, 0.03, 5)[1:], abs=1e-12)
    assert np.isnan(motion.slide[0])


GOOD = "time_s,e0,e1,e2,e3,d_x_mm,d_y_mm,d_z_mm{more}\n0,1,0,0,0,0,0,0{a}\n1,0,1,0,0,0,0,0{b}\n2,0,0,1,0,0,0,0{c}\n"


def jointed(**changed: str | tuple[str, ...]) -> str:
    """Three poses of a hinge."""
    columns: dict[str, str | tuple[str, ...]] = {"method": "joint", "joint_type": "hinge", "axis1_x": "1"}
    columns |= dict.fromkeys(("axis1_y", "axis1_z", "point1_x_mm", "point1_y_mm", "point1_z_mm"), "0")
    columns |= {"end_e0": "1"} | dict.fromkeys(("end_e1", "end_e2", "end_e3", "end_x_mm", "end_y_mm", "end_z_mm"), "0")
    columns |= changed
    cells = [(one,) * 3 if isinstance(one, str) else one for one in columns.values()]
    lines = ["".join(f",{cell}" for cell in line) for line in zip(*cells, strict=True)]
    return GOOD.format(more="".join(f",{name}" for name in columns), **dict(zip("abc", lines, strict=True)))


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "1: expected the columns of keyframes.csv"),
        ("a,b\n1,2\n", "missing columns time_s, e0"),
        ("time_s,e0,e1,e2,e3,d_x_mm,d_y_mm,d_z_mm\n0,1,0,0,0,0,0,0\n", "two keyframes or more, found 1"),
        (GOOD.format(more="", a="", b="", c="").replace("\n2,", "\n0.5,"), ":4: time_s must increase"),
        (GOOD.format(more="", a="", b="", c="").replace("0,1,0,0,0,0,0\n2", "0,1.1,0,0,0,0,0\n2"), ":3: e0 to e3"),
        (
            GOOD.format(more="", a="", b="", c="").replace("0,1,0,0,0,0,0\n2", "x,1,0,0,0,0,0\n2"),
            ":3: e0: expected",
        ),
        (GOOD.format(more="", a="", b="", c="").replace("0,1,0,0,0,0,0\n2", "0,1,0,0,nan,0,0\n2"), ":3: d_x_mm: expe"),
        (GOOD.format(more="", a=",7", b="", c=""), ":2: expected 8 cells, found 9"),
        (GOOD.format(more=",phase", a=",1", b=",3", c=",3"), ":3: phases must be numbered"),
        (GOOD.format(more=",phase", a=",2", b=",2", c=",2"), ":2: the first phase must be 1"),
        (GOOD.format(more=",phase", a=",1", b=",1", c=",2"), ":4: the last phase has no keyframe but its first\n"),
        (GOOD.format(more=",knot", a=",0", b=",0.7", c=",0.5"), ":4: the knots must increase"),
        (GOOD.format(more=",knot", a=",0", b=",0.5", c=",0.9"), "must be 0, 1"),
        (GOOD.format(more=",law", a=",magic", b=",magic", c=",magic"), ":2: expected a law"),
        (
            GOOD.format(more=",law,law_peak", a=",cycloidal,1.5", b=",cycloidal,1.5", c=",cycloidal,1.5"),
            ":2: law_peak: expected 0.05 to 0.95, found '1.5'",
        ),
        (
            GOOD.format(more=",law,law_peak", a=",cycloidal,1e-310", b=",cycloidal,1e-310", c=",cycloidal,1e-310"),
            ":2: law_peak: expected 0.05 to 0.95, found '1e-310'",
        ),
        (GOOD.format(more=",law", a=",empirical", b=",empirical", c=",empirical"), "give law cycloidal"),
        (GOOD.format(more=",method", a=",dlb", b=",dib", c=",dlb"), "method: expected one of"),
        (GOOD.format(more=",law_start_s,law_end_s", a=",1,0", b=",1,0", c=",1,0"), ":2: law_start_s and law_end_s"),
        (GOOD.format(more=",e0", a=",1", b=",1", c=",1"), "stands twice"),
        (GOOD.format(more=",method", a=",joint", b=",joint", c=",joint"), "does not tell of a joint"),
        (jointed(), ":1: the column angle1_deg is missing"),
        (jointed(angle1_deg="x"), ":2: angle1_deg: expected a number"),
        (jointed(angle1_deg="10", axis1_x=("1", "1", "0")), ":4: axis1_x must be the same in all lines"),
        (jointed(angle1_deg="10", axis1_x="0.9"), ":2: axes must be unit vectors"),
        (jointed(angle1_deg="10", joint_type="saddle"), "joint_type: expected one of hinge"),
    ],
)
def test_what_is_wrong_with_a_file_is_told_with_its_line(text: str, says: str, tmp_path: Path) -> None:
    path = tmp_path / "keys.csv"
    path.write_text(text)
    with pytest.raises(ElbowscrewError) as caught:
        read_keyframes(path)
    assert says in f"{caught.value}\n"
    assert caught.value.exit_code in (3, 4)


def test_a_law_begins_and_ends_where_the_file_says(tmp_path: Path) -> None:
    """Before and after the law the motion rests; with one of the two columns alone neither counts."""
    path = tmp_path / "keys.csv"
    path.write_text(GOOD.format(more=",law,law_start_s,law_end_s", **dict.fromkeys("abc", ",linear,0.5,1.5")))
    motion = interpolate(read_keyframes(path), 9)
    step = np.abs(np.diff(motion.euler_parameters, axis=0)).max(axis=1)
    assert (step[[0, 1, 6, 7]] < 1e-12).all()
    assert (step[2:6] > 0.01).all()
    path.write_text(GOOD.format(more=",law,law_start_s", **dict.fromkeys("abc", ",linear,0.5")))
    assert (np.abs(np.diff(interpolate(read_keyframes(path), 9).euler_parameters, axis=0)).max(axis=1) > 0.01).all()


def test_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    save_analysis(analyze(TRIAL), tmp_path / "r", figure_formats=())
    keys = str(tmp_path / "r" / "keyframes.csv")
    assert main(["interpolate", keys, "--frames", "20"]) == 0
    assert capsys.readouterr().out == "keyframes_motion.csv\n"
    lines = (tmp_path / "keyframes_motion.csv").read_text().splitlines()
    assert lines[0].startswith("frame,time_s,phase,t,theta_deg,slide_mm,e0")
    assert len(lines) == 21
    assert main(["interpolate", keys, "--frames", "20"]) == 6
    assert main(["interpolate", keys, "--frames", "20", "--force", "--law", "linear", "--method", "sclerp"]) == 0
    assert main(["interpolate", keys, "--frames", "1"]) == 2
    assert main(["interpolate", keys, "--frames", "9", "--law-peak", "0.3"]) == 2
    assert main(["interpolate", "missing.csv", "--frames", "9"]) == 3
    (tmp_path / "latin.csv").write_bytes(b"time_s,\xff\xfe\n1,2\n")
    assert main(["interpolate", "latin.csv", "--frames", "9"]) == 3
    assert "Traceback" not in capsys.readouterr().err
