"""``elbowscrew report``: what it writes, says, and refuses."""

from __future__ import annotations

from pathlib import Path

import pytest

from elbowscrew import analyze, save_analysis, simulate_trial
from elbowscrew.cli import main


@pytest.fixture(scope="module")
def batch(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("batch")
    for k in range(2):
        recording = simulate_trial(frames=80, inversion=40, seed=k).recording
        save_analysis(analyze(recording), folder / f"trial{k}", figure_formats=(), report=False)
    return folder


def test_pages_of_a_batch_and_their_paths_on_standard_output(batch: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["report", str(batch)]) == 0
    told = capsys.readouterr()
    pages = [batch / "trial0" / "report.html", batch / "trial1" / "report.html", batch / "index.html"]
    pages += [batch / "repetitions.csv", batch / "cycles.csv"]
    assert told.out.splitlines() == [str(page) for page in pages]
    assert told.err == ""
    assert all(page.read_text(encoding="utf-8").startswith("<!DOCTYPE html>") for page in pages[:3])
    assert main(["report", str(batch / "trial1"), "-q"]) == 0
    assert capsys.readouterr().out == ""


def test_figures_go_where_they_are_asked_for(
    batch: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    asked = ["report", str(batch), "--figures", "fig7,overlay", "--width", "single"]
    assert main([*asked, "--figure-format", "svg", "-o", "figs"]) == 0
    assert sorted(path.name for path in Path("figs").iterdir()) == [
        "overlay.caption.txt",
        "overlay.svg",
        "trial0_fig7.caption.txt",
        "trial0_fig7.svg",
        "trial1_fig7.caption.txt",
        "trial1_fig7.svg",
    ]
    assert main([*asked, "--figure-format", "svg", "-o", "figs"]) == 6
    assert "--force" in capsys.readouterr().err
    assert main([*asked, "--figure-format", "svg", "-o", "figs", "--force"]) == 0
    assert main(asked) == 0
    assert len(list(Path("elbowscrew_figures").glob("*.pdf"))) == 3


@pytest.mark.parametrize(
    ("arguments", "code", "word"),
    [
        (["{batch}/none"], 3, "no such folder"),
        (["{batch}/trial0/figures_are_not_here"], 3, "no such folder"),
        (["{empty}"], 3, "no finished result"),
        (["{batch}", "--figures", "fig11"], 2, "fig10"),
        (["{batch}", "--figures", "fig7", "--width", "wide"], 2, "--width"),
        (["{batch}", "--figures", "fig7", "--figure-format", "none"], 2, "none"),
        (["{batch}", "--width", "single"], 2, "--figures"),
        (["{batch}", "--force"], 2, "--figures"),
        (["{batch}/trial0", "--figures", "overlay"], 4, "at least 2"),
        ([], 2, "RESULTS"),
    ],
)
def test_what_it_refuses(
    batch: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], code: int, word: str
) -> None:
    given = [argument.format(batch=batch, empty=tmp_path) for argument in arguments]
    assert main(["report", *given]) == code
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.count("\n") == 1
    assert word in told.err


def test_a_damaged_result_stops_no_other_and_is_told(batch: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (batch / "trial2").mkdir()
    for name in ("summary.json", "screw.csv", "joint.json"):
        (batch / "trial2" / name).write_text("{}")
    try:
        assert main(["report", str(batch)]) == 3
        told = capsys.readouterr()
        assert told.out.count("report.html") == 2
        assert told.err.count("trial2") == told.err.count("\n") == 1
        assert "trial2" in (batch / "index.html").read_text(encoding="utf-8")
    finally:
        for path in (batch / "trial2").iterdir():
            path.unlink()
        (batch / "trial2").rmdir()


def test_a_page_that_cannot_be_written_is_told(batch: Path, capsys: pytest.CaptureFixture[str]) -> None:
    place = batch / "trial0" / "report.html"
    place.unlink(missing_ok=True)
    place.mkdir()
    try:
        assert main(["report", str(batch / "trial0")]) == 6
        told = capsys.readouterr().err
        assert told.count("\n") == 1
        assert str(place) in told
        assert [path.name for path in place.parent.iterdir() if path.name.startswith(".")] == []
    finally:
        place.rmdir()
