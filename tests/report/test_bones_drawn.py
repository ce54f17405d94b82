"""Bones in space, on the page and in a clip: where they lie, what is told of them, and what is kept."""

from __future__ import annotations

import hashlib
import io
import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image, ImageSequence
from scipy.spatial.transform import Rotation

from elbowscrew import Mesh, analyze, read_mesh, read_result, save_analysis, simulate_trial
from elbowscrew.cli import main
from elbowscrew.errors import ResultError, UsageError
from elbowscrew.report import write_trial_page
from elbowscrew.report.clip import clip_of, kind_of
from elbowscrew.report.scene import scene_of
from elbowscrew.results.trial_views import view_of_result

CORNERS = np.array([[0.0, 0.0, 0.0], [0.05, 0.0, 0.01], [0.0, 0.04, 0.0], [0.01, 0.0, 0.2]])
FACES = np.array([[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]])
OBJ = "\n".join(
    [*("v {} {} {}".format(*(1000.0 * corner)) for corner in CORNERS), *("f {} {} {}".format(*(f + 1)) for f in FACES)]
)


@pytest.fixture(scope="module")
def bones(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A finished result whose page has two bones, with their files beside it."""
    folder = tmp_path_factory.mktemp("bones")
    (folder / "femur.obj").write_text(OBJ)
    trial = simulate_trial(joint="knee", frames=60, inversion=30, rate_hz=50.0, proximal="moving", gaps=1)
    meshes = {"thigh": read_mesh(folder / "femur.obj"), "Shank": Mesh(vertices=CORNERS, faces=FACES, triangles=9)}
    save_analysis(analyze(trial.recording), folder / "result", figure_formats=(), meshes=meshes)
    return folder


def copied(bones: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(bones / "result", tmp_path / "result"))


def test_bones_lie_where_their_bodies_lie(bones: Path) -> None:
    """By matrices: in the frame of the distal body at the reference, as the screws are expressed."""
    view = view_of_result(bones / "result")
    joint = json.loads((bones / "result" / "joint.json").read_text())["bodies"]["distal_in_proximal"]
    R = Rotation.from_quat(joint["quaternion"], scalar_first=True).as_matrix()
    placed = {"distal": 1000.0 * CORNERS, "proximal": (1000.0 * CORNERS - joint["position_mm"]) @ R}
    found = scene_of(view)["bones"]
    assert {one["of"] for one in found} == {"proximal", "distal"}
    for one in found:
        assert np.reshape(one["vertices"], (-1, 3)) == pytest.approx(placed[one["of"]], abs=0.06)
        assert one["faces"] == FACES.ravel().tolist()


def test_the_page_tells_of_each_bone_and_keeps_it(bones: Path, tmp_path: Path) -> None:
    page = (bones / "result" / "report.html").read_text()
    digest = hashlib.sha256((bones / "femur.obj").read_bytes()).hexdigest()
    assert f'Bone of the thigh: femur.obj (SHA-256 <span class="digest">{digest}</span>), 4 triangles' in page
    assert "4 of its 9 triangles" in page
    kept = json.loads((bones / "result" / "meshes.json").read_text())
    assert (kept["proximal"]["sha256"], kept["distal"]["triangles"]) == (digest, 9)
    copy = copied(bones, tmp_path)
    assert write_trial_page(copy).read_text() == page  # of the files alone
    assert read_result(copy).view_3d().page.count('data-show="bones"') == 1
    write_trial_page(copy, {"proximal": read_mesh(bones / "femur.obj")})
    assert "Bone of the shank" not in (copy / "report.html").read_text()
    assert json.loads((copy / "meshes.json").read_text())["distal"] is None
    assert view_of_result(copy).meshes["proximal"].vertices == pytest.approx(CORNERS, abs=1e-5)
    text = (copy / "meshes.json").read_text()
    (copy / "meshes.json").write_text(text.replace("[0,1,2]", "[0,1,9]"))
    with pytest.raises(ResultError, match=r"meshes\.json"):
        view_of_result(copy)


def test_without_bones_nothing_is_said_of_them(result: Path) -> None:
    page = (result / "report.html").read_text()
    assert "Bone of" not in page
    assert 'data-show="bones"' not in page
    assert not (result / "meshes.json").exists()


@pytest.mark.parametrize(
    ("names", "says"),
    [
        (["femur"], "--mesh 'femur': no body of this trial; possible: 'Thigh', 'thigh', 'proximal', 'Shank', 'shank'"),
        (["thigh", "proximal"], "--mesh 'proximal': a second one of the same body"),
    ],
)
def test_a_bone_of_no_body_is_an_error(bones: Path, names: list[str], says: str) -> None:
    mesh = read_mesh(bones / "femur.obj")
    with pytest.raises(UsageError) as caught:
        write_trial_page(bones / "result", dict.fromkeys(names, mesh))
    assert says in str(caught.value)
    with pytest.raises(UsageError, match="meshes"):
        read_result(bones / "result").view_3d(meshes={"femur": mesh})


def test_a_clip_plays_the_motion_in_its_own_time(bones: Path) -> None:
    view = view_of_result(bones / "result")
    clip = Image.open(io.BytesIO(clip_of(view, ".gif")))
    frames = [np.asarray(one.convert("RGB")) for one in ImageSequence.Iterator(clip)]
    assert clip.info["loop"] == 0
    assert len(frames) * clip.info["duration"] == pytest.approx(
        1230.0, abs=30.0
    )  # 59 steps of 20 ms, and the last picture
    first, middle = frames[0].astype(int), frames[len(frames) // 2].astype(int)
    assert (np.abs(first - middle).sum(axis=2) > 60).sum() > 500
    still = Image.open(io.BytesIO(clip_of(view, ".png")))
    assert still.size == (1920, 1560)
    seen = np.asarray(still.convert("RGB")).reshape(-1, 3).astype(int)
    for color in ((0, 114, 178), (213, 94, 0)):  # the two bodies
        assert (np.abs(seen - color).max(axis=1) < 3).sum() > 200
    edge = np.concatenate([frames[0][0], frames[0][-1], frames[0][:, 0], frames[0][:, -1]])
    assert (edge == 255).all()  # nothing is cut off


def test_clip_and_bones_on_the_command_line(bones: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def run(*arguments: Any) -> tuple[int, str]:
        code = main([str(one) for one in arguments])
        return code, capsys.readouterr().err

    copy, femur = copied(bones, tmp_path), bones / "femur.obj"
    assert run("report", copy, "--mesh", f"shank={femur}", "-q") == (0, "")
    assert "Bone of the thigh" not in (copy / "report.html").read_text()
    still = tmp_path / "still.png"
    assert run("report", copy, "--clip", still, "--mesh", f"thigh={femur}", "-q") == (0, "")
    assert "Bone of the thigh" not in (copy / "report.html").read_text()  # drawn, not kept
    for arguments, code, says in (
        (("--clip", still), 6, "exists already"),
        (("--clip", tmp_path / "view.avi"), 2, "expected a name that ends in .gif, .webm, .png"),
        (("--clip", still, "--figures", "theta"), 2, "one after the other"),
        (("--mesh", "thigh"), 2, "expected a body and a file, as in thigh=femur.stl"),
        (("--mesh", f"thigh={femur}", "--mesh", f"thigh={femur}"), 2, "given twice"),
        (("--mesh-unit", "m"), 2, "belongs to --mesh"),
        (("--mesh", f"thigh={femur}", "--figures", "theta"), 2, "leave one of the two out"),
    ):
        found, err = run("report", copy, *arguments)
        assert (found, says in err) == (code, True), err
    trial = tmp_path / "t.csv"
    assert run("simulate", trial, "--joint", "knee", "--frames", "60", "--inversion", "30")[0] == 0
    out = tmp_path / "out"
    asked = ("analyze", trial, "-o", out, "-q", "--figure-format", "none")
    assert run(*asked, "--mesh", f"tibia={femur}")[0] == 2
    assert not out.exists()
    assert run(*asked, "--mesh", f"Shank={femur}", "--mesh-unit", "mm")[0] == 0
    assert "meshes.json" in (out / "SHA256SUMS").read_text()


def test_webm_needs_ffmpeg(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")
    with pytest.raises(
        UsageError, match=r"needs the program ffmpeg, which is not installed; give a name that ends in \.gif"
    ):
        kind_of(Path("view.webm"))


def test_a_page_is_the_same_the_first_time_and_again(bones: Path, result: Path, tmp_path: Path) -> None:
    """So that one that was interrupted is made as if nothing had been."""
    copy = Path(shutil.copytree(result, tmp_path / "result"))
    meshes = {"distal": read_mesh(bones / "femur.obj")}
    first = write_trial_page(copy, meshes).read_bytes()
    sums = (copy / "SHA256SUMS").read_bytes()
    assert b"meshes.json" in first
    assert write_trial_page(copy, meshes).read_bytes() == first
    assert (copy / "SHA256SUMS").read_bytes() == sums
