"""The rule for outliers: Grubbs' of one sample, its rate of false alarms, and trials and subjects told apart."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from elbowscrew.geometry.arrays import Float
from elbowscrew.group.outliers import FALSE_ALARMS, outliers, outliers_of_study

RATE = 0.05


def flagged(values: Float, rate: float = RATE) -> list[int]:
    found: list[int] = outliers(values, np.zeros(values.size, dtype=np.int64), np.ones(values.size), rate).tolist()
    return found


@pytest.mark.parametrize("n", [5, 7])
def test_of_one_sample_it_is_the_test_of_grubbs(n: int) -> None:
    usual = np.array([-1.2, -0.3, 0.1, 0.4, 0.9, 1.1])[: n - 1]
    t = stats.t.isf(RATE / (2 * n), n - 2)
    critical = (n - 1) / np.sqrt(n) * np.sqrt(t**2 / (n - 2 + t**2))
    told = []
    for value in np.linspace(0.0, 12.0, 60):
        sample = np.append(usual, value)
        off = np.abs(sample - sample.mean())
        told.append(bool(off.max() / sample.std(ddof=1) > critical))
        expected = [0] * n
        if told[-1]:
            expected[int(off.argmax())] = int(np.sign((sample - sample.mean())[off.argmax()]))
        assert flagged(sample) == expected
    assert 0 < sum(told) < 60


def test_outliers_do_not_hide_each_other() -> None:
    sample = np.array([0.1, -0.4, 0.3, 0.9, -1.0, 0.2, -0.6, 0.5, -0.1, 0.7, 30.0, 31.0])
    assert stats.zscore(sample, ddof=1).max() < 2.4  # alone, neither stands out
    assert flagged(sample) == [0] * 10 + [1, 1]
    assert flagged(-sample) == [0] * 10 + [-1, -1]


def test_round_off_is_no_outlier_and_too_few_have_none() -> None:
    assert flagged(np.array([7.0] * 9 + [7.0 + 1e-14])) == [0] * 10
    assert flagged(np.full(8, 3.0)) == [0] * 8
    assert flagged(np.array([5.0] * 9 + [6.0])) == [0] * 9 + [1]
    assert flagged(np.array([1.0, 2.0, 3.0, 1e9])) == [0] * 4
    assert flagged(np.array([1.0, 2.0, 3.0, 4.0, 1e9])) == [0, 0, 0, 0, 1]


@given(st.lists(st.integers(-50, 50), min_size=5, max_size=20), st.floats(0.1, 10), st.integers(-100, 100))
def test_outliers_do_not_depend_on_unit_and_origin(values: list[int], scale: float, shift: int) -> None:
    x = np.array(values, dtype=np.float64)
    assert flagged(scale * (x + shift)) == flagged(x)


def study(rng: np.random.Generator, kind: str) -> tuple[dict[str, Float], list[list[int]], list[str]]:
    """Four numbers of two clean groups: trials of nobody, or of six subjects with one to six trials."""
    if kind.isdigit():
        n = int(kind)
        groups, subjects = [list(range(n)), list(range(n, 2 * n))], [""] * (2 * n)
    else:
        sizes = rng.integers(1, 7, size=12)
        subjects = [f"s{k % 6}" for k, size in enumerate(sizes) for _ in range(size)]
        bounds = np.cumsum(sizes)
        groups = [list(range(bounds[5])), list(range(bounds[5], bounds[11]))]
    share = 0.0 if kind.isdigit() else float(rng.choice([0.0, 0.5, 0.9]))
    numbers = {}
    for name in "abcd":
        own = {(k, subject): rng.standard_normal() for k in range(2) for subject in set(subjects)}
        common = np.array([own[k, subjects[row]] for k, rows in enumerate(groups) for row in rows])
        noise = rng.standard_normal(len(subjects))
        numbers[name] = np.sqrt(share) * common + np.sqrt(1.0 - share) * noise
    return numbers, groups, subjects


@pytest.mark.parametrize("kind", ["5", "12", "subjects"])
def test_a_clean_study_has_an_outlier_as_rarely_as_stated(kind: str) -> None:
    rng, times = np.random.default_rng(11), 300
    alarms = 0
    for _ in range(times):
        found = outliers_of_study(*study(rng, kind))
        alarms += any(one.trial.any() or one.subject.any() for one in found.values())
    assert alarms <= stats.binom.ppf(0.999, times, FALSE_ALARMS)


def test_a_trial_is_compared_with_its_subjects_others_and_a_subject_with_subjects() -> None:
    rng = np.random.default_rng(2)
    subjects = [f"s{k // 4}" for k in range(32)]
    own = np.repeat([10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0], 4)
    values = own + 0.1 * rng.standard_normal(32)
    values[5] += 3.0  # far for its subject, in the midst of all
    found = outliers_of_study({"x": values}, [list(range(32))], subjects)["x"]
    assert np.flatnonzero(found.trial).tolist() == [5]
    assert not found.subject.any()
    values[28:] += 400.0
    found = outliers_of_study({"x": values}, [list(range(32))], subjects)["x"]
    assert np.flatnonzero(found.trial).tolist() == [5]
    assert found.subject.tolist() == [0] * 28 + [1] * 4


def test_a_mean_of_one_trial_is_less_sure_than_a_mean_of_many() -> None:
    """Subjects who are all alike: the one with a single trial is off by one trial's noise, and no outlier."""
    rng, alarms = np.random.default_rng(4), 0
    subjects = ["one", *(f"s{k // 20}" for k in range(180))]
    for _ in range(200):
        found = outliers_of_study({"x": rng.standard_normal(181)}, [list(range(181))], subjects)["x"]
        alarms += bool(found.subject[0])
    assert alarms <= stats.binom.ppf(0.999, 200, FALSE_ALARMS)
