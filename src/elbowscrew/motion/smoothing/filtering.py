"""Low-pass filtering of poses without lag, and the cut-off that the noise asks for."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowscrew.errors import SettingError
from elbowscrew.geometry.arrays import Float, Index
from elbowscrew.geometry.dual_quaternion import conjugate, continuous_signs, multiply, normalize
from elbowscrew.model import BodyPoints
from elbowscrew.motion.difference import points_from_radius, rms_displacement
from elbowscrew.motion.tracking.inserted import recorded_poses

# Two passes of a 2nd-order Butterworth filter are at -3 dB where one is at -3/2 dB: (f/f_design)^4 = sqrt(2) - 1.
_TWO_PASSES: Final = float((np.sqrt(2.0) - 1.0) ** 0.25)

FEWEST_FRAMES: Final = 6
"""A shorter run of poses is not filtered: there the two ends, which a zero-phase filter keeps, are most of it."""

# Settled is a filter whose memory has decayed by e^-32; nearer to 0 Hz, or to half the rate, that takes forever.
_SETTLED: Final = 32.0
_MARGIN_SHARE: Final = 1e-4

# The cut-offs tried, and those of them (from this share of the rate on) whose residual is taken to be noise alone.
_LOWEST_HZ: Final = 1.0
_HIGHEST_SHARE: Final = 0.4
_NOISE_SHARE: Final = 0.2
_GRID_STEP: Final = 1.08
_STRETCH: Final = 4096
_STRETCHES: Final = 6
_FEWEST_FOR_NOISE: Final = 20

# The density of white noise is the same at all frequencies; where it falls below this share it is none.
_WHITE: Final = 0.3
_NO_NOISE_M: Final = 1e-9

# Below the uppermost frequencies noise is what has a density as flat as this over an octave; not looked for below 4 Hz.
_FLAT: Final = 0.6
_LOWEST_NOISE_HZ: Final = 4.0
_BLOCK: Final = 65_536


def lowpass_poses(
    poses: Float, elapsed: Float, rate_hz: float, cutoff_hz: float, broken_rows: Index | None = None
) -> Float:
    """Filter a series of poses by a 2nd-order Butterworth low-pass, forward and backward.

    The eight components are filtered alike inside each run of known poses and normalized by the dual norm. This is
    equivariant: the filtered series of ``L Q_i R`` is ``L F(Q)_i R`` for constant poses L and R, wherever the origins
    of the laboratory and of the body lie. A screw motion at constant speed passes unchanged, as the filter multiplies
    it by a dual number. A run is continued beyond its ends by point reflection, ``Q_-k = Q_0 Q_k^-1 Q_0``, over and
    over until the filter has settled: its first and its last pose stay as they are, noise included, and the filter
    takes full effect from a quarter of a period of the cut-off inward.

    Parameters
    ----------
    poses : ndarray, shape (N, 8)
        Unit dual quaternions of any sign; NaN where there is no pose.
    elapsed : ndarray, shape (N,)
        Seconds, increasing. A run also ends where a step is off the nominal one by more than half a frame.
    rate_hz : float
        Frames per second.
    cutoff_hz : float
        Where the two passes together are at -3 dB: the gain is ``1/sqrt(2)``.
    broken_rows : ndarray of int, optional
        Rows that the motion reaches by a leap: nothing is filtered across them.

    Returns
    -------
    ndarray, shape (N, 8)
        Sign-continuous; NaN where there was no pose. Runs of less than `FEWEST_FRAMES` are as they were.

    Raises
    ------
    SettingError
        If the cut-off is not below half the rate, or within a ten-thousandth of the rate of that or of 0.

    References
    ----------
    Winter 2009 (two passes, correction of the cut-off); Robertson & Dowling 2003 (the correction in the tangent of
    the frequency, so that it is exact at any rate).

    Examples
    --------
    >>> from elbowscrew.geometry import dual_quat_from_screw
    >>> time_s = np.arange(200) / 100.0
    >>> steady = dual_quat_from_screw(2.0 * time_s, 0.1 * time_s, [0, 0, 1], [0, 0, 0])
    >>> bool(np.allclose(lowpass_poses(steady, time_s, 100.0, 6.0), steady, rtol=0.0, atol=1e-12))
    True
    """
    lowpass = _Lowpass(rate_hz, cutoff_hz)
    poses = continuous_signs(poses)
    poses[~np.isfinite(poses).all(axis=1)] = np.nan
    for run in _runs(poses, elapsed, rate_hz, broken_rows, FEWEST_FRAMES):
        poses[run] = lowpass(_Spectrum.of(poses[run], lowpass.settling))
    return poses


def noise_gain(rate_hz: float, cutoff_hz: float) -> float:
    """Variance that the filter leaves of white noise, as a share of it, in the interior of a run.

    It is the sum of the squared impulse response of both passes: with ``w = tan(pi f/rate)`` of the design, the mean
    over all frequencies of ``1/(1 + x^4)^2``, ``x = tan(pi g/rate)/w``. At the ends of a run it is 1.

    Parameters
    ----------
    rate_hz, cutoff_hz : float
        As in `lowpass_poses`.

    Returns
    -------
    float
        From 0 to 1.

    Examples
    --------
    >>> round(noise_gain(100.0, 6.0), 4)
    0.1238
    """
    return _white_gains(rate_hz, cutoff_hz)[1]


def automatic_cutoff(
    poses: Float, elapsed: Float, rate_hz: float, radius: float, broken_rows: Index | None = None
) -> float:
    """Cut-off of one body by residual analysis: as much motion is lost as noise gets through.

    The residual is the RMS displacement of the body's points by the filter. For white noise its square is a straight
    line over the share of the noise's variance that does not show in it; this line, fitted to the upper frequencies
    and continued to 0 Hz, gives the whole noise, and the cut-off is the lowest one whose residual is no larger. (Over
    the frequency itself, as in Winter, the residual of noise is bent and the line misses the noise by 2 %: at 100 Hz
    that is little, at 450 Hz it doubles the cut-off.) Frames that were put in between by what exported the file tell
    nothing of the noise and are left out (`recorded_poses`).

    Parameters
    ----------
    poses, elapsed, rate_hz, broken_rows
        As in `lowpass_poses`.
    radius : float
        Radius of gyration of the body's points, meters.

    Returns
    -------
    float
        Hz, from 1 (a body at rest) to 0.4 of the rate (poses whose residual falls nowhere as that of noise does, or
        is below a nanometer).

    Raises
    ------
    SettingError
        If the poses are known nowhere for a second without a gap, or the rate is too low.

    References
    ----------
    Winter 2009, residual analysis.
    """
    series = continuous_signs(poses)
    recorded = recorded_poses(series)
    series, elapsed, rate_hz = series[recorded], elapsed[recorded], rate_hz / recorded.step
    if broken_rows is not None:
        broken_rows = -(-(broken_rows - recorded.start) // recorded.step)
    fewest = max(int(np.ceil(rate_hz / _LOWEST_HZ)), _FEWEST_FOR_NOISE)
    runs = _spread(_runs(series, elapsed, rate_hz, broken_rows, fewest), fewest)
    highest_hz = _HIGHEST_SHARE * rate_hz
    if not runs or _NOISE_SHARE * rate_hz <= _LOWEST_HZ:
        msg = (
            f"--lowpass auto: expected {fewest} frames without a gap, at over {_LOWEST_HZ / _NOISE_SHARE:g} frames per "
            f"second, found {_longest(_runs(series, elapsed, rate_hz, broken_rows, 1))} at {rate_hz:g}; "
            "give the cut-off in Hz"
        )
        raise SettingError(msg)
    count = int(np.ceil(np.log(highest_hz / _LOWEST_HZ) / np.log(_GRID_STEP))) + 1
    grid = np.geomspace(_LOWEST_HZ, highest_hz, count)
    points = points_from_radius(radius)
    longest = _Lowpass(rate_hz, grid[0]).settling
    spectra = [_Spectrum.of(series[run], longest) for run in runs]

    known: dict[int, float] = {}

    def look_at(several: Sequence[int]) -> None:
        """Find the mean squares of the residual at some cut-offs of the grid."""
        lowpasses = [_Lowpass(rate_hz, grid[k]) for k in several]
        errors = [
            _residuals(series[run], spectrum, lowpasses, points) for run, spectrum in zip(runs, spectra, strict=True)
        ]
        for k, error in zip(several, np.concatenate(errors, axis=1), strict=True):
            known[k] = float(np.mean(error**2))

    def square(k: int) -> float:
        """Mean square of the residual at a cut-off of the grid; few of them are looked at."""
        if k not in known:
            look_at([k])
        return known[k]

    gain, gain_square = np.transpose([_white_gains(rate_hz, cutoff_hz) for cutoff_hz in grid])
    hidden = 2.0 * gain - gain_square
    look_at(range(int(np.searchsorted(grid, _NOISE_SHARE * rate_hz)), grid.size))  # ten, which most noise is told by
    noise = _noise_band(grid, square, hidden, _NOISE_SHARE * rate_hz)
    if noise is None:
        return float(highest_hz)
    whole = np.polyfit(hidden[noise], [square(k) for k in noise], 1)[1]
    # The higher the cut-off, the more of every frequency passes, and the smaller is the residual.
    above = bisect_left(range(count), True, key=lambda k: bool(square(k) <= whole))
    if above == count:
        return float(highest_hz)
    if above == 0:
        return _LOWEST_HZ
    between = np.log([square(above), square(above - 1)])
    return float(np.exp(np.interp(np.log(whole), between, np.log(grid[[above, above - 1]]))))


def _residuals(run: Float, spectrum: _Spectrum, lowpasses: list[_Lowpass], points: BodyPoints) -> Float:
    """How far each of several filters moves the points of a run of poses (N, 8), shape (K, N)."""
    gains = np.array([lowpass.gain(spectrum) for lowpass in lowpasses])
    inner = slice(spectrum.beyond, spectrum.beyond + spectrum.frames)
    filtered = np.fft.irfft(spectrum.components[:, None] * gains, spectrum.length)[..., inner].reshape(8, -1).T
    poses = multiply(spectrum.first, normalize(filtered))
    unfiltered = np.tile(np.ascontiguousarray(run.T), len(lowpasses)).T
    return rms_displacement(unfiltered, poses, points).reshape(len(lowpasses), -1)


def _noise_band(grid: Float, square: Callable[[int], float], hidden: Float, lowest_hz: float) -> range | None:
    """Cut-offs of the grid between which the residual is that of white noise; None where there are none.

    They are the uppermost. Where frames were repeated or put in between, by whatever exported the file or to fill
    gaps, the noise ends below these: then it is looked for an octave at a time, each half an octave lower, and taken
    where it is densest.
    """
    noise = range(int(np.searchsorted(grid, lowest_hz)), grid.size)
    lower, upper = (square(k) / (1.0 - hidden[k]) for k in (noise[0], noise[-1]))
    if upper >= max(_WHITE * lower, _NO_NOISE_M**2):
        return noise
    found, densest = None, _NO_NOISE_M**2
    while lowest_hz > _LOWEST_NOISE_HZ:
        lowest_hz /= np.sqrt(2.0)
        bounds = np.searchsorted(grid, lowest_hz * np.array([1.0, np.sqrt(2.0), 2.0])) - [0, 0, 1]
        first, middle, last = bounds.tolist()
        lower, upper = (
            (square(one) - square(other)) / (hidden[other] - hidden[one])
            for one, other in ((first, middle), (middle, last))
        )
        if densest < min(lower, upper) and _FLAT * max(lower, upper) < min(lower, upper):
            found, densest = range(first, last + 1), max(lower, upper)
    return found


def _spread(runs: list[slice], fewest: int) -> list[slice]:
    """Some stretches of the runs, spread over all of them: the cut-off does not need each frame of a long recording."""
    length = max(_STRETCH, fewest)
    pieces = [
        slice(start, min(start + length, run.stop))
        for run in runs
        for start in range(run.start, max(run.stop - fewest, run.start) + 1, length)
    ]
    return pieces if len(pieces) <= _STRETCHES else pieces[:: -(-len(pieces) // _STRETCHES)]


def _longest(runs: list[slice]) -> int:
    return max((run.stop - run.start for run in runs), default=0)


class _Spectrum(NamedTuple):
    """A run of poses by frequencies: continued beyond its ends, and seen from its own first pose.

    Seen from there, digits go to the motion and not to the position in the laboratory.
    """

    first: Float
    frames: int
    beyond: int
    length: int
    tangents: Float
    components: NDArray[np.complex128]

    @classmethod
    def of(cls, run: Float, settling: int) -> _Spectrum:
        """Transform a run (N, 8) with so many frames more at either end."""
        # A length of small factors only, which the transform is fast at, by going on farther than need be.
        count = _fast_length(len(run) + 2 * settling)
        beyond = (count - len(run) + 1) // 2
        local = _continued(multiply(conjugate(run[0]), run), beyond)[:count]
        tangents = np.tan(np.pi * np.arange(count // 2 + 1) / count)
        return cls(run[0].copy(), len(run), beyond, count, tangents, np.fft.rfft(local.T))


class _Lowpass:
    """The two passes together, for one rate and one cut-off, by their frequency response.

    A run is continued beyond its ends until the filter has settled, so that nothing of the discrete Fourier
    transform's wrap-around reaches it, and the response is that of the two recursive passes to the last digits.
    """

    def __init__(self, rate_hz: float, cutoff_hz: float) -> None:
        self._tangent = _designed_tangent(rate_hz, cutoff_hz)
        w = self._tangent
        squared_radius = (1.0 - np.sqrt(2.0) * w + w**2) / (1.0 + np.sqrt(2.0) * w + w**2)
        self.settling = int(np.ceil(-2.0 * _SETTLED / np.log(squared_radius)))

    def gain(self, run: _Spectrum) -> Float:
        """Share of each frequency of a run that both passes let through."""
        return np.asarray(1.0 / (1.0 + (run.tangents / self._tangent) ** 4))

    def __call__(self, run: _Spectrum) -> Float:
        """Filter one run of poses (N, 8), continued until the filter has settled, or farther."""
        gain = self.gain(run)
        inner = slice(run.beyond, run.beyond + run.frames)
        filtered = np.empty((8, run.frames))
        for row, component in zip(filtered, run.components, strict=True):
            row[...] = np.fft.irfft(component * gain, run.length)[inner]
        poses: Float = filtered.T
        for start in range(0, run.frames, _BLOCK):  # which takes no memory but the result's
            part = slice(start, start + _BLOCK)
            poses[part] = multiply(run.first, normalize(poses[part]))
        return poses


def _fast_length(least: int) -> int:
    """The least number from there on with no prime factor but 2, 3 and 5."""
    best = 1 << (least - 1).bit_length()
    fives = 1
    while fives < best:
        threes = fives
        while threes < best:
            best = min(best, threes << (-(-least // threes) - 1).bit_length())
            threes *= 3
        fives *= 5
    return best


def _designed_tangent(rate_hz: float, cutoff_hz: float) -> float:
    """``tan(pi f/rate)`` of the frequency f at which each single pass is at -3 dB."""
    lowest, highest = _MARGIN_SHARE * rate_hz, (0.5 - _MARGIN_SHARE) * rate_hz
    if not lowest <= cutoff_hz <= highest:
        msg = (
            f"--lowpass {cutoff_hz:g}: expected a cut-off from {lowest:g} to {highest:g} Hz, below half the rate of "
            f"{rate_hz:g} frames per second; give a lower one, or none"
        )
        raise SettingError(msg)
    return float(np.tan(np.pi * cutoff_hz / rate_hz)) / _TWO_PASSES


def _white_gains(rate_hz: float, cutoff_hz: float) -> tuple[float, float]:
    """Mean over all frequencies of the gain of the two passes, ``1/(1 + x^4)``, and of its square."""
    w = _designed_tangent(rate_hz, cutoff_hz)
    fourth = w**4
    gain = (fourth + w * (1.0 - w**2) / np.sqrt(2.0)) / (1.0 + fourth)
    square = (fourth * gain + w * (3.0 - w**2) / (4.0 * np.sqrt(2.0))) / (1.0 + fourth)
    return float(gain), float(square)


def _runs(poses: Float, elapsed: Float, rate_hz: float, broken_rows: Index | None, fewest: int) -> list[slice]:
    """Runs of known poses on an even clock, at least so many frames long."""
    rows = np.flatnonzero(np.isfinite(poses).all(axis=1))
    if rows.size < fewest:
        return []
    uneven = np.abs(np.diff(elapsed[rows]) * rate_hz - 1.0) > 0.5
    ends = (np.diff(rows) > 1) | uneven
    if broken_rows is not None:
        ends |= np.isin(rows[1:], broken_rows)
    bounds = np.r_[0, np.flatnonzero(ends) + 1, rows.size]
    first, size = rows[bounds[:-1]], np.diff(bounds)
    return [slice(int(f), int(f + s)) for f, s in zip(first[size >= fewest], size[size >= fewest], strict=True)]


def _continued(run: Float, frames: int) -> Float:
    """Continue a run at both ends by point reflection of the motion, again and again for as many frames as wanted."""
    while frames > 0:
        more = min(frames, len(run) - 1)
        before = _reflected(run[0], run[more:0:-1])
        after = _reflected(run[-1], run[-2 : -more - 2 : -1])
        run = np.concatenate([before, run, after])
        frames -= more
    return run


def _reflected(center: Float, poses: Float) -> Float:
    return multiply(multiply(center, conjugate(poses)), center)
