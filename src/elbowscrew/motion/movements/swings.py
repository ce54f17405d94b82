"""The swings of a joint: its rotation on an even clock, smoothed as its own rhythm allows, and where it turns."""

from __future__ import annotations

import heapq
from typing import Final, NamedTuple

import numpy as np

from elbowscrew.geometry.arrays import Float, Index
from elbowscrew.motion.movements.phases import turning_points
from elbowscrew.motion.smoothing.filtering import _designed_tangent, _fast_length, noise_gain

# Third differences of white noise have the variance 1 + 9 + 9 + 1; the median of |x| is 1/1.4826 of its sd.
_THIRD_DIFFERENCE: Final = 20.0
_SD_OF_MEDIAN: Final = 1.4826
FEWEST_FOR_NOISE: Final = 23
"""Fewer poses in a row than this do not tell the noise: their third differences are too few."""

# The rhythm of the motion is the frequency below which so much of its energy lies; the filter keeps four times that.
_ENERGY_SHARE: Final = 0.8
_OVER_RHYTHM: Final = 4.0
_LOWEST_HZ: Final = 2.0
_HIGHEST_HZ: Final = 12.0
_HIGHEST_SHARE: Final = 0.2
_END_SHARE: Final = 0.4
_POSSIBLE_SHARE: Final = 1e-3
_SETTLED_PERIODS: Final = 3.0

# A swing is at least so large: twice the largest deviation that smoothed noise reaches, two degrees, a tenth of all.
_LEAST_SWING: Final = float(np.radians(2.0))
_RANGE_SHARE: Final = 0.1
_FEWEST_DRAWS: Final = 3.0

LOCAL_SHARE: Final = 0.375
"""A turn with less than this share of the prominence of its like neighbors is a hesitation of a larger swing."""
# Within such shares above and below that it is in doubt, which it is; the latter holds small strokes of 25 of 90 deg.
_NEAR: Final = 0.25
_NEAR_BELOW: Final = 0.4
_NEAR_SWING: Final = 1.3
_FAST_SHARE: Final = 0.25
_FAST_RANK: Final = 3


class Swings(NamedTuple):
    """A rotation on an even clock, and its turning points.

    Attributes
    ----------
    rate_hz : float
        Samples per second of the even clock, which begins with the recording.
    cutoff_hz : float
        Cut-off of the two-pass Butterworth filter.
    noise, smooth_noise : float
        Standard deviation (rad) of the white noise of one sample, and of what the filter leaves of it.
    least, noise_swing : float
        Least swing between two turning points, and the largest that the noise makes, radians.
    level, smooth : ndarray, shape (N,)
        The rotation with its two ends by the samples beside them, and the same filtered, radians.
    all_reversals, reversals : ndarray of int64, shape (T,)
        Samples of the turning points by the least swing, the ends of the recording among them; and of those that are
        left by the local rule.
    doubtful : dict of int to str
        Why turning points are in doubt, by their samples.
    close_removed : ndarray of int64
        Turning points that the local rule took out by little.
    small_rad : ndarray, shape (S,)
        Heights of strokes out and back between lows that the motion comes back to, which the local rule took out.
    fast_rad : float
        Peak to peak of what the filter took out and a 12 Hz one would keep, the third largest, radians.
    """

    rate_hz: float
    cutoff_hz: float
    noise: float
    smooth_noise: float
    least: float
    noise_swing: float
    level: Float
    smooth: Float
    all_reversals: Index
    reversals: Index
    doubtful: dict[int, str]
    close_removed: Index
    small_rad: Float
    fast_rad: float

    @property
    def cutoff(self) -> float:
        """Cut-off in cycles a sample."""
        return self.cutoff_hz / self.rate_hz


def swings_of(
    twist: Float,
    rate_hz: float,
    noise: float | None = None,
    least_swing: float | None = None,
    cutoff_hz: float | None = None,
) -> Swings:
    """Smooth a rotation and find where it turns.

    Parameters
    ----------
    twist : ndarray, shape (N,)
        Rotation about one direction on an even clock, continuous, radians, finite; ten samples at least.
    rate_hz : float
    noise : float, optional
        Standard deviation of its white noise, radians; by third differences if not given.
    least_swing : float, optional
        Swing (rad) that is known to count: it takes the place of the threshold and of the local rule.
    cutoff_hz : float, optional
        Of the filter; by the motion's own rhythm if not given.

    References
    ----------
    Third differences as a measure of noise: Gasser, Sroka, Jennen-Steinmetz 1986, Biometrika 73 (second differences).
    The zero-phase filter: Winter 2009.
    """
    sigma = noise_of(twist) if noise is None else noise
    cutoff_hz = _cutoff(twist, rate_hz, sigma) if cutoff_hz is None else cutoff_hz
    level = twist.copy()
    reach = round(_END_SHARE * rate_hz / cutoff_hz)
    level[0], level[-1] = _end_level(twist, reach), _end_level(twist[::-1], reach)
    smooth = lowpass_series(level, rate_hz, cutoff_hz)
    smooth_noise = sigma * float(np.sqrt(noise_gain(rate_hz, cutoff_hz)))
    noise_swing = largest_noise_swing(sigma, twist.size, rate_hz, cutoff_hz)
    least = max(noise_swing, _LEAST_SWING, _RANGE_SHARE * float(np.ptp(smooth))) if least_swing is None else least_swing
    every = turning_points(smooth, least)
    kept, close = every, np.empty(0, dtype=np.int64)
    doubtful: dict[int, str] = {}
    if least_swing is None:
        kept, close = _by_local_rule(every, smooth[every])
        doubtful = _doubts(kept, smooth[kept], least)
    return Swings(
        rate_hz=rate_hz,
        cutoff_hz=cutoff_hz,
        noise=sigma,
        smooth_noise=smooth_noise,
        least=least,
        noise_swing=noise_swing,
        level=level,
        smooth=smooth,
        all_reversals=every,
        reversals=kept,
        doubtful=doubtful,
        close_removed=close,
        small_rad=_small_strokes(every, kept, smooth),
        fast_rad=_left_out(level, smooth, rate_hz, cutoff_hz),
    )


def largest_noise_swing(noise: float, count: int, rate_hz: float, cutoff_hz: float) -> float:
    """Twice the largest deviation that white noise reaches in so many samples under the filter, in its unit."""
    draws = max(2.0 * cutoff_hz * count / rate_hz, _FEWEST_DRAWS)
    return 2.0 * float(np.sqrt(2.0 * np.log(draws) * noise_gain(rate_hz, cutoff_hz))) * noise


def noise_of(series: Float) -> float:
    """Standard deviation of the white noise of a series (N,), by its third differences; 0 of fewer than 21 of them.

    Examples
    --------
    >>> bool(abs(noise_of(np.random.default_rng(1).normal(0.0, 0.3, 5000)) - 0.3) < 0.02)
    True
    """
    third = np.diff(series, 3)
    third = third[np.isfinite(third)]
    if third.size <= FEWEST_FOR_NOISE - 3:
        return 0.0
    return float(_SD_OF_MEDIAN * np.median(np.abs(third)) / np.sqrt(_THIRD_DIFFERENCE))


def lowpass_series(series: Float, rate_hz: float, cutoff_hz: float) -> Float:
    """Filter a series (N,) by a 2nd-order Butterworth low-pass, forward and backward, -3 dB at the cut-off together.

    It is continued beyond its ends by point reflection, which they keep.
    """
    beyond = int(np.ceil(_SETTLED_PERIODS * rate_hz / cutoff_hz))
    continued, left = series, beyond
    while left > 0:
        more = min(left, len(continued) - 1)
        before = 2.0 * continued[0] - continued[more:0:-1]
        after = 2.0 * continued[-1] - continued[-2 : -more - 2 : -1]
        continued = np.concatenate([before, continued, after])
        left -= more
    length = _fast_length(len(continued))
    bridge = np.linspace(continued[-1], continued[0], length - len(continued) + 2)[1:-1]
    spectrum = np.fft.rfft(np.concatenate([continued, bridge]))
    turn = np.minimum(np.pi * np.arange(length // 2 + 1) / length, 0.5 * np.pi - 1e-9)
    gain = 1.0 / (1.0 + (np.tan(turn) / _designed_tangent(rate_hz, cutoff_hz)) ** 4)
    filtered: Float = np.fft.irfft(spectrum * gain, length)[beyond : beyond + series.size]
    return filtered


def _cutoff(twist: Float, rate_hz: float, sigma: float) -> float:
    """Four times the frequency below which 80 % of the energy about the straight line lies, from 2 to 12 Hz."""
    count = twist.size
    position = np.linspace(-1.0, 1.0, count)
    centered = twist - twist.mean()
    centered = centered - position * (position @ centered) / (position @ position)
    length = _fast_length(2 * count)
    energy = np.cumsum(np.maximum(np.abs(np.fft.rfft(centered, length)) ** 2 - sigma**2 * count, 0.0))
    rhythm = float(np.searchsorted(energy, _ENERGY_SHARE * energy[-1])) * rate_hz / length if energy[-1] > 0.0 else 0.0
    highest = min(_HIGHEST_HZ, _HIGHEST_SHARE * rate_hz)
    possible = _POSSIBLE_SHARE * rate_hz
    return float(max(min(max(_OVER_RHYTHM * rhythm, _LOWEST_HZ), highest), possible))


def _end_level(series: Float, reach: int) -> float:
    """First value of a series, by the straight line through so many of the next ones."""
    count = min(max(reach, 3), series.size - 1)
    values = series[1 : count + 1]
    if count <= 3:
        return float(values.mean())
    position = np.arange(1, count + 1) - 0.5 * (count + 1)
    return float(values.mean() - 0.5 * (count + 1) * (position @ values) / (position @ position))


def _left_out(level: Float, smooth: Float, rate_hz: float, cutoff_hz: float) -> float:
    """Peak to peak of the motion between the cut-off and 12 Hz, over half a period of the cut-off, third largest."""
    highest = min(_HIGHEST_HZ, _HIGHEST_SHARE * rate_hz)
    if highest <= 1.05 * cutoff_hz:
        return 0.0
    window = max(round(0.5 * rate_hz / cutoff_hz), 2)
    count = level.size // window
    if count < _FAST_RANK:
        return 0.0
    rest = (lowpass_series(level, rate_hz, highest) - smooth)[: count * window].reshape(count, window)
    return float(np.partition(np.ptp(rest, axis=1), -_FAST_RANK)[-_FAST_RANK])


def fast_content(swings: Swings, rise: float) -> bool:
    """Whether the filter left out motion that matters beside a rise (rad) of the cycles."""
    return swings.fast_rad > _FAST_SHARE * rise


def _small_strokes(every: Index, kept: Index, smooth: Float) -> Float:
    """Heights of tops that are not kept, between lows no higher than the kept low beside them, shape (S,).

    So low is within a tenth of the kept swing there.
    """
    values, stays = smooth[every], np.isin(every, kept)
    if stays.all() or kept.size < 3:
        return np.empty(0)
    inner = np.arange(1, every.size - 1)
    tops = inner[~stays[inner] & (values[inner] > values[inner - 1]) & (values[inner] > values[inner + 1])]
    levels = smooth[kept]
    is_low = np.append(levels[0] < levels[1], levels[1:] < levels[:-1])
    lows = np.flatnonzero(is_low)
    nearest = lows[np.abs(kept[lows] - every[tops][:, None]).argmin(axis=1)]
    swing = np.abs(levels[np.where(nearest + 1 < kept.size, nearest + 1, nearest - 1)] - levels[nearest])
    base = np.maximum(values[tops - 1], values[tops + 1])
    from_low: Float = (values[tops] - levels[nearest])[base - levels[nearest] <= _RANGE_SHARE * swing]
    return from_low


def _prominences(values: Float) -> tuple[Float, Float]:
    """Prominence of every turn, shape (T,), and its ratio to the smaller of its like neighbors', inf without one."""
    swing = np.abs(np.diff(values))
    inner = np.minimum(np.append(np.inf, swing), np.append(swing, np.inf))
    if values.size > 3:  # beside the recording's ends only the inner swing is known in full
        inner[1], inner[-2] = swing[1], swing[-2]
    before = np.concatenate([[np.inf, np.inf], inner[:-2]])
    after = np.concatenate([inner[2:], [np.inf, np.inf]])
    like = np.minimum(before, after)
    ratio = np.full(values.size, np.inf)
    np.divide(inner, like, out=ratio, where=np.isfinite(like) & (like > 0.0))
    return inner, ratio


def _by_local_rule(reversals: Index, values: Float) -> tuple[Index, Index]:
    """Take out the smallest swing again and again while it is small beside its neighbors; also what went by little.

    Turns are a doubly linked list here, and swings that are small beside their neighbors a heap: taking one out
    changes the standing of the few swings near it only, so that all takes linear time but for the heap's logarithm.
    """
    count = reversals.size
    if count <= 3:
        return reversals, np.empty(0, dtype=np.int64)
    _, ratio = _prominences(values)
    first_bad = np.flatnonzero(np.minimum(ratio[1:-2], ratio[2:-1]) < LOCAL_SHARE) + 1
    if not first_bad.size:
        return reversals, np.empty(0, dtype=np.int64)
    chain = _Chain(values.tolist())
    heap = [(chain.swing(k), k) for k in first_bad.tolist()]
    heapq.heapify(heap)
    close: list[int] = []
    while heap and chain.left > 3:
        size, k = heapq.heappop(heap)
        if not chain.alive[k] or not 0 <= chain.after[k] < count or chain.swing(k) != size:
            continue
        share = chain.share(k)
        if not share < LOCAL_SHARE:
            continue
        if share > (1.0 - _NEAR_BELOW) * LOCAL_SHARE:
            close += [k, chain.after[k]]
        for near in chain.take_out(k):
            if chain.share(near) < LOCAL_SHARE:
                heapq.heappush(heap, (chain.swing(near), near))
    return reversals[np.array(chain.alive)], reversals[np.array(sorted(close), dtype=np.int64)]


class _Chain:
    """Turns that are left, each with the one before and the one after it."""

    def __init__(self, values: list[float]) -> None:
        self.values = values
        self.left = len(values)
        self.before = list(range(-1, self.left - 1))
        self.after = list(range(1, self.left + 1))
        self.alive = [True] * self.left

    def swing(self, k: int) -> float:
        """Size of the swing from a turn to the next."""
        return abs(self.values[self.after[k]] - self.values[k])

    def _is_end(self, k: int) -> bool:
        return self.before[k] < 0 or self.after[k] >= len(self.values)

    def _prominence(self, k: int) -> float:
        if self.before[k] < 0:
            return self.swing(k)
        if self.after[k] >= len(self.values):
            return self.swing(self.before[k])
        left, right = self.swing(self.before[k]), self.swing(k)
        if self.left > 3:
            if self.before[self.before[k]] < 0:
                return right
            if self.after[self.after[k]] >= len(self.values):
                return left
        return min(left, right)

    def _ratio(self, k: int) -> float:
        like = []
        if not self._is_end(self.before[k]):
            like.append(self._prominence(self.before[self.before[k]]))
        if not self._is_end(self.after[k]):
            like.append(self._prominence(self.after[self.after[k]]))
        least = min(like, default=0.0)
        return self._prominence(k) / least if least > 0.0 else np.inf

    def share(self, k: int) -> float:
        """Smaller ratio of the two reversals of a swing; inf where one of them is an end of the recording."""
        if self._is_end(k) or self._is_end(self.after[k]):
            return np.inf
        return min(self._ratio(k), self._ratio(self.after[k]))

    def take_out(self, k: int) -> list[int]:
        """Take a swing out, both reversals of it; return the swings near it."""
        other = self.after[k]
        left, right = self.before[k], self.after[other]
        self.alive[k] = self.alive[other] = False
        self.after[left], self.before[right] = right, left
        self.left -= 2
        near, at = [], left
        for _ in range(4):
            if self.before[at] < 0:
                break
            at = self.before[at]
        for _ in range(9):
            if at >= len(self.values) or self.after[at] >= len(self.values):
                break
            near.append(at)
            at = self.after[at]
        return near


def _doubts(reversals: Index, values: Float, least: float) -> dict[int, str]:
    """Why reversals are in doubt: a swing hardly over the threshold, or small beside its neighbors."""
    if reversals.size < 3:
        return {}
    swing = np.abs(np.diff(values))
    _, ratio = _prominences(values)
    doubts = {int(at): "small-swing" for at in reversals[1:-1][np.minimum(swing[:-1], swing[1:]) < _NEAR_SWING * least]}
    doubts |= {int(at): "small-beside-neighbors" for at in reversals[ratio < (1.0 + _NEAR) * LOCAL_SHARE]}
    return doubts
