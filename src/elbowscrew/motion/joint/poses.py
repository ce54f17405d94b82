"""Relative poses of a joint, and what the errors of each are weighed by."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from elbowscrew.geometry._blocks import evenly_thinned
from elbowscrew.geometry.arrays import Float, Index

COMPONENTS: Final = 6
"""Numbers that a pose has, three of them of its orientation."""


class Poses(NamedTuple):
    """Relative poses with what their errors are weighed by.

    Attributes
    ----------
    joint : ndarray, shape (F, 8)
        Distal body in the proximal one, any signs.
    whitener : ndarray, shape (F, 6, 6) or (F, 3, 6)
        ``U`` with ``U^T U`` the inverse covariance of each pose's error in the distal body's frame; three rows where
        the positions were not measured.
    """

    joint: Float
    whitener: Float

    @classmethod
    def of(cls, joint: Float, covariance: Float) -> Poses:
        """Poses (F, 8) and the covariances (F, 6, 6) of their errors in the distal body's frame.

        The variance of positions that were not measured is infinite (`fitted_covariance`).
        """
        return cls(joint, whitener_of(information_of(np.broadcast_to(covariance, (len(joint), 6, 6)))))

    @property
    def located(self) -> bool:
        """Whether the positions were measured."""
        return int(self.whitener.shape[-2]) == COMPONENTS

    def at(self, rows: Index | slice) -> Poses:
        """Give the poses of some frames."""
        return Poses(self.joint[rows], self.whitener[rows])

    def thinned(self, most: int) -> tuple[Poses, Index]:
        """At most so many frames, evenly spread, and which they are."""
        rows = evenly_thinned(np.arange(len(self.joint)), most)
        return self.at(rows), rows


def information_of(covariance: Float) -> Float:
    """Inverse of covariances (..., 6, 6); 0 for positions whose variance is infinite."""
    if np.isfinite(covariance[..., 3:, 3:]).all():
        return np.asarray(np.linalg.inv(covariance), dtype=np.float64)
    found = np.zeros(covariance.shape)
    found[..., :3, :3] = np.linalg.inv(covariance[..., :3, :3])
    return found


def whitener_of(information: Float) -> Float:
    """``U`` with ``U^T U`` the information (..., 6, 6): upper triangular, with three rows if positions have none."""
    if information[..., 3:, 3:].any():
        return np.swapaxes(np.linalg.cholesky(information), -1, -2)
    turning = np.swapaxes(np.linalg.cholesky(information[..., :3, :3]), -1, -2)
    return np.concatenate([turning, np.zeros(turning.shape)], axis=-1)
