"""How far a model is from the measured motion, frame by frame."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import pose_from_dual_quat
from elbowscrew.geometry.lines import angle_of_lines, direction_between, distance_across
from elbowscrew.model import BodyPoints
from elbowscrew.motion.difference import angle_between, origin_distance, rms_displacement
from elbowscrew.motion.screws.helical import HelicalSeries, helical_series
from elbowscrew.motion.screws.measurement import Measurement
from elbowscrew.motion.screws.relative import expressed
from elbowscrew.motion.screws.sense import modeled_angle
from elbowscrew.settings import Settings


class ModelErrors(NamedTuple):
    """The modeled motion as it is expressed, its screws, and its errors.

    Attributes
    ----------
    expressed : ndarray, shape (..., N, 8)
    series : HelicalSeries
    angle_error, axis_error : ndarray, shape (..., N)
        Radians; as all errors NaN where nothing was measured.
    translation_error, rms_displacement, axis_distance : ndarray, shape (..., N)
        Meters.
    """

    expressed: Float
    series: HelicalSeries
    angle_error: Float
    translation_error: Float
    rms_displacement: Float
    axis_error: Float
    axis_distance: Float


def model_errors(dual_quat: Float, measured: Measurement, points: BodyPoints, settings: Settings) -> ModelErrors:
    """Compare modeled displacements with the measured motion.

    Parameters
    ----------
    dual_quat : ndarray, shape (..., N, 8)
        Of one model or of several, in the frame of the measured displacements.
    measured : Measurement
    points : BodyPoints
        What the RMS displacement is averaged over.
    settings : Settings

    Returns
    -------
    ModelErrors
    """
    D, sense = measured.displacement, measured.sense
    D_model = expressed(dual_quat, measured.joint, measured.express_in)
    angle, sign = modeled_angle(D_model[..., :4], measured.screw.euler_parameters, sense, measured.elapsed)
    series = helical_series(D_model, np.radians(settings.min_angle_deg), angle, sign)
    near = pose_from_dual_quat(measured.change)[1]
    found = ModelErrors(
        expressed=D_model,
        series=series,
        angle_error=angle_between(D, dual_quat),
        translation_error=origin_distance(D, dual_quat),
        rms_displacement=rms_displacement(D, dual_quat, points),
        axis_error=(direction_between if sense.signed else angle_of_lines)(measured.line, series.line),
        axis_distance=distance_across(measured.line, series.line, near),
    )
    for error in found[2:]:
        error[..., ~measured.joint.measured] = np.nan
    return found
