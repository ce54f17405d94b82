"""The page of a study: every trial and every failure, outliers by the rule it states."""

from __future__ import annotations

import json
import re
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
import pytest
from finished_results import HOSTILE, write_rows
from plain_pages import plain
from read_charts import picture_in
from sealed import resealed

from elbowscrew import analyze, save_analysis, simulate_trial
from elbowscrew.choices import JointName
from elbowscrew.cli import main
from elbowscrew.disk import file_sets
from elbowscrew.disk.file_sets import write_set
from elbowscrew.disk.temporary import replaced_of
from elbowscrew.errors import OutputError, ResultError
from elbowscrew.report import remake_pages, results_in, write_study_page
from elbowscrew.report.study import read_study
from elbowscrew.report.study_page import study_page
from elbowscrew.report.trials_table import ROWS_AS_TEXT, thumb_code, thumbnail
from elbowscrew.results.proof import ProvedFile
from elbowscrew.results.table_reading import read_columns

MOST_BYTES_A_TRIAL = 300  # ten thousand trials in 3 MB
TABLES = ("summary.csv", "failures.csv", "repetitions.csv", "cycles.csv")
WRITTEN = ("index.html", "repetitions.csv", "cycles.csv")


def text_of(folder: Path) -> str:
    return (folder / "index.html").read_text(encoding="utf-8")


def links(page: str) -> list[str]:
    return re.findall(r'<th scope="row"><a href="([^"]+)">', page)


def test_every_trial_and_every_failure_is_there(study: Path) -> None:
    page = text_of(study)
    found = {unquote(link) for link in links(page)}
    places = [folder.relative_to(study).as_posix() for folder in results_in([study])]
    assert len(places) == 18
    # The one trial without a page of its own is told without a link.
    assert found == {f"{place}/report.html" for place in places if place != "trial 3"}
    assert '<th scope="row">trial 3</th>' in page
    assert "18 trials analyzed" in page
    assert "2 failed" in page
    assert "data/broken.csv" in page
    assert "http" not in page.replace("http-equiv", "")


def test_hostile_names_and_reasons_are_escaped(study: Path) -> None:
    page = text_of(study)
    assert "<b>%41</b>" not in page
    assert 'href="trial%20%237%20%3Cb%3E%2541%3C/b%3E/report.html"' in page
    assert HOSTILE[:20] not in page
    assert page.count("<script") == 2


def test_what_the_manifest_says_is_carried(study: Path) -> None:
    found = read_study(study)
    assert found.factors == ("subject", "condition")
    told = {trial.folder: trial.factors["condition"] for trial in found.trials}
    assert told["trial 4"] == "slow"
    assert told["trial 5"] == "fast"
    assert "Distributions by condition" in text_of(study)
    assert read_study(study, ["subject"]).factors == ("subject",)


def test_the_outlier_is_flagged_within_its_condition(study: Path) -> None:
    page = text_of(study)
    (row,) = re.findall(r'<tr><th scope="row"><a href="[^"]+">trial 5</a>.*?</tr>', page)
    assert "Largest angle high" in row
    assert page[: page.index("<script")].count("Largest angle high") == 1
    assert "Of studies without an outlier at most 5 % have one flagged" in plain(page)


def test_each_column_holds_what_its_heading_says(study: Path) -> None:
    page = text_of(study)
    above = page[page.index('id="h-trials"') :]
    above = above[above.index("<thead") : above.index("</thead")]
    headings = re.findall(r'<th scope="col"[^>]*>([^<]*)</th>', above)
    (row,) = re.findall(r'<tr><th scope="row"><a href="[^"]+">trial 5</a></th>(.*?)</tr>', page)
    cells = [re.sub("<[^>]*>", "", cell) for cell in re.findall(r"<td[^>]*>(.*?)</td>", row, re.DOTALL)]
    assert len(headings) == 1 + len(cells)
    summary = json.loads((study / "trial 5" / "summary.json").read_text(encoding="utf-8"))
    motion, model = summary["motion"], summary["interpolation"]
    shown = dict(zip(reversed(headings), reversed(cells), strict=False))
    for heading, value in {
        "Largest angle, deg": motion["theta_max_deg"],
        "Dispersion of the axes, deg": motion["axis_dispersion_deg"],
        "Model error, RMS rotation, deg": model["rms_angle_error_deg"],
        "RMS displacement, mm": model["rms_displacement_mm"],
    }.items():
        assert float(shown[heading].replace("−", "-")) == pytest.approx(
            value, abs=0.051 if "Largest" in heading else 0.0051
        ), heading
    assert float(shown["Model error, RMS rotation, deg"]) != pytest.approx(model["rmse_theta_deg"], abs=0.0051)


def test_any_folder_of_results_will_do(result: Path, tmp_path: Path) -> None:
    shutil.copytree(result, tmp_path / "a" / "deep" / "one")
    shutil.copytree(result, tmp_path / "two")
    (tmp_path / "notes").mkdir()
    (tmp_path / ".hidden").mkdir()
    shutil.copytree(result, tmp_path / ".hidden" / "partial")
    assert [path.relative_to(tmp_path).as_posix() for path in results_in([tmp_path])] == ["a/deep/one", "two"]
    page = write_study_page(tmp_path).read_text(encoding="utf-8")
    assert links(page) == ["a/deep/one/report.html", "two/report.html"]
    assert "failed" not in page


def test_links_out_of_the_folder_are_not_followed(result: Path, tmp_path: Path) -> None:
    shutil.copytree(result, tmp_path / "study" / "one")
    shutil.copytree(result, tmp_path / "elsewhere")
    (tmp_path / "study" / "out").symlink_to(tmp_path / "elsewhere", target_is_directory=True)
    assert [path.name for path in results_in([tmp_path / "study"])] == ["one"]


def test_a_damaged_result_is_a_failure_of_its_own(result: Path, tmp_path: Path) -> None:
    for name in ("good", "damaged", "poor"):
        shutil.copytree(result, tmp_path / name)
    (tmp_path / "damaged" / "summary.json").write_text("{")
    summary = json.loads((tmp_path / "poor" / "summary.json").read_text())
    del summary["motion"]["axis_dispersion_deg"]
    (tmp_path / "poor" / "summary.json").write_text(json.dumps(summary))
    resealed(tmp_path / "poor")
    made = remake_pages([tmp_path])
    assert [page.relative_to(tmp_path).as_posix() for page in made.files] == ["good/report.html", *WRITTEN]
    assert len(made.errors) == 2
    page = text_of(tmp_path)
    assert links(page) == ["good/report.html"]
    assert "2 failed" in page
    assert "damaged" in page
    assert "axis_dispersion_deg" in page


def test_what_could_not_be_read_for_the_page_alone_is_an_error(
    result: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("one", "two"):
        shutil.copytree(result, tmp_path / name)

    def read(source: ProvedFile, *rest: Any) -> Any:
        if source.path.parent.name == "two":
            msg = f"{source.path}: cannot be read: Input/output error"
            raise ResultError(msg)
        return read_columns(source, *rest)

    monkeypatch.setattr("elbowscrew.report.study.read_columns", read)
    assert main(["report", str(tmp_path)]) == 3
    told = capsys.readouterr()
    assert f"{tmp_path / 'index.html'}: shows a trial as failed: {tmp_path / 'two' / 'screw.csv'}" in told.err
    assert told.out.splitlines() == [str(tmp_path / name) for name in ("one/report.html", "two/report.html", *WRITTEN)]
    assert "1 failed" in text_of(tmp_path)
    monkeypatch.undo()
    assert main(["report", str(tmp_path), "-q"]) == 0
    assert "failed" not in text_of(tmp_path)


def test_what_a_killed_run_has_begun_is_undone_before_anything_is_read(
    result: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("one", "two"):
        shutil.copytree(result, tmp_path / name)
    before = {path.name: path.read_bytes() for path in (tmp_path / "two").iterdir() if path.is_file()}

    def die(_former: Path) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(file_sets, "roll_back", lambda _staged: False)
    with pytest.raises(KeyboardInterrupt):
        write_set(tmp_path / "two", {"report.html": b"new", "SHA256SUMS": b"new"}, die)
    monkeypatch.undo()
    assert not (tmp_path / "two" / "SHA256SUMS").exists()
    write_study_page(tmp_path)
    assert links(text_of(tmp_path)) == ["one/report.html", "two/report.html"]
    assert "failed" not in text_of(tmp_path)
    assert {path.name: path.read_bytes() for path in (tmp_path / "two").iterdir() if path.is_file()} == before


def test_a_result_that_a_killed_run_has_moved_aside_is_not_passed_over(
    result: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Where two folders cannot change places in one step; only a run to that place knows its name."""
    for name in ("one", "in/two"):
        shutil.copytree(result, tmp_path / name)
    shutil.copytree(result, replaced_of(tmp_path, "one"))  # that run came to its end but for the removal
    aside = replaced_of(tmp_path / "in", "two")
    shutil.copytree(result, tmp_path / "in" / "three")
    (tmp_path / "in" / "two").rename(aside)
    assert main(["report", str(tmp_path), "-q"]) == 3
    assert f"{aside}: an earlier result that a run which was killed has moved aside" in capsys.readouterr().err
    assert "1 failed" in text_of(tmp_path)
    aside.rename(tmp_path / "in" / "two")
    assert main(["report", str(tmp_path), "-q"]) == 0
    assert "failed" not in text_of(tmp_path)


def test_a_folder_without_results_is_told(tmp_path: Path) -> None:
    with pytest.raises(ResultError, match="analyze trials"):
        write_study_page(tmp_path)
    with pytest.raises(ResultError, match="no such folder"):
        results_in([tmp_path / "none"])
    assert list(tmp_path.iterdir()) == []


def test_failures_alone_make_a_page(tmp_path: Path) -> None:
    write_rows(tmp_path / "failures.csv", [["path", "error class", "message"], ["a.csv", "RecordingError", "cut"]])
    page = write_study_page(tmp_path).read_text(encoding="utf-8")
    assert "0 trials analyzed" in page
    assert "a.csv" in page


def test_nothing_of_the_users_is_replaced(result: Path, tmp_path: Path) -> None:
    shutil.copytree(result, tmp_path / "one")
    (tmp_path / "index.html").write_text("<p>my home page")
    with pytest.raises(OutputError, match=r"index\.html"):
        write_study_page(tmp_path)
    assert text_of(tmp_path) == "<p>my home page"


def test_the_same_results_give_the_same_bytes(study: Path) -> None:
    before = text_of(study)
    assert study_page(read_study(study), TABLES) == before
    assert write_study_page(study).read_text(encoding="utf-8") == before


@pytest.mark.parametrize("named", [True, False], ids=["subjects", "no subjects"])
def test_a_trial_more_takes_a_few_hundred_bytes(study: Path, named: bool) -> None:
    found = read_study(study)
    size = []
    for count in (600, 1800):
        trials = [
            replace(
                found.trials[k % 18],
                folder=f"folder {k}/a trial with a rather long name {k}",
                page=True,
                factors={"subject": f"S{k // 20}", "condition": ("slow", "fast")[k % 2]} if named else {},
            )
            for k in range(count)
        ]
        page = study_page(replace(found, trials=tuple(trials), factors=found.factors if named else ()))
        data = json.loads(re.findall(r'id="data">(.*?)</script>', page, re.DOTALL)[0])
        assert data["folders"] == [trial.folder for trial in trials]
        assert len(links(page)) == ROWS_AS_TEXT
        assert f"only the first {ROWS_AS_TEXT} of {count} trials" in page
        size.append(len(page.encode()))
    assert (size[1] - size[0]) / 1200 < MOST_BYTES_A_TRIAL
    assert size[1] < 1_000_000


def test_of_many_trials_the_spread_is_drawn_and_not_each(study: Path) -> None:
    found = read_study(study)
    trials = [
        replace(found.trials[0], folder=f"t{k}", factors={}, values={**found.trials[0].values, "top": 100.0 + k})
        for k in range(200)
    ]
    page = study_page(replace(found, trials=tuple(trials), factors=()))
    strip = picture_in(page[page.index('aria-label="Chart: Largest angle"') :])
    assert not [one for one in strip.iter("circle") if one.get("class") == "one"]
    assert sum(one.get("class") == "many" for one in strip.iter("path")) == 1
    assert "Spread of the trials: all trials" in page
    assert "10th to 90th percentile of the trials" in page


def test_a_thumbnail_takes_some_bytes_however_long_the_trial() -> None:
    time_s = np.linspace(0.0, 100.0, 100_000)
    theta = 60.0 - 60.0 * np.cos(time_s / 10.0)
    theta[500:900] = np.nan
    code = thumb_code(time_s, theta, (0.0, 120.0))
    assert len(code) == 66
    drawn = thumbnail(code)
    heights = [float(y) for y in re.findall(r"[ML][\d.]+ ([\d.]+)", drawn)]
    assert min(heights) == pytest.approx(2.0, abs=0.1)  # the highest angle is at the top
    assert max(heights) == pytest.approx(32.0, abs=0.1)
    along = [float(x) for x in re.findall(r"[ML]([\d.]+) ", drawn)]
    assert (along[0], along[-1]) == (1.0, 98.5)  # from edge to edge, whatever the clock begins at
    assert thumb_code(time_s + 250.0, theta, (0.0, 120.0)) == code
    theta[20_000:60_000] = np.nan
    gappy = thumb_code(time_s, theta, (0.0, 120.0))
    assert gappy[:12] == code[:12]
    assert gappy[14:38] == 24 * "."
    assert thumbnail(gappy).count("M") == 2
    assert thumb_code(time_s, np.full_like(theta, np.nan), (0.0, 1.0)) == 66 * "."
    assert thumb_code(np.zeros(1), np.zeros(1), (0.0, 0.0)) == 66 * "0"


def test_a_number_that_no_trial_has_makes_no_column(study: Path) -> None:
    page = text_of(study)
    assert "Range about the second axis" not in page
    found = read_study(study)
    values = [{**trial.values, "second": 20.0 if k == 3 else np.nan} for k, trial in enumerate(found.trials)]
    trials = tuple(replace(trial, values=one) for trial, one in zip(found.trials, values, strict=True))
    assert ">Range about the second axis, deg</th>" in study_page(replace(found, trials=trials))


def test_the_columns_of_a_batchs_manifest_are_those_between_path_and_frames(result: Path, tmp_path: Path) -> None:
    for name in ("=one", "two", "left over"):
        shutil.copytree(result, tmp_path / name)
    header = ["trial", "path", "session", "condition", "frames", "expressed_in"]
    rows = [["'=one", "in/1.csv", "1", "<i>a</i>", "450", "proximal"], ["two", "in/2.csv", "2", "b", "450", "lab"]]
    write_rows(tmp_path / "summary.csv", [header, *rows])
    found = read_study(tmp_path)
    assert found.factors == ("condition", "session")
    assert [trial.factors for trial in found.trials] == [
        {"condition": "<i>a</i>", "session": "1"},
        {"condition": "b", "session": "2"},
    ]
    assert found.others == ("left over",)
    page = write_study_page(tmp_path).read_text(encoding="utf-8")
    assert links(page) == ["%3Done/report.html", "two/report.html"]
    assert "1 further result in this folder (left over)" in page
    assert "<i>a" not in page


def test_numbers_of_two_joints_have_no_common_median(tmp_path: Path) -> None:
    tops: dict[JointName, tuple[float, ...]] = {"elbow": (100.0, 110.0, 120.0), "knee": (50.0, 60.0, 70.0)}
    for joint, angles in tops.items():
        for k, top in enumerate(angles):
            trial = simulate_trial(frames=80, inversion=40, top_deg=top, seed=k, joint=joint)
            save_analysis(analyze(trial.recording), tmp_path / f"{joint}{k}", figure_formats=(), report=False)
    write_study_page(tmp_path)
    page = text_of(tmp_path)
    assert "Distributions by joint" in page
    medians = dict(re.findall(r'Largest angle, deg</th><td>(\w+)</td><td class="n">3</td><td class="n">([\d.]+)', page))
    assert set(medians) == set(tops)
    for joint, angles in tops.items():
        assert float(medians[joint]) == pytest.approx(angles[1], abs=0.5)
    assert "Distributions by joint" not in text_of_one_joint(tmp_path / "elbow0", tmp_path / "one")


def text_of_one_joint(result: Path, folder: Path) -> str:
    shutil.copytree(result, folder / result.name)
    write_study_page(folder)
    return text_of(folder)
