"""Bones of Motive's skeletons: read as bodies where they are named, with a warning."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from elbowscrew import Settings, analyze, read_recording, save_simulation, simulate_trial
from elbowscrew.cli import main
from elbowscrew.errors import NoBodiesError, RecordingError, SettingError

TRIAL = simulate_trial(frames=80, inversion=40, top_deg=80.0, seed=4)
NAMES = {"Upper Arm": "Anna:LUArm", "Forearm": "Anna:LFArm"}


def skeleton(path: Path, *, bodies: bool = False, space: str = "Global") -> Path:
    """The trial as its bones, and its rigid bodies before them if asked for; bones stand in columns of 7."""
    save_simulation(TRIAL, path)
    lines = [line.split(",") for line in path.read_text().splitlines()]
    header = next(k for k, cells in enumerate(lines) if cells[0] == "Frame")
    types = next(cells for cells in lines if "Rigid Body" in cells)
    own = [k for k, kind in enumerate(types) if kind == "Rigid Body" and "Error" not in lines[header - 1][k]]
    kept = list(range(2)) + (own if bodies else [])
    made = []
    for k, cells in enumerate(lines):
        if k == 0 or len(cells) < len(types):
            made.append(cells)
            continue
        bones = [cells[column] for column in own]
        if k < header - 1:
            bones = [
                NAMES.get(cell, "Bone" if cell == "Rigid Body" else f"{n // 7 + 1:X}") for n, cell in enumerate(bones)
            ]
        made.append([cells[column] for column in kept] + bones)
    text = "\n".join(",".join(cells) for cells in made) + "\n"
    path.write_text(text.replace("Coordinate Space,Global", f"Coordinate Space,{space}"))
    return path


def test_bones_that_are_named_are_analyzed_with_a_warning(tmp_path: Path) -> None:
    chosen = Settings(proximal="anna:luarm", distal="Anna:LFArm")
    recording = read_recording(skeleton(tmp_path / "t.csv"), **chosen.statements)
    assert [body.name for body in recording.bodies] == list(NAMES.values())
    analysis = analyze(recording, chosen)
    assert np.degrees(analysis.screw.angle.max()) == pytest.approx(80.0, abs=0.5)
    warned = [warning.message for warning in analysis.warnings if warning.code == "skeleton-bone"]
    assert len(warned) == 2
    assert all("constrains" in message for message in warned)


def test_bones_are_not_taken_by_themselves(tmp_path: Path) -> None:
    path = skeleton(tmp_path / "t.csv")
    with pytest.raises(NoBodiesError, match=r"proximal and distal \('Anna:LUArm', 'Anna:LFArm'\)"):
        read_recording(path)
    with pytest.raises(NoBodiesError, match="no rigid bodies"):
        read_recording(path, bones=("LUArm", "#1"))
    one = read_recording(path, bones="Anna:LFArm")
    with pytest.raises(SettingError, match="one of a skeleton: name both bones"):
        analyze(one, Settings(distal="Anna:LFArm"))


def test_beside_rigid_bodies_bones_are_read_only_by_name(tmp_path: Path) -> None:
    path = skeleton(tmp_path / "t.csv", bodies=True)
    alone = read_recording(path)
    assert [body.name for body in alone.bodies] == ["Upper Arm", "Forearm"]
    assert alone.source is not None
    assert alone.source.bones == ("Anna:LUArm", "Anna:LFArm")
    mixed = Settings(proximal="Upper Arm", distal="Anna:LFArm")
    analysis = analyze(read_recording(path, **mixed.statements), mixed)
    assert [one.code for one in analysis.warnings].count("skeleton-bone") == 1
    with pytest.raises(SettingError, match="did you mean 'Anna:LUArm'"):
        analyze(alone, Settings(proximal="Ana:LUArm", distal="Forearm"))


def test_bones_in_the_frames_of_their_parents_are_refused(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="Coordinate Space 'Global'"):
        read_recording(skeleton(tmp_path / "t.csv", space="Local"), bones="*")


def test_info_tells_of_bones(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["info", str(skeleton(tmp_path / "t.csv", bodies=True))]) == 0
    assert "Anna:LUArm, Anna:LFArm" in capsys.readouterr().out
    assert main(["info", str(skeleton(tmp_path / "bones.csv"))]) == 0
    out, err = capsys.readouterr()
    assert "--proximal Anna:LUArm --distal Anna:LFArm" in out
    assert "constrain" in out
    assert "[skeleton-bone]" in err
