"""The instantaneous helical axis, from the twist of the motion."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import point_nearest_origin
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.twist import instantaneous_screw
from elbowscrew.model import InstantaneousMotion
from elbowscrew.motion.smoothing.smoothing import inside

_BLOCK: Final = 16384


def twists(displacement: Float, known: NDArray[np.bool_], elapsed: Float, rate_hz: float, margin: int) -> Float:
    """Twist of every frame, shape (N, 6), rad/s and m/s, from the poses on either side of it.

    It is that of the screw that leads from the pose before to the pose after, over the time between them: exact
    for a steady screw motion. It is not given near a gap, where a filter leaves most of the noise.

    Parameters
    ----------
    displacement : ndarray, shape (N, 8)
        Smooth: the twist of unfiltered poses is mostly noise.
    known : ndarray of bool, shape (N,)
        Where it was measured.
    elapsed : ndarray, shape (N,)
        Seconds.
    rate_hz : float
    margin : int
        Frames to either side that must be measured, too; 1 at least.

    References
    ----------
    The twist ``2 Q' Q*``; Woltring 1994, Human Movement Science 13.
    """
    twist = np.full((len(displacement), 6), np.nan)
    inner = np.flatnonzero(inside(np.isfinite(displacement[:, 0]) & known, elapsed, rate_hz, margin))
    for rows in np.array_split(inner, -(-inner.size // _BLOCK) or 1):
        span = elapsed[rows + 1] - elapsed[rows - 1]
        step = dq.multiply(displacement[rows + 1], dq.conjugate(displacement[rows - 1]))
        twist[rows] = 2.0 * dq.log(dq.canonical(step)) / span[:, None]
    return twist


def instantaneous_motion(
    twist: Float,
    frame: NDArray[np.int64],
    time_s: Float,
    min_rate: float,
    sense: Float,
    lowpass_hz: float | None,
) -> InstantaneousMotion:
    """Instantaneous helical axis of every frame, from its twist.

    Parameters
    ----------
    twist : ndarray, shape (N, 6)
        `twists` of the frames: rad/s and m/s.
    frame : ndarray of int64, shape (N,)
    time_s : ndarray, shape (N,)
        The file's times, seconds.
    min_rate : float
        Angular velocity (rad/s) below which there is no axis.
    sense : ndarray, shape (3,)
        Direction about which a positive angular velocity turns.
    lowpass_hz : float or None
        Cut-off of the filter that the poses went through.
    """
    screw = instantaneous_screw(twist)
    sign = np.where(np.nan_to_num(screw.line[:, :3]) @ sense < 0.0, -1.0, 1.0)
    gated = ~(screw.rate >= min_rate)
    line = screw.line * sign[:, None]
    slide_rate = screw.pitch * screw.rate * sign
    line[gated], slide_rate[gated] = np.nan, np.nan
    return InstantaneousMotion(
        frame=frame,
        time_s=time_s,
        lowpass_hz=lowpass_hz,
        angular_velocity=screw.rate * sign,
        slide_velocity=slide_rate,
        axis_direction=line[:, :3].copy(),  # a view would keep all of the line
        axis_point=point_nearest_origin(line),
    )
