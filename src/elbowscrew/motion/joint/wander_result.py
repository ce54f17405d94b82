"""An axis that wanders, as it is reported: how far, where it is on average, and where it is at each angle."""

from __future__ import annotations

from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np

from elbowscrew.choices import ExpressIn
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import point_nearest_origin
from elbowscrew.geometry.arrays import Float
from elbowscrew.model import JointMotion
from elbowscrew.model.joint_axis import AxisPath, AxisWander, LineEstimate, MeanLine
from elbowscrew.motion.joint.estimates import LineErrors, ProximalErrors, line_errors, line_estimate
from elbowscrew.motion.joint.joint_fit import LineFit
from elbowscrew.motion.joint.lines import Z_LINE, line_twist
from elbowscrew.motion.joint.wander import Wander, deviation_of_size
from elbowscrew.motion.screws.pose_noise import JointNoise

_PARTS: Final = 15


class Told(NamedTuple):
    """What `JointAxis` says of an axis' wander; no mean, its errors and no path where it is not sure that it does."""

    wander: AxisWander
    mean_axis: MeanLine | None
    path: AxisPath | None
    errors: ProximalErrors | None


def told_wander(
    found: Wander,
    fit: LineFit,
    reference_angle: float,
    joint: JointMotion,
    noise: JointNoise,
    towards: Float,
    *,
    express_in: ExpressIn,
) -> Told:
    """Tell an axis' wander in the frame the screws are expressed in.

    Parameters
    ----------
    found : Wander
    fit : LineFit
        That it was found from.
    reference_angle : float
        The fit's angle at the reference.
    joint : JointMotion
    noise : JointNoise
    towards : ndarray, shape (6,)
        A line in the proximal body that gives the axis its sense.
    express_in : {"distal", "proximal", "lab"}
        The distal body is the one at the reference, which stands to the proximal one as the model says there.
    """
    wander = AxisWander(
        tilt=found.tilt,
        tilt_sd=deviation_of_size(found.interval, found.step, slice(-4, -2)),
        shift=found.shift,
        shift_sd=deviation_of_size(found.interval, found.step, slice(-2, None)),
        significant=found.significant,
        unseen_tilt=found.unseen_tilt,
        unseen_shift=found.unseen_shift,
    )
    if not found.significant:
        return Told(wander, None, None, None)
    sense = 1.0 if dq.transform_lines(fit.proximal, Z_LINE)[:3] @ towards[:3] >= 0.0 else -1.0
    in_distal = express_in == "distal"
    base = fit.distal if in_distal else fit.proximal

    def at(angle: float) -> tuple[LineEstimate, LineErrors]:
        here = found.error_rows(np.array(angle))
        rows = found.reference_rows(np.array(angle), reference_angle) if in_distal else here
        pose = _moved(base, rows @ found.step)
        proximal = sense * dq.transform_lines(_moved(fit.proximal, here @ found.step), Z_LINE)
        line = line_estimate(proximal, sense * dq.transform_lines(pose, Z_LINE), joint, express_in)
        errors = line_errors(
            found.interval, found.inverse, rows[:2], rows[2:], pose, line, joint, noise, express_in=express_in
        )
        return line, errors

    edges = found.middle + found.half_range * np.linspace(-1.0, 1.0, _PARTS + 1)
    middles = 0.5 * (edges[1:] + edges[:-1])
    frames = np.histogram(np.clip(fit.angle, edges[0], edges[-1]), edges)[0]
    lines, errors = zip(*(at(angle) for angle in middles[:: int(sense)]), strict=True)
    path = AxisPath(
        angle=sense * (middles[:: int(sense)] - reference_angle),
        direction=np.stack([line.direction for line in lines]),
        point=np.stack([line.point for line in lines]),
        axis_sd=np.array([error.axis_sd for error in errors]),
        point_sd=np.array([error.point_sd for error in errors]),
        frames=frames[:: int(sense)].astype(np.int64),
    )
    mean, mean_errors = at(found.middle)
    own = sense * dq.transform_lines(_moved(fit.distal, found.mean_distal_rows @ found.step), Z_LINE)
    known = bool(np.isfinite(mean_errors.axis_cone))
    rows = found.mean_rows
    return Told(
        wander,
        MeanLine(
            line=replace(mean, direction_distal=own[:3], point_distal=point_nearest_origin(own)),
            **mean_errors._asdict(),
        ),
        path,
        ProximalErrors(found.interval, rows[:2], rows[2:], _moved(fit.proximal, rows @ found.step), known),
    )


def _moved(pose: Float, tilt_shift: Float) -> Float:
    """A line's pose (8,) after a step (4,) of tilts and shifts."""
    return dq.normalize(dq.multiply(pose, dq.exp(line_twist(tilt_shift))))
