"""What is left of an analysis where no positions were measured: directions and angles, everything else NaN or None."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Final, TypeVar, cast

import numpy as np

from elbowscrew.geometry.arrays import Float
from elbowscrew.model.joint_axis import AxisWander, FittedJoint, JointAxis, LineEstimate, MeanLine, PoseNoise
from elbowscrew.model.joint_type import JointLine, JointType, SecondRotation, TwoAxes
from elbowscrew.model.results import Analysis
from elbowscrew.model.table_record import TableRecord
from elbowscrew.quantities import Quantity

Table = TypeVar("Table", bound=TableRecord)

_NAN: Final = float("nan")
_NOWHERE: Final = np.full(3, np.nan)
_HINGE_SHIFTS: Final = (2, 3, 6, 7, 8)  # among a hinge's numbers those of places and of the slide


def without_places(analysis: Analysis) -> Analysis:
    """Empty all that hangs on positions.

    Parameters
    ----------
    analysis : Analysis
        Of rotations about the bodies' origins, as which orientations alone are analyzed.
    """
    axis, angles, steps = analysis.mean_axis, analysis.joint_angles, analysis.steps
    return replace(
        analysis,
        screw=without_lengths(analysis.screw),
        mean_axis=replace(axis, point=_NOWHERE, distance=np.full(axis.distance.shape, np.nan), position_excursion=_NAN),
        joint_axis=_joint_axis(analysis.joint_axis),
        joint_type=None if analysis.joint_type is None else _joint_type(analysis.joint_type),
        joint_angles=None if angles is None else without_lengths(angles),
        instantaneous=without_lengths(analysis.instantaneous),
        steps=None if steps is None else without_lengths(steps),
        repetitions=without_lengths(analysis.repetitions),
        repeatability=replace(analysis.repeatability, point_sd=_NAN),
        interpolated=without_lengths(analysis.interpolated),
    )


def without_lengths(record: Table) -> Table:
    """Empty the columns of a table that are lengths or velocities."""
    names = {column.attribute for column in record.table if column.quantity in (Quantity.LENGTH, Quantity.VELOCITY)}
    emptied = {name: np.full(getattr(record, name).shape, np.nan) for name in names}
    return cast(Table, replace(cast(Any, record), **emptied))


def _joint_axis(axis: JointAxis) -> JointAxis:
    return replace(
        axis,
        hinge=None if axis.hinge is None else _fitted(axis.hinge),
        weighted_mean=_line(axis.weighted_mean),
        sara=_line(axis.sara),
        noise={end: None if noise is None else _noise(noise) for end, noise in axis.noise.items()},
        wander=None if axis.wander is None else _wander(axis.wander),
        mean_axis=None if axis.mean_axis is None else _mean(axis.mean_axis),
        path=None if axis.path is None else without_lengths(axis.path),
    )


def _line(line: LineEstimate) -> LineEstimate:
    return replace(line, point=_NOWHERE, point_proximal=_NOWHERE, point_distal=_NOWHERE)


def _fitted(fit: FittedJoint) -> FittedJoint:
    return replace(
        fit,
        line=_line(fit.line),
        covariance=_unknown(fit.covariance, _HINGE_SHIFTS),
        point_sd=_NAN,
        point_radius=_NAN,
        skin_radius=_NAN,
        pitch=_NAN,
        pitch_sd=_NAN,
        pitch_sure=_NAN,
        residual_translation=_NAN,
    )


def _mean(mean: MeanLine) -> MeanLine:
    return replace(mean, line=_line(mean.line), point_sd=_NAN, point_radius=_NAN, skin_radius=_NAN)


def _wander(wander: AxisWander) -> AxisWander:
    return replace(wander, shift=_NAN, shift_sd=_NAN, unseen_shift=_NAN)


def _noise(noise: PoseNoise) -> PoseNoise:
    return replace(noise, covariance=_unknown(noise.covariance, (3, 4, 5)))


def _unknown(covariance: Float, places: tuple[int, ...]) -> Float:
    found = covariance.copy()
    found[list(places)], found[:, list(places)] = np.nan, np.nan
    return found


def _joint_type(found: JointType) -> JointType:
    two, second, joint = found.two_axes, found.second_rotation, found.coordinates
    return replace(
        found,
        candidates=tuple(replace(candidate, residual_translation=_NAN) for candidate in found.candidates),
        two_axes=None if two is None else _two_axes(two),
        second_rotation=None if second is None else _second_rotation(second),
        coordinates=None if joint is None else replace(joint, point=np.full(joint.point.shape, np.nan)),
        residual_translation=np.full(found.residual_translation.shape, np.nan),
    )


def _joint_line(line: JointLine) -> JointLine:
    return replace(line, point_proximal=_NOWHERE, point_distal=_NOWHERE, point_radius=_NAN)


def _two_axes(two: TwoAxes) -> TwoAxes:
    return replace(
        two,
        axis1=_joint_line(two.axis1),
        axis2=_joint_line(two.axis2),
        distance=None,
        foot1=None,
        foot2=None,
        offset=None,
    )


def _second_rotation(second: SecondRotation) -> SecondRotation:
    return replace(second, axis=None if second.axis is None else _joint_line(second.axis))
