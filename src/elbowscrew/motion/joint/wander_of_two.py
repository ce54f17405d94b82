"""Whether one of two axes wanders with its own angle, by how much, and where both are on the mean."""

from __future__ import annotations

from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.twist import adjoint
from elbowscrew.model.joint_axis import AxisWander
from elbowscrew.motion.joint.blocks import block_jackknife
from elbowscrew.motion.joint.influence import with_columns
from elbowscrew.motion.joint.interval import SURE, JointInterval, joint_interval
from elbowscrew.motion.joint.joint_fit import integrated_autocorrelation
from elbowscrew.motion.joint.likelihood import Fit
from elbowscrew.motion.joint.lines import about_z
from elbowscrew.motion.joint.poses import Poses
from elbowscrew.motion.joint.two_axes import TwoAxesMechanism
from elbowscrew.motion.joint.type_interval import Evidence, influence_of_type
from elbowscrew.motion.joint.wander import TELLS_NOTHING, columns_at, deviation_of_size, summed_columns
from elbowscrew.quantities import in_digits

_JOINT: Final = 12  # shared numbers of two axes; behind them four of each axis' wander: tilts, then shifts
_WANDER: Final = 4
_ALL: Final = _JOINT + 2 * _WANDER


class WanderOfTwo(NamedTuple):
    """Two axes, each a line that moves in proportion to its own angle, from one end of its range to the other.

    Attributes
    ----------
    each : tuple of AxisWander or None
        Of axis 1 in the proximal body and of axis 2 in the distal one; None where a wander of 45 deg would not be seen.
    step : ndarray, shape (12,)
        From the fit to the mean axes; NaN where the frames do not determine them.
    interval : JointInterval
        Of the same numbers, whatever the wander is.
    covariance : ndarray, shape (12, 12)
        Of the same under noise of the residuals' size and autocorrelation.
    """

    each: tuple[AxisWander | None, AxisWander | None]
    step: Float
    interval: JointInterval
    covariance: Float

    @property
    def significant(self) -> bool:
        """Whether one of both wanders."""
        return any(one is not None and one.significant for one in self.each)

    @property
    def words(self) -> str:
        """Which axes wander, and how far."""
        told = []
        for number, one in enumerate(self.each, start=1):
            if one is not None and one.significant:
                size = f"{in_digits(np.degrees(one.tilt))} deg and {in_digits(1000.0 * one.shift)} mm"
                told.append(f"axis {number} wanders by {size}")
        return " and ".join(told)


def wander_of_two(fit: Fit[TwoAxesMechanism], poses: Poses, evidence: Evidence) -> WanderOfTwo:
    """Test for axes that wander with their own angles, both in one linear step from the fit.

    Parameters
    ----------
    fit : Fit
        Angles 0 are where the clusters sit right.
    poses : Poses
        Those of the fit, in order of time, with positions: orientations alone tell so little of a wander that no
        linear step is near enough.
    evidence : Evidence
        Of the same frames.

    Notes
    -----
    Each axis' numbers are judged with the other's beside them: alone, they take a part of what the other one does.
    """
    more, step = with_columns(influence_of_type(fit, poses), _columns_of_both(fit.mechanism))
    interval = joint_interval(
        more,
        evidence.clusters,
        skin=evidence.skin,
        reference_angle=0.0,
        reference_second=0.0,
        noise_known=evidence.noise_known,
    )
    if interval.residuals is not None and not interval.residuals.flat and interval.blocks is None:
        # Slow noise goes with so many numbers: by its spectrum alone one in ten of those that it makes would be told.
        interval = replace(interval, blocks=block_jackknife(more))
    each = (None, None) if interval.residuals is None else (_wander(interval, step, 0), _wander(interval, step, 1))
    scale = max(more.variance, 1.0 if evidence.noise_known else 0.0) * integrated_autocorrelation(more.whitened)
    return WanderOfTwo(each, step[:_JOINT], interval.of_first(_JOINT), scale * more.inverse[:_JOINT, :_JOINT])


def _columns_of_both(at: TwoAxesMechanism) -> Float:
    """What wanders of both axes add to the poses (F, 6, 8), as twists of the distal body in its own frame."""
    first, second = at.frames.T
    after = dq.multiply(at.between, about_z(second))
    frames = (adjoint(dq.multiply(at.distal, dq.conjugate(after))), -adjoint(dq.multiply(at.distal, about_z(-second))))
    found = []
    # Seen from the distal body the proximal one turns about axis 2 the other way.
    for angle, frame, sense in zip((first, second), frames, (1.0, -1.0), strict=True):
        grid, summed = summed_columns(float(angle.min()), float(angle.max()), sense=sense)
        found.append(frame @ columns_at(angle, grid, summed))
    return np.concatenate(found, axis=2)


def _wander(interval: JointInterval, step: Float, axis: int) -> AxisWander | None:
    first = _JOINT + _WANDER * axis
    tilt, shift = slice(first, first + 2), slice(first + 2, first + 4)
    rows = np.eye(_ALL)
    sizes = [float(np.linalg.norm(step[part])) for part in (tilt, shift)]
    sure = [interval.radius(rows[part], SURE) for part in (tilt, shift)]
    if not 2.0 * sure[0] < TELLS_NOTHING:
        return None
    return AxisWander(
        tilt=2.0 * sizes[0],
        tilt_sd=deviation_of_size(interval, step, tilt),
        shift=2.0 * sizes[1],
        shift_sd=deviation_of_size(interval, step, shift),
        significant=any(size > limit for size, limit in zip(sizes, sure, strict=True)),
        unseen_tilt=2.0 * sure[0],
        unseen_shift=2.0 * sure[1],
    )
