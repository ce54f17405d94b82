"""What markers tell of a fit's errors: how far a stationary model is believed beside what they did."""

from __future__ import annotations

import numpy as np
import pytest
from cluster_noise import Hinge
from scipy.stats import multivariate_t

from elbowscrew.geometry.arrays import Float
from elbowscrew.motion.joint.influence import Influence
from elbowscrew.motion.joint.nonrigid import nonrigid_covariance

WORTH = np.array([0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 1e3, 1e4, 1e5])


def any_influence(angle: Float) -> Influence:
    """A fit of two numbers: only its angles enter the evidence."""
    count = len(angle)
    rng = np.random.default_rng(3)
    return Influence(
        angle=angle,
        inverse=np.eye(2),
        whitened=np.zeros((count, 5)),
        design=rng.normal(size=(count, 5, 2)),
        whitener=rng.normal(size=(count, 5, 6)),
        joint=np.tile(np.eye(8)[0], (count, 1)),
    )


def log_evidence(rows: Float, variance: float, worth: float) -> float:
    """Of columns (nu) drawn from a covariance that is inverse Wishart about ``variance I``, one after the other.

    Each column, given those before it, has a multivariate t distribution.
    """
    rank = len(rows)
    scale, freedom, total = worth * variance * np.eye(rank), worth + 2.0, 0.0
    for column in rows.T:
        total += multivariate_t.logpdf(column, shape=scale / freedom, df=freedom)
        scale, freedom = scale + np.outer(column, column), freedom + 1.0
    return total


@pytest.mark.parametrize("own_shape", [False, True])
@pytest.mark.parametrize("with_angle", [0.0, 1.0, 2.0])
def test_the_model_is_believed_by_its_evidence(own_shape: bool, with_angle: float) -> None:
    """What goes with the angle has more on the angle's own waves than white noise; too little to be seen elsewhere."""
    rng = np.random.default_rng(17)
    count, nu = 900, 6
    angle = 0.3 + 1.2 * (1.0 - np.cos(np.linspace(0.0, 2.0 * np.pi, count)))
    noise = rng.normal(size=(count, nu))
    wave = np.cos(angle) - np.cos(angle).mean()
    z = noise + with_angle * wave[:, None] / np.linalg.norm(wave) * np.array([1.0, -1.0, 1.0, 0.0, 0.0, 0.0])
    found = nonrigid_covariance(
        any_influence(angle), Hinge().shapes[1], 1e-3 * z, segment="distal", own_shape=own_shape
    )
    assert found is not None
    about = angle - angle.mean()
    waves = np.stack([np.ones(count), np.cos(about), np.sin(about), about], axis=1)
    if own_shape:
        waves, z = waves[:, 1:] - waves[:, 1:].mean(axis=0), z - z.mean(axis=0)
    # The three waves that differ most, orthonormal.
    basis = waves @ np.linalg.eigh(waves.T @ waves)[1][:, -3:]
    basis /= np.linalg.norm(basis, axis=0)
    variance = float(np.sum(z**2) / (nu * (count - own_shape)))
    logs = np.array([log_evidence(basis.T @ z, variance, worth) for worth in WORTH])
    weight = np.exp(logs - logs.max())
    kept = weight > 1e-9
    assert found.weight == pytest.approx(weight[kept] / weight[kept].sum(), rel=2e-3, abs=1e-6)
    assert found.freedom == pytest.approx(WORTH[kept] + nu)


def test_the_more_goes_with_the_angle_the_less_the_model_is_believed() -> None:
    rng = np.random.default_rng(18)
    angle = 1.2 * (1.0 - np.cos(np.linspace(0.0, 2.0 * np.pi, 900)))
    noise = rng.normal(size=(900, 6))
    worth = []
    for size in (0.0, 4.0, 8.0):
        z = 1e-3 * (noise + size * np.cos(angle)[:, None] / 30.0 * np.ones(6))
        found = nonrigid_covariance(any_influence(angle), Hinge().shapes[1], z, segment="distal", own_shape=True)
        assert found is not None
        worth.append(float(found.weight @ found.freedom) - 6.0)
    assert worth[0] > 10.0 * worth[1] > 10.0 * worth[2]
