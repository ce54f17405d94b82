"""Independent reference implementations: rotation matrices and 2x2 complex matrices, nothing from the package."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowscrew.geometry.arrays import Float


def rodrigues(axis: Float, angle: Float) -> Float:
    """Rotation matrices (N, 3, 3) about one axis, by Rodrigues' formula."""
    n = axis / np.linalg.norm(axis)
    K = np.array([[0.0, -n[2], n[1]], [n[2], 0.0, -n[0]], [-n[1], n[0], 0.0]])
    a = np.asarray(angle)[:, None, None]
    rotation: Float = np.eye(3) + np.sin(a) * K + (1.0 - np.cos(a)) * (K @ K)
    return rotation


def quaternion_xyzw(R: Float) -> Float:
    """Quaternions, scalar last, from the eigenvector of Bar-Itzhack's matrix: no case distinction at pi."""
    m = R
    K = np.empty((len(R), 4, 4))
    K[:, 0] = np.stack(
        [
            m[:, 0, 0] - m[:, 1, 1] - m[:, 2, 2],
            m[:, 1, 0] + m[:, 0, 1],
            m[:, 2, 0] + m[:, 0, 2],
            m[:, 2, 1] - m[:, 1, 2],
        ],
        axis=1,
    )
    K[:, 1] = np.stack(
        [
            m[:, 1, 0] + m[:, 0, 1],
            m[:, 1, 1] - m[:, 0, 0] - m[:, 2, 2],
            m[:, 2, 1] + m[:, 1, 2],
            m[:, 0, 2] - m[:, 2, 0],
        ],
        axis=1,
    )
    K[:, 2] = np.stack(
        [
            m[:, 2, 0] + m[:, 0, 2],
            m[:, 2, 1] + m[:, 1, 2],
            m[:, 2, 2] - m[:, 0, 0] - m[:, 1, 1],
            m[:, 1, 0] - m[:, 0, 1],
        ],
        axis=1,
    )
    K[:, 3] = np.stack(
        [
            m[:, 2, 1] - m[:, 1, 2],
            m[:, 0, 2] - m[:, 2, 0],
            m[:, 1, 0] - m[:, 0, 1],
            m[:, 0, 0] + m[:, 1, 1] + m[:, 2, 2],
        ],
        axis=1,
    )
    return np.linalg.eigh(K / 3.0)[1][:, :, -1]


@dataclass(frozen=True)
class KnownTrial:
    """A hinge with slide, the arm moving, all by matrices; meters, radians, the line in the arm's frame."""

    proximal_R: Float
    proximal_p: Float
    distal_R: Float
    distal_p: Float
    angle: Float
    slide: Float
    direction: Float
    point: Float

    def line_in(self, frame: str) -> tuple[Float, Float]:
        """Direction and point nearest the origin, in "arm", in "forearm" at frame 0, or in "lab" at frame 0."""
        if frame == "proximal":
            h, p = self.direction, self.point
        elif frame == "lab":
            h, p = self.proximal_R[0] @ self.direction, self.proximal_R[0] @ self.point + self.proximal_p[0]
        else:
            J_R = self.proximal_R[0].T @ self.distal_R[0]
            J_p = self.proximal_R[0].T @ (self.distal_p[0] - self.proximal_p[0])
            h, p = J_R.T @ self.direction, J_R.T @ (self.point - J_p)
        return h, p - (p @ h) * h


def known_trial(
    top_deg: float,
    *,
    frames: int = 450,
    inversion: int = 211,
    slide: float = 0.004,
    seed: int = 0,
    gentle: bool = False,
) -> KnownTrial:
    """Flex to the top at the inversion and back, by smoothstep or as gently as by minimum jerk, from the reference."""
    rng = np.random.default_rng(seed)
    i = np.arange(frames)
    tau = np.where(i <= inversion, i / inversion, (frames - 1 - i) / (frames - 1 - inversion))
    progress = tau**3 * (10.0 - 15.0 * tau + 6.0 * tau**2) if gentle else tau**2 * (3.0 - 2.0 * tau)
    angle, s = np.radians(top_deg) * progress, slide * progress
    direction = rng.normal(size=3)
    direction /= np.linalg.norm(direction)
    point = rng.normal(scale=0.1, size=3)
    t = i / 100.0
    proximal_R = rodrigues(rng.normal(size=3), 0.4 * np.sin(0.9 * t) + 0.3) @ rodrigues(rng.normal(size=3), 0.2 * t)
    proximal_p = np.array([0.3, 1.2, -0.4]) + 0.05 * np.stack([np.sin(t), np.cos(2 * t), np.sin(0.5 * t)], axis=1)
    J0_R, J0_p = rodrigues(rng.normal(size=3), np.array([0.7]))[0], np.array([0.02, -0.25, 0.04])
    H = rodrigues(direction, angle)
    J_R = H @ J0_R
    J_p = (H @ (J0_p - point)[:, None])[..., 0] + point + s[:, None] * direction
    distal_p = (proximal_R @ J_p[:, :, None])[..., 0] + proximal_p
    return KnownTrial(proximal_R, proximal_p, proximal_R @ J_R, distal_p, angle, s, direction, point)


def relative_motion(trial: KnownTrial) -> tuple[Float, Float]:
    """Displacement of the forearm in its own reference frame (eq. 35): rotations (N, 3, 3) and translations (N, 3)."""
    J_R = np.swapaxes(trial.proximal_R, 1, 2) @ trial.distal_R
    J_p = (np.swapaxes(trial.proximal_R, 1, 2) @ (trial.distal_p - trial.proximal_p)[:, :, None])[..., 0]
    return J_R[0].T @ J_R, (J_p - J_p[0]) @ J_R[0]


class ComplexDualQuaternion:
    """A dual quaternion as a pair of 2x2 complex matrices."""

    def __init__(self, real: NDArray[np.complex128], dual: NDArray[np.complex128]) -> None:
        self.real, self.dual = real, dual

    @classmethod
    def from_pose(cls, wxyz: Float, d: Float) -> ComplexDualQuaternion:
        q = _complex(*wxyz)
        return cls(q, 0.5 * _complex(0.0, *d) @ q)

    @classmethod
    def blend(cls, poses: list[ComplexDualQuaternion], weights: list[float]) -> ComplexDualQuaternion:
        real = sum((w * Q.real for w, Q in zip(weights, poses, strict=True)), np.zeros((2, 2), complex))
        dual = sum((w * Q.dual for w, Q in zip(weights, poses, strict=True)), np.zeros((2, 2), complex))
        size = np.sqrt(np.linalg.det(real).real)
        real, dual = real / size, dual / size
        projection = 0.5 * np.trace(real.conj().T @ dual).real
        return cls(real, dual - projection * real)

    @property
    def half_angle(self) -> float:
        """Angle of the real part, from its trace and determinant of the traceless rest."""
        w = 0.5 * np.trace(self.real).real
        rest = self.real - w * np.eye(2)
        return float(np.arctan2(np.sqrt(abs(np.linalg.det(rest))), w))

    @property
    def position(self) -> Float:
        d = 2.0 * self.dual @ self.real.conj().T
        return np.array([d[0, 0].imag, d[0, 1].real, d[0, 1].imag])


def _complex(w: float, x: float, y: float, z: float) -> NDArray[np.complex128]:
    return np.array([[w + 1j * x, y + 1j * z], [-y + 1j * z, w - 1j * x]])
