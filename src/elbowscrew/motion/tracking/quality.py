"""How far a recording can be trusted: figures of each body and of the clock, and warnings where they are bad."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowscrew.geometry.arrays import Float
from elbowscrew.model import BodyQuality, ClockQuality, QualityWarning, Recording, RigidBody, Spread
from elbowscrew.motion.difference import turn_and_distance
from elbowscrew.motion.tracking.body_pairs import (
    check_same_pose,
    check_swaps,
    constant_positions_warning,
    turns_on_the_spot,
)
from elbowscrew.motion.tracking.clock import allowed_offset, elapsed_time
from elbowscrew.motion.tracking.inserted import inserted_warnings
from elbowscrew.motion.tracking.losses import frames_warning, poses_at
from elbowscrew.motion.tracking.lost_poses import CheckedBody, check_tracking
from elbowscrew.quantities import in_digits
from elbowscrew.settings import Settings

_LARGE_RESIDUAL_M: Final = 0.005
_FAR_PIVOT_M: Final = 0.02


class CheckedRecording(NamedTuple):
    """Result of `check_bodies`.

    Attributes
    ----------
    elapsed : ndarray, shape (N,)
        Clock, as by `elapsed_time`.
    bodies : tuple of CheckedBody
        In the order of the bodies.
    quality : tuple of BodyQuality
        Theirs.
    warnings : tuple of QualityWarning
        Those of the bodies, of pairs of them, and of the clock; the recording's own are not among them.
    """

    elapsed: Float
    bodies: tuple[CheckedBody, ...]
    quality: tuple[BodyQuality, ...]
    warnings: tuple[QualityWarning, ...]


def check_bodies(recording: Recording, bodies: tuple[RigidBody, ...], settings: Settings) -> CheckedRecording:
    """Take out what is not a measurement, and collect all there is to say about these bodies and the clock.

    Raises
    ------
    RecordingError
        If the recording has no usable clock.
    """
    elapsed = elapsed_time(recording)
    checked = tuple(check_tracking(body, recording, elapsed, settings) for body in bodies)
    flips = tuple(_sign_flips(body) for body in bodies)
    warnings = list(clock_warnings(recording))
    for body, found, flipped in zip(bodies, checked, flips, strict=True):
        warnings += found.warnings
        warnings += _sign_flip_warnings(body, flipped, recording)
        warnings += [warning for check in BODY_CHECKS for warning in check(body, recording)]
    on_the_spot = [found.body.name for found in checked if turns_on_the_spot(found.body)]
    if len(on_the_spot) > 1:
        warnings.append(constant_positions_warning(on_the_spot))
        checked = tuple(
            replace(found, body=found.body.without_positions()) if turns_on_the_spot(found.body) else found
            for found in checked
        )
    for one, other in combinations(bodies, 2):
        warnings += check_same_pose(one, other)
        warnings += check_swaps(one, other, recording, elapsed)
    quality = tuple(_body_quality(found, flipped.size, elapsed) for found, flipped in zip(checked, flips, strict=True))
    return CheckedRecording(elapsed, checked, quality, tuple(warnings))


def _body_quality(checked: CheckedBody, sign_flips: int, elapsed: Float) -> BodyQuality:
    """Figures of one body, of the poses that count as measured."""
    body = checked.body
    known = np.flatnonzero(body.tracked)
    span = np.diff(elapsed[known])
    pose = poses_at(body.dual_quat_lab_body, known)
    turn, distance = turn_and_distance(pose[:-1], pose[1:])
    return BodyQuality(
        name=body.name,
        identifier=body.identifier,
        tracked_share=float(body.tracked.mean()) if body.loss.size else 0.0,
        lost_frames=body.loss_counts(),
        sign_flips=sign_flips,
        leaps=int(checked.leap_rows.size),
        fastest_turn=float((turn / span).max(initial=0.0)),
        fastest_speed=float((distance / span).max(initial=0.0)) if body.located else None,
        marker_residual=_spread(body.marker_residual, body),
        reported_error=_spread(body.reported_error, body),
        pivot_offset=None if body.marker_offsets is None else float(np.linalg.norm(body.marker_offsets.mean(axis=0))),
        shape_deviation=_largest(body.shape_deviation, body),
        markers=0 if body.marker_offsets is None else len(body.marker_offsets),
    )


def clock_quality(recording: Recording) -> ClockQuality:
    """Figures of the clock."""
    frame, time_s = recording.frame, recording.time_s
    steps = np.diff(frame)
    even = (frame - frame[0]) / recording.rate_hz
    offset = time_s - time_s[0] - even
    return ClockQuality(
        missing_frames=int((steps[steps > 1] - 1).sum()),
        frame_gaps=int((steps > 1).sum()),
        repeated_frames=int((steps <= 0).sum()),
        largest_offset_s=float(np.ptp(offset)) if offset.size else 0.0,
    )


def clock_warnings(recording: Recording) -> tuple[QualityWarning, ...]:
    """Warnings about frames that are missing or stand twice, and about times that do not keep step with them."""
    quality = clock_quality(recording)
    found = []
    steps = np.diff(recording.frame)
    if quality.frame_gaps:
        rows = np.flatnonzero(steps > 1) + 1
        message = (
            f"{quality.missing_frames} frames are not in the file, in {quality.frame_gaps} places, the first before "
            f"frame {recording.frame[rows[0]]}: taken as gaps in time"
        )
        found.append(frames_warning("missing-frames", message, rows, recording))
    if quality.repeated_frames:
        rows = np.flatnonzero(steps <= 0) + 1
        message = (
            f"frame numbers do not increase in {quality.repeated_frames} places, the first at frame "
            f"{recording.frame[rows[0]]}: the times are taken as the clock"
        )
        found.append(frames_warning("frame-numbers", message, rows, recording))
    elif quality.largest_offset_s > allowed_offset(recording):
        message = (
            f"times stray from the frame numbers by up to {in_digits(1000 * quality.largest_offset_s, 3)} ms: "
            "the times are taken as the clock"
        )
        found.append(QualityWarning(code="irregular-clock", message=message))
    return tuple(found)


def _sign_flip_warnings(body: RigidBody, flips: NDArray[np.intp], recording: Recording) -> list[QualityWarning]:
    if not flips.size:
        return []
    message = (
        f"the quaternion of body {body.name!r} changes its sign {flips.size} times: the same poses, made continuous"
    )
    return [frames_warning("sign-flips", message, flips, recording, "note")]


def _residual_warnings(body: RigidBody, recording: Recording) -> list[QualityWarning]:
    if body.marker_residual is None:
        return []
    rows = np.flatnonzero(np.nan_to_num(body.marker_residual) > _LARGE_RESIDUAL_M)
    if not rows.size:
        return []
    message = (
        f"the markers of body {body.name!r} do not fit it in {rows.size} frames (RMS over "
        f"{1000 * _LARGE_RESIDUAL_M:g} mm, at most {in_digits(1000 * np.nanmax(body.marker_residual), 3)} mm): "
        "not rigid, mislabeled or swapped"
    )
    return [frames_warning("marker-residual", message, rows, recording)]


def _pivot_warnings(body: RigidBody, _recording: Recording) -> list[QualityWarning]:
    if body.marker_offsets is None:
        return []
    pivot = float(np.linalg.norm(body.marker_offsets.mean(axis=0)))
    if not pivot > _FAR_PIVOT_M:
        return []
    message = (
        f"the origin of body {body.name!r} lies {1000 * pivot:.0f} mm from the centroid of its markers: "
        "it is not the barycenter that the paper assumes (the axis does not depend on it)"
    )
    return [QualityWarning(code="pivot-offset", message=message, severity="note")]


BODY_CHECKS: Final = (_residual_warnings, _pivot_warnings, inserted_warnings)
"""A new check of a body is one function and one entry here."""


def _sign_flips(body: RigidBody) -> NDArray[np.intp]:
    """Rows at which the quaternion, as it is in the file, has the other sign than in the last frame."""
    known = np.flatnonzero(body.tracked)
    real = poses_at(body.dual_quat_lab_body, known)[:, :4]
    flips: NDArray[np.intp] = known[1:][np.sum(real[1:] * real[:-1], axis=1) < 0.0]
    return flips


def _largest(values: Float | None, body: RigidBody) -> float | None:
    return None if values is None else float(np.nan_to_num(values[body.tracked]).max(initial=0.0))


def _spread(values: Float | None, body: RigidBody) -> Spread | None:
    if values is None:
        return None
    counted = values[body.tracked & np.isfinite(values)]
    if not counted.size:
        return None
    median, high = np.percentile(counted, [50, 95])
    return Spread(median=float(median), percentile_95=float(high), largest=float(counted.max()))
