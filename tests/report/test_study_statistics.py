"""Every number of a study's page computed again by pandas and scipy: eight subjects, two conditions, known effect."""

from __future__ import annotations

import json
import re
import shutil
from html import unescape
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from drawn_trials import elbow_landmarks
from matplotlib.figure import Figure
from read_charts import Read, keys_in, picture_in
from scipy import stats
from sealed import resealed
from subject_studies import (
    BETWEEN_DEG,
    EFFECT_DEG,
    MIDDLE_MM,
    WITHIN_DEG,
    Made,
    made_trials,
    write_made,
)

from elbowscrew import Settings, analyze, save_analysis, simulate_trial
from elbowscrew.cli import main
from elbowscrew.plots.overlay import plot_conditions, plot_subjects
from elbowscrew.report import results_in, write_study_page
from elbowscrew.report.study import trials_of
from elbowscrew.report.study_curves import curves_of
from elbowscrew.report.study_groups import groups_of

NUMBERS = {
    "Largest angle, deg": ("top_deg", 1),
    "Dispersion of the axes, deg": ("dispersion_deg", 2),
    "Model error, RMS rotation, deg": ("error_deg", 2),
}


@pytest.fixture(scope="module")
def template(tmp_path_factory: pytest.TempPathFactory) -> Path:
    recording = simulate_trial(frames=60, inversion=30, proximal="moving", seed=1).recording
    analysis = analyze(recording, landmarks=elbow_landmarks())
    return save_analysis(analysis, tmp_path_factory.mktemp("template") / "r", figure_formats=(), report=False)


@pytest.fixture(scope="module")
def trials() -> list[Made]:
    return made_trials()


@pytest.fixture(scope="module")
def made(template: Path, trials: list[Made], tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("made") / "study"
    write_made(template, folder, trials)
    write_study_page(folder)
    return folder


@pytest.fixture(scope="module")
def page(made: Path) -> str:
    return text_of(made)


@pytest.fixture(scope="module")
def frame(trials: list[Made]) -> pd.DataFrame:
    return pd.DataFrame([{name: getattr(one, name) for name in one.__dataclass_fields__} for one in trials])


def text_of(folder: Path) -> str:
    return (folder / "index.html").read_text(encoding="utf-8")


def rows_of(page: str, section: str) -> list[list[str]]:
    part = page[page.index(f'id="{section}"') :]
    part = part[: part.index("</section>")]
    rows = re.findall(r"<tr>(.*?)</tr>", part, re.DOTALL)
    cells = [re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row, re.DOTALL) for row in rows]
    return [[unescape(re.sub("<[^>]*>", "", cell)).replace("−", "-") for cell in row] for row in cells]


def numbers_in(cell: str) -> list[float]:
    return [float(text) for text in re.findall(r"-?\d+(?:\.\d+)?", cell)]


def test_the_numbers_of_each_condition_are_those_of_pandas_and_scipy(page: str, frame: pd.DataFrame) -> None:
    shown = {(row[0], row[1]): row[2:] for row in rows_of(page, "h-numbers")[1:]}
    assert set(shown) == {(name, condition) for name in NUMBERS for condition in ("fast", "slow")}
    for (name, condition), (count, quartiles, subjects, mean, between, within, icc, reason) in shown.items():
        column, decimals = NUMBERS[name]
        table = frame[frame.condition == condition]
        by = table.groupby("subject")[column]
        k, n, sizes = by.ngroups, len(table), by.size()
        unit, fine = 0.5001 * 10.0**-decimals, 0.5001 * 10.0 ** -(decimals + 1)
        assert (int(count), int(subjects)) == (n, k) == (n, 8)
        assert numbers_in(quartiles) == pytest.approx(table[column].quantile([0.5, 0.25, 0.75]).tolist(), abs=unit)
        means = by.mean()
        low, high = stats.t.interval(0.95, k - 1, means.mean(), stats.sem(means))
        assert numbers_in(mean) == pytest.approx([means.mean(), low, high], abs=unit)
        # The analysis of variance by the harmonic mean of the numbers of trials.
        ms_within = float(((table[column] - by.transform("mean")) ** 2).sum()) / (n - k)
        n0 = stats.hmean(sizes)
        F = n0 * means.var() / ms_within
        assert float(within) == pytest.approx(np.sqrt(ms_within), abs=fine)
        expected = [F, F / stats.f.ppf(0.975, k - 1, n - k), F * stats.f.ppf(0.975, n - k, k - 1)]
        assert numbers_in(icc) == pytest.approx([(f - 1.0) / (f + n0 - 1.0) for f in expected], abs=5.001e-4)
        if F > 1.0:
            assert float(between) == pytest.approx(np.sqrt((F - 1.0) * ms_within / n0), abs=fine)
            assert reason == ""
        else:
            assert between == ""
            assert "differ no more" in reason


def test_the_effect_and_the_deviations_that_went_in_come_out(page: str) -> None:
    shown = {row[1]: row[2:] for row in rows_of(page, "h-numbers") if row[0] == "Largest angle, deg"}
    means = {condition: numbers_in(row[3])[0] for condition, row in shown.items()}
    # Paired by subject: 2 deg within, at least three trials under each condition.
    assert means["fast"] - means["slow"] == pytest.approx(EFFECT_DEG, abs=3.0 * WITHIN_DEG * np.sqrt(2 / 3 / 8))
    for row in shown.values():
        assert float(row[5]) == pytest.approx(WITHIN_DEG, rel=0.4)
        assert float(row[4]) == pytest.approx(BETWEEN_DEG, rel=0.6)


def test_differences_are_those_of_the_subjects_by_pandas_and_scipy(page: str, frame: pd.DataFrame) -> None:
    shown = {row[0]: row[1:] for row in rows_of(page, "h-differences")[1:]}
    assert set(shown) == set(NUMBERS)
    for name, (words, subjects, mean, sd) in shown.items():
        column, decimals = NUMBERS[name]
        unit, fine = 0.5001 * 10.0**-decimals, 0.5001 * 10.0 ** -(decimals + 1)
        means = frame.pivot_table(index="subject", columns="condition", values=column)
        off = means["slow"] - means["fast"]
        assert (words, int(subjects)) == ("slow − fast".replace("−", "-"), 8)
        paired = stats.ttest_rel(means["slow"], means["fast"]).confidence_interval(0.95)
        assert numbers_in(mean) == pytest.approx([off.mean(), paired.low, paired.high], abs=unit)
        assert float(sd) == pytest.approx(off.std(), abs=fine)
    _, low, high = numbers_in(shown["Largest angle, deg"][2])
    assert low < -EFFECT_DEG < high  # the effect that went in
    # Far narrower than of subjects that are not paired: 5 deg between them cancel.
    assert high - low < 2.0 * stats.t.ppf(0.975, 7) * 1.5 * WITHIN_DEG * np.sqrt(2 / 3 / 8)
    assert "none is widened for the number of comparisons" in page


def test_the_difference_of_the_curves_has_the_band_of_its_subjects(made: Path, page: str) -> None:
    of_subjects = means_of(made)
    off = (of_subjects.loc["slow"] - of_subjects.loc["fast"]).to_numpy()
    part = page[page.index('id="h-differences"') :]
    chart = Read(picture_in(part))
    unit = 1.1 * chart.pixel * 0.1
    (line,) = chart.outline("mean")
    assert line[:, 1] == pytest.approx(off.mean(axis=0), abs=unit)
    assert np.stack([one[:, 1] for one in chart.outline("thin")]) == pytest.approx(off, abs=unit)
    (zero,) = chart.outline("level")
    assert zero == pytest.approx(np.array([[0.0, 0.0], [100.0, 0.0]]), abs=0.05)
    (band,) = chart.outline("band-spread")
    rng = np.random.default_rng(2010)
    times = rng.multinomial(8, np.full(8, 1 / 8), size=2000)
    values = off[:, 50]
    samples = [np.repeat(values, count) for count in times]
    ratios = [
        abs(one.mean() - values.mean()) / (one.std(ddof=1) / np.sqrt(8)) if np.ptp(one) > 1e-9 else 0.0
        for one in samples
    ]
    half = np.quantile(ratios, 0.95) * stats.sem(values)
    at = band[np.abs(band[:, 0] - 50) < 0.1, 1]
    assert [at.min(), at.max()] == pytest.approx([values.mean() - half, values.mean() + half], abs=unit)
    assert "Mean of 8 subjects with both, 63 trials." in part
    notes = re.findall(r"<metadata>(.*?)</metadata>", part, re.DOTALL)
    assert [name for name, *_ in json.loads(unescape(notes[0]))["series"] if name.startswith("S")] == [
        f"S{k}" for k in range(1, 9)
    ]


def test_of_few_subjects_each_difference_is_told(few: Path, frame: pd.DataFrame) -> None:
    page = text_of(few)
    rows = {row[0]: row for row in rows_of(page, "h-differences")}
    means = frame.pivot_table(index="subject", columns="condition", values="top_deg").loc[["S1", "S2", "S3"]]
    off = means["slow"] - means["fast"]
    told = re.findall(r"(S\d) (-?[\d.]+)", rows["Largest angle, deg"][-1])
    assert [name for name, _ in told] == list(off.index)
    assert [float(value) for _, value in told] == pytest.approx(off.tolist(), abs=0.051)
    part = page[page.index('id="h-differences"') :]
    chart = Read(picture_in(part))
    assert not chart.outline("band-spread")
    assert len(chart.outline("thin")) == 3
    assert "Mean of 3 subjects with both, 21 trials; too few subjects for a band." in part


def test_what_cannot_be_paired_is_not_compared(template: Path, trials: list[Made], tmp_path: Path) -> None:
    apart = [one for one in trials if (one.condition == "fast") == (one.subject < "S3")][:9]
    chosen = [one for one in apart if one.condition == "fast"][:3] + [one for one in apart if one.condition == "slow"][
        :3
    ]
    assert len({one.condition for one in chosen}) == 2
    write_made(template, tmp_path / "s", chosen)
    write_study_page(tmp_path / "s")
    page = text_of(tmp_path / "s")
    part = page[page.index('id="h-differences"') :]
    assert "nothing can be paired" in part[: part.index("</section>")]
    assert "<table" not in part[: part.index("</section>")]


def test_the_long_tables_are_those_of_the_trials_with_their_keys(made: Path, trials: list[Made]) -> None:
    for name in ("cycles.csv", "repetitions.csv"):
        table = pd.read_csv(made / name, dtype=str, keep_default_na=False)
        assert list(table.columns[:3]) == ["trial", "subject", "condition"]
        parts = []
        for one in sorted(trials, key=lambda one: one.folder):
            part = pd.read_csv(made / one.folder / name, dtype=str, keep_default_na=False)
            part.insert(0, "trial", one.folder)
            part.insert(1, "subject", one.subject)
            part.insert(2, "condition", one.condition)
            parts.append(part)
        pd.testing.assert_frame_equal(table, pd.concat(parts, ignore_index=True))
        assert f'<a href="{name}">' in text_of(made)


def test_a_trial_in_other_units_stands_in_the_long_tables_in_the_studys(template: Path, tmp_path: Path) -> None:
    shutil.copytree(template, tmp_path / "a")
    recording = simulate_trial(frames=60, inversion=30, proximal="moving", seed=1).recording
    other = Settings(angle_unit="rad", length_unit="m")
    save_analysis(analyze(recording, other), tmp_path / "b", figure_formats=(), report=False)
    write_study_page(tmp_path)
    for name in ("cycles.csv", "repetitions.csv"):
        table = pd.read_csv(tmp_path / name)
        one, two = (table[table.trial == trial].drop(columns="trial").reset_index(drop=True) for trial in "ab")
        pd.testing.assert_frame_equal(one, two, rtol=1e-12)
        assert table.subject.isna().all()
    assert "theta_deg" in (tmp_path / "cycles.csv").read_text()


def means_of(made: Path) -> pd.DataFrame:
    """Means of cycles, trials and subjects, one after the other: rows condition and subject, columns percent."""
    table = pd.read_csv(made / "cycles.csv")
    keys = ["condition", "subject", "trial", "percent"]
    of_trials = table.groupby(keys).theta_deg.mean()
    of_subjects = of_trials.groupby(["condition", "subject", "percent"]).mean().reset_index()
    return of_subjects.pivot_table(index=["condition", "subject"], columns="percent", values="theta_deg")


def test_mean_curves_are_means_of_subjects_with_their_band(made: Path, page: str) -> None:
    of_subjects = means_of(made)
    charts = page[page.index('id="h-curves"') :].split("<strong>")[1:4]
    assert [chart[: chart.index("<")] for chart in charts] == [
        "Mean of each group",
        "Each subject: fast",
        "Each subject: slow",
    ]
    together = Read(picture_in(charts[0]))
    for k, condition in enumerate(("fast", "slow")):
        stack = of_subjects.loc[condition].to_numpy()
        (line,) = together.outline(f"mean group{k}")
        unit = 1.1 * together.pixel * 0.1
        assert line[:, 0] == pytest.approx(np.arange(101), abs=0.05)
        assert line[:, 1] == pytest.approx(stack.mean(axis=0), abs=unit)
        assert not together.outline(f"thin group{k}")
        (band,) = together.outline(f"band-group{k}")
        alone = Read(picture_in(charts[1 + k]))
        drawn = np.stack([one[:, 1] for one in alone.outline("thin")])
        assert drawn == pytest.approx(stack, abs=unit)
        # The bootstrap, resample by resample, at three percents.
        times = np.random.default_rng(2010).multinomial(8, np.full(8, 1 / 8), size=2000)
        for percent in (20, 50, 71):
            values = stack[:, percent]
            ratios = []
            for count in times:
                sample = np.repeat(values, count)
                spread = sample.std(ddof=1)
                ratios.append(abs(sample.mean() - values.mean()) / (spread / np.sqrt(8)) if spread > 1e-9 else 0.0)
            half = np.quantile(ratios, 0.95) * stats.sem(values)
            at = band[np.abs(band[:, 0] - percent) < 0.1, 1]
            assert [at.min(), at.max()] == pytest.approx([values.mean() - half, values.mean() + half], abs=unit)
    assert ("path", "mean group0", "fast") in keys_in(charts[0])
    assert ("rect", "band-group1", "slow: 95 %") in keys_in(charts[0])
    assert "mean of 8 subjects" in charts[1]


def test_the_mean_axis_is_that_of_the_subjects_in_the_bones_frame(page: str, frame: pd.DataFrame) -> None:
    shown = {row[0]: row[1:] for row in rows_of(page, "h-axes")[1:]}
    assert set(shown) == {"fast", "slow"}
    for condition, (kind, subjects, count, direction, up, forward, spread, point, apart) in shown.items():
        table = frame[frame.condition == condition]
        assert (kind, int(subjects), int(count)) == ("joint axis", 8, len(table))
        of = [np.stack(list(one.direction)) for _, one in table.groupby("subject")]
        each = np.stack([np.linalg.svd(one)[2][0] for one in of])
        mean = np.linalg.svd(each)[2][0]
        mean *= np.sign(mean[2])
        assert numbers_in(direction) == pytest.approx(mean.tolist(), abs=5.1e-5)
        assert float(up) == pytest.approx(np.degrees(np.arctan(mean[1] / mean[2])), abs=5.1e-3)
        assert float(forward) == pytest.approx(np.degrees(np.arctan(mean[0] / mean[2])), abs=5.1e-3)
        angles = np.degrees(np.arccos(np.abs(each @ mean)))
        assert float(spread) == pytest.approx(np.sqrt(np.sum(angles**2) / 7), abs=5.1e-3)
        places = []
        for _, one in table.groupby("subject"):
            off, along = np.stack(list(one.point_mm)) - MIDDLE_MM, np.stack(list(one.direction))
            places.append((off - (off @ mean / (along @ mean))[:, None] * along).mean(axis=0))
        middle = np.mean(places, axis=0)
        assert numbers_in(point) == pytest.approx(middle.tolist(), abs=5.1e-3)
        assert float(apart) == pytest.approx(np.sqrt(np.sum((np.array(places) - middle) ** 2) / 7), abs=5.1e-3)


def test_a_clean_study_has_no_outlier(page: str) -> None:
    assert '<span class="badge outlier">' not in page


@pytest.fixture(scope="module")
def few(template: Path, trials: list[Made], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three subjects, without landmarks."""
    folder = tmp_path_factory.mktemp("few") / "study"
    write_made(template, folder, [one for one in trials if one.subject in ("S1", "S2", "S3")], landmarks=False)
    write_study_page(folder)
    return folder


def test_of_few_subjects_each_is_drawn_and_no_band(few: Path) -> None:
    page = text_of(few)
    charts = page[page.index('id="h-curves"') :].split("<strong>")[1:4]
    together = Read(picture_in(charts[0]))
    assert not together.outline("band-group0")
    stack = means_of(few).loc["slow"].to_numpy()
    drawn = np.stack([one[:, 1] for one in together.outline("thin group1")])
    assert drawn == pytest.approx(stack, abs=0.11 * together.pixel)
    assert "slow: mean of 3 subjects" in charts[0]
    assert "too few subjects for a band" in charts[0]


def test_axes_of_clusters_are_not_averaged_and_the_reason_is_told(few: Path) -> None:
    page = text_of(few)
    part = page[page.index('id="h-axes"') :]
    part = part[: part.index("</section>")]
    assert "<table" not in part
    assert "no trial has both landmarks and an axis" in part
    assert "cannot be compared" in part


def test_without_subjects_nothing_is_said_of_them(
    few: Path, template: Path, trials: list[Made], tmp_path: Path
) -> None:
    write_made(template, tmp_path / "s", trials[:9])
    table = (tmp_path / "s" / "summary.csv").read_text().replace("subject", "session")
    (tmp_path / "s" / "summary.csv").write_text(table)
    write_study_page(tmp_path / "s")
    page = text_of(tmp_path / "s")
    assert "SD between subjects" not in page
    assert page.count("No subject is named") == 3
    assert "no subject that is named has trials under two of them" in page
    counts = {name: sum(one.condition == name for one in trials[:9]) for name in ("fast", "slow")}
    assert all(f"{name}: mean of {count} trials." in page for name, count in counts.items())
    assert "band-group" not in page[page.index("<body") :]
    rows = {row[0]: row for row in rows_of(page, "h-axes")[1:]}
    assert all(row[2] == "–" for row in rows.values())


def test_a_trial_without_a_whole_cycle_is_left_out_and_named(
    few: Path, template: Path, trials: list[Made], tmp_path: Path
) -> None:
    write_made(template, tmp_path / "s", trials[:6])
    gone = tmp_path / "s" / trials[0].folder
    lines = (gone / "cycles.csv").read_text().splitlines(keepends=True)
    cut = [line if ",50.0," not in line else line[: line.rindex(",") + 1] + "\n" for line in lines]
    (gone / "cycles.csv").write_text("".join(cut))
    resealed(gone)
    write_study_page(tmp_path / "s")
    assert f"1 trial ({trials[0].folder})" in text_of(tmp_path / "s")
    table = pd.read_csv(tmp_path / "s" / "cycles.csv")
    assert table[table.trial == trials[0].folder].theta_deg.isna().sum() == len(trials[0].cycles_deg)


def test_figures_by_condition_and_by_subject_show_the_same_means(made: Path) -> None:
    study = trials_of(results_in([made]))
    groups, _ = groups_of(study, study.trials)
    curves = curves_of(study.trials, groups).of_groups
    of_subjects = means_of(made)
    lines = {line.get_label(): line for line in plot_conditions(Figure().add_subplot(), curves).get_lines()}
    for condition in ("fast", "slow"):
        stack = of_subjects.loc[condition].to_numpy()
        assert lines[condition].get_ydata() == pytest.approx(stack.mean(axis=0))
        drawn = plot_subjects(Figure().add_subplot(), curves[condition], "rad")
        each = np.stack([np.asarray(line.get_ydata()) for line in drawn.get_lines()])
        assert np.degrees(each) == pytest.approx(np.vstack([stack, stack.mean(axis=0)]))
        (band,) = drawn.collections
        ends = np.asarray(band.get_paths()[0].vertices)
        at = np.degrees(ends[np.abs(ends[:, 0] - 50.0) < 1e-9, 1])
        assert at.min() < stack[:, 50].mean() < at.max()


@pytest.mark.parametrize("by", ["condition", "subject"])
def test_the_overlay_by_condition_or_subject_is_written_with_its_caption(made: Path, tmp_path: Path, by: str) -> None:
    asked = [
        "report",
        str(made),
        "--figures",
        "overlay",
        "--by",
        by,
        "--figure-format",
        "svg",
        "-o",
        str(tmp_path / "f"),
    ]
    assert main(asked) == 0
    assert {path.name for path in (tmp_path / "f").iterdir()} == {"overlay.svg", "overlay.caption.txt"}
    caption = (tmp_path / "f" / "overlay.caption.txt").read_text(encoding="utf-8")
    assert "fast: 8 subjects" in caption
    assert "95 % interval of the mean at each percent" in caption
    assert "No band" not in caption


def test_what_an_overlay_cannot_be_drawn_by_is_told(
    few: Path, template: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copytree(few, tmp_path / "s")
    asked = ["report", str(tmp_path / "s"), "--figures", "overlay", "-o", str(tmp_path / "f"), "--figure-format", "svg"]
    assert main([*asked, "--by", "condition"]) == 0
    caption = (tmp_path / "f" / "overlay.caption.txt").read_text(encoding="utf-8")
    assert "No band of fast, slow: fewer than 6 subjects; thin lines are subjects." in caption
    for refused in (
        ["report", str(few), "--by", "subject"],
        ["report", str(few), "--figures", "fig7", "--by", "subject"],
    ):
        assert main(refused) == 2
        assert "--by" in capsys.readouterr().err
    # Of one trial nothing is said: it is left out, with a warning; of none, that ends it.
    table = (tmp_path / "s" / "summary.csv").read_text().splitlines()
    (tmp_path / "s" / "summary.csv").write_text("\n".join([table[0], table[1].replace("fast", ""), *table[2:]]) + "\n")
    assert main([*asked, "--by", "condition", "--force"]) == 0
    assert capsys.readouterr().err.count("left out of the overlay") == 1
    (tmp_path / "s" / "summary.csv").unlink()
    assert main([*asked, "--by", "condition", "--force"]) == 4
    assert "manifest's column 'condition'" in capsys.readouterr().err
