"""Which law a phase of the recording follows: named, fitted, or its own."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowscrew.errors import SettingError
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import sclerp
from elbowscrew.geometry._small_angle import length
from elbowscrew.geometry.arrays import Float
from elbowscrew.model import BodyPoints, ModelPhases, PhaseLaw
from elbowscrew.motion.difference import rms_displacement, told_error
from elbowscrew.motion.interpolation.laws import LAWS, asymmetric, named_law

LawFunction = Callable[[Float], Float]

_PEAKS: Final = (0.1, 0.9)
_COARSE: Final = 17
_PEAK_TOLERANCE: Final = 1e-4
_LEAST_TURN: Final = 1e-3
_STEP: Final = 1e-4
_BATCH_FRAMES: Final = 4096
_FEWEST_FOR_SD: Final = 6
# Second differences of white noise have the variance 1 + 4 + 1.
_SECOND_DIFFERENCE: Final = 6.0
_GOLDEN: Final = 0.5 * (np.sqrt(5.0) - 1.0)


class FittedLaw(NamedTuple):
    """A phase's law and the function of tau that it is."""

    law: PhaseLaw
    function: LawFunction


def laws_of(
    name: str,
    peak: float | None,
    pose: Float,
    measured: NDArray[np.bool_],
    elapsed: Float,
    frame: NDArray[np.int64],
    phases: ModelPhases,
    points: BodyPoints,
) -> tuple[FittedLaw, ...]:
    """Law of every phase, by its name, by the best fit ("best"), or the recording's own ("empirical").

    How near a law is to the recording is told by the RMS displacement between the measured poses and the ScLERP from
    the phase's first pose to its last under that law. The best law is the one of `LAWS`, with the time of its highest
    velocity, for which this is least.

    Parameters
    ----------
    name : str
    peak : float or None
        Time of the highest velocity, as a share of the phase.
    pose : ndarray, shape (N, 8)
        Sign-continuous; NaN where there is none.
    measured : ndarray of bool, shape (N,)
        The poses that count in the fit.
    elapsed : ndarray, shape (N,)
        Seconds.
    frame : ndarray of int, shape (N,)
        For messages.
    phases : ModelPhases
    points : BodyPoints

    Raises
    ------
    SettingError
        If the law is the recording's own, and a phase does not turn the joint.
    """
    made = _phases_of(pose, measured, elapsed, phases, points)
    if name not in ("empirical", "best"):
        return tuple(_named_laws(name, peak, made))
    found = []
    for p, (phase, (first, last)) in enumerate(zip(made, phases.law_rows.tolist(), strict=True)):
        if name == "empirical":
            function = phase.own_law(f"frames {frame[first]} to {frame[last]}")
            found.append(FittedLaw(PhaseLaw(name, None, phase.rms(function)), function))
        else:
            best = phase.best_law()
            span = float(elapsed[last] - elapsed[first])
            ends_sd = None if phases.law_sd_s is None else phases.law_sd_s[p] / span
            found.append(best._replace(law=best.law._replace(peak_sd=phase.peak_sd(best.law, ends_sd))))
    return tuple(found)


def _phases_of(
    pose: Float, measured: NDArray[np.bool_], elapsed: Float, phases: ModelPhases, points: BodyPoints
) -> Iterator[_Phase]:
    for p, (first, last) in enumerate(phases.law_rows.tolist()):
        ends = pose[phases.bound_rows[p : p + 2]]
        rows = np.arange(first, last + 1)
        rows = rows[measured[rows]]
        yield _Phase(ends, pose[rows], (elapsed[rows] - elapsed[first]) / (elapsed[last] - elapsed[first]), points)


def _named_laws(name: str, peak: float | None, phases: Iterator[_Phase]) -> Iterator[FittedLaw]:
    """One law for all phases, which are looked at many at a time: most of what a short one costs are the calls."""
    law = named_law(name, peak).position
    for some in _batches(phases):
        modeled = np.concatenate([phase.modeled(law(phase.tau)) for phase in some])
        error = _error(np.concatenate([phase.pose for phase in some]), modeled, some[0].points)
        for part in np.split(error, np.cumsum([phase.tau.size for phase in some[:-1]], dtype=np.intp)):
            yield FittedLaw(PhaseLaw(name, peak, float(_rms_of(part))), law)


def _batches(phases: Iterator[_Phase]) -> Iterator[list[_Phase]]:
    """Phases of some thousand frames together."""
    batch: list[_Phase] = []
    frames = 0
    for phase in phases:
        batch.append(phase)
        frames += phase.tau.size
        if frames >= _BATCH_FRAMES:
            yield batch
            batch, frames = [], 0
    if batch:
        yield batch


def _error(pose: Float, modeled: Float, points: BodyPoints) -> Float:
    return told_error(rms_displacement(pose, modeled, points), points)


def _rms_of(error: Float) -> Float:
    """Over the last axis; NaN of none."""
    if not error.shape[-1]:
        return np.full(error.shape[:-1], np.nan)
    return np.asarray(np.sqrt(np.mean(error**2, axis=-1)))


class _Phase(NamedTuple):
    """First and last pose, the measured poses between and their tau."""

    ends: Float
    pose: Float
    tau: Float
    points: BodyPoints

    def rms(self, law: LawFunction) -> float:
        return float(self._rms(law(self.tau)))

    def _rms(self, share: Float) -> Float:
        """Of shares of the way (..., n), shape (...)."""
        return _rms_of(_error(self.pose, self.modeled(share), self.points))

    def modeled(self, share: Float) -> Float:
        return sclerp(self.ends[0], self.ends[1], share, way="as given")

    def named(self, name: str, peak: float | None) -> FittedLaw:
        law = named_law(name, peak).position
        return FittedLaw(PhaseLaw(name, peak, self.rms(law)), law)

    def best_law(self) -> FittedLaw:
        peaks = self._peaks([name for name in LAWS if name != "linear"])
        return min((self.named(name, peaks.get(name)) for name in LAWS), key=lambda fit: fit.law.rms)

    def _peaks(self, names: list[str]) -> dict[str, float]:
        """Time of the highest velocity that suits each law best."""
        coarse = np.linspace(*_PEAKS, _COARSE)
        best = np.array([np.argmin(self._rms_by([(name, peak) for peak in coarse])) for name in names])
        low, high = coarse[np.maximum(best - 1, 0)], coarse[np.minimum(best + 1, _COARSE - 1)]
        peaks = _least(lambda peaks: self._rms_by(list(zip(names, peaks, strict=True))), low, high)
        return {name: round(peak, 4) for name, peak in zip(names, peaks.tolist(), strict=True)}

    def _rms_by(self, laws: list[tuple[str, float]]) -> Float:
        """By laws of some names and peaks (K), shape (K,)."""
        return self._rms(np.stack([asymmetric(LAWS[name], peak).position(self.tau) for name, peak in laws]))

    def peak_sd(self, law: PhaseLaw, ends_sd: Float | None) -> float:
        """Standard deviation of a fitted time of highest velocity, to first order, as a share of the phase.

        It has three parts: the residual of the phase's own law (with its autocorrelation), the noise of the two poses
        that the model runs between, and the times where the law begins and ends.

        Parameters
        ----------
        law : PhaseLaw
        ends_sd : ndarray, shape (2,), or None
            Standard deviations of those two times, as shares of the phase.
        """
        if law.peak is None or ends_sd is None or self.tau.size < _FEWEST_FOR_SD:
            return np.nan
        tau = self.tau
        fitted = named_law(law.name, law.peak).position
        by_peak, by_time = (
            (after - before) / (2.0 * _STEP)
            for before, after in (
                [named_law(law.name, law.peak + way * _STEP).position(tau) for way in (-1.0, 1.0)],
                [fitted(np.clip(tau + way * _STEP, 0.0, 1.0)) for way in (-1.0, 1.0)],
            )
        )
        weight = by_peak / float(by_peak @ by_peak)
        residual = self.own_law("")(tau) - fitted(tau)
        noise = float(np.sqrt(np.mean(np.diff(residual, 2) ** 2) / _SECOND_DIFFERENCE))
        parts = (
            np.sqrt(_autocorrelated(weight * residual)),
            noise * float(weight @ (1.0 - fitted(tau))),
            noise * float(weight @ fitted(tau)),
            ends_sd[0] * float(weight @ (by_time * (1.0 - tau))),
            ends_sd[1] * float(weight @ (by_time * tau)),
        )
        return float(np.sqrt(np.sum(np.square(parts))))

    def own_law(self, place: str) -> LawFunction:
        """Share of the phase's turn that the joint has made, about the axis of the whole turn."""
        whole = dq.log(dq.multiply(dq.conjugate(self.ends[0]), self.ends[1]))[:3]
        turn = float(length(whole))
        if turn < 0.5 * _LEAST_TURN or not self.tau.size:
            msg = f"--law empirical: the joint does not turn between {place}, so that it has no law there"
            raise SettingError(msg)
        step = dq.multiply(dq.conjugate(self.ends[0]), self.pose)
        half = np.arctan2(step[:, 1:4] @ (whole / turn), step[:, 0])
        half = np.unwrap(np.concatenate([[0.0], half]))[1:]
        inner = (self.tau > 0.0) & (self.tau < 1.0)
        tau = np.concatenate([[0.0], self.tau[inner], [1.0]])
        share = np.concatenate([[0.0], half[inner] / turn, [1.0]])
        return lambda x: np.interp(x, tau, share)


def _autocorrelated(parts: Float) -> float:
    """Variance of a sum of parts (N,) that go on for some time: their covariances up to the first that is negative."""
    total = own = float(parts @ parts)
    for lag in range(1, parts.size):
        common = float(parts[lag:] @ parts[:-lag])
        if common <= 0.0:
            break
        total += 2.0 * common
    return max(total, own)


def _least(function: Callable[[Float], Float], low: Float, high: Float) -> Float:
    """Where functions, each with one minimum between its two points (K,), are least: golden sections, all at once."""
    inner = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
    values = function(inner[0]), function(inner[1])
    while (wide := high - low > _PEAK_TOLERANCE).any():
        first = values[0] < values[1]
        high, low = np.where(wide & first, inner[1], high), np.where(wide & ~first, inner[0], low)
        new = np.where(first, high - _GOLDEN * (high - low), low + _GOLDEN * (high - low))
        value = function(new)
        inner = np.where(first, new, inner[1]), np.where(first, inner[0], new)
        values = np.where(first, value, values[1]), np.where(first, values[0], value)
    return 0.5 * (low + high)
