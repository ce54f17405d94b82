"""The page of a trial says what the result says, and nothing in it is more than text."""

from __future__ import annotations

import base64
import hashlib
import json
import re
import shutil
import subprocess
import sys
from collections import Counter
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from finished_results import HOSTILE
from hypothesis import given
from hypothesis import strategies as st
from sealed import resealed

from elbowscrew import Settings, analyze, save_analysis, simulate_trial
from elbowscrew.errors import OutputError, ResultError
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.dual_quaternion import dual_quat_from_pose, transform_points
from elbowscrew.report import write_trial_page
from elbowscrew.report.charts import path_of, ticks_between
from elbowscrew.report.methods import methods_of
from elbowscrew.report.pages import json_for_script, number
from elbowscrew.report.scene import MOST_FRAMES, scene_of
from elbowscrew.report.trial_page import trial_page
from elbowscrew.results.result_files import BATCH_MARK, RESULT_FILES
from elbowscrew.results.trial_views import view_of, view_of_result
from elbowscrew.view.decimation import drawn_rows
from elbowscrew.view.scene import bodies_in_space, frames_in_space


class Seen(HTMLParser):
    """Elements, attributes and texts of a page."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.elements: Counter[str] = Counter()
        self.attributes: list[tuple[str, str, str]] = []
        self.texts: list[str] = []
        self.raw: dict[str, list[str]] = {"script": [], "style": []}
        self._inside = ""
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements[tag] += 1
        self.attributes += [(tag, name, value or "") for name, value in attrs]
        self._inside = tag

    def handle_endtag(self, tag: str) -> None:
        self._inside = ""

    def handle_data(self, data: str) -> None:
        if self._inside in self.raw:
            self.raw[self._inside].append(data)
        else:
            self.texts.append(data)

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.texts).split())


@pytest.fixture(scope="module")
def page(result: Path) -> str:
    return (result / "report.html").read_text(encoding="utf-8")


def test_the_page_asks_for_nothing_and_runs_nothing_but_its_own(page: str) -> None:
    seen = Seen(page)
    for tag, name, value in seen.attributes:
        assert not name.startswith("on"), (tag, name)
        assert name != "style", tag
        if name in ("src", "href", "xlink:href", "action", "data"):
            assert re.fullmatch(r"#[\w-]+|[\w.]+\.(csv|json|txt)", value), value
    policy = next(
        value for tag, name, value in seen.attributes if name == "content" and value.startswith("default-src")
    )
    assert policy.startswith("default-src 'none';")
    assert "unsafe" not in policy
    assert "http" not in policy
    for kind, text in (("style", seen.raw["style"][0]), ("script", seen.raw["script"][1])):
        digest = base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
        assert f"{kind}-src 'sha256-{digest}'" in policy


def test_hostile_names_are_text_and_nothing_else(hostile: Path, page: str) -> None:
    text = (hostile / "report.html").read_text(encoding="utf-8")
    assert "<script>alert" not in text
    assert "onerror=alert(1)>" not in text
    assert "\u2028" not in Seen(text).raw["script"][0]
    seen, usual = Seen(text), Seen(page)
    assert set(seen.elements) <= set(usual.elements)
    assert seen.elements["script"] == usual.elements["script"] == 2
    assert "49" not in [piece.strip() for piece in seen.texts[:12]]
    shown = " ".join(HOSTILE.split())
    assert seen.text.count(shown) >= 4


def test_json_in_a_script_ends_neither_the_script_nor_the_line() -> None:
    value = {"name": f"{HOSTILE}<!--<script>\u2029", "numbers": [1.5, None]}
    text = str(json_for_script(value))
    assert not set("<>&\u2028\u2029") & set(text)
    assert json.loads(text) == value


def test_the_page_says_what_the_summary_says(page: str, result: Path) -> None:
    summary = json.loads((result / "summary.json").read_text())
    joint = json.loads((result / "joint.json").read_text())
    text = Seen(page).text
    motion, model = summary["motion"], summary["interpolation"]
    for value in (
        f"{motion['theta_max_deg']:.1f}",
        f"frame {motion['theta_max_frame']}",
        f"{motion['axis_dispersion_deg']:.2f} deg",
        f"{model['rms_angle_error_deg']:.2f} deg RMS",
        f"{100 * (1 - summary['trial']['missing_share']):.1f} %",
        f"ICC(A,1) {joint['repeatability']['icc']:.3f}",
        ", ".join(f"{part:.4f}" for part in joint[joint["preferred"]]["direction"]).replace("-", "−"),
        summary["elbowscrew"],
    ):
        assert value in text, value
    for warning in summary["warnings"]:
        assert warning["message"] in text
    for option in summary["settings"]:
        assert option in text


def test_a_page_links_to_the_study_whose_batch_made_it(result: Path, tmp_path: Path) -> None:
    view = view_of_result(result)
    inside = tmp_path / "study" / "subject 1" / "trial"
    inside.mkdir(parents=True)
    assert "all trials of the study" not in trial_page(view, inside)
    (tmp_path / "study" / BATCH_MARK).touch()
    assert '<a href="../../index.html">all trials of the study</a>' in trial_page(view, inside)


def test_the_contents_lead_to_every_section_and_tables_have_captions(page: str) -> None:
    contents = re.search(r'<nav class="contents".*?</nav>', page, re.S)
    assert contents
    listed = re.findall(r'<a href="#([^"]+)">([^<]+)</a>', contents[0])
    assert listed == re.findall(r'<h2 id="([^"]+)"[^>]*>([^<]+)</h2>', page)
    assert len(listed) > 8
    assert len(re.findall(r"<table", page)) == len(re.findall(r"<table[^>]*>\s*<caption><span>[^<]+", page)) > 5


def test_the_same_result_gives_the_same_bytes(result: Path, tmp_path: Path) -> None:
    copy = shutil.copytree(result, tmp_path / "copy")
    before = (copy / "report.html").read_bytes()
    assert write_trial_page(copy).read_bytes() == before  # as the analysis made it, from the same files
    assert [path for path in copy.rglob("*") if path.name.startswith(".")] == []
    assert {path.name for path in copy.iterdir()} <= set(RESULT_FILES)


def test_nothing_of_the_users_is_replaced(result: Path, tmp_path: Path) -> None:
    copy = shutil.copytree(result, tmp_path / "copy")
    (copy / "report.html").write_text("my own notes")
    with pytest.raises(OutputError, match=r"report\.html"):
        write_trial_page(copy)
    assert (copy / "report.html").read_text() == "my own notes"


def test_a_result_that_lacks_a_number_is_told(result: Path, tmp_path: Path) -> None:
    copy = shutil.copytree(result, tmp_path / "copy")
    summary = json.loads((copy / "summary.json").read_text())
    del summary["interpolation"]["rmse_theta_deg"]
    (copy / "summary.json").write_text(json.dumps(summary))
    with pytest.raises(ResultError, match="rmse_theta_deg"):
        write_trial_page(resealed(copy))


def test_a_page_without_figures_needs_neither_pandas_nor_matplotlib_and_no_page_no_templates(
    samples: Path, tmp_path: Path
) -> None:
    for option, forbidden in (("--report", {"pandas", "matplotlib"}), ("--no-report", {"jinja2"})):
        folder = tmp_path / option.strip("-")
        arguments = ["analyze", str(samples / "elbow_paper.csv"), "-o", str(folder), "--figure-format", "none", option]
        script = (
            f"import sys\nfrom elbowscrew.cli import main\nassert main({arguments!r}) == 0\n"
            "print(*{name.split('.')[0] for name in sys.modules}, file=sys.stderr)"
        )
        done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
        assert not set(done.stderr.split()) & forbidden
        assert (folder / "report.html").exists() == (option == "--report")


@pytest.mark.parametrize("express_in", ["distal", "proximal", "lab"])
def test_the_view_moves_the_forearm_along_its_path(express_in: Any, tmp_path: Path) -> None:
    recording = simulate_trial(frames=120, inversion=60, gaps=1, gap_frames=15, proximal="moving", seed=3).recording
    analysis = analyze(recording, Settings(express_in=express_in))
    folder = save_analysis(analysis, tmp_path / "r", figure_formats=(), report=False)
    scene = json.loads(json.dumps(scene_of(view_of_result(folder)), allow_nan=False))
    path = 1000.0 * bodies_in_space(view_of(analysis)).path
    lost = [turn is None for turn in scene["turn"]]
    assert lost == (~np.isfinite(path).all(axis=1)).tolist()
    assert any(lost)
    for k in np.flatnonzero(~np.array(lost)):
        pose = dual_quat_from_pose(np.array(scene["turn"][k]), np.array(scene["shift"][k]))
        assert transform_points(pose, np.array(scene["distal"]["origin"])) == pytest.approx(path[k], abs=0.05)
    # The joint's line goes through where it lies at every frame: a point of it moves along it only.
    known = [k for k, axis in enumerate(scene["axis"]) if axis is not None]
    assert known
    assert all(scene["theta"][k] is not None for k in known)


def test_long_trials_are_thinned_in_the_view_and_in_the_charts(tmp_path: Path) -> None:
    recording = simulate_trial(frames=20000, inversion=9000, rate_hz=1000.0).recording
    folder = save_analysis(analyze(recording), tmp_path / "r", figure_formats=())
    scene = scene_of(view_of_result(folder))
    assert len(scene["frame"]) == MOST_FRAMES
    assert (scene["frame"][0], scene["frame"][-1]) == (0, 19999)
    assert (folder / "report.html").stat().st_size < 1_000_000


@given(st.lists(st.one_of(st.floats(-100, 100), st.just(float("nan"))), min_size=1, max_size=400), st.integers(2, 40))
def test_thinning_keeps_ends_extremes_and_gaps(values: list[float], buckets: int) -> None:
    y = np.array(values)
    rows = drawn_rows(y, parts=buckets, keep_gaps=True)
    assert rows.size <= max(3 * buckets + 2, 2 * buckets)
    assert (np.diff(rows) > 0).all()
    assert {0, y.size - 1} <= set(rows.tolist())
    if np.isfinite(y).any():
        assert np.nanmax(y[rows]) == np.nanmax(y)
        assert np.nanmin(y[rows]) == np.nanmin(y)
    assert np.isnan(y[rows]).any() == np.isnan(y).any()


@given(st.floats(-1e6, 1e6), st.floats(1e-3, 1e6), st.integers(3, 9))
def test_ticks_are_round_lie_inside_and_are_not_too_many(low: float, width: float, most: int) -> None:
    if width < 1e-9 * abs(low):
        return
    ticks, decimals = ticks_between(low, low + width, most)
    assert 2 <= len(ticks) <= most + 5
    air = 1e-8 * max(abs(low), width)
    assert all(low - air <= tick <= low + width + air for tick in ticks)
    assert all(abs(tick - round(tick, decimals)) <= air for tick in ticks)
    assert len({f"{tick:.{decimals}f}" for tick in ticks}) == len(ticks)


def test_a_curve_is_broken_where_it_is_not_known() -> None:
    nan = float("nan")
    assert path_of(np.array([0.0, 1, 2, 3]), np.array([5.0, nan, 7, 8])) == "M0.0 5.0M2.0 7.0L3.0 8.0"


def test_numbers_are_written_for_people() -> None:
    assert [number(value, 1) for value in (-0.04, -1.26, None, float("nan"), 3.0)] == ["0.0", "−1.3", "–", "–", "3.0"]


METHODS: dict[str, tuple[dict[str, Any], list[str], list[str]]] = {
    "default": (
        {},
        ["were not filtered", "frame 0", "forearm's frame at the reference", "DLB", "cycloidal", "10°",
         "poses (frames 0, "],
        ["Butterworth", "resampled", "Tukey"],
    ),
    "filtered": ({"lowpass_hz": 6.0}, ["low-pass filtered at 6 Hz", "Butterworth"], ["not filtered", "Winter"]),
    "automatic": ({"lowpass_hz": "auto"}, ["chosen by residual analysis (Winter 2009)"], ["not filtered"]),
    "others": (
        {"express_in": "proximal", "reference_window": 4, "robust": True, "method": "sclerp", "law": "harmonic",
         "resample_hz": 50.0, "radius_mm": 40.0, "axis_sd_deg": 2.0, "marker_noise_mm": 0.2},
        ["the upper arm's frame", "mean of 4 frames from frame", "Tukey's biweight", "ScLERP", "harmonic",
         "resampled to 50 Hz", "radius of gyration of 40 mm", "direction is 2° or less"],
        ["recorded at", "10°"],
    ),
    "whole": ({"phases": "whole", "law_peak": 0.4}, ["2 phases between start, inversion and end of the recording",
              "the cycloidal one, with its highest velocity at 0.4 of the phase"], ["reversals and rests", "fewest"]),
    "inversion": ({"inversion": 55}, ["with the inversion at frame 55"], ["reversals and rests"]),
    "tolerance": ({"tolerance_mm": 2.0}, ["the fewest measured poses", "within 2 mm", "screw linear interpolation",
                  "the linear one"], ["reversals and rests", "DLB", "cycloidal"]),
    "best": ({"law": "best"}, ["each phase follows the one nearest the measurement", "reversals and rests"],
             ["cycloidal"]),
    "empirical": ({"law": "empirical"}, ["the recording's own"], ["cycloidal"]),
    "joint": ({"method": "joint"}, ["interpolation of the screw-hinge's angle of 3 keyframe"], ["DLB"]),
    "stated": ({"method": "joint", "joint_type": "hinge"}, ["interpolation of the hinge's angle of"], ["DLB"]),
    "ball": ({"method": "joint", "joint_type": "ball"}, ["interpolation of the ball joint's rotation of"], ["axes of"]),
    "no noise": ({"noise": "none"}, ["screw-hinge"], ["Standard deviations"]),
}  # fmt: skip


@pytest.mark.parametrize("name", METHODS)
def test_the_methods_tell_the_settings_used(name: str, tmp_path: Path) -> None:
    changes, said, unsaid = METHODS[name]
    recording = simulate_trial(frames=150, inversion=60, proximal="moving", seed=1).recording
    folder = save_analysis(analyze(recording, Settings(**changes)), tmp_path / "r", figure_formats=(), report=False)
    text = methods_of(view_of_result(folder))
    for words in said:
        assert words in text, text
    for words in unsaid:
        assert words not in text, text


def test_a_motion_without_a_single_axis_is_said_to_have_none(ball_result: Path) -> None:
    trial = view_of_result(ball_result)
    text = Seen(trial_page(trial, ball_result)).text
    assert "the motion has no single axis" in text
    assert "The motion has no single axis" in methods_of(trial)
    assert "None of them is reported" in methods_of(trial)
    assert "95 % cone" not in methods_of(trial)
    assert "95 % confidence of the joint axis" not in text


@pytest.mark.parametrize("express_in", ["distal", "proximal", "lab"])
def test_the_view_has_both_axes_and_the_second_goes_along(express_in: Any, tmp_path: Path) -> None:
    recording = simulate_trial(joint_type="two-axes", frames=120, inversion=60, proximal="moving", seed=3).recording
    analysis = analyze(recording, Settings(express_in=express_in))
    folder = save_analysis(analysis, tmp_path / "r", figure_formats=(), report=False)
    scene = json.loads(json.dumps(scene_of(view_of_result(folder)), allow_nan=False))
    first, second = scene["joint"]["axes"]
    assert analysis.joint_type is not None
    assert analysis.joint_type.two_axes is not None
    told = analysis.joint_type.two_axes
    to_proximal, to_distal = {
        "distal": (dq.conjugate(analysis.joint.reference), np.eye(8)[0]),
        "proximal": (np.eye(8)[0], analysis.joint.reference),
        "lab": (
            analysis.joint.dual_quat_lab_proximal,
            dq.multiply(analysis.joint.dual_quat_lab_proximal, analysis.joint.reference),
        ),
    }[express_in]
    for axis, pose, direction, point in (
        (first, to_proximal, told.axis1.direction_proximal, told.axis1.point_proximal),
        (second, to_distal, told.axis2.direction_distal, told.axis2.point_distal),
    ):
        assert axis["direction"] == pytest.approx(dq.transform_lines(pose, [*direction, 0, 0, 0])[:3], abs=2e-5)
        assert axis["center"] == pytest.approx(1000.0 * transform_points(pose, point), abs=0.02)
        assert np.array(axis["across"]) @ axis["direction"] == pytest.approx([0.0, 0.0], abs=1e-4)
    assert (first["moves"], second["moves"]) == (False, True)
    assert scene["joint"]["center"] is None


def test_the_view_has_the_center_of_a_ball_and_no_axes_of_a_hinge(result: Path, tmp_path: Path) -> None:
    recording = simulate_trial(joint_type="ball", frames=120, inversion=60, seed=3).recording
    view = view_of_result(save_analysis(analyze(recording), tmp_path / "r", figure_formats=(), report=False))
    joint, ball = scene_of(view)["joint"], view.joint_summary["ball"]
    assert ball is not None
    assert joint["axes"] == []
    there = transform_points(frames_in_space(view)[0], np.array(ball["center_in_proximal_mm"]) / 1e3)
    assert joint["center"] == pytest.approx(1e3 * there, abs=0.02)
    sizes = np.linalg.norm(joint["semiAxes"], axis=1)
    assert sizes == pytest.approx(np.linalg.norm(ball["semi_axes95_mm"] or [[0.0]], axis=1), abs=1e-3)
    assert scene_of(view_of_result(result))["joint"] == {"axes": [], "center": None, "semiAxes": None}
