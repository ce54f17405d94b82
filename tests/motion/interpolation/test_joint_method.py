"""Models in the joint's own angles: what they are between keyframes, whom they serve, and who is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from elbowscrew import ComparisonPlan, Recording, RigidBody, Settings, analyze, compare, save_simulation, simulate_trial
from elbowscrew.cli import main
from elbowscrew.errors import SettingError
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.model import Analysis
from elbowscrew.report.methods import methods_of
from elbowscrew.results.trial_views import view_of_result

EXACT: dict[str, Any] = {"frames": 160, "inversion": 70, "marker_noise_mm": 0.0}
FRAMES = (0, 25, 70, 100, 159)


def modeled(**settings: Any) -> Any:
    kind = settings.pop("kind")
    recording = simulate_trial(**EXACT, **kind).recording
    return analyze(recording, Settings(keyframes=FRAMES, inversion=70, **settings))


def poses_of(analysis: Analysis) -> Any:
    model = analysis.interpolated
    return dq.dual_quat_from_pose(model.euler_parameters, model.translation)


@pytest.mark.parametrize("law", ["cycloidal", "linear"])
@pytest.mark.parametrize(
    "kind",
    [
        {"joint_type": "hinge", "top_deg": 220.0},
        {"joint_type": "screw-hinge", "slide_mm": 9.0},
        {"joint_type": "ball", "joint": "hip", "top_deg": 100.0},
    ],
)
def test_about_one_axis_or_a_center_it_is_sclerp(kind: dict[str, Any], law: Any) -> None:
    one, other = (modeled(kind=kind, method=method, law=law) for method in ("joint", "sclerp"))
    assert one.keyframes.joint.type == kind["joint_type"].replace("-", "_")
    assert poses_of(one) == pytest.approx(poses_of(other), abs=1e-7)


@pytest.mark.parametrize("knots", ["law", "uniform", "angle"])
@pytest.mark.parametrize("side", ["left", "right"])
def test_between_keyframes_both_angles_go_evenly(side: Any, knots: Any) -> None:
    """By SciPy's rotations about the true axes, at angles that go evenly from keyframe to keyframe."""
    trial = simulate_trial(**EXACT, joint_type="two-axes", side=side)
    analysis = analyze(
        trial.recording,
        Settings(method="joint", law="harmonic", knots=knots, keyframes=FRAMES, inversion=70, express_in="proximal"),
    )
    phase, t = np.ma.getdata(analysis.interpolated.phase), analysis.interpolated.fraction
    told = [np.array(trial.truth["joint_angles"][f"angle{k}_deg"]) for k in (1, 2)]
    turns = []
    for number, (axis, course) in enumerate(zip(("axis1", "axis2"), told, strict=True)):
        angle = np.empty(160)
        for p, members in enumerate((FRAMES[:3], FRAMES[2:])):
            rows = phase == p + 1
            angle[rows] = np.interp(t[rows], analysis.keyframes.knots[p], course[list(members)])
        line = trial.truth["two_axes"][axis]["proximal"]
        turns.append((Rotation.from_rotvec(np.radians(angle)[:, None] * line["direction"]), line["point_mm"]))
        assert analysis.keyframes.joint_angle is not None
        assert np.degrees(analysis.keyframes.joint_angle[:, number]) == pytest.approx(course[list(FRAMES)], abs=1e-7)
    (first, p1), (second, p2) = turns
    rotation = first * second
    place = first.apply(second.apply(-np.array(p2)) + p2 - p1) + p1  # of the proximal body's origin
    quat = rotation.as_quat()[:, [3, 0, 1, 2]]
    sign = np.sign(np.sum(quat * analysis.interpolated.euler_parameters, axis=1))[:, None]
    assert analysis.interpolated.euler_parameters == pytest.approx(sign * quat, abs=1e-8)
    assert 1e3 * analysis.interpolated.translation == pytest.approx(place, abs=1e-5)
    met = FRAMES if knots == "law" else FRAMES[::2]  # with other knots only the phases' ends have their own time
    assert analysis.interpolated.rms_displacement[list(met)] == pytest.approx(np.zeros(len(met)), abs=1e-9)


def test_it_goes_the_way_round_that_the_motion_went() -> None:
    """Over 300 deg between two keyframes, not over the 60 that are left."""
    analysis = modeled(kind={"joint_type": "hinge", "top_deg": 300.0}, method="joint", law="linear")
    whole = analyze(
        simulate_trial(**EXACT, joint_type="hinge", top_deg=300.0).recording,
        Settings(method="joint", law="polynomial-345", phases="whole", inversion=70),
    )
    assert whole.keyframes.joint_angle is not None
    assert np.degrees(whole.keyframes.joint_angle[:, 0]) == pytest.approx([0.0, 300.0, 0.0], abs=1e-6)
    assert np.nanmax(whole.interpolated.rms_displacement) < 1e-8
    assert np.degrees(analysis.keyframes.joint_angle[2, 0]) == pytest.approx(300.0, abs=1e-6)


def wild(frames: int = 120) -> Recording:
    """A body that goes where it will, so that no joint explains it."""
    rng = np.random.default_rng(3)
    time = np.linspace(0.0, 1.0, frames)[:, None]
    waves = [rng.normal(size=6) * np.sin((k + 1) * np.pi * time + rng.normal(size=6)) for k in range(3)]
    course = np.sum(waves, axis=0)
    quat = Rotation.from_rotvec(0.8 * course[:, :3]).as_quat()[:, [3, 0, 1, 2]]
    pose = dq.dual_quat_from_pose(quat, 0.3 * course[:, 3:])
    return Recording.from_bodies(
        [RigidBody(name="b", dual_quat_lab_body=pose, loss=np.zeros(frames, dtype=np.uint8))], rate_hz=100
    )


@pytest.mark.parametrize("stated", ["auto", "free", "rigid"])
def test_a_joint_without_angles_is_refused_in_one_line(stated: str) -> None:
    with pytest.raises(SettingError, match='method="joint": the joint is') as caught:
        analyze(wild(), Settings(method="joint", joint_type=stated))
    assert "\n" not in str(caught.value)
    assert " here, which has no angles" in str(caught.value)
    if stated != "auto":
        assert f"is {stated} here" in str(caught.value)


def test_a_stated_type_that_the_motion_does_not_determine_is_refused() -> None:
    """Two axes on the motion of one: how they share the rotation is not told by it."""
    recording = simulate_trial(frames=150, inversion=60, proximal="moving", seed=1).recording
    with pytest.raises(SettingError, match="does not determine the angles of a joint of type two-axes"):
        analyze(recording, Settings(method="joint", joint_type="two-axes"))


def test_a_stated_type_is_taken() -> None:
    recording = simulate_trial(**EXACT, joint_type="two-axes").recording
    analysis = analyze(recording, Settings(method="joint", joint_type="ball"))
    assert analysis.keyframes.joint is not None
    assert analysis.keyframes.joint.type == "ball"


def test_a_comparison_has_it_beside_the_others_and_says_why_where_it_cannot() -> None:
    plan = ComparisonPlan(methods=("joint", "sclerp"), laws=("best",), counts=(2, 3), data=("raw", "decimated"))
    trial = simulate_trial(frames=200, inversion=90, joint_type="two-axes", seed=3)
    models = compare(trial.recording, plan=plan).models
    mine = (models.method == "joint") & (models.data == "raw")
    assert models.keyframes_per_phase[mine].tolist().count(2) == 1
    direct = analyze(trial.recording, Settings(method="joint", law="best")).interpolated.rms_displacement
    found = models.rms_displacement[mine & (models.keyframes_per_phase == 2)]
    assert found == pytest.approx([np.sqrt(np.nanmean(direct**2))], rel=1e-9)
    refused = compare(wild(), plan=plan).models
    notes = refused.note[refused.method == "joint"].tolist()
    assert notes
    assert all("--method joint: the joint is" in note for note in notes)
    assert not any(refused.note[refused.method == "sclerp"])


def test_filtered_keyframes_have_filtered_angles() -> None:
    """What the joint leaves of them is not their own noise any more."""
    plan = ComparisonPlan(
        methods=("joint",), laws=("polynomial-345",), blends=("piecewise",), counts=(2,), data=("raw", "lowpass")
    )
    trial = simulate_trial(joint_type="hinge", marker_noise_mm=1.0, seed=8)
    models = compare(trial.recording, Settings(lowpass_hz=4.0), plan).models
    errors = dict(zip(models.data.tolist(), models.rms_displacement.tolist(), strict=True))
    assert errors["lowpass 4 Hz"] < errors["raw"]


def test_the_commands(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """Analyze, batch, report and interpolate know it; a refusal has an exit code and one line."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "study").mkdir()
    save_simulation(simulate_trial(frames=160, inversion=70, joint_type="two-axes"), tmp_path / "study" / "a.csv")
    assert main(["batch", "study", "-o", "out", "--method", "joint", "--figure-format", "none"]) == 0
    folder = next((tmp_path / "out").glob("*/keyframes.csv")).parent
    assert "interpolation of the angles about the joint's two axes" in methods_of(view_of_result(folder))
    assert main(["report", str(folder)]) == 0
    assert main(["interpolate", str(folder / "keyframes.csv"), "--frames", "50"]) == 0
    plain = tmp_path / "r"
    assert main(["analyze", "study/a.csv", "-o", str(plain), "--figure-format", "none"]) == 0
    assert "joint_type" not in (plain / "keyframes.csv").read_text()
    capsys.readouterr()
    assert main(["interpolate", str(plain / "keyframes.csv"), "--frames", "50", "--method", "joint", "--force"]) == 4
    assert "does not tell of a joint" in capsys.readouterr().err
    free = ["--method", "joint", "--joint-type", "free", "--figure-format", "none"]
    assert main(["analyze", "study/a.csv", "-o", "f", *free]) == 4
    told = capsys.readouterr().err
    assert "the joint is free here" in told
    assert "Traceback" not in told
