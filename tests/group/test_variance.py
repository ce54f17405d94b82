"""Variance between and within subjects: the textbook's example, the analysis of variance, and simulated subjects."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from elbowscrew.geometry.arrays import Float
from elbowscrew.group.variance import variation

# Shrout and Fleiss 1979, table 2: six targets, four judges; ICC(1,1) is 0.17.
SHROUT_FLEISS = [[9, 2, 5, 8], [6, 1, 3, 2], [8, 4, 6, 8], [7, 1, 2, 6], [10, 5, 6, 9], [6, 2, 4, 7]]


def of(rows: list[list[float]] | list[list[int]]) -> list[Float]:
    return [np.array(row, dtype=np.float64) for row in rows]


def test_the_example_of_shrout_and_fleiss() -> None:
    found = variation(of(SHROUT_FLEISS))
    assert found.icc == pytest.approx(0.166, abs=5e-4)
    assert (found.icc_low, found.icc_high) == pytest.approx((-0.133, 0.723), abs=5e-4)  # McGraw and Wong 1996
    assert (found.subjects, found.trials, found.reason) == (6, 24, "")


def test_of_equal_numbers_it_is_the_analysis_of_variance() -> None:
    rng = np.random.default_rng(7)
    rows = rng.normal(rng.normal(50.0, 3.0, 8)[:, None], 2.0, (8, 5))
    found = variation(list(rows))
    F = stats.f_oneway(*rows).statistic
    within = rows.var(axis=1, ddof=1).mean()
    assert found.within_sd == pytest.approx(np.sqrt(within))
    assert found.between_sd == pytest.approx(np.sqrt((F - 1.0) * within / 5))
    assert found.icc == pytest.approx((F - 1.0) / (F + 4.0))
    low, high = F / stats.f.ppf(0.975, 7, 32), F * stats.f.ppf(0.975, 32, 7)
    assert (found.icc_low, found.icc_high) == pytest.approx(((low - 1) / (low + 4), (high - 1) / (high + 4)))
    assert (found.mean_low, found.mean_high) == pytest.approx(
        stats.t.interval(0.95, 7, rows.mean(), stats.sem(rows.mean(axis=1)))
    )


def test_a_subject_with_more_trials_weighs_no_more() -> None:
    few, many = variation(of([[1.0, 3.0], [5.0, 7.0]])), variation(of([[1.0, 3.0] * 50, [5.0, 7.0]]))
    assert few.mean == many.mean == 4.0


@pytest.mark.parametrize("share", [0.2, 0.8])
def test_of_unequal_numbers_variances_are_right_and_intervals_hold(share: float) -> None:
    rng, sizes, times = np.random.default_rng(1), [1, 2, 2, 3, 4, 6, 6, 8], 600
    between, held = [], 0
    for _ in range(times):
        subjects = [rng.normal(rng.normal(0.0, np.sqrt(share)), np.sqrt(1.0 - share), size) for size in sizes]
        found = variation(subjects)
        held += found.icc_low <= share <= found.icc_high
        # The variance itself, which is negative where the deviation is not given.
        means, n = np.array([one.mean() for one in subjects]), 8 / sum(1 / size for size in sizes)
        between.append(means.var(ddof=1) - found.within_sd**2 / n)
        assert np.isnan(found.between_sd) if between[-1] <= 0 else found.between_sd**2 == pytest.approx(between[-1])
    assert np.mean(between) == pytest.approx(share, abs=4.0 * np.std(between) / np.sqrt(times))
    assert 0.925 < held / times < 0.98


@pytest.mark.parametrize(
    ("rows", "empty", "reason"),
    [
        ([], {"mean", "mean_low", "between_sd", "within_sd", "icc"}, "no value is known"),
        ([[np.nan]], {"mean", "mean_low", "between_sd", "within_sd", "icc"}, "no value is known"),
        ([[1.0, 2.0]], {"mean_low", "between_sd", "icc", "icc_low"}, "one subject"),
        ([[1.0], [2.0], [np.nan, 4.0]], {"between_sd", "within_sd", "icc", "icc_high"}, "one trial"),
        ([[1.0, 3.0], [1.5, 2.5]], {"between_sd"}, "differ no more"),
        ([[2.0, 2.0], [2.0, 2.0]], {"between_sd", "icc", "icc_low", "icc_high"}, "differ no more"),
    ],
)
def test_what_is_not_defined_is_empty_with_the_reason(rows: list[list[float]], empty: set[str], reason: str) -> None:
    found = variation(of(rows))
    names = ("mean", "mean_low", "between_sd", "within_sd", "icc", "icc_low", "icc_high")
    unknown = {name for name in names if np.isnan(getattr(found, name))}
    assert empty <= unknown
    assert unknown - empty <= {"icc_low", "icc_high"}
    assert reason in found.reason


def test_subjects_whose_trials_are_all_alike_agree_wholly() -> None:
    found = variation(of([[0.1 + 0.2, 0.3], [0.7, 0.7]]))
    assert (found.within_sd, found.icc, found.icc_low, found.icc_high) == (0.0, 1.0, 1.0, 1.0)
    assert found.between_sd == pytest.approx(np.std([0.3, 0.7], ddof=1))
