"""The joint's type as an analysis tells it: two axes and a center with truth, and a hinge that stays one."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import moving_joints as mj
import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d
from trials import joint_poses

from elbowscrew import Analysis, Recording, RigidBody, Settings, analyze, read_recording, simulate_trial
from elbowscrew.cli import main
from elbowscrew.cli.render import analysis_table
from elbowscrew.cli.render_joint import joint_axis_text
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.interface.facts import facts
from elbowscrew.motion.joint.typed import identify_joint
from elbowscrew.motion.movements.course import two_axes_of
from elbowscrew.plots.joint_type import joint_text
from elbowscrew.report.joint_words import joint_sentences
from elbowscrew.results.joint_summary import joint_summary
from elbowscrew.results.summary import summary_from_analysis
from elbowscrew.results.trial_views import view_of_analysis


def degrees_off(found: list[float], truth: tuple[float, float, float]) -> float:
    """Angle between two lines."""
    n, m = np.array(found), np.array(truth) / np.linalg.norm(truth)
    return float(np.degrees(np.arcsin(min(1.0, float(np.linalg.norm(np.cross(n, m)))))))


def test_an_elbow_that_flexes_and_pronates_has_two_axes(
    real_data: Path, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    analysis = analyze(read_recording(real_data / "cases" / "two_axis_elbow.csv"), Settings(proximal="none"))
    told = joint_summary(analysis)
    found, axes = told["joint_type"], told["two_axes"]
    assert axes is not None
    assert (found["type"], found["status"]) == ("two_axes", "determined")
    assert degrees_off(axes["axis1"]["direction_in_proximal"], (0.98, 0.1, 0.17)) < 0.1
    assert degrees_off(axes["axis2"]["direction_in_distal"], (0.1, -0.99, 0.05)) < 0.1
    assert axes["angle_between_deg"] == pytest.approx(89.57, abs=0.1)
    assert axes["distance_mm"] in (pytest.approx(12.225, abs=0.1), pytest.approx(-12.225, abs=0.1))
    low, high = axes["angle_between_deg_low"], axes["angle_between_deg_high"]
    assert low is not None
    assert high is not None
    assert low < 89.57 < high
    summary = summary_from_analysis(analysis)
    assert summary["motion"]["joint_axis"] is None  # one axis would be 20 deg off
    analysis_table(summary, tmp_path)
    assert "two axes (determined)" in " ".join(capsys.readouterr().out.split())


def test_a_hip_has_a_center(real_data: Path) -> None:
    found = joint_summary(analyze(read_recording(real_data / "cases" / "hip_ball.csv")))
    assert found["joint_type"]["type"] == "ball"
    assert found["ball"] is not None
    assert found["ball"]["center_in_proximal_mm"] == pytest.approx([30.0, -50.0, 80.0], abs=0.2)
    assert found["ball"]["center_in_distal_mm"] == pytest.approx([0.0, 250.0, 0.0], abs=0.2)


def test_pronation_while_flexing_is_no_single_axis(real_data: Path) -> None:
    """140 deg of flexion with 60 deg of pronation: a hinge is 20 deg off and leaves 12 deg."""
    markers = ("UA0", "UA1", "UA2", "UA3", "FA0", "FA1", "FA2", "FA3")
    recording = read_recording(real_data / "cases" / "pronation60.csv", markers=markers)
    analysis = analyze(recording, Settings(proximal_markers=markers[:4], distal_markers=markers[4:]))
    found = joint_summary(analysis)
    assert found["joint_type"]["type"] == "two_axes"
    assert found["two_axes"] is not None
    assert found["two_axes"]["axis1"]["range_deg"] == pytest.approx(140.0, abs=5.0)
    assert found["two_axes"]["axis2"]["range_deg"] == pytest.approx(60.0, abs=5.0)
    assert analysis.joint_axis.best is None
    assert "no-single-axis" in {warning.code for warning in analysis.warnings}


def test_a_hinge_keeps_its_axis_and_no_richer_type_is_tried() -> None:
    """What the hinge leaves is white in time: no joint could leave less."""
    analysis = analyze(simulate_trial(frames=120, inversion=60, seed=2).recording)
    told = joint_summary(analysis)
    found = told["joint_type"]
    assert found["type"] in ("hinge", "screw_hinge")
    assert found["type"] == analysis.joint_axis.preferred
    assert found["status"] == "determined"
    assert {one["type"] for one in found["candidates"]} <= {"rigid", "hinge", "screw_hinge"}
    assert told["two_axes"] is None
    assert told["ball"] is None
    assert (found["decided_by"], found["interval_method"]) != (None, None)


def test_how_undetermined_axes_stand_to_each_other_is_left_open(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    recording = simulate_trial(joint_type="hinge", proximal="moving", frames=200, inversion=95, seed=3).recording
    analysis = analyze(recording, Settings(joint_type="two_axes"))
    told, summary = joint_summary(analysis), summary_from_analysis(analysis)
    axes = told["two_axes"]
    assert axes is not None
    assert not (axes["axis1"]["determined"] and axes["axis2"]["determined"])
    between = {name: value for name, value in axes.items() if name not in ("axis1", "axis2")}
    assert not between.pop("order_determined")
    assert between == dict.fromkeys(between)
    analysis_table(summary, tmp_path)
    assert "how they stand to each other is undetermined" in " ".join(capsys.readouterr().out.split())
    assert "How the axes stand to each other is undetermined." in joint_sentences(
        view_of_analysis(analysis, summary, told)
    )
    assert joint_text(analysis) == "Joint: two axes (as stated)"


def test_parallel_axes_may_turn_against_each_other() -> None:
    """As links of a chain do; both are seen by where their lines are."""
    rng = np.random.default_rng(3)
    time = np.linspace(0.0, 2.0 * np.pi, 200)
    first = np.radians(60.0) * 0.5 * (1.0 - np.cos(time))
    second = -np.radians(40.0) * 0.5 * (1.0 - np.cos(time - 0.7))
    up = np.array([0.0, 0.0, 1.0])
    lines = mj.turned(first, mj.line(up, np.zeros(3))), mj.turned(second, mj.line(up, np.array([0.25, 0.0, 0.0])))
    seen, covariance = mj.noisy(dq.multiply(dq.multiply(*lines), mj.rest_pose(rng)), rng, 0.1, 2e-4)
    found = identify_joint(seen, covariance, seen[0], noise_known=True)
    assert (found.type, found.status) == ("two_axes", "determined")
    assert found.two_axes is not None
    assert [line.determined for line in found.two_axes.lines] == [True, True]
    assert found.two_axes.offset is not None
    assert found.two_axes.offset.value == pytest.approx(0.25, abs=3.0 * found.two_axes.offset.sd)


def test_a_knee_that_screws_home_is_a_hinge_that_wanders(real_data: Path) -> None:
    """15 deg of axial turn go with the first third of the flexion: two axes are no certainty there."""
    analysis = analyze(read_recording(real_data / "cases" / "knee_screwhome.csv"))
    found = joint_summary(analysis)
    assert found["joint_type"]["type"] in ("hinge", "screw_hinge")
    assert found["joint_type"]["status"] == "approximate"
    assert found["wander"] is not None
    assert found["wander"]["significant"] is True
    assert found["mean_axis"] is not None


def test_few_frames_of_no_clear_joint_are_no_certain_pair_of_axes(real_data: Path) -> None:
    """The same pair, and as uncertain, for no arm and for one that stands still."""
    recording = read_recording(real_data / "cases" / "swap_arm_forearm.csv")
    directions = []
    for still in ("none", "desk"):
        found = analyze(recording, Settings(proximal=still, distal="board")).joint_type
        assert found is not None
        assert (found.type, found.status) == ("two_axes", "approximate")
        assert found.two_axes is not None
        assert not found.two_axes.order_determined
        directions.append([found.two_axes.axis1.direction_distal, found.two_axes.axis2.direction_distal])
    assert directions[1] == pytest.approx(np.array(directions[0]), abs=1e-4)


@pytest.mark.parametrize(
    ("name", "proximal", "distal"), [("0627_0117", 1, 2), ("0706_122504", 1, 2), ("0706_122504", 2, 3)]
)
def test_a_hinge_of_a_robot_is_no_ball_for_half_a_degree(
    real_data: Path, name: str, proximal: int, distal: int
) -> None:
    """It leaves a half degree, well beyond what its markers' noise explains, and two axes or a ball leave less."""
    recording = read_recording(real_data / "real" / f"v121_thomazach_2023{name}.csv")
    bodies = Settings(proximal=f"Rigid Body {proximal}", distal=f"Rigid Body {distal}")
    analysis = analyze(recording, bodies)
    assert analysis.joint_type is not None
    assert analysis.joint_type.type in ("hinge", "screw_hinge")
    assert analysis.joint_type.status == "approximate"


def test_a_joint_that_hardly_moves_has_no_axis() -> None:
    """A degree to and fro, well told by its noise, is play or drift."""
    angle = np.radians(0.5) * np.sin(np.linspace(0.0, 6.0, 200))
    seen, covariance = mj.noisy(joint_poses(angle, 0.0 * angle), np.random.default_rng(1), 0.02, 2e-5)
    for known in (True, False):
        found = identify_joint(seen, covariance, seen[0], noise_known=known)
        assert (found.type, found.status) == ("rigid", "approximate")
    still = joint_poses(0.0 * angle, 0.0 * angle)
    seen, covariance = mj.noisy(still, np.random.default_rng(2), 0.02, 2e-5)
    for known in (True, False):
        found = identify_joint(seen, covariance, seen[0], noise_known=known)
        assert (found.type, found.status) == ("rigid", "determined")


def test_axes_that_turn_one_at_a_time_are_warned_of() -> None:
    """Both orders of the two axes make the same poses, and what can be done about it is said."""
    rng = np.random.default_rng(31)
    exact = mj.two_axes(2, (90.0, 90.0), 80.0, 0.03, rng)
    sway = np.radians(80.0) * (0.5 - 0.5 * np.cos(np.linspace(0.0, 4.0 * np.pi, 120)))
    one, two = exact.truth["axis1"], exact.truth["axis2"]
    first, second = np.concatenate([sway, 0.0 * sway]), np.concatenate([0.0 * sway, sway])
    poses = dq.multiply(dq.multiply(mj.turned(first, one), exact.poses[0]), mj.turned(second, two))
    seen, _ = mj.noisy(poses, rng, 0.1, 2e-4)
    body = RigidBody(name="forearm", dual_quat_lab_body=seen, loss=np.zeros(240, dtype=np.uint8))
    analysis = analyze(Recording.from_bodies([body], rate_hz=100.0))
    assert [warning.message for warning in analysis.warnings if warning.code == "axes-order"] == [
        "the joint has two axes, but hardly turns about both at once, so that it does not tell which one is that of "
        "the proximal body: axes and angles may be the other way round; turn about each at several angles of the other"
    ]
    told = joint_summary(analysis)["joint_type"]
    assert (told["type"], told["status"]) == ("two_axes", "approximate")


@pytest.mark.parametrize("together", ["second of first", "first of second", "no"])
def test_axes_whose_angles_follow_from_each_other_are_not_told(together: str) -> None:
    """Two rings of 60 and 45 deg turned as one: another pair leaves as little, and cones of 2.7 deg held 2 of 12."""
    rng = np.random.default_rng(3)
    exact = mj.two_axes(300, (60.0, 45.0), 90.0, 0.0, rng)
    time = np.linspace(0.0, 4.0 * np.pi, 300)
    angles = np.radians([60.0, 45.0]) * np.stack([0.5 - 0.5 * np.cos(time)] * 2, axis=1)
    if together == "no":
        angles[:, 1] = np.radians(45.0) * (0.5 - 0.5 * np.cos(0.7 * time + 1.0))
    if together == "first of second":  # which goes on while the first goes out and back
        angles[:, 1] = np.radians(45.0) * np.linspace(-1.0, 1.0, 300)
        angles[:, 0] = np.radians(60.0) * (1.0 - np.linspace(-1.0, 1.0, 300) ** 2)
    first, second = exact.truth["angles"][0]
    one, two = exact.truth["axis1"], exact.truth["axis2"]
    rest = dq.multiply(mj.turned(-first, one), dq.multiply(exact.poses[0], mj.turned(-second, two)))
    poses = dq.multiply(mj.turned(angles[:, 0], one), dq.multiply(rest, mj.turned(angles[:, 1], two)))
    seen, covariance = mj.noisy(poses, rng, 0.1, 2e-4)
    found = identify_joint(seen, covariance, seen[0], noise_known=True)
    assert found.type == "two_axes"
    assert found.two_axes is not None
    assert [line.determined for line in found.two_axes.lines] == [together == "no"] * 2
    words = "; one angle follows from the other, so that other axes explain the motion as well"
    wanted = ("determined", False) if together == "no" else ("approximate", True)
    assert (found.status, found.reason.endswith(words)) == wanted


def test_one_axis_of_a_pair_whose_order_is_open_is_not_told(tmp_path: Path) -> None:
    """Skin of 6 mm at 60 and 30 deg: what was told as axis 2, within 20 deg, is that of the other body, 54 deg off."""
    source = tmp_path / "elbow.csv"
    joint = ["--joint-type", "two-axes", "--top", "60", "--pronation", "30"]
    assert main(["simulate", str(source), *joint, "--skin", "6", "--seed", "1", "--quiet"]) == 0
    analysis = analyze(source)
    assert analysis.joint_type is not None
    two = analysis.joint_type.two_axes
    assert two is not None
    truth = tuple(json.loads(source.with_suffix(".truth.json").read_text())["two_axes"]["axis2"]["distal"]["direction"])
    assert degrees_off(list(two.axis2.direction_distal), truth) > np.degrees(two.axis2.axis_cone)
    assert not two.order_determined
    assert [line.determined for line in two.lines] == [False, False]
    assert "axis-undetermined" in [warning.code for warning in analysis.warnings]


def test_orientations_alone_tell_a_direction_in_the_other_body_and_no_place() -> None:
    """It has the error of the reference pose there, which of one frame is larger than the axis' own."""
    recording = simulate_trial(joint_type="two-axes", seed=1).recording
    bodies = tuple(replace(body, located=False, marker_motion=None) for body in recording.bodies)
    two = joint_summary(analyze(replace(recording, bodies=bodies)))["two_axes"]
    assert two is not None
    for line in (two["axis1"], two["axis2"]):
        assert line["cone95_deg"] is not None
        assert line["cone95_other_deg"] is not None
        assert line["cone95_other_deg"] > 1.05 * line["cone95_deg"]
        assert (line["radius95_mm"], line["radius95_other_mm"]) == (None, None)


def test_an_axis_seen_from_the_other_body_has_the_error_of_the_reference_pose() -> None:
    """Of twelve elbows: in its own body an axis is within its interval, in the other within the wider one of that."""
    back = {"proximal": "distal", "distal": "proximal"}
    near, far, own_alone = [], [], []
    for seed in range(12):
        trial = simulate_trial(joint_type="two-axes", seed=seed)
        two = joint_summary(analyze(trial.recording))["two_axes"]
        truth = trial.truth["two_axes"]
        assert two is not None
        for axis, own in (("axis1", "proximal"), ("axis2", "distal")):
            told = two[axis]  # type: ignore[literal-required]
            for body in (own, back[own]):
                line = truth[axis][body]
                turn = degrees_off(told[f"direction_in_{body}"], tuple(line["direction"]))
                off = np.cross(np.array(told[f"point_in_{body}_mm"]) - line["point_mm"], line["direction"])
                shift = float(np.linalg.norm(off))
                if body == own:
                    near += [turn <= told["cone95_deg"], shift <= told["radius95_mm"]]
                else:
                    far += [turn <= told["cone95_other_deg"], shift <= told["radius95_other_mm"]]
                    own_alone.append(shift <= told["radius95_mm"])
    assert np.mean(near) > 0.85
    assert np.mean(far) > 0.85
    assert np.mean(own_alone) < 0.4


@pytest.mark.parametrize(
    ("joint", "stated", "words"),
    [
        ("hinge", "ball", "the joint is stated to be a ball joint, but the motion does not determine its center"),
        ("screw-hinge", "rigid", "the joint is stated to be rigid, but the bodies move by "),
        ("two-axes", "rigid", "the joint is stated to be rigid, but the bodies move by "),
    ],
)
def test_a_statement_that_the_motion_does_not_bear_out_is_warned_of(joint: str, stated: str, words: str) -> None:
    trial = simulate_trial(joint_type=joint, seed=63)  # type: ignore[arg-type]
    analysis = analyze(trial.recording, Settings(joint_type=stated))
    told = {warning.code: warning.message for warning in analysis.warnings}
    assert told["stated-joint"].startswith(words)
    assert "hardly move" not in " ".join(told.values())
    ball = joint_summary(analysis)["ball"]
    assert ball is None or (ball["radius95_mm"], ball["semi_axes95_mm"]) == (None, None)


def test_a_gain_beyond_measure_is_not_told_to_the_tenth(real_data: Path) -> None:
    """It was 207741999917.1 times."""
    analysis = analyze(read_recording(real_data / "cases" / "identity_fast_start.csv"))
    assert analysis.joint_type is not None
    assert "a richer type leaves over 1000 times less variance" in analysis.joint_type.reason


def test_intervals_that_no_markers_have_a_part_in_are_warned_of(real_data: Path) -> None:
    """Skin then passes for a slide, a wander or a second axis; stated, it is in the interval."""
    cases = real_data / "cases"
    for name, settings, warned in (
        ("two_axis_elbow.csv", Settings(proximal="none"), True),
        ("two_axis_elbow.csv", Settings(proximal="none", skin_motion=(2.0, 1.0)), False),
        ("strokes_sign.csv", Settings(), True),
        ("noise_error_column_only.csv", Settings(), False),
        ("imu_only.csv", Settings(), False),
    ):
        told = analyze(read_recording(cases / name), settings)
        assert ("skin-unseen" in {warning.code for warning in told.warnings}) == warned, name
        method = joint_summary(told)["joint_type"]["interval_method"]
        assert method is not None
        nothing = ", for bodies that are rigid on their bones, as the file tells nothing of markers"
        assert method.endswith(nothing) == (warned or settings.skin_motion is not None)


def test_error_bars_of_bodies_without_markers_are_those_of_their_unseen_markers(real_data: Path) -> None:
    """An error column alone: three markers at 30 mm make 0.6 deg, where four at 50 mm would make 0.22."""
    analysis = analyze(read_recording(real_data / "cases" / "noise_error_column_only.csv"))
    assert float(np.degrees(np.nanmedian(analysis.screw.angle_sd))) == pytest.approx(0.6, abs=0.05)
    assert analysis.joint_axis.best is not None
    assert analysis.joint_axis.best.noise_ratio == pytest.approx(1.0, abs=0.1)
    assert not {warning.code for warning in analysis.warnings} & {"noise-assumed", "beyond-noise"}


@pytest.mark.parametrize(("factor", "severity"), [(1.0, "note"), (0.1, "warning")])
def test_error_bars_of_assumed_markers_are_warned_of(real_data: Path, factor: float, severity: str) -> None:
    """A filter took what jitters; the more where a hinge leaves more than markers that are assumed explain."""
    recording = read_recording(real_data / "cases" / "noise_error_column_only.csv")
    assert recording.bodies[0].reported_error is not None
    smooth = tuple(
        replace(
            one,
            dual_quat_lab_body=gaussian_filter1d(one.dual_quat_lab_body, 6.0, axis=0),
            reported_error=None if one.reported_error is None else factor * one.reported_error,
        )
        for one in recording.bodies
    )
    smooth = tuple(replace(one, dual_quat_lab_body=dq.normalize(one.dual_quat_lab_body)) for one in smooth)
    analysis = analyze(replace(recording, bodies=smooth))
    told = {warning.code: warning for warning in analysis.warnings}
    assert told["noise-assumed"].severity == severity
    said = re.search(r"as a hinge leaves (\d+\.\d) times as much", told["noise-assumed"].message)
    assert (said is not None) == (severity == "warning")
    if said is not None:
        assert analysis.joint_axis.best is not None
        assert float(said[1]) == pytest.approx(analysis.joint_axis.best.noise_ratio, abs=0.051)


@pytest.fixture(scope="module")
def wandering() -> Analysis:
    """An elbow whose first axis tilts by 3 deg from the start to the top, and turns by more against itself."""
    return analyze(simulate_trial(joint_type="two-axes", wander_deg=3.0, seed=3).recording)


def test_an_axis_that_wanders_is_told_wherever_two_axes_are(wandering: Analysis) -> None:
    told = joint_summary(wandering)
    two = told["two_axes"]
    assert two is not None
    one, other = two["axis1"]["wander"], two["axis2"]["wander"]
    assert one is not None
    assert other is not None
    assert (one["significant"], other["significant"]) == (True, False)
    assert one["size_deg"] == pytest.approx(4.1, abs=0.5)
    assert told["wander"] is None
    deg, mm = f"{one['size_deg']:.2g}", f"{one['size_mm']:.2g}"
    kind = told["joint_type"]
    assert (kind["type"], kind["status"]) == ("two_axes", "approximate")
    assert kind["reason"] == f"the noise of the poses explains what it leaves; axis 1 wanders by {deg} deg and {mm} mm"
    summary = summary_from_analysis(wandering)
    terminal = joint_axis_text(summary["motion"], located=True)
    assert terminal.startswith("mean axis 1 (")
    assert f"deg about it, over which it wanders by {deg} deg and {mm} mm; axis 2 (" in terminal
    unseen = f"{other['unseen_deg']:.2g} deg would not be seen; "
    assert f"deg about it, over which a wander below {unseen}" in terminal
    sentences = joint_sentences(view_of_analysis(wandering, summary, told))
    here, there = f"{one['size_deg']:.2f} deg", f"{one['size_mm']:.2f} mm"
    below = f"{other['unseen_deg']:.2f} deg"
    assert next(sentence for sentence in sentences if "θ mixes" in sentence).endswith(
        f" Axis 1 wanders by {here} and {there} over its range: both axes are given as they are on the mean. A wander "
        f"below {below} of axis 2 may exceed the intervals unseen."
    )
    said = dict(facts(summary, told))
    assert " (mean of an axis that wanders); 95 % within " in said["axis 1"]
    assert "mean of" not in said["axis 2"]
    # Nearer than the axis at either end, which is 3 deg from the other, and twice that about itself.
    assert degrees_off(two["axis1"]["direction_in_proximal"], (0.986, 0.104, -0.131)) < 4.0


def test_what_is_not_known_of_a_wander_is_not_said(wandering: Analysis) -> None:
    """Where 45 deg would not be seen the page says so, the terminal nothing; of an axis that is open nobody speaks."""
    found = wandering.joint_type
    assert found is not None
    two = found.two_axes
    assert two is not None
    axis1, axis2 = replace(two.axis1, wander=None), replace(two.axis2, wander=None, determined=False)
    one = replace(wandering, joint_type=replace(found, two_axes=replace(two, axis1=axis1, axis2=axis2)))
    summary = summary_from_analysis(one)
    assert "over which" not in joint_axis_text(summary["motion"], located=True)
    told = " ".join(joint_sentences(view_of_analysis(one, summary, joint_summary(one))))
    assert told.endswith(" Whether axis 1 wanders with its angle the motion does not tell.")
    assert "A wander below" not in told
    open_too = replace(two, axis1=axis1, axis2=replace(axis2, determined=True))
    one = replace(wandering, joint_type=replace(found, two_axes=open_too))
    told = " ".join(joint_sentences(view_of_analysis(one, summary_from_analysis(one), joint_summary(one))))
    assert told.endswith(" Whether axis 1 or axis 2 wanders with its angle the motion does not tell.")


def test_cuts_are_on_the_first_angle_where_an_axis_wanders(wandering: Analysis) -> None:
    """It has two axes all the same; and a filter moves no cut, though the angles that are told are of the mean axes."""
    found = wandering.joint_type
    assert found is not None
    assert found.two_axes is not None
    assert found.two_axes.only_wander_doubted
    assert two_axes_of(found) is found.coordinates
    doubted = replace(found, two_axes=replace(found.two_axes, only_wander_doubted=False))
    assert two_axes_of(doubted) is None
    recording = simulate_trial(joint_type="two-axes", wander_deg=3.0, seed=3).recording
    for lowpass in (4.0, 8.0):
        filtered = analyze(recording, Settings(lowpass_hz=lowpass)).repetitions
        for name in ("start_time_s", "end_time_s"):
            assert getattr(filtered, name) == pytest.approx(getattr(wandering.repetitions, name), abs=0.002)
