"""What a rotation is cut into: cycles, movements and why a boundary between them is uncertain."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew.geometry.arrays import Bool, Float
from elbowscrew.motion.movements.unseen import LONGEST_GAP_S

Reasons = tuple[str, ...]

REASONS: Final[dict[str, str]] = {
    "small-swing": "a swing there is hardly larger than the smallest that counts",
    "small-beside-neighbors": "a reversal there is about as small, beside its neighbors, as a hesitation",
    "noise": "the noise hides the foot of the movement",
    "law": "the motion does not begin and end there as gently as it is taken to, or the noise hides whether it does",
    "rest-in-doubt": "a stop there lasts about as long as the shortest rest",
    "fast": "the motion has faster parts than its rhythm, which the cuts do not follow",
    "gap": "it lies, or the height that it is told from, where there is no pose",
    "no-dominant-axis": "the rotation has no dominant axis",
    "two-axes": "the joint seems to have two axes, and the cuts are on the rotation about the direction between",
    "unsigned": "theta is to have no sense (--signed no)",
}
"""Why a boundary is uncertain: codes and words."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Cycles:
    """Cycles out and back; a value for each of them, times in seconds from the first frame.

    Attributes
    ----------
    start_s, inversion_s, end_s : ndarray, shape (C,)
        Foot of the movement out, middle of the time at the top, foot of the movement back.
    start_sd_s, inversion_sd_s, end_sd_s : ndarray, shape (C,)
        Their standard deviations, by the noise and by what is not known of the law of motion at the foot.
    incomplete : ndarray of bool, shape (C,)
        Whether the recording begins or ends on the way, the joint coming less than 90 % of the way there, or a turn may
        be lost in it (`Cuts.hidden_s`).
    sense : ndarray, shape (C,)
        1 of a cycle out and back, -1 of one back and out, which only a given one can be, 0 of one without a swing.
    start_reasons, inversion_reasons, end_reasons : tuple of tuple of str
        Why the boundaries are uncertain, codes of `REASONS`; empty if they are not.
    """

    start_s: Float
    inversion_s: Float
    end_s: Float
    start_sd_s: Float
    inversion_sd_s: Float
    end_sd_s: Float
    incomplete: Bool
    sense: Float
    start_reasons: tuple[Reasons, ...]
    inversion_reasons: tuple[Reasons, ...]
    end_reasons: tuple[Reasons, ...]

    @property
    def times_s(self) -> Float:
        """Start, inversion and end, shape (C, 3)."""
        return np.column_stack([self.start_s, self.inversion_s, self.end_s])

    @property
    def uncertain(self) -> Bool:
        """Whether start, inversion and end are uncertain, shape (C, 3)."""
        reasons = zip(self.start_reasons, self.inversion_reasons, self.end_reasons, strict=True)
        return np.array([[bool(one) for one in cycle] for cycle in reasons], dtype=np.bool_).reshape(-1, 3)


@dataclass(frozen=True, slots=True, kw_only=True)
class Movements:
    """Movements between rests of a quarter of a second and more; seconds from the first frame.

    Attributes
    ----------
    onset_s, offset_s, onset_sd_s, offset_sd_s : ndarray, shape (M,)
    onset_reasons, offset_reasons : tuple of tuple of str
        Why they are uncertain, codes of `REASONS`.
    stroke_begin_s, stroke_end_s : ndarray, shape (K,)
        The strokes that the movements consist of: motion in one sense.
    stroke_begin_sd_s, stroke_end_sd_s : ndarray, shape (K,)
        Their standard deviations.
    stroke_begin_gap_s, stroke_end_gap_s : ndarray, shape (K, 2)
        Begin and end of the gap that they are told from; NaN where there is none.
    outward : ndarray of bool, shape (K,)
        Whether a stroke is outward.
    reverses : ndarray of bool, shape (K - 1,)
        Whether the motion turns back between a stroke and the next, or only stops.
    turn_s : ndarray, shape (K - 1,)
        When it does: where cycles turn or meet, as they do; else in the middle between the strokes' feet.
    """

    onset_s: Float
    offset_s: Float
    onset_sd_s: Float
    offset_sd_s: Float
    onset_reasons: tuple[Reasons, ...]
    offset_reasons: tuple[Reasons, ...]
    stroke_begin_s: Float
    stroke_end_s: Float
    stroke_begin_sd_s: Float
    stroke_end_sd_s: Float
    stroke_begin_gap_s: Float
    stroke_end_gap_s: Float
    outward: Bool
    reverses: Bool
    turn_s: Float


@dataclass(frozen=True, slots=True, kw_only=True)
class Cuts:
    """What a rotation is cut into.

    Attributes
    ----------
    cycles : Cycles
    movements : Movements
    cutoff_hz : float
        Cut-off of the filter that the cuts are found under, by the motion's own rhythm.
    noise : float
        Standard deviation of the rotation's white noise, radians.
    least_swing, excursion : float
        Least swing between turns, and the largest angle less the smallest, radians.
    small : ndarray, shape (S,)
        Heights of small strokes out and back between cycles that count as hesitations, radians.
    hidden_s : ndarray, shape (G, 2)
        Begin and end of stretches without a pose in which the joint may turn back unseen.
    """

    cycles: Cycles
    movements: Movements
    cutoff_hz: float
    noise: float
    least_swing: float
    excursion: float
    small: Float
    hidden_s: Float

    def rows(self, seconds: Float, elapsed: Float) -> Float:
        """Fractional rows of a recording at such times; whole at its frames.

        Parameters
        ----------
        seconds : ndarray, shape (K,)
            Since the first frame.
        elapsed : ndarray, shape (N,)
            Times of the frames, seconds.
        """
        return np.interp(seconds, elapsed - elapsed[0], np.arange(elapsed.size, dtype=np.float64))


def no_cycles() -> Cycles:
    """Give cycles of which there is none."""
    none = np.empty(0)
    return Cycles(
        start_s=none, inversion_s=none, end_s=none, start_sd_s=none, inversion_sd_s=none, end_sd_s=none,
        incomplete=np.empty(0, dtype=np.bool_), sense=none, start_reasons=(), inversion_reasons=(), end_reasons=(),
    )  # fmt: skip


def no_movements() -> Movements:
    """Give movements of which there is none."""
    none, flags = np.empty(0), np.empty(0, dtype=np.bool_)
    return Movements(
        onset_s=none, offset_s=none, onset_sd_s=none, offset_sd_s=none, onset_reasons=(), offset_reasons=(),
        stroke_begin_s=none, stroke_end_s=none,
        stroke_begin_sd_s=none, stroke_end_sd_s=none,
        stroke_begin_gap_s=np.empty((0, 2)), stroke_end_gap_s=np.empty((0, 2)),
        outward=flags, reverses=flags, turn_s=none,
    )  # fmt: skip


def long_gaps(elapsed: Float, known: NDArray[np.intp]) -> Float:
    """Begin and end of gaps of over a tenth of a second, shape (G, 2), seconds from the first frame."""
    time = elapsed[known] - elapsed[0]
    long = np.flatnonzero(np.diff(time) > LONGEST_GAP_S)
    long = long[np.diff(known)[long] > 1]
    return np.column_stack([time[long], time[long + 1]])


def gap_at(seconds: Float, gaps: Float) -> Float:
    """Give the longest of the gaps (G, 2) that one of the times of a row (K, P) lies in, shape (K, 2); NaN if none."""
    inside = np.any((gaps[:, 0] <= seconds[..., None]) & (seconds[..., None] < gaps[:, 1]), axis=1)
    found = np.full((len(seconds), 2), np.nan)
    if len(gaps):
        lengths = np.where(inside, gaps[:, 1] - gaps[:, 0], 0.0)
        some = inside.any(axis=1)
        found[some] = gaps[np.argmax(lengths, axis=1)[some]]
    return found


def duration_of(gaps: Float) -> Float:
    """Durations of gaps (..., 2); 0 of none."""
    return np.nan_to_num(gaps[..., 1] - gaps[..., 0])
