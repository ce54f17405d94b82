"""Trials and subjects that stand out, by an exact rule with a stated rate of false alarms."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtr

from elbowscrew.geometry.arrays import Float
from elbowscrew.group.variance import variation

FALSE_ALARMS: Final = 0.05
"""Probability that a whole study without outliers has one flagged."""
LEAST: Final = 5
"""Trials of one subject, or subjects, of which one can be told from the others."""
_LEAST_FREEDOM: Final = LEAST - 2
_MOST: Final = 3
_VALUES_FOR_EACH: Final = 4
_ROUND_OFF: Final = 1e-9

Sides = NDArray[np.int64]
"""1 for a value that is too high, -1 for one that is too low, else 0."""


class Outliers(NamedTuple):
    """What stands out in one number, shape (N,) each: trials among those of their subject, subjects among subjects.

    `tests` is how many tests could be done: of none, nothing is known of outliers.
    """

    trial: Sides
    subject: Sides
    tests: int


class _Test(NamedTuple):
    """One test: values of rows of a study, by the groups whose means they are compared with."""

    number: str
    rows: list[list[int]]
    values: Float
    groups: NDArray[np.int64]
    weights: Float
    of_subjects: bool


def outliers_of_study(
    numbers: Mapping[str, Float], groups: Sequence[Sequence[int]], subjects: Sequence[str]
) -> dict[str, Outliers]:
    """Flag trials and subjects in all numbers of a study, at most in one clean study of twenty.

    The rate is shared evenly by all tests that can be done: in each number and group one of trials against the others
    of their subject, with the variance that all subjects share, and one of subjects' means against each other.

    Parameters
    ----------
    numbers : mapping of str to ndarray, shape (N,)
        Numbers of the trials, about normal; NaN where not known.
    groups : sequence of sequence of int
        Rows of the trials that are alike but for their subjects.
    subjects : sequence of str
        Of each trial; those whose subject is not known ("") are compared with each other.
    """
    tests = [
        test
        for name, values in numbers.items()
        for rows in groups
        for test in _tests(name, values, [row for row in rows if np.isfinite(values[row])], subjects)
        if _freedom(test.groups) >= _LEAST_FREEDOM
    ]
    found = {
        name: Outliers(
            np.zeros(len(subjects), dtype=np.int64),
            np.zeros(len(subjects), dtype=np.int64),
            sum(test.number == name for test in tests),
        )
        for name in numbers
    }
    for test in tests:
        of = found[test.number]
        sides = outliers(test.values, test.groups, test.weights, FALSE_ALARMS / len(tests))
        for rows, side in zip(test.rows, sides.tolist(), strict=True):
            (of.subject if test.of_subjects else of.trial)[rows] = side
    return found


def _tests(name: str, values: Float, rows: list[int], subjects: Sequence[str]) -> list[_Test]:
    """Tests of the known values of one group."""
    of: dict[str, list[int]] = {}
    for row in rows:
        of.setdefault(subjects[row], []).append(row)
    alone = of.pop("", [])
    known = list(of.values())
    within = np.repeat(np.arange(len(known)), [len(one) for one in known])
    tests = [
        _Test(name, [[row] for row in trials], values[trials], groups, np.ones(len(trials)), False)
        for trials, groups in (
            ([row for one in known for row in one], within),
            (alone, np.zeros(len(alone), dtype=np.int64)),
        )
        if trials
    ]
    if known:
        means = np.array([values[one].mean() for one in known])
        tests.append(_Test(name, known, means, np.zeros(len(known), dtype=np.int64), _weights(values, known), True))
    return tests


def _weights(values: Float, known: Sequence[list[int]]) -> Float:
    """Inverse variances of the means of subjects: of few trials a mean is less sure."""
    found = variation([values[one] for one in known])
    sizes = np.array([len(one) for one in known])
    spread = np.nan_to_num(found.between_sd) ** 2 + np.nan_to_num(found.within_sd) ** 2 / sizes
    return 1.0 / spread if (spread > 0.0).all() else np.ones(len(known))


def outliers(values: Float, groups: NDArray[np.int64], weights: Float, false_alarms: float) -> Sides:
    """Tell the values that lie too far from the mean of their own group for the variance that all groups share.

    Generalized extreme studentized deviate: each value against the mean and the variance of all others, by Student's
    distribution times the number of values (exact for one outlier); up to three outliers are looked for, which could
    hide each other, each with its part of the rate.

    Parameters
    ----------
    values : ndarray, shape (N,)
    groups : ndarray, shape (N,)
        Number of each value's group.
    weights : ndarray, shape (N,)
        Inverse variances, up to a factor.
    false_alarms : float
        Probability that normal values without an outlier have one.

    Returns
    -------
    ndarray, shape (N,)

    References
    ----------
    Grubbs 1950, Ann Math Stat 21:27-58; Rosner 1983, Technometrics 25:165-172.
    """
    found = np.zeros(values.size, dtype=np.int64)
    left = np.arange(values.size)
    most = min(max(values.size // _VALUES_FOR_EACH, 1), _MOST)
    round_off = _ROUND_OFF * float(np.abs(values).max(initial=0.0))
    taken: list[tuple[int, int]] = []
    told = 0
    while len(taken) < most and (freedom := _freedom(groups[left])) >= _LEAST_FREEDOM:
        x, w = values[left], weights[left]
        _, of = np.unique(groups[left], return_inverse=True)
        whole = np.bincount(of, w)
        off = x - (np.bincount(of, w * x) / whole)[of]
        judged = np.bincount(of)[of] > 1
        # Of the sum of squares, what goes with the value when it is left out.
        part = np.divide(w * off**2, 1.0 - w / whole[of], out=np.zeros_like(x), where=judged)
        worst = int(part.argmax())
        if not abs(off[worst]) > round_off:
            break
        others = max(float(np.sum(w * off**2) - part[worst]), float(w.max()) * round_off**2)
        t = np.sqrt(part[worst] * freedom / others)
        taken.append((int(left[worst]), 1 if off[worst] > 0.0 else -1))
        if 2.0 * judged.sum() * float(stdtr(freedom, -t)) <= false_alarms / most:
            told = len(taken)
        left = np.delete(left, worst)
    for row, side in taken[:told]:
        found[row] = side
    return found


def _freedom(groups: NDArray[np.int64]) -> int:
    """Degrees of freedom of the variance about the groups' means when one value is left out."""
    return int(groups.size - np.unique(groups).size - 1)
