"""A motion rebuilt from its keyframes alone."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew.errors import SettingError
from elbowscrew.geometry.dual_quaternion import pose_from_dual_quat
from elbowscrew.model import Analysis, Keyframes, KeyframeSet, ModelPhases, RebuiltMotion
from elbowscrew.motion.interpolation.laws import named_law
from elbowscrew.motion.interpolation.modeling import METHODS, model_motion
from elbowscrew.motion.screws.frames import frame_called
from elbowscrew.motion.screws.helical import helical_series
from elbowscrew.motion.screws.relative import expressed

Float = NDArray[np.float64]

_MIN_ANGLE: Final = float(np.radians(10.0))


def keyframes_of(analysis: Analysis) -> KeyframeSet:
    """Give the keyframes of a model, with all that rebuilds its motion.

    Parameters
    ----------
    analysis : Analysis

    Returns
    -------
    KeyframeSet
        What stands in ``keyframes.csv``.

    Examples
    --------
    >>> import elbowscrew
    >>> analysis = elbowscrew.analyze(elbowscrew.simulate_trial(marker_noise_mm=0).recording)
    >>> keyframes_of(analysis).knot
    array([0., 1., 2.])
    """
    keyframes, settings = analysis.keyframes, analysis.settings
    phases, rows = keyframes.phases, keyframes.row
    bounds = keyframes.phase_bounds
    if len(keyframes.knots) == phases.count:
        parts = [p + knots[: None if p == phases.count - 1 else -1] for p, knots in enumerate(keyframes.knots)]
        knot = np.concatenate(parts)
    else:
        knot = phases.count * keyframes.knots[0]
    J = analysis.joint
    D = expressed(analysis.displacement[rows], J, frame_called(settings.express_in, analysis.named_joint)[0])
    time_s = analysis.screw.time_s[0] + analysis.elapsed
    return KeyframeSet(
        frame=keyframes.frame,
        time_s=time_s[rows],
        phase=np.searchsorted(bounds[1:-1], np.arange(rows.size), side="right").astype(np.int64) + 1,
        knot=knot,
        angle=analysis.screw.angle[rows],
        dual_quat=D,
        method=settings.model_method,
        blend=settings.blend,
        law=analysis.laws,
        law_start_s=time_s[phases.law_rows[:, 0]],
        law_end_s=time_s[phases.law_rows[:, 1]],
    )


def interpolate(keyframes: KeyframeSet, frames: int) -> RebuiltMotion:
    """Rebuild the motion between keyframes, frames evenly in time from the first to the last.

    Parameters
    ----------
    keyframes : KeyframeSet
        From `keyframes_of`, or read by `elbowscrew.read_keyframes`.
    frames : int
        Two at least.

    Returns
    -------
    RebuiltMotion
        The angle is 0 where there is no displacement, and positive where it is largest.

    Raises
    ------
    SettingError
        If a law is not known in closed form, or the poses cannot be blended so.

    References
    ----------
    P 30-36.

    Examples
    --------
    >>> import elbowscrew
    >>> analysis = elbowscrew.analyze(elbowscrew.simulate_trial(marker_noise_mm=0).recording)
    >>> motion = interpolate(keyframes_of(analysis), 450)
    >>> bool(np.abs(motion.angle - analysis.interpolated.angle).max() < 1e-9)
    True
    """
    laws = [named_law(law.name, law.peak).position for law in keyframes.law]
    wanted = np.linspace(keyframes.time_s[0], keyframes.time_s[-1], frames)
    # One clock that has the frames wanted, the keyframes, and the times between which the laws run.
    time_s = np.unique(np.concatenate([wanted, keyframes.time_s, keyframes.law_start_s, keyframes.law_end_s]))
    row = np.searchsorted(time_s, keyframes.time_s)
    pose = np.full((time_s.size, 8), np.nan)
    pose[row] = keyframes.dual_quat
    count = len(keyframes.law)
    first = np.flatnonzero(np.diff(keyframes.phase, prepend=0))
    bounds = np.concatenate([first, [row.size - 1]])
    law_rows = np.column_stack([np.searchsorted(time_s, t) for t in (keyframes.law_start_s, keyframes.law_end_s)])
    phases = ModelPhases(bound_rows=row[bounds], law_rows=law_rows)
    if keyframes.blend == "piecewise":
        knots = tuple(keyframes.knot[bounds[p] : bounds[p + 1] + 1] - p for p in range(count))
    else:
        knots = (keyframes.knot / count,)
    modeled = model_motion(
        pose,
        time_s,
        Keyframes(row=row, frame=keyframes.frame, phases=phases, knots=knots),
        METHODS[keyframes.method],
        laws,
    )
    chosen = np.searchsorted(time_s, wanted)
    D = modeled.dual_quat[chosen]
    known = np.flatnonzero(np.isfinite(D[:, 0]))
    if not known.size:
        msg = "the blended poses cancel in every frame: no motion comes out; give keyframes closer together"
        raise SettingError(msg)
    least = int(known[np.argmin(np.linalg.norm(D[known, 1:4], axis=1))])
    series = helical_series(D, _MIN_ANGLE, least)
    if series.angle[known[np.argmax(np.abs(series.angle[known]))]] < 0.0:
        series = series.reversed()
    return RebuiltMotion(
        frame=np.arange(frames, dtype=np.int64),
        time_s=wanted,
        phase=modeled.phase[chosen],
        fraction=modeled.fraction[chosen],
        angle=series.angle,
        slide=series.slide,
        euler_parameters=D[:, :4],
        translation=pose_from_dual_quat(D)[1],
    )
