"""The direction of a hinge's axis from orientations alone: maximum likelihood, as of whole poses."""

from __future__ import annotations

import numpy as np

from elbowscrew.geometry.arrays import Float
from elbowscrew.motion.joint.fitting import frames_that_count_as_one
from elbowscrew.motion.joint.joint_fit import LineFit
from elbowscrew.motion.joint.likelihood import fit_mechanism
from elbowscrew.motion.joint.poses import Poses
from elbowscrew.motion.joint.robust_fit import fit_robustly, refined_robustly
from elbowscrew.motion.joint.simple_types import OneAxis


def fit_direction(joint: Float, covariance: Float, *, robust: bool = False) -> LineFit:
    """Fit a hinge to relative orientations; both lines pass the bodies' origins, as nothing says where they are.

    Parameters
    ----------
    joint : ndarray, shape (F, 8)
        Rotations of the distal body in the proximal one, in order of time.
    covariance : ndarray, shape (F, 6, 6)
        Of each pose's error, that of its position infinite.
    robust : bool
        Tukey's biweight in place of least squares.

    Returns
    -------
    LineFit
        Told are the tilts of both lines.
    """
    poses = Poses.of(joint, covariance)
    fit = fit_mechanism(OneAxis.start(joint), poses)
    if robust:
        fit = refined_robustly(fit_robustly(fit, poses), poses)
    hinge = fit.mechanism
    return LineFit(
        proximal=hinge.proximal,
        distal=hinge.distal,
        angle=hinge.frames[:, 0],
        pitch=0.0,
        residual=fit.residual,
        weight=fit.weight,
        information=fit.information,
        noise_ratio=float(np.sqrt(fit.variance)),
        correlation=frames_that_count_as_one(fit),
        freedom=fit.freedom,
        told=fit.told,
    )
