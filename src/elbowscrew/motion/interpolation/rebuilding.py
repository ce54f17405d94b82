"""A motion rebuilt from its keyframes alone."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew.errors import SettingError
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import pose_from_dual_quat
from elbowscrew.model import Analysis, Keyframes, KeyframeSet, ModelPhases, RebuiltMotion
from elbowscrew.motion.interpolation.laws import named_law
from elbowscrew.motion.interpolation.modeling import METHODS, Method, joint_method, model_motion
from elbowscrew.motion.joint.coordinates import expressed_angles, expressed_joint
from elbowscrew.motion.screws.frames import frame_called
from elbowscrew.motion.screws.helical import helical_series
from elbowscrew.motion.screws.relative import expressed, frame_change
from elbowscrew.motion.screws.sense import sense_of

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
    J, express_in = analysis.joint, frame_called(settings.express_in, analysis.named_joint)[0]
    D = expressed(analysis.displacement[rows], J, express_in)
    joint, angle = keyframes.joint, keyframes.joint_angle
    if joint is not None and angle is not None:
        change = frame_change(J, express_in)
        joint, angle = expressed_joint(joint, change), expressed_angles(joint, angle, change)
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
        joint=joint,
        joint_angle=angle,
        located=J.located,
    )


def interpolate(keyframes: KeyframeSet, frames: int) -> RebuiltMotion:
    """Rebuild the motion between keyframes; see `elbowscrew.interpolate`.

    Raises
    ------
    SettingError
        If a law is not known in closed form, or the poses cannot be blended so.
    """
    laws = [named_law(law.name, law.peak).position for law in keyframes.law]
    wanted = np.linspace(keyframes.time_s[0], keyframes.time_s[-1], frames)
    # One clock that has the frames wanted, the keyframes, and the times between which the laws run.
    time_s = np.unique(np.concatenate([wanted, keyframes.time_s, keyframes.law_start_s, keyframes.law_end_s]))
    row = np.searchsorted(time_s, keyframes.time_s)
    of_keyframes, method = _coordinates(keyframes)
    coordinates = np.full((time_s.size, of_keyframes.shape[1]), np.nan)
    coordinates[row] = of_keyframes
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
        coordinates,
        time_s,
        Keyframes(row=row, frame=keyframes.frame, phases=phases, knots=knots),
        method,
        laws,
    )
    chosen = np.searchsorted(time_s, wanted)
    D = modeled.dual_quat[chosen]
    if not np.isfinite(D[:, 0]).any():
        msg = "the blended poses cancel in every frame: no motion comes out; give keyframes closer together"
        raise SettingError(msg)
    angle, sign = _angle_of_keyframes(modeled.dual_quat[:, :4], time_s, row, keyframes.angle)
    series = helical_series(D, _MIN_ANGLE, angle[chosen], sign[chosen])
    return RebuiltMotion(
        frame=np.arange(frames, dtype=np.int64),
        time_s=wanted,
        phase=modeled.phase[chosen],
        fraction=modeled.fraction[chosen],
        angle=series.angle,
        slide=series.slide if keyframes.located else np.full(frames, np.nan),
        euler_parameters=D[:, :4],
        translation=pose_from_dual_quat(D)[1] if keyframes.located else np.full((frames, 3), np.nan),
    )


def _coordinates(keyframes: KeyframeSet) -> tuple[Float, Method]:
    """Give what is interpolated between the keyframes, and how."""
    if keyframes.method != "joint":
        return keyframes.dual_quat, METHODS[keyframes.method]
    if keyframes.joint is None or keyframes.joint_angle is None:
        msg = "--method joint: these keyframes do not tell of a joint; give another, such as --method sclerp"
        raise SettingError(msg)
    return keyframes.joint_angle, joint_method(keyframes.joint)


def _angle_of_keyframes(quat: Float, time_s: Float, row: NDArray[np.intp], wanted: Float) -> tuple[Float, Float]:
    """Theta of rebuilt poses and the sign of its axis, with the sense, or without one, that the keyframes have."""
    least = int(row[np.argmin(np.abs(wanted))])
    known = np.isfinite(quat[row, 0]) & np.isfinite(wanted)
    found = []
    for choice in ("yes", "no"):
        sense = sense_of(quat, time_s, least, sigma=0.0, signed=choice)
        for way in (1.0, -1.0) if sense.signed else (1.0,):
            offset = way * sense.angle[row][known] - wanted[known]
            whole = 2.0 * np.pi * np.round(np.median(offset) / (2.0 * np.pi)) if sense.signed and known.any() else 0.0
            found.append((float(np.sum((offset - whole) ** 2)), way * sense.angle - whole, way * sense.sign))
    best = min(found, key=lambda one: one[0])
    return best[1], best[2]
