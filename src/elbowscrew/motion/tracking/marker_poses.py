"""Rigid bodies out of markers, for recordings without solved bodies."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from elbowscrew.errors import SettingError
from elbowscrew.geometry import FittedPose, fit_poses, fit_poses_dual_qr
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import conjugate, transform_points
from elbowscrew.model import MarkerMotion, Recording, RigidBody, TrackingLoss, at_origin, marker_matches
from elbowscrew.motion.tracking.resolution import coarse_step

_REFINEMENTS: Final = 2

POSE_METHODS: Final[dict[str, tuple[Callable[[Float, Float], FittedPose], int]]] = {
    "svd": (fit_poses, 3),
    "dual-qr": (fit_poses_dual_qr, 4),
}
"""Each with the fewest markers it needs."""


def body_from_markers(recording: Recording, name: str, patterns: tuple[str, ...], method: str) -> RigidBody:
    """Build a rigid body from some of a recording's markers, its origin at their centroid.

    Parameters
    ----------
    recording : Recording
        Read with these markers.
    name : str
        Name of the body.
    patterns : tuple of str
        Names of the markers, or patterns that fit them.
    method : {"svd", "dual-qr"}

    Raises
    ------
    SettingError
        If too few markers fit, or no frame sees all of them.

    References
    ----------
    P 22-29.
    """
    fit, fewest = POSE_METHODS[method]
    chosen = [marker for marker in recording.markers if marker_matches(marker.name, patterns)]
    unknown = [p for p in patterns if not any(marker_matches(marker.name, (p,)) for marker in chosen)]
    if len(chosen) < fewest or unknown:
        found = ", ".join(marker.name for marker in chosen) or "none"
        there = ", ".join(marker.name for marker in recording.markers[:8]) or "none; name them to read_recording, too"
        nobody = f"{', '.join(unknown)} fits no marker; " if unknown else ""
        msg = (
            f"{name}: {nobody}{', '.join(patterns)!r} fits {len(chosen)} markers ({found}); {method} needs {fewest}; "
            f"markers read: {there}"
        )
        raise SettingError(msg)
    seen = np.stack([marker.position for marker in chosen], axis=1)
    seen = np.where(at_origin(seen)[..., None], np.nan, seen)
    shape = cluster_shape(seen)
    if shape is None:
        names = ", ".join(marker.name for marker in chosen)
        msg = f"{name}: its markers are never all seen in one frame ({names}); leave out those that are seldom seen"
        raise SettingError(msg)
    fitted = fit(shape, seen)
    lost = ~np.isfinite(fitted.dual_quat).all(axis=1)
    if lost.all():
        flat = "one line" if method == "svd" else "one plane"
        msg = f"{name}: the markers give no pose in any frame: they lie on {flat}, or too few are seen; choose others"
        raise SettingError(msg)
    svd = method == "svd"
    return RigidBody(
        name=name,
        dual_quat_lab_body=fitted.dual_quat,
        loss=np.where(lost, TrackingLoss.BLANK, TrackingLoss.NONE).astype(np.uint8),
        marker_offsets=shape,
        marker_residual=fitted.deviation if svd else fit_poses(shape, seen).deviation,
        marker_motion=MarkerMotion.of_markers(fitted.dual_quat, seen, shape, own_shape=True),
        shape_deviation=None if svd else fitted.deviation,
        coarse_step=coarse_step(seen.reshape(len(seen), -1)),
    )


def cluster_shape(seen: Float) -> Float | None:
    """Shape of a marker cluster, shape (M, 3), about its centroid and turned as in the first whole frame.

    Each marker's position is its median over the frames that see all of them, so that a frame with a marker gone astray
    does not bend the shape.

    Parameters
    ----------
    seen : ndarray, shape (N, M, 3)
        NaN where not seen.

    Returns
    -------
    ndarray or None
        None if no frame sees all markers.
    """
    whole = seen[np.isfinite(seen).all(axis=(1, 2))]
    if not len(whole):
        return None
    shape: Float = whole[0] - whole[0].mean(axis=0)
    for _ in range(_REFINEMENTS):
        pose = fit_poses(shape, whole).dual_quat
        fitted = np.isfinite(pose).all(axis=1)
        if not fitted.any():
            return shape
        shape = np.median(transform_points(conjugate(pose[fitted])[:, None, :], whole[fitted]), axis=0)
        shape = shape - shape.mean(axis=0)
    return shape
