"""Covariance of a fit from blocks of the motion left out in turn (method J): whatever changes from block to block."""

from __future__ import annotations

from typing import Final

import numpy as np

from elbowscrew.motion.joint.influence import Influence
from elbowscrew.motion.joint.tails import Mixture

BLOCKS: Final = 8


def block_jackknife(influence: Influence, blocks: int = BLOCKS) -> Mixture:
    """Covariance by the jackknife over blocks of equal angular travel.

    Parameters
    ----------
    influence : Influence
    blocks : int
        One fewer are the degrees of freedom.

    References
    ----------
    Künsch 1989 for the jackknife of blocks; each estimate without a block is one linear step from the whole.
    """
    travel = np.concatenate([[0.0], np.cumsum(np.sum(np.abs(np.diff(influence.angles, axis=0)), axis=1))])
    whole = max(float(travel[-1]), np.finfo(np.float64).tiny)
    number = np.minimum((blocks * travel / whole).astype(np.int64), blocks - 1)
    starts = np.searchsorted(number, np.arange(1, blocks))
    parts = zip(np.split(influence.design, starts), np.split(influence.whitened, starts), strict=True)
    information, pull = [], []
    for design, whitened in parts:
        information.append(np.tensordot(design, design, axes=((0, 1), (0, 1))))
        pull.append(np.tensordot(design, whitened, axes=((0, 1), (0, 1))))
    total = np.sum(information, axis=0)
    scale = np.sqrt(np.diag(total))
    # Where the rest does not determine the joint the step of least length is all that is known.
    step = np.stack(
        [
            -np.linalg.lstsq((total - own) / np.outer(scale, scale), force / scale, rcond=1e-12)[0] / scale
            for own, force in zip(information, pull, strict=True)
        ]
    )
    off = step - step.mean(axis=0)
    return Mixture.of_one((blocks - 1) / blocks * off.T @ off, float(blocks - 1))
