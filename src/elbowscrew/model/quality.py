"""Figures that tell how far a recording can be trusted, in SI units and radians."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class Spread:
    """Median, 95th percentile and largest of some lengths, meters."""

    median: float
    percentile_95: float
    largest: float


@dataclass(frozen=True, slots=True, kw_only=True)
class BodyQuality:
    """Figures of one body.

    Attributes
    ----------
    name, identifier : str
    tracked_share : float
        Share of frames with a measured pose.
    lost_frames : mapping of str to int
        Lost frames by reason.
    sign_flips, leaps : int
        Changes of the quaternion's sign; steps beyond the limits.
    fastest_turn, fastest_speed : float
        Between successive measured poses: rad/s and m/s, the latter None of a body without positions.
    marker_residual, reported_error : Spread or None
        RMS distance of the markers seen from the body's own; the error column of the file.
    pivot_offset : float or None
        Distance of the body's origin from the centroid of its markers, meters.
    shape_deviation : float or None
        Largest distance of the triangular factor from the identity, where poses come of the dual QR decomposition.
    markers : int
    """

    name: str
    identifier: str
    tracked_share: float
    lost_frames: Mapping[str, int]
    sign_flips: int
    leaps: int
    fastest_turn: float
    fastest_speed: float | None
    marker_residual: Spread | None
    reported_error: Spread | None
    pivot_offset: float | None
    shape_deviation: float | None
    markers: int


@dataclass(frozen=True, slots=True, kw_only=True)
class ClockQuality:
    """Figures of the clock.

    Attributes
    ----------
    missing_frames, frame_gaps : int
        Frame numbers left out, and in how many places.
    repeated_frames : int
        Places where the frame number does not increase.
    largest_offset_s : float
        How far the times stray from an even clock.
    """

    missing_frames: int
    frame_gaps: int
    repeated_frames: int
    largest_offset_s: float
