"""A recording on another clock: evenly at a rate of choice."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from elbowscrew.errors import SettingError
from elbowscrew.geometry import sclerp
from elbowscrew.geometry.arrays import Bool, Float, Index
from elbowscrew.geometry.dual_quaternion import align_signs
from elbowscrew.model import MarkerMotion, QualityWarning, Recording, RigidBody, TrackingLoss
from elbowscrew.motion.tracking.clock import elapsed_time, step_ratios

_MOST_FRAMES: Final = 10_000_000
_LONGEST_STEP_FRAMES: Final = 1.5
# So near to a frame, as a share of the step, a time is that frame's: the rounding of ten million frames is less.
_SAME: Final = 1e-7
_ROUNDING: Final = 1e-12


def resample_recording(
    recording: Recording, rate_hz: float, broken_rows: Index | None = None, elapsed: Float | None = None
) -> Recording:
    """Put a recording on an even clock, by interpolation between neighboring frames.

    Poses go by ScLERP, positions of markers and figures of the bodies linearly; nothing is interpolated across a frame
    that is lost, missing in the file, or reached by a leap. Take out what is not a measurement (`tracked_bodies`) and
    build bodies from markers first: between a true and a false pose all poses are false, and markers interpolated on
    straight lines make a smaller cluster. Interpolation also takes noise away, unevenly over the frames.

    Parameters
    ----------
    recording : Recording
        Interpolated over its clock.
    rate_hz : float
        Frames per second of the result.
    broken_rows : ndarray of int, optional
        Rows that a body reaches by a leap: what lies between one of them and the row before is lost.
    elapsed : ndarray, shape (N,), optional
        The recording's clock; that by `elapsed_time` if it is not given.

    Returns
    -------
    Recording
        From the first to the last time of the recording, frames numbered from 0. A frame that is lost has the reason
        of the nearer one of its lost neighbors. A note tells of the resampling, and a warning of the motion that folds
        into a lower rate.

    Raises
    ------
    SettingError
        If the rate gives fewer than 2 frames or more than 10 million.
    RecordingError
        If the recording has no usable clock.

    References
    ----------
    P 30-31 (ScLERP).

    Examples
    --------
    >>> from elbowscrew import simulate_trial
    >>> trial = resample_recording(simulate_trial().recording, 50.0)
    >>> trial.rate_hz, trial.frame.size, [warning.code for warning in trial.warnings]
    (50.0, 225, ['resampled', 'aliasing'])
    """
    elapsed = elapsed_time(recording) if elapsed is None else elapsed
    count = _frame_count(recording, elapsed, rate_hz)
    since_start = np.arange(count) / rate_hz
    between = _neighbors(elapsed, since_start, recording.rate_hz, broken_rows)
    return replace(
        recording,
        bodies=tuple(_resampled_body(body, between) for body in recording.bodies),
        frame=np.arange(count, dtype=np.int64),
        time_s=recording.time_s[0] + since_start,
        rate_hz=float(rate_hz),
        markers=tuple(replace(marker, position=_linear(marker.position, between)) for marker in recording.markers),
        warnings=recording.warnings + resampling_warnings(recording.rate_hz, rate_hz),
    )


def linear_at(values: Float, elapsed: Float, wanted: Float, rate_hz: float) -> Float:
    """Values (N, ...) of one clock at the times of another; NaN beside a NaN and where frames are missing between.

    Parameters
    ----------
    values : ndarray, shape (N, ...)
    elapsed, wanted : ndarray, shape (N,) and (K,)
        Seconds.
    rate_hz : float
        Frames per second of the values.
    """
    return _linear(values, _neighbors(elapsed, wanted, rate_hz, None))


def _frame_count(recording: Recording, elapsed: Float, rate_hz: float) -> int:
    duration_s = float(elapsed[-1]) if elapsed.size else 0.0
    possible = 0.0 < rate_hz < np.inf
    frames = np.floor(duration_s * rate_hz * (1.0 + _ROUNDING)) + 1.0 if possible else 0.0
    if 2.0 <= frames <= _MOST_FRAMES:
        return int(frames)
    found = f"{frames:.0f} in {duration_s:g} s" if possible else "no rate"
    msg = (
        f"--resample {rate_hz:g}: expected a rate above 0 that gives 2 to {_MOST_FRAMES} frames, found {found}; "
        f"the recording's own rate is {recording.rate_hz:g} frames per second"
    )
    raise SettingError(msg)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Neighbors:
    """The rows before and after each time, how far it is from the one to the other, and which row it is the time of.

    Attributes
    ----------
    before, after, nearer : ndarray of int, shape (K,)
    fraction : ndarray, shape (K,)
    same : ndarray of bool, shape (K,)
        Where the time is that of the nearer row.
    apart : ndarray of bool, shape (K,)
        Where frames are missing between the two rows.
    broken : ndarray of bool, shape (K,)
        Where a leap lies between them.
    """

    before: Index
    after: Index
    nearer: Index
    fraction: Float
    same: Bool
    apart: Bool
    broken: Bool


def _neighbors(elapsed: Float, wanted: Float, rate_hz: float, broken_rows: Index | None) -> _Neighbors:
    before = np.clip(np.searchsorted(elapsed, wanted, side="right") - 1, 0, elapsed.size - 2)
    after = before + 1
    fraction = np.clip((wanted - elapsed[before]) / (elapsed[after] - elapsed[before]), 0.0, 1.0)
    same = np.minimum(fraction, 1.0 - fraction) <= _SAME
    return _Neighbors(
        before=before,
        after=after,
        nearer=np.where(fraction < 0.5, before, after),
        fraction=fraction,
        same=same,
        apart=~same & (step_ratios(elapsed, rate_hz)[before] > _LONGEST_STEP_FRAMES),
        broken=~same & np.isin(after, [] if broken_rows is None else broken_rows),
    )


def _resampled_body(body: RigidBody, between: _Neighbors) -> RigidBody:
    before, after, nearer = between.before, between.after, between.nearer
    farther = before + after - nearer
    loss = body.loss[nearer]
    lost_only_farther = ~between.same & (loss == TrackingLoss.NONE)
    loss[lost_only_farther] = body.loss[farther[lost_only_farther]]
    known = loss == TrackingLoss.NONE
    loss[known & between.broken] = TrackingLoss.LEAP
    loss[known & between.apart] = TrackingLoss.ABSENT
    start, end = body.dual_quat_lab_body[before], body.dual_quat_lab_body[after]
    pose = sclerp(start, end, between.fraction)
    # A body that stands still does so to the last digit: the checks of tracking look for that.
    still = (align_signs(end, start) == start).all(axis=1)
    pose = np.where((between.same | still)[:, None], body.dual_quat_lab_body[nearer], pose)
    return replace(
        body,
        dual_quat_lab_body=np.where((loss != TrackingLoss.NONE)[:, None], np.nan, pose),
        loss=loss,
        reported_error=_optional_linear(body.reported_error, between),
        marker_residual=_optional_linear(body.marker_residual, between),
        marker_motion=None if body.marker_motion is None else _motion_on(body.marker_motion, between),
        shape_deviation=_optional_linear(body.shape_deviation, between),
    )


def _motion_on(motion: MarkerMotion, between: _Neighbors) -> MarkerMotion:
    """The same frames, by the rows of the new clock that they lie between."""
    old = between.before + between.fraction
    return replace(motion, row=np.interp(motion.row, old, np.arange(old.size, dtype=np.float64)))


def _linear(values: Float, between: _Neighbors) -> Float:
    """Values (N, ...) at the times wanted; NaN beside a NaN, and where frames are missing or a leap lies between."""
    shape = (-1,) + (1,) * (values.ndim - 1)
    fraction = between.fraction.reshape(shape)
    blend = (1.0 - fraction) * values[between.before] + fraction * values[between.after]
    blend = np.where((between.apart | between.broken).reshape(shape), np.nan, blend)
    return np.where(between.same.reshape(shape), values[between.nearer], blend)


def _optional_linear(values: Float | None, between: _Neighbors) -> Float | None:
    return None if values is None else _linear(values, between)


def resampling_warnings(old_hz: float, new_hz: float, given: Sequence[str] = ()) -> tuple[QualityWarning, ...]:
    """Give the note of a change of rate, and the warning of what folds into a lower one.

    It is a warning where options (`given`) name frames: those may be meant as the file counts them.
    """
    message = f"resampled from {old_hz:g} to {new_hz:g} frames per second: frame numbers count from 0 at the first time"
    if given:
        message += f", also those of {' and '.join(given)}: they are not the file's"
    note = QualityWarning(code="resampled", message=message, severity="warning" if given else "note")
    if new_hz >= old_hz:
        return (note,)
    message = (
        f"the rate is lowered from {old_hz:g} to {new_hz:g} frames per second: motion and noise above "
        f"{0.5 * new_hz:g} Hz fold into what is below, unless they are filtered out first (--lowpass)"
    )
    return (note, QualityWarning(code="aliasing", message=message))
