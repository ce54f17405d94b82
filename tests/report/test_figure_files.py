"""Files of figures: formats for print, fonts, and the figures that are asked for."""

from __future__ import annotations

import io
import logging
import re
from pathlib import Path

import numpy as np
import pytest
from drawn_trials import drawn_trial
from matplotlib.figure import Figure
from PIL import Image

from elbowscrew import Settings, analyze, save_analysis, simulate_trial
from elbowscrew.cli import main
from elbowscrew.errors import UsageError
from elbowscrew.plots.layout import settle
from elbowscrew.plots.style import new_figure, publication_style
from elbowscrew.report.figure_files import figure_files, files_of
from elbowscrew.view.figure_names import FIGURE_ENTRIES, USUAL_FIGURES, chosen_figures


def test_tiff_has_600_dpi_and_lzw() -> None:
    content = figure_files(drawn_trial("short"), ["theta"], ["tiff"], 85.0)["theta.tiff"]
    with Image.open(io.BytesIO(content)) as image:
        assert image.size[0] == pytest.approx(85.0 / 25.4 * 600, abs=1)
        assert image.info["dpi"] == (600.0, 600.0)
        assert image.info["compression"] == "tiff_lzw"
        assert image.mode == "RGB"


def test_eps_holds_all_of_a_figure_and_nothing_hangs_on_the_day(caplog: pytest.LogCaptureFixture) -> None:
    """Matplotlib warns where something is transparent, which EPS does not have; of all figures the ink test looks."""
    with caplog.at_level(logging.WARNING, logger="matplotlib"):
        content = figure_files(drawn_trial("two axes"), ["joint"], ["eps"])["joint.eps"]
    assert not caplog.records
    assert content.startswith(b"%!PS-Adobe")
    assert b"CreationDate" not in content
    assert figure_files(drawn_trial("two axes"), ["joint"], ["eps"])["joint.eps"] == content


def test_the_font_asked_for_is_that_of_the_letters() -> None:
    trial = drawn_trial("short")
    usual = figure_files(trial, ["theta"], ["pdf"])["theta.pdf"]
    assert set(re.findall(rb"/BaseFont /\w+\+(\w+)", usual)) == {b"DejaVuSans"}
    mono = figure_files(trial, ["theta"], ["pdf"], font="dejavu sans mono")["theta.pdf"]
    assert b"DejaVuSansMono" in mono
    with pytest.raises(UsageError, match=r"--font 'DejaVu Sams': no such font .* DejaVu Sans"):
        figure_files(trial, ["theta"], ["pdf"], font="DejaVu Sams")


def test_an_unknown_font_ends_the_command_before_the_work(tmp_path: Path, samples: Path) -> None:
    trial, out = str(samples / "elbow_paper.csv"), tmp_path / "out"
    assert main(["analyze", trial, "--font", "No Such Font", "-o", str(out)]) == 2
    assert main(["batch", trial, "--font", "No Such Font", "-o", str(out)]) == 2
    assert main(["compare", trial, "--font", "No Such Font", "-o", str(out)]) == 2
    assert not out.exists()


@pytest.mark.parametrize("asked", [None, ("axis", "velocity")])
def test_the_figures_asked_for_are_drawn(tmp_path: Path, asked: tuple[str, ...] | None) -> None:
    settings = Settings.model_validate({"figures": asked})
    analysis = analyze(simulate_trial(frames=60, inversion=30).recording, settings)
    folder = save_analysis(analysis, tmp_path / "r", figure_formats=("svg",), report=False)
    drawn = {path.stem for path in (folder / "figures").glob("*.svg")}
    assert drawn == (set(USUAL_FIGURES) - {"anatomy"} if asked is None else set(asked))


def test_all_figures_are_every_one() -> None:
    assert chosen_figures(("theta", "all")) == tuple(FIGURE_ENTRIES)
    assert chosen_figures(("velocity", "axis")) == ("velocity", "axis")
    assert chosen_figures(None) == USUAL_FIGURES
    with pytest.raises(UsageError, match=r"figures: .* did you mean 'theta'"):
        Settings.model_validate({"figures": ("thta",)})


def test_a_png_has_the_pixels_that_matplotlib_writes() -> None:
    def drawing() -> Figure:
        figure = new_figure(40.0, 20.0)
        figure.add_subplot().plot([0.0, 1.0, 0.5], color="#D55E00")
        return figure

    content = files_of({"line": drawing}, ["png"])["line.png"]
    with publication_style(None):
        figure = drawing()
        settle(figure)
        stream = io.BytesIO()
        figure.savefig(stream, format="png")
    with Image.open(io.BytesIO(content)) as found, Image.open(stream) as expected:
        found.verify()  # the checksums
        assert found.info["dpi"] == pytest.approx((300.0, 300.0), abs=0.02)
        expected_pixels = np.asarray(expected.convert("RGB"))
    with Image.open(io.BytesIO(content)) as found:
        assert found.mode == "RGB"
        assert np.array_equal(np.asarray(found), expected_pixels)
