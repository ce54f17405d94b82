"""Publication figures: their size on paper, their fonts, the paper's four and the overlay."""

from __future__ import annotations

import io
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from drawn_trials import drawn_trial
from finished_results import flexion_only
from matplotlib.figure import Figure
from PIL import Image

from elbowscrew import analyze, save_analysis, simulate_trial
from elbowscrew.errors import OutputError, SettingError, UsageError
from elbowscrew.group.curves import PERCENT
from elbowscrew.plots.overlay import MeanCurve, mean_curve, plot_overlay
from elbowscrew.plots.registry import FIGURES
from elbowscrew.report.figure_files import figure_files
from elbowscrew.report.names import figure_names, width_mm
from elbowscrew.report.publication import save_publication_figures
from elbowscrew.results.trial_views import view_of_result
from elbowscrew.view.figure_names import FIGURE_CHOICES, USUAL_FIGURES

POINTS_PER_MM = 72.0 / 25.4
SINGLES = tuple(name for name in FIGURE_CHOICES if name != "overlay")


@pytest.fixture(scope="module")
def wandering(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A result whose axis wanders, which has a figure that others have not."""
    recording = simulate_trial(frames=100, inversion=50, joint_type="hinge", wander_deg=12.0, seed=3).recording
    return save_analysis(analyze(recording), tmp_path_factory.mktemp("wander") / "r", figure_formats=(), report=False)


@pytest.mark.parametrize("width", [85.0, 170.0])
@pytest.mark.parametrize("name", SINGLES)
def test_figures_have_the_width_asked_for_and_carry_their_fonts(
    result: Path, wandering: Path, name: str, width: float
) -> None:
    trial = drawn_trial("two axes") if name == "anatomy" else view_of_result(wandering, [name])
    files = figure_files(trial, [name], ["pdf", "svg", "png"], width)
    pdf = files[f"{name}.pdf"]
    box = re.search(rb"/MediaBox \[ ?0 0 ([\d.]+) ([\d.]+) ?\]", pdf)
    assert box
    assert float(box[1]) == pytest.approx(width * POINTS_PER_MM, abs=0.01)
    assert b"/FontFile2" in pdf
    assert b"/Type3" not in pdf
    svg = files[f"{name}.svg"].decode()
    assert float(re.search(r'<svg [^>]*width="([\d.]+)pt"', svg)[1]) == pytest.approx(width * POINTS_PER_MM, abs=0.01)  # type: ignore[index]
    assert "<text" not in svg  # letters are outlines
    assert all(link.startswith(("#", "data:")) for link in re.findall(r'href="([^"]*)"', svg))
    with Image.open(io.BytesIO(files[f"{name}.png"])) as image:
        assert image.size[0] == pytest.approx(width / 25.4 * 300, abs=1)


def test_figures_of_the_result_folder_are_made_again_to_the_byte(tmp_path: Path) -> None:
    analysis = analyze(simulate_trial(frames=100, inversion=50, seed=3).recording)
    folder = save_analysis(analysis, tmp_path / "r", figure_formats=("png", "svg"), report=False)
    again = figure_files(view_of_result(folder), USUAL_FIGURES, ("png", "svg"))
    assert again == {path.name: path.read_bytes() for path in (folder / "figures").iterdir()}
    assert len(again) == 3 * 5


def test_figures_are_the_same_with_one_core_and_with_more(result: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    trial = view_of_result(result, SINGLES)
    monkeypatch.setenv("OMP_NUM_THREADS", "1")
    alone = figure_files(trial, SINGLES, ("png",))
    monkeypatch.delenv("OMP_NUM_THREADS")
    assert figure_files(trial, SINGLES, ("png",)) == alone
    assert set(alone) == {
        f"{name}.{kind}" for name in SINGLES if name not in ("axis_path", "anatomy") for kind in ("png", "caption.txt")
    }


def test_the_papers_figures_show_measured_and_modeled_at_one_scale(result: Path) -> None:
    trial = view_of_result(result)
    drawn = {name: FIGURES[name](trial).axes[0] for name in ("fig7", "fig8", "fig9", "fig10")}
    lines = {name: [np.asarray(line.get_ydata()) for line in ax.get_lines()] for name, ax in drawn.items()}
    assert lines["fig7"][0] == pytest.approx(np.degrees(trial.angle), nan_ok=True)
    assert lines["fig8"][0] == pytest.approx(np.degrees(trial.modeled_angle), nan_ok=True)
    for k in range(4):
        assert lines["fig9"][k] == pytest.approx(trial.euler_parameters[:, k], nan_ok=True)
        assert lines["fig10"][k] == pytest.approx(trial.modeled_euler_parameters[:, k], nan_ok=True)
    assert drawn["fig7"].get_ylim() == drawn["fig8"].get_ylim()
    assert drawn["fig9"].get_ylim() == drawn["fig10"].get_ylim()


def test_the_mean_curve_of_a_trial_is_that_of_its_cycles(result: Path) -> None:
    trial = view_of_result(result, ["cycles"])
    curve = mean_curve(trial)
    assert curve is not None
    assert trial.repetition_curve is not None
    assert curve.cycles == 2
    assert curve.angle == pytest.approx(trial.repetition_curve["theta_mean"])


def test_the_overlay_shows_mean_and_deviation_between_trials() -> None:
    bump = np.sin(np.pi * PERCENT / 100.0)
    curves = [MeanCurve(height * bump, 1) for height in (1.0, 2.0, 3.0)]
    ax = plot_overlay(Figure().add_subplot(), curves, "rad")
    mean = next(np.asarray(line.get_ydata()) for line in ax.get_lines() if line.get_label() == "mean")
    assert mean == pytest.approx(2.0 * bump)
    vertices = np.asarray(ax.collections[0].get_paths()[-1].vertices)
    middle = vertices[np.abs(vertices[:, 0] - 50.0) < 1e-9, 1]
    assert [middle.min(), middle.max()] == pytest.approx([1.0, 3.0])  # 2 ± 1


def test_figures_of_several_results_have_names_of_their_own(result: Path, tmp_path: Path) -> None:
    places = [tmp_path / "a" / "Trial 1_elbowscrew", tmp_path / "b" / "trial 1", tmp_path / "c" / ".._..%&"]
    for place in places:
        shutil.copytree(result, place)
    out = tmp_path / "out"
    made = save_publication_figures(places, out, ["fig7", "overlay"], ["svg"], width_mm=85.0)
    assert made.left_out == ()
    assert {path.name for path in made.files} == {
        f"{name}.{kind}"
        for name in ("Trial_1_fig7", "trial_1~2_fig7", "trial_fig7", "overlay")
        for kind in ("svg", "caption.txt")
    }
    assert {path.parent for path in made.files} == {out}
    before = (out / "overlay.svg").read_bytes()
    with pytest.raises(OutputError, match="--force"):
        save_publication_figures(places, out, ["fig7", "overlay"], ["svg"], width_mm=85.0)
    assert save_publication_figures(places, out, ["overlay"], ["svg"], width_mm=85.0, force=True)
    assert (out / "overlay.svg").read_bytes() == before


def test_an_overlay_needs_movements(result: Path, tmp_path: Path) -> None:
    flexion = save_analysis(analyze(flexion_only()), tmp_path / "flexion", figure_formats=(), report=False)
    with pytest.raises(SettingError, match="found 1 of 2"):
        save_publication_figures([result, flexion], tmp_path / "out", ["overlay"], ["pdf"], width_mm=170.0)
    assert not (tmp_path / "out").exists()


def test_an_overlay_leaves_out_what_has_no_cycle_and_says_so(result: Path, tmp_path: Path) -> None:
    flexion = save_analysis(analyze(flexion_only()), tmp_path / "flexion", figure_formats=(), report=False)
    second = shutil.copytree(result, tmp_path / "second")
    made = save_publication_figures([result, flexion, second], tmp_path, ["overlay"], ["svg"], width_mm=85.0)
    assert made.left_out == (flexion,)
    assert made.files == (tmp_path / "overlay.svg", tmp_path / "overlay.caption.txt")


def test_names_and_widths() -> None:
    assert figure_names(["theta, fig7", "theta"]) == ("theta", "fig7")
    assert (width_mm("single"), width_mm("double"), width_mm("90"), width_mm("120.5mm")) == (85.0, 170.0, 90.0, 120.5)
    assert (width_mm("one-and-half"), width_mm("springer-single"), width_mm("elsevier-double")) == (120.0, 84.0, 190.0)
    assert figure_names(["all"]) == SINGLES
    assert figure_names(["overlay,all"]) == (*SINGLES, "overlay")
    for bad in ("wide", "10", "nan", "1e9", "-85"):
        with pytest.raises(UsageError, match="--width"):
            width_mm(bad)
    for names in (["thta"], [""], ["theta;axis"]):
        with pytest.raises(UsageError, match="--figures"):
            figure_names(names)
