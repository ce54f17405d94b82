"""The sense of the rotation since the reference: theta as a function of the pose and of one axis for the trial.

A displacement turns by theta about h as well as by -theta about -h. Which of the two is meant is decided once for the
whole trial, by the axis that dominates it; only where the motion turns all the way round do whole turns come from its
course. Where no axis dominates there is no sense, and theta is the unsigned rotation.
"""

from __future__ import annotations

from typing import Final, Literal, NamedTuple

import numpy as np

from elbowscrew.geometry._small_angle import length, row_length
from elbowscrew.geometry.arrays import Bool, Float, Index
from elbowscrew.model import Sense
from elbowscrew.motion.tracking.inserted import recorded_poses

SignedChoice = Literal["auto", "yes", "no"]

# The ratio of hinges is below 0.002, of axes that wander by 30 deg up to 0.14, of real elbows and knees 0.05 to 0.14; a
# ball has 0.3 and two axes 0.5.
DOMINANT_RATIO: Final = 0.20
_TURN: Final = 2.0 * np.pi
# The twist says little of a rotation whose axis is so far from the dominant one: ``w^2 + (v.u)^2`` is that of both.
_LEAST_TWIST_SQUARE: Final = 0.25
_LEAST_FREE_ARC: Final = float(np.radians(20.0))
_BINS: Final = 3600
_SLOPE_STEPS: Final = 5
_LONG_GAP_ROWS: Final = 3
# A run of frames is on its own side of the reference if it leaves that by so many times the angle at which it passes.
_PROMINENCE: Final = 3.0
_TIE: Final = 0.05
_NEAR_AXIS: Final = 0.5
_ROUNDING: Final = 1e-9
LARGE_JUMP: Final = float(np.radians(20.0))
_LEAST_DIFFERENCES: Final = 20
_MEDIAN_CHI2_3: Final = 2.366
_THIRD_DIFFERENCE_GAIN: Final = 20.0


class _Rotation(NamedTuple):
    """Known displacements with a scalar part that is not negative; M of N rows."""

    scalar: Float
    vector: Float
    phi: Float

    @classmethod
    def of(cls, quat: Float) -> _Rotation:
        positive = np.where(quat[..., :1] < 0.0, -quat, quat)
        scalar, vector = positive[..., 0], positive[..., 1:]
        return cls(scalar, vector, 2.0 * np.arctan2(length(vector), scalar))


class _Sheets(NamedTuple):
    """Sign and whole turns of every known row; ``theta = sign phi + 2 pi turns``."""

    sign: Float
    turns: Float


def sense_of(
    quat: Float, time_s: Float, reference_row: int, *, sigma: float | None = None, signed: SignedChoice = "auto"
) -> Sense:
    """Find the dominant axis of a motion and the sense that it gives the rotation in every frame.

    Parameters
    ----------
    quat : ndarray, shape (N, 4)
        Unit quaternions of the displacements since the reference, scalar first, each of any sign; NaN where unknown.
    time_s : ndarray, shape (N,)
        Seconds, increasing; only for whole turns across a gap.
    reference_row : int
        Row that no whole turn is counted at.
    sigma : float, optional
        Noise of a component of the rotation, radians; None to take it from the motion's third differences.
    signed : {"auto", "yes", "no"}
        Whether the angle has a sense; by the ratio if "auto".

    Returns
    -------
    Sense

    References
    ----------
    The twist about an axis is the swing-twist decomposition of a rotation. Leading direction of axes without sense:
    Watson 1965, Biometrika 52.

    Examples
    --------
    >>> half = np.radians([0.0, 40.0, 100.0, 40.0])
    >>> quat = np.column_stack([np.cos(half), np.sin(half), 0.0 * half, 0.0 * half])
    >>> np.degrees(sense_of(quat, np.arange(4.0), 0).angle).round(6)
    array([  0.,  80., 200.,  80.])
    """
    known = np.isfinite(quat).all(axis=1)
    rows = np.flatnonzero(known)
    noise = rotation_noise(quat) if sigma is None else sigma
    rotation = _Rotation.of(quat[rows])
    direction, ratio = _dominant(rotation.vector, noise)
    has_sense = ratio <= DOMINANT_RATIO if signed == "auto" else signed == "yes"
    along = rotation.vector @ direction
    psi = 2.0 * np.arctan2(along, rotation.scalar)
    good = rotation.scalar**2 + along**2 >= _LEAST_TWIST_SQUARE
    turns, counted, bridged = _whole_turns(psi, good, rows, time_s[rows])
    turns -= turns[rows == reference_row].sum()  # of the one row, or 0 without it
    twist = psi + _TURN * turns
    if has_sense:
        sheets = _Sheets(np.where(along < 0.0, -1.0, 1.0), turns)
        if not counted:
            sheets = _passed_aside(sheets, rotation.phi, noise)
        angle = sheets.sign * rotation.phi + _TURN * sheets.turns
        way, tied = _larger_excursion(angle)
        sheets = _Sheets(way * sheets.sign, way * sheets.turns)
    else:
        way, tied = _larger_excursion(twist)[0], False
        sheets = _Sheets(np.ones(rows.size), np.zeros(rows.size))
    angle = sheets.sign * rotation.phi + _TURN * sheets.turns
    beyond = _beyond_geodesic(angle, quat[rows], rows)
    jumped = beyond.size > 0 and beyond.max() > _ROUNDING
    return Sense(
        signed=has_sense,
        direction=way * direction,
        ratio=ratio,
        sigma=noise,
        counted=counted,
        tied=tied,
        angle=_spread(angle, rows, known.size),
        sign=_spread(sheets.sign, rows, known.size),
        turns=_spread(sheets.turns, rows, known.size),
        twist=_spread(way * twist, rows, known.size),
        largest_jump=float(beyond.max()) if jumped else 0.0,
        jump_row=int(rows[np.argmax(beyond)]) if jumped else None,
        jumps=int((beyond > LARGE_JUMP).sum()),
        bridged_rows=tuple(bridged.tolist()),
    )


def rotation_noise(quat: Float) -> float:
    """Noise of a component of the rotation, radians, from third differences: motion leaves next to nothing in them.

    Parameters
    ----------
    quat : ndarray, shape (N, 4)
        Unit quaternions, each of any sign; NaN where unknown.

    Returns
    -------
    float
        0 where fewer than 20 differences are known.
    """
    if len(quat) < _LEAST_DIFFERENCES:
        return 0.0
    flips = np.einsum("ni,ni->n", quat[1:], quat[:-1]) < 0.0
    sign = np.cumprod(np.concatenate([[1.0], np.where(flips, -1.0, 1.0)]))
    series = quat * sign[:, None]
    size = row_length(np.diff(series[recorded_poses(series)].T, 3, axis=1))
    size = size[np.isfinite(size)]
    if size.size < _LEAST_DIFFERENCES:
        return 0.0
    return float(2.0 * np.median(size) / np.sqrt(_THIRD_DIFFERENCE_GAIN * _MEDIAN_CHI2_3))


def modeled_angle(modeled: Float, measured: Float, sense: Sense, time_s: Float) -> tuple[Float, Float]:
    """Theta of a model's poses, with the sense of the measured motion.

    Where the model's axis lies within 60 deg of the measured one, it turns as that does; elsewhere the value nearest
    the measured theta is taken. Whole turns are those nearest the measured theta, which is interpolated over its gaps.

    Parameters
    ----------
    modeled, measured : ndarray, shape (..., N, 4) and (N, 4)
        Unit quaternions of the displacements since the reference, each of any sign; NaN where unknown.
    sense : Sense
        Of the measured ones.
    time_s : ndarray, shape (N,)

    Returns
    -------
    angle, sign : ndarray, shape (..., N)
        Theta, radians, and the sign of its axis as in `Sense`; NaN where the model has no pose.
    """
    if not sense.signed:
        phi = _Rotation.of(modeled).phi
        return phi, np.where(np.isfinite(phi), 1.0, np.nan)
    vector = _Rotation.of(measured).vector
    size = length(vector)
    known = np.isfinite(sense.angle)
    clear = known & (2.0 * size > _PROMINENCE * sense.sigma)
    axis = np.broadcast_to(sense.direction, vector.shape).copy()
    axis[clear] = (sense.sign[clear] / size[clear])[:, None] * vector[clear]
    return angle_beside(modeled, axis, np.interp(time_s, time_s[known], sense.angle[known]))


def angle_beside(quat: Float, axis: Float, angle: Float) -> tuple[Float, Float]:
    """Theta of displacements that has the sense of an axis beside them, or is nearest an angle where theirs is another.

    Parameters
    ----------
    quat : ndarray, shape (..., N, 4)
        Unit quaternions, each of any sign; NaN where unknown.
    axis : ndarray, shape (N, 3) or (3,)
        Unit directions about which a positive angle turns.
    angle : ndarray, shape (N,)
        Radians.

    Returns
    -------
    angle, sign : ndarray, shape (..., N)
        As of `modeled_angle`.
    """
    rotation = _Rotation.of(quat)
    along = np.sum(rotation.vector * axis, axis=-1)
    near = np.abs(along) >= _NEAR_AXIS * length(rotation.vector)
    plus, minus = (phi + _TURN * np.round((angle - phi) / _TURN) for phi in (rotation.phi, -rotation.phi))
    nearer = np.abs(plus - angle) <= np.abs(minus - angle)
    positive = np.where(near, along >= 0.0, nearer)
    theta = np.where(positive, plus, minus)
    return theta, np.where(np.isfinite(theta), np.where(positive, 1.0, -1.0), np.nan)


def _dominant(vector: Float, noise: float) -> tuple[Float, float]:
    """Leading direction (3,) of ``sum sin^2(phi/2) h h^T`` less the noise's share, and the eigenvalues' ratio."""
    moments = vector.T @ vector - 0.25 * noise**2 * len(vector) * np.eye(3)
    values, directions = np.linalg.eigh(moments)
    ratio = max(float(values[1]), 0.0) / float(values[2]) if values[2] > 0.0 else 1.0
    return directions[:, 2], ratio


def _whole_turns(psi: Float, good: Bool, rows: Index, time_s: Float) -> tuple[Float, bool, Index]:
    """Whole turns of each known row, whether they were counted along time, and the rows before gaps they hang on."""
    chosen = np.flatnonzero(good)
    if chosen.size < 2:
        return np.zeros(psi.size), False, rows[:0]
    clear = psi[chosen]
    step = _wrapped(np.diff(clear))
    span = np.diff(rows[chosen])
    cut = _free_cut(clear, step, span == 1)
    turning, far = _steps_by_speed(step, span, time_s[chosen])
    if cut is None:
        course = clear[0] + np.concatenate([[0.0], np.cumsum(turning)])
        count = np.round((course - clear) / _TURN)
        return count[np.clip(np.cumsum(good) - 1, 0, None)], True, rows[chosen[far]]
    # The window of one turn that holds 0, the reference, begins and ends at the cut.
    outside = psi > cut if cut > 0.0 else psi < cut
    against = np.flatnonzero((turning != step) & _crosses(clear[:-1], turning, cut))
    return np.where(outside, -np.sign(cut), 0.0), False, rows[chosen[against]]


def _crosses(start: Float, move: Float, place: float) -> Bool:
    """Whether moves from angles go past a place on the circle."""
    past = (start - place) % _TURN
    crossed: Bool = (past + move < 0.0) | (past + move >= _TURN)
    return crossed


def _free_cut(psi: Float, step: Float, adjacent: Bool) -> float | None:
    """Middle of the widest arc of 20 deg or more that no frame lies in and no step crosses; None if there is none.

    An arc that lies within a gap, the shorter way round, is as good as visited: it is taken only if there is no other.
    """
    place = np.floor((psi + np.pi) * (_BINS / _TURN)).astype(np.intp) % _BINS
    taken = np.flatnonzero(np.bincount(place, minlength=_BINS))
    empty = (np.diff(taken, append=taken[0] + _BINS) - 1) * (_TURN / _BINS)
    cuts = []
    for k in np.flatnonzero(empty >= _LEAST_FREE_ARC - 2.0 * _TURN / _BINS):
        lower = psi[place == taken[k]].max()
        upper = psi[place == taken[(k + 1) % taken.size]].min()
        free = (upper - lower) % _TURN or _TURN
        middle = float(_wrapped(lower + 0.5 * free))
        crossed = _crosses(psi[:-1], step, middle)
        if free >= _LEAST_FREE_ARC and not crossed[adjacent].any():
            cuts.append((not crossed.any(), float(free), middle))
    return max(cuts)[2] if cuts else None


def _steps_by_speed(step: Float, span: Index, time_s: Float) -> tuple[Float, Index]:
    """Steps of the twist with the whole turns that the mean of the slopes at its two sides gives a gap.

    Returns
    -------
    step : ndarray, shape (M - 1,)
    far : ndarray of int
        Steps over a gap in which the slopes make the motion turn by more than half a turn.
    """
    course = np.concatenate([[0.0], np.cumsum(step)])
    gap = np.flatnonzero(span > 1)
    stretch = np.cumsum(np.concatenate([[0], (span > _LONG_GAP_ROWS).astype(np.intp)]))
    begins = np.searchsorted(stretch, stretch, side="left")
    ends = np.searchsorted(stretch, stretch, side="right") - 1
    before = np.maximum(gap - _SLOPE_STEPS, begins[gap])
    after = np.minimum(gap + 1 + _SLOPE_STEPS, ends[gap + 1])
    slopes = np.zeros((2, gap.size))
    for slope, first, last in zip(slopes, (before, gap + 1), (gap, after), strict=True):
        moving = last > first
        a, b = first[moving], last[moving]
        slope[moving] = (course[b] - course[a]) / (time_s[b] - time_s[a])
    sides = (gap > before).astype(np.float64) + (after > gap + 1)
    slope = slopes.sum(axis=0) / np.maximum(sides, 1.0)
    more = np.zeros(step.size)
    turned = slope * (time_s[gap + 1] - time_s[gap])
    more[gap] = np.round((turned - step[gap]) / _TURN)
    return step + _TURN * more, gap[np.abs(turned) > np.pi]


def _passed_aside(sheets: _Sheets, phi: Float, noise: float) -> _Sheets:
    """Give frames that only seem to pass the reference the sense of their neighbors.

    A run of frames between two multiples of 360 deg is on its own side of a multiple if it leaves that by three times
    the angle at which it passes it, and by three times the noise. One that does not is mirrored at the multiple.
    """
    angle = sheets.sign * phi + _TURN * sheets.turns
    sheet = np.floor(angle / _TURN)
    edge = np.flatnonzero(np.diff(sheet))
    if not edge.size:
        return sheets
    first = np.concatenate([[0], edge + 1])
    own = sheet[first]
    above = np.maximum.reduceat(angle, first) - _TURN * own
    below = _TURN * (own + 1.0) - np.minimum.reduceat(angle, first)
    rising = np.diff(own)
    passing = np.where(np.abs(rising) == 1.0, np.minimum(phi[edge], phi[edge + 1]), 0.0)
    least = _PROMINENCE * np.maximum(passing, noise)
    counts = np.ones(first.size, dtype=np.bool_)
    counts[:-1] &= np.where(rising > 0.0, below[:-1], above[:-1]) >= least
    counts[1:] &= np.where(rising > 0.0, above[1:], below[1:]) >= least
    if counts.all():
        return sheets
    target = _neighbors(sheet, np.repeat(counts, np.diff(first, append=angle.size)), phi, angle)
    move = target - sheet
    mirrored = np.abs(move) == 1.0
    border = np.where(move > 0.0, sheet + 1.0, sheet)
    return _Sheets(
        np.where(mirrored, -sheets.sign, sheets.sign), np.where(mirrored, 2.0 * border - sheets.turns, sheets.turns)
    )


def _neighbors(sheet: Float, counts: Bool, phi: Float, angle: Float) -> Float:
    """Sheet of every row: its own where that counts, else of the rows that do, changing at the smallest rotation."""
    sure = np.flatnonzero(counts)
    if not sure.size:
        return np.full(sheet.size, sheet[np.argmax(np.abs(angle))])
    after = np.searchsorted(sure, np.arange(sheet.size))
    earlier = sheet[sure[np.clip(after - 1, 0, None)]]
    later = sheet[sure[np.clip(after, None, sure.size - 1)]]
    changes = ~counts & (earlier != later)
    target = np.where(counts, sheet, earlier)
    doubtful = np.flatnonzero(changes)
    if doubtful.size:
        group = after[doubtful]
        begins = np.flatnonzero(np.diff(group, prepend=-1))
        number = np.repeat(np.arange(begins.size), np.diff(begins, append=group.size))
        least = np.minimum.reduceat(phi[doubtful], begins)
        nearest = np.flatnonzero(phi[doubtful] == least[number])
        at = nearest[np.flatnonzero(np.diff(number[nearest], prepend=-1))]
        past = np.arange(doubtful.size) > at[number]
        target[doubtful[past]] = later[doubtful[past]]
    return target


def _larger_excursion(angle: Float) -> tuple[float, bool]:
    """Sign that makes the larger excursion positive, or of two equal ones the first, and whether they are equal."""
    if not angle.size:
        return 1.0, False
    up, down = max(float(angle.max()), 0.0), max(-float(angle.min()), 0.0)
    if up == down == 0.0 or abs(up - down) > _TIE * (up + down):
        return (1.0 if up >= down else -1.0), False
    first = angle[np.argmax(np.abs(angle) > 0.5 * max(up, down))]
    return (1.0 if first > 0.0 else -1.0), True


def _beyond_geodesic(angle: Float, quat: Float, rows: Index) -> Float:
    """How far theta moves beyond the rotation between rows that are adjacent; 0 between those that are not."""
    if rows.size < 2:
        return np.zeros(0)
    before, after = np.ascontiguousarray(quat.T)[:, :-1], np.ascontiguousarray(quat.T)[:, 1:]
    apart, together = row_length(after - before), row_length(after + before)
    geodesic = 4.0 * np.arctan2(np.minimum(apart, together), np.maximum(apart, together))
    beyond: Float = np.where(np.diff(rows) == 1, np.abs(np.diff(angle)) - geodesic, 0.0)
    return beyond


def _wrapped(angle: Float) -> Float:
    """Angle from -pi up to pi."""
    wrapped: Float = (angle + np.pi) % _TURN - np.pi
    return wrapped


def _spread(values: Float, rows: Index, count: int) -> Float:
    """Values of the known rows among all of them."""
    found = np.full(count, np.nan)
    found[rows] = values
    return found
