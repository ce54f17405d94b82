"""Figures of every repetition, and how alike the repetitions are."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew.geometry._small_angle import divide, length
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.lines import direction_between, piercing
from elbowscrew.model import CycleCurves, QualityWarning, Repeatability, Repetitions, ScrewMotion
from elbowscrew.motion.axes.mean_axis import mean_line_of
from elbowscrew.motion.movements.boundaries import Cycles
from elbowscrew.motion.movements.phases import nearest_rows
from elbowscrew.motion.movements.unseen import Gaps, gaps_of

_POINTS: Final = 101
_CYCLES_TOLD: Final = 6
_ABOVE_LEAST: Final = 1.5
_HIDDEN_SHARE: Final = 0.02  # of the range of a cycle: less than this does not make its largest angle unknown
_FAST_SHARE: Final = 0.5  # of the highest speed; beside slower frames the highest one is not looked for


def repetitions_of(
    cycles: Cycles, screw: ScrewMotion, line: Float, angular_velocity: Float, elapsed: Float, least_rate: float = 0.0
) -> Repetitions:
    """Figures of every cycle.

    Parameters
    ----------
    cycles : Cycles
    screw : ScrewMotion
    line : ndarray, shape (N, 6)
        Axes of the frames, NaN where there is none.
    angular_velocity, elapsed : ndarray, shape (N,)
        rad/s and seconds.
    least_rate : float
        Angular velocities under it (rad/s) are not given.

    Returns
    -------
    Repetitions
        The largest angle and the range are those of the frames from start to end; NaN where the angle may have gone
        farther in a gap.
    """
    count = cycles.start_s.size
    time = elapsed - elapsed[0]
    start, top, end = (nearest_rows(elapsed, seconds) for seconds in cycles.times_s.T)
    direction, point = np.full((count, 3), np.nan), np.full((count, 3), np.nan)
    slide_range, highest, span = np.full((3, count), np.nan)
    speed = np.full((count, 2), np.nan)
    moving = np.flatnonzero(np.isfinite(angular_velocity))
    given = (int(moving[0]), int(moving[-1])) if moving.size else (0, 0)
    # A pose that is filled in goes straight on over a top.
    gaps = gaps_of(np.where(screw.filled, np.nan, screw.angle), time)
    unseen = _mean_in_gaps(screw.angle, angular_velocity, time)
    for k, (first, turn, last) in enumerate(zip(start.tolist(), top.tolist(), end.tolist(), strict=True)):
        rows = slice(first, last + 1)
        known = first + np.flatnonzero(screw.valid[rows] & np.isfinite(line[rows]).all(axis=1))
        highest[k], span[k] = _largest(screw.angle, first, last, gaps)
        way = float(cycles.sense[k])
        # What the filter leaves out at the ends of the recording is not lost in it.
        strokes = [(max(given[0], first), first, turn + 1, way), (turn, turn, last + 1, -way)]
        if way != 0.0:
            speed[k] = [
                _highest(to * angular_velocity[begin : min(end, given[1] + 1)], to * unseen[whole:end], least_rate)
                for begin, whole, end, to in strokes
            ][:: int(way)]
        if known.size:
            direction[k], point[k] = mean_line_of(screw.angle[known], line[known])
            slides = screw.slide[rows]
            slide_range[k] = np.ptp(slides[np.isfinite(slides)])
    middle = _mean_direction(direction)
    return Repetitions(
        number=np.arange(1, count + 1),
        start_frame=screw.frame[start],
        inversion_frame=screw.frame[top],
        end_frame=screw.frame[end],
        start_time_s=np.interp(cycles.start_s, time, screw.time_s),
        end_time_s=np.interp(cycles.end_s, time, screw.time_s),
        start_time_sd_s=cycles.start_sd_s,
        end_time_sd_s=cycles.end_sd_s,
        duration_s=cycles.end_s - cycles.start_s,
        incomplete=cycles.incomplete,
        start_angle=_between_frames(cycles.start_s, screw.angle, time),
        top_angle=highest,
        angle_range=span,
        slide_range=slide_range,
        outward_speed=speed[:, 0],
        back_speed=speed[:, 1],
        axis_direction=direction,
        axis_point=point,
        axis_deviation=direction_between(direction, middle),
    )


def cycle_curves_of(cycles: Cycles, angle: Float, elapsed: Float) -> CycleCurves:
    """Every cycle over its time normalized from start to end; the angle is interpolated linearly between frames.

    Parameters
    ----------
    cycles : Cycles
    angle, elapsed : ndarray, shape (N,)
    """
    count, time = cycles.start_s.size, elapsed - elapsed[0]
    percent = np.linspace(0.0, 100.0, _POINTS)
    seconds = cycles.start_s[:, None] + 0.01 * percent * (cycles.end_s - cycles.start_s)[:, None]
    return CycleCurves(
        cycle=np.repeat(np.arange(1, count + 1), _POINTS),
        percent=np.tile(percent, count),
        angle=_between_frames(seconds.ravel(), angle, time),
    )


def repeatability_of(curves: CycleCurves, repetitions: Repetitions, near: Float) -> Repeatability:
    """Mean curve over normalized time, ICC, CMC, and spread of the axes, of two cycles and more.

    Parameters
    ----------
    curves : CycleCurves
    repetitions : Repetitions
    near : ndarray, shape (3,)

    References
    ----------
    McGraw and Wong 1996, ICC(A,1); Kadaba and others 1989, CMC within a day.
    """
    percent = np.linspace(0.0, 100.0, _POINTS)
    angles = curves.angle.reshape(-1, _POINTS)
    count = np.isfinite(angles).sum(axis=0)
    total = np.where(np.isfinite(angles), angles, 0.0)
    mean = divide(total.sum(axis=0), count.astype(np.float64))
    square = np.where(np.isfinite(angles), (angles - mean) ** 2, 0.0).sum(axis=0)
    whole = angles[:, np.isfinite(angles).all(axis=0)]
    axes = repetitions.axis_direction
    return Repeatability(
        percent=percent,
        mean=mean,
        sd=np.where(count > 1, np.sqrt(square / np.maximum(count - 1, 1)), np.nan),
        count=count.astype(np.int64),
        icc=intraclass_correlation(whole.T),
        cmc=multiple_correlation(whole),
        axis_sd=_spread(repetitions.axis_deviation),
        point_sd=_point_spread(axes, repetitions.axis_point, near),
        top_sd=float(np.std(repetitions.top_angle, ddof=1)) if len(angles) > 1 else float("nan"),
    )


def intraclass_correlation(table: Float) -> float:
    """ICC(A,1), two-way, absolute agreement, single measures, of targets by raters.

    Parameters
    ----------
    table : ndarray, shape (n, k)
        Targets in rows (points of time), raters in columns (repetitions).

    Returns
    -------
    float
        NaN of fewer than two of either, and where nothing varies.

    References
    ----------
    McGraw and Wong 1996; with random raters the ICC(2,1) of Shrout and Fleiss 1979.
    """
    n, k = table.shape
    if n < 2 or k < 2:
        return float("nan")
    grand = table.mean()
    rows, columns = table.mean(axis=1), table.mean(axis=0)
    between_rows = k * np.sum((rows - grand) ** 2) / (n - 1)
    between_columns = n * np.sum((columns - grand) ** 2) / (k - 1)
    rest = np.sum((table - rows[:, None] - columns + grand) ** 2) / ((n - 1) * (k - 1))
    whole = between_rows + (k - 1) * rest + k * (between_columns - rest) / n
    return float((between_rows - rest) / whole) if whole > 0.0 else float("nan")


def multiple_correlation(curves: Float) -> float:
    """Coefficient of multiple correlation of curves within a day.

    Parameters
    ----------
    curves : ndarray, shape (R, T)

    Returns
    -------
    float
        1 for curves that are one; NaN for fewer than two, where nothing varies, and where its square is negative.

    References
    ----------
    Kadaba and others 1989, Journal of Orthopaedic Research 7.
    """
    repetitions, points = curves.shape
    if repetitions < 2 or points < 2:
        return float("nan")
    within = np.sum((curves - curves.mean(axis=0)) ** 2) / (points * (repetitions - 1))
    whole = np.sum((curves - curves.mean()) ** 2) / (repetitions * points - 1)
    square = 1.0 - within / whole if whole > 0.0 else -1.0
    return float(np.sqrt(square)) if square >= 0.0 else float("nan")


def _between_frames(seconds: Float, angle: Float, time: Float) -> Float:
    """Angle at times (K,) between frames; NaN where a neighboring frame has none."""
    after = np.clip(np.searchsorted(time, seconds), 1, time.size - 1)
    part = (seconds - time[after - 1]) / (time[after] - time[after - 1])
    # At a frame itself its neighbor does not matter.
    before_angle, after_angle = angle[after - 1], angle[after]
    found = np.where(part <= 0.0, before_angle, (1.0 - part) * before_angle + part * after_angle)
    return np.where(part >= 1.0, after_angle, found)


def _largest(angle: Float, first: int, last: int, gaps: Gaps) -> tuple[float, float]:
    """Largest angle of the rows from first to last, and their range; NaN where it may be larger in a gap."""
    known = angle[first : last + 1][np.isfinite(angle[first : last + 1])]
    if not known.size:
        return float("nan"), float("nan")
    highest, span = float(known.max()), float(np.ptp(known))
    here = (gaps.before < last) & (gaps.after > first)
    more = gaps.highest[here].max(initial=-np.inf) > highest + _HIDDEN_SHARE * span
    less = gaps.lowest[here].min(initial=np.inf) < highest - span - _HIDDEN_SHARE * span
    return float("nan") if more else highest, float("nan") if more or less else span


def _mean_direction(directions: Float) -> Float:
    """Mean of the directions that are known; NaN of one, which has nothing to be off from."""
    known = directions[np.isfinite(directions[:, 0])]
    if len(known) < 2:
        return np.full(3, np.nan)
    total = known.sum(axis=0)
    return divide(total, length(total))


def _spread(values: Float) -> float:
    known = values[np.isfinite(values)]
    return float(np.sqrt(np.sum(known**2) / (known.size - 1))) if known.size > 1 else float("nan")


def _point_spread(directions: Float, points: Float, near: Float) -> float:
    """Standard deviation of where the axes pierce the plane across their mean at the point nearest the body."""
    known = np.isfinite(directions[:, 0])
    if known.sum() < 2:
        return float("nan")
    n, p = directions[known], points[known]
    middle = _mean_direction(n)
    point = piercing(n, p, middle, near)
    return _spread(length(point - point.mean(axis=0)))


def speed_warnings(repetitions: Repetitions, sense: Float) -> tuple[QualityWarning, ...]:
    """Say in which cycles the highest speed is not given, of a motion that has speeds; `sense` is that of `Cycles`."""
    unknown = np.isnan(repetitions.outward_speed) | np.isnan(repetitions.back_speed)
    numbers = repetitions.number[unknown & (sense != 0.0)]
    if not numbers.size:
        return ()
    message = (
        f"the highest speed of a stroke is left empty in {_cycles_called(numbers)}: it may lie where no speed is "
        "known, about lost frames, or the joint turns the other way there (instantaneous.csv)"
    )
    return (QualityWarning(code="speeds-unknown", message=message, count=numbers.size),)


def angle_warnings(repetitions: Repetitions) -> tuple[QualityWarning, ...]:
    """Say in which cycles the largest angle or the range is not given."""
    numbers = repetitions.number[np.isnan(repetitions.angle_range)]
    if not numbers.size:
        return ()
    message = (
        f"the largest theta or its range is left empty in {_cycles_called(numbers)}: by the speeds beside the lost "
        "frames the angle goes farther among them"
    )
    return (QualityWarning(code="angles-unknown", message=message, count=numbers.size),)


def given_warnings(cycles: Cycles) -> tuple[QualityWarning, ...]:
    """Say which of the cycles that were given are none out and back."""
    number = np.arange(1, cycles.sense.size + 1)
    parts = [
        f"{_cycles_called(number[cycles.sense == sense])}: {what}"
        for sense, what in (
            (-1.0, "cut at a top, so that the joint goes back first and then out"),
            (0.0, "without a swing beyond the noise, so that its speeds are left empty"),
        )
        if (cycles.sense == sense).any()
    ]
    if not parts:
        return ()
    return (QualityWarning(code="given-cycles", message=f"of the cycles of --cycles, {'; '.join(parts)}"),)


def _cycles_called(numbers: NDArray[np.int64]) -> str:
    told = ", ".join(map(str, numbers[:_CYCLES_TOLD].tolist())) + (" and others" if numbers.size > _CYCLES_TOLD else "")
    return f"cycle{'s' if numbers.size > 1 else ''} {told}"


def _mean_in_gaps(angle: Float, speed: Float, time: Float) -> Float:
    """Mean speed of each stretch of frames without one, by the angles at its two ends, shape (N,); NaN elsewhere.

    Of an end of the recording it is given where frames are lost there.
    """
    found = np.full(speed.size, np.nan)
    known = np.flatnonzero(np.isfinite(speed) & np.isfinite(angle))
    if not known.size:
        return found
    posed = np.flatnonzero(np.isfinite(angle))
    for end, nearest in ((posed[0], known[0]), (posed[-1], known[-1])):
        if np.isnan(angle[min(end, nearest) : max(end, nearest)]).any():
            known = np.union1d(known, end)
    place = np.searchsorted(known, np.arange(speed.size))
    inside = np.isnan(speed) & (place > 0) & (place < known.size)
    before, after = known[place[inside] - 1], known[place[inside]]
    found[inside] = (angle[after] - angle[before]) / (time[after] - time[before])
    return found


def _highest(speed: Float, unseen: Float, least_rate: float) -> float:
    """Highest of the speeds of a stroke; NaN where it may lie among those that are not known, or is none its way.

    That is beside fast ones, and where the joint is fast in the mean of the frames without a speed (`unseen`). Speeds
    under `least_rate` are not known either, and those beside them little above it.
    """
    known = np.isfinite(speed)
    if not known.any():
        return float("nan")
    highest = float(speed[known].max())
    beside = known & (np.append(~known[1:], False) | np.insert(~known[:-1], 0, False))
    fast = max(_FAST_SHARE * highest, _ABOVE_LEAST * least_rate)
    unknown = (speed[beside] >= fast).any() or (unseen >= fast).any() or highest <= 0.0
    return float("nan") if unknown else highest
