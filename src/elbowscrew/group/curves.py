"""Mean curves: of the cycles of a trial, of the trials of a subject, of the subjects."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from elbowscrew.geometry.arrays import Bool, Float

PERCENT: Final[Float] = np.linspace(0.0, 100.0, 101)
LEAST_FOR_BAND: Final = 6
"""Subjects from which on there is a band."""
RESAMPLES: Final = 2000
SEED: Final = 2010
"""Resamples of the bootstrap over subjects, and the seed that they are drawn with."""
_LEVEL: Final = 0.95


@dataclass(frozen=True, slots=True, kw_only=True)
class GroupCurve:
    """The mean curve of one condition.

    Attributes
    ----------
    subjects : tuple of str
    trials : int
    of_subjects : ndarray, shape (K, 101)
        Mean of the trials of each subject.
    mean : ndarray, shape (101,)
        Mean of the subjects.
    low, high : ndarray, shape (101,), or None
        At each percent the 95 % interval of the mean (not of the whole curve at once); None of fewer than six subjects.
    """

    subjects: tuple[str, ...]
    trials: int
    of_subjects: Float
    mean: Float
    low: Float | None
    high: Float | None


def curve_of_cycles(angle: Float, incomplete: Bool) -> tuple[Float | None, int]:
    """Average the cycles of a trial over their own time, those that are complete and known throughout.

    A mean over some cycles here and others there would jump where the one leaves off.

    Parameters
    ----------
    angle : ndarray, shape (R, 101)
    incomplete : ndarray of bool, shape (R,)
        Cycles that the recording has a part of: their 0 and 100 % are not where the others have them.

    Returns
    -------
    mean : ndarray, shape (101,), or None
        None if there is no such cycle.
    count : int
        How many there are.
    """
    whole = angle[np.isfinite(angle).all(axis=1) & ~incomplete]
    return (whole.mean(axis=0) if len(whole) else None), len(whole)


def group_curve(curves: Mapping[str, Sequence[Float]], *, independent: bool = True) -> GroupCurve:
    """Average the curves of trials, first within each subject, then over the subjects.

    The band is a bootstrap over subjects, studentized at each percent: of so few, percentiles alone hold 88 % where
    95 % are asked for. It is the same each time.

    Parameters
    ----------
    curves : mapping of str to sequence of ndarray, shape (101,)
        Of the trials of each subject, known throughout.
    independent : bool
        Whether the subjects are known to be different ones; else there is no band.

    References
    ----------
    Efron and Tibshirani 1993, An Introduction to the Bootstrap, section 12.5.
    """
    subjects = tuple(sorted(curves))
    stack = np.stack([np.mean(curves[name], axis=0) for name in subjects])
    mean = stack.mean(axis=0)
    half = _half_width(stack, mean) if independent and len(subjects) >= LEAST_FOR_BAND else None
    return GroupCurve(
        subjects=subjects,
        trials=sum(map(len, curves.values())),
        of_subjects=stack,
        mean=mean,
        low=None if half is None else mean - half,
        high=None if half is None else mean + half,
    )


def _half_width(stack: Float, mean: Float) -> Float:
    """Half the width of the band: standard error times the quantile of the resamples' own ratios to theirs."""
    count = len(stack)
    times = np.random.default_rng(SEED).multinomial(count, np.full(count, 1.0 / count), size=RESAMPLES)
    off = stack - mean
    moved = times @ off / count
    variance = np.maximum(times @ off**2 / count - moved**2, 0.0) / (count - 1)
    ratio = np.abs(moved)
    # A resample of one subject alone, or of subjects that are alike, has no error to go by.
    ratio = np.divide(ratio, np.sqrt(variance), out=np.zeros_like(ratio), where=variance > 1e-24 * mean**2 + 1e-300)
    half: Float = np.quantile(ratio, _LEVEL, axis=0) * stack.std(axis=0, ddof=1) / np.sqrt(count)
    return half
