"""Mean curves: which cycles count, what subjects weigh, and what the bands hold."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from elbowscrew.group.curves import LEAST_FOR_BAND, PERCENT, curve_of_cycles, group_curve

BUMP = np.sin(np.pi * PERCENT / 100.0)


def test_a_trial_is_the_mean_of_its_whole_cycles() -> None:
    cycles = np.stack([1.0 * BUMP, 2.0 * BUMP, 30.0 * BUMP, 400.0 * BUMP])
    cycles[2, 40] = np.nan
    mean, count = curve_of_cycles(cycles, np.array([False, False, False, True]))
    assert count == 2
    assert mean == pytest.approx(1.5 * BUMP)
    assert curve_of_cycles(cycles[2:], np.array([False, True])) == (None, 0)


def test_a_subject_with_more_trials_weighs_no_more() -> None:
    found = group_curve({"a": [BUMP] * 9 + [3.0 * BUMP], "b": [4.0 * BUMP]})
    assert found.mean == pytest.approx(2.6 * BUMP)  # of 1.2 and 4
    assert (found.subjects, found.trials) == (("a", "b"), 11)
    assert found.of_subjects == pytest.approx(np.stack([1.2 * BUMP, 4.0 * BUMP]))


def test_from_six_subjects_on_there_is_a_band_the_same_each_time() -> None:
    curves = {f"s{k}": [(1.0 + 0.1 * k**2) * BUMP] for k in range(LEAST_FOR_BAND)}
    found, again = group_curve(curves), group_curve(dict(reversed(curves.items())))
    assert found.low is not None
    assert found.high is not None
    assert np.array_equal(found.low, np.asarray(again.low))
    inner = slice(1, -1)
    assert (found.low[inner] < found.mean[inner]).all()
    assert found.low + found.high == pytest.approx(2.0 * found.mean)
    assert found.low[[0, -1]] == pytest.approx(found.mean[[0, -1]])  # where all are alike
    del curves["s0"]
    assert group_curve(curves).low is None
    assert group_curve(curves | {"s0": [BUMP]}, independent=False).low is None


@pytest.mark.parametrize("subjects", [6, 15])
def test_the_band_holds_the_mean_as_often_as_stated(subjects: int) -> None:
    rng, times, held = np.random.default_rng(3), 250, 0
    for _ in range(times):
        heights = rng.standard_normal(subjects)
        found = group_curve({f"s{k}": [np.array([height])] for k, height in enumerate(heights)})
        assert found.low is not None
        assert found.high is not None
        held += bool(found.low[0] <= 0.0 <= found.high[0])
    assert held >= stats.binom.ppf(0.01, times, 0.95)
    assert held < times
