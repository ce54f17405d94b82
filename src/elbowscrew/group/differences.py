"""What one condition has over another within the same subjects: in which subjects differ from each other drops out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from scipy.special import stdtrit

from elbowscrew.geometry.arrays import Float
from elbowscrew.group.curves import GroupCurve, group_curve

_UPPER: Final = 0.975


@dataclass(frozen=True, slots=True, kw_only=True)
class PairedDifference:
    """How a number differs between two conditions, second less first, paired by subject.

    Attributes
    ----------
    subjects : tuple of str
        Those with a known value under both.
    of_subjects : ndarray, shape (K,)
        Mean of a subject's trials under the second condition less that under the first.
    mean, low, high : float
        Mean of the subjects' differences, and its 95 % interval by Student's distribution; the interval is NaN of one
        subject, all are of none.
    sd : float
        Standard deviation of the subjects' differences; NaN of fewer than two.
    """

    subjects: tuple[str, ...]
    of_subjects: Float
    mean: float
    low: float
    high: float
    sd: float


def paired_difference(first: Mapping[str, Float], second: Mapping[str, Float]) -> PairedDifference:
    """Compare a number under two conditions by the subjects that have both.

    Each subject's trials are averaged first, so that one with more trials weighs no more.

    Parameters
    ----------
    first, second : mapping of str to ndarray, shape (n,)
        Values of the trials of each subject; NaN where not known.

    Returns
    -------
    PairedDifference
    """
    means = [_means(one) for one in (first, second)]
    subjects = tuple(sorted(means[0].keys() & means[1].keys()))
    found = np.array([means[1][name] - means[0][name] for name in subjects])
    count, nan = len(subjects), float("nan")
    mean = float(found.mean()) if count else nan
    sd = float(found.std(ddof=1)) if count > 1 else nan
    half = float(stdtrit(count - 1, _UPPER)) * sd / np.sqrt(count) if count > 1 else nan
    return PairedDifference(
        subjects=subjects, of_subjects=found, mean=mean, low=float(mean - half), high=float(mean + half), sd=sd
    )


def difference_curve(first: Mapping[str, Sequence[Float]], second: Mapping[str, Sequence[Float]]) -> GroupCurve | None:
    """Average the differences of curves, second less first, over the subjects that have both; None if none has.

    Parameters
    ----------
    first, second : mapping of str to sequence of ndarray, shape (101,)
        Of the trials of each subject, known throughout.

    Returns
    -------
    GroupCurve or None
        Its `trials` are those of both conditions; its band is that of `elbowscrew.group.curves.group_curve`, by
        resampling the subjects' differences.
    """
    both = sorted(first.keys() & second.keys())
    if not both:
        return None
    found = group_curve({name: [np.mean(second[name], axis=0) - np.mean(first[name], axis=0)] for name in both})
    return replace(found, trials=sum(len(first[name]) + len(second[name]) for name in both))


def _means(values: Mapping[str, Float]) -> dict[str, float]:
    """Mean of each subject's known values, of those that have one."""
    return {name: float(of[known].mean()) for name, of in values.items() if (known := np.isfinite(of)).any()}
