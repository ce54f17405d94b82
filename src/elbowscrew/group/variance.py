"""Variance between subjects and from trial to trial, and the intraclass correlation, of any numbers of trials."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.special import fdtri, stdtrit

from elbowscrew.geometry.arrays import Float

_UPPER: Final = 0.975
_ROUND_OFF: Final = 1e-12


@dataclass(frozen=True, slots=True, kw_only=True)
class Variation:
    """How a number varies in one condition; NaN where not defined, with the reason.

    Attributes
    ----------
    subjects, trials : int
        With a known value.
    mean, mean_low, mean_high : float
        Mean of the subjects' means, and its 95 % interval by Student's distribution.
    between_sd : float
        Standard deviation between subjects, without what their trials add.
    within_sd : float
        Standard deviation between the trials of a subject.
    icc, icc_low, icc_high : float
        ICC(1,1): one-way random effects, absolute agreement, of a single trial, and its 95 % interval.
    reason : str
        Why something is not defined; empty if all is.
    """

    subjects: int
    trials: int
    mean: float
    mean_low: float
    mean_high: float
    between_sd: float
    within_sd: float
    icc: float
    icc_low: float
    icc_high: float
    reason: str


def variation(values: Sequence[Float]) -> Variation:
    """Analyze the variance of a number by subjects: unweighted means, exact for equal numbers of trials.

    Parameters
    ----------
    values : sequence of ndarray, shape (n_i,)
        Values of each subject's trials; NaN where not known.

    Returns
    -------
    Variation

    References
    ----------
    Shrout and Fleiss 1979, Psychol Bull 86:420-428, ICC(1,1); Thomas and Hultquist 1978, Ann Stat 6:582-587, for
    unequal numbers of trials, with the harmonic mean of these.
    """
    known = [one[np.isfinite(one)] for one in values]
    known = [one for one in known if one.size]
    subjects, sizes = len(known), np.array([one.size for one in known])
    trials = int(sizes.sum())
    nan = float("nan")
    mean, half, between, within, icc, low, high = nan, nan, nan, nan, nan, nan, nan
    reasons = []
    if not subjects:
        reasons.append("no value is known")
    else:
        means = np.array([one.mean() for one in known])
        mean = float(means.mean())
        least = _ROUND_OFF * float(np.abs(np.concatenate(known)).max())
        inside = sum(float(np.sum((one - one.mean()) ** 2)) for one in known)
        if trials > subjects:
            within = float(np.sqrt(inside / (trials - subjects)))
            within = within if within > least else 0.0
        else:
            reasons.append("each subject has one trial")
        if subjects < 2:
            reasons.append("there is one subject")
        else:
            spread = float(means.std(ddof=1))
            spread = spread if spread > least else 0.0
            half = float(stdtrit(subjects - 1, _UPPER)) * spread / np.sqrt(subjects)
    if subjects > 1 and trials > subjects:
        size = subjects / float(np.sum(1.0 / sizes))
        variance = spread**2 - within**2 / size
        if variance > 0.0:
            between = float(np.sqrt(variance))
        else:
            reasons.append("the subjects differ no more than their trials do")
        if spread > 0.0 or within > 0.0:
            icc = _icc(size * spread**2, within**2, size)
            free = subjects - 1, trials - subjects
            low = _icc(size * spread**2 / float(fdtri(*free, _UPPER)), within**2, size)
            high = _icc(size * spread**2 * float(fdtri(*reversed(free), _UPPER)), within**2, size)
    return Variation(
        subjects=subjects,
        trials=trials,
        mean=mean,
        mean_low=mean - half,
        mean_high=mean + half,
        between_sd=between,
        within_sd=within,
        icc=icc,
        icc_low=low,
        icc_high=high,
        reason="; ".join(reasons),
    )


def _icc(between: float, within: float, size: float) -> float:
    """ICC(1,1) of the mean squares between and within subjects of so many trials each."""
    return (between - within) / (between + (size - 1.0) * within)
