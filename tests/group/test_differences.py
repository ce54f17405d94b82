"""Differences between two conditions, paired by subject, against scipy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from elbowscrew.geometry.arrays import Float
from elbowscrew.group.differences import difference_curve, paired_difference

RNG = np.random.default_rng(3)


def conditions(count: int, effect: float) -> tuple[dict[str, Float], dict[str, Float]]:
    """Trials of subjects, who differ by far more than their conditions do."""
    own = {f"S{k}": 50.0 * RNG.standard_normal() for k in range(count)}
    first = {name: base + RNG.standard_normal(int(RNG.integers(1, 6))) for name, base in own.items()}
    second = {name: base + effect + RNG.standard_normal(int(RNG.integers(1, 6))) for name, base in own.items()}
    return first, second


def test_it_is_the_paired_t_interval_of_the_subjects_means() -> None:
    first, second = conditions(7, 3.0)
    found = paired_difference(first, second)
    a, b = (np.array([one[name].mean() for name in sorted(one)]) for one in (first, second))
    expected = stats.ttest_rel(b, a).confidence_interval(0.95)
    assert (found.low, found.high) == pytest.approx((expected.low, expected.high))
    assert found.mean == pytest.approx((b - a).mean())
    assert found.sd == pytest.approx(np.std(b - a, ddof=1))
    turned = paired_difference(second, first)
    assert (turned.mean, turned.low, turned.high) == pytest.approx((-found.mean, -found.high, -found.low))


def test_only_subjects_known_under_both_count_and_trials_weigh_nothing() -> None:
    first = {"a": np.array([1.0, np.nan]), "b": np.array([2.0]), "c": np.array([9.0]), "d": np.array([np.nan])}
    second = {"a": np.array([2.0, 4.0, 3.0, 3.0]), "b": np.array([6.0]), "d": np.array([1.0])}
    found = paired_difference(first, second)
    assert found.subjects == ("a", "b")
    assert found.of_subjects.tolist() == [2.0, 4.0]
    assert found.mean == 3.0


def test_of_one_subject_there_is_no_interval_and_of_none_nothing() -> None:
    one = paired_difference({"a": np.array([1.0])}, {"a": np.array([3.0])})
    assert one.mean == 2.0
    assert np.isnan([one.low, one.high, one.sd]).all()
    none = paired_difference({"a": np.array([1.0])}, {"b": np.array([3.0])})
    assert none.subjects == ()
    assert np.isnan([none.mean, none.low, none.high, none.sd]).all()


def test_the_interval_holds_the_effect_as_often_as_it_says() -> None:
    held = 0
    for _ in range(400):
        found = paired_difference(*conditions(6, 3.0))
        held += found.low < 3.0 < found.high
    assert 0.91 < held / 400 < 0.99  # four standard errors about 0.95


@pytest.mark.parametrize("count", [5, 8])
def test_curves_are_paired_too_and_have_a_band_from_six_subjects_on(count: int) -> None:
    percent = np.linspace(0.0, 1.0, 101)
    own = {f"S{k}": 20.0 * RNG.standard_normal() for k in range(count)}
    first = {name: [(100.0 + base + RNG.standard_normal()) * percent] for name, base in own.items()}
    second = {name: [(106.0 + base + RNG.standard_normal()) * percent] * 2 for name, base in own.items()}
    found = difference_curve(first, second | {"alone": [percent]})
    assert found is not None
    assert (found.subjects, found.trials) == (tuple(sorted(own)), 3 * count)
    assert found.of_subjects == pytest.approx(np.stack([second[name][0] - first[name][0] for name in sorted(own)]))
    assert found.mean == pytest.approx(found.of_subjects.mean(axis=0))
    assert (found.low is None) == (count < 6)
    if found.low is not None and found.high is not None:
        assert found.low[100] < 6.0 < found.high[100]
        assert found.high[100] - found.low[100] < 8.0  # the subjects' 20 are no part of it
    assert difference_curve(first, {"alone": [percent]}) is None
