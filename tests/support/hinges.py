"""Errors of the estimators of a hinge's line over many synthetic trials, beside the bound of Cramér and Rao."""

from __future__ import annotations

import numpy as np
from trials import ARM, FOREARM, LINE, START, joint_poses, noisy_joint, pose_covariance

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Float
from elbowscrew.model import PoseNoise
from elbowscrew.motion.axes.mean_axis import mean_axis_of
from elbowscrew.motion.joint.joint_fit import fit_joint, sara_lines
from elbowscrew.motion.screws.helical import helical_series
from elbowscrew.motion.screws.sense import sense_of
from elbowscrew.motion.screws.uncertainty import joint_covariance

FRAMES = 450
OUTLIERS = np.array([0.3] * 3 + [0.05] * 3)
_Z = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0])


def hinge_errors(top_deg: float, trials: int, *, seed: int, robust_too: bool = False) -> dict[str, Float]:
    """Angles (rad) between each estimate of the line in the arm and the truth, and the bound in "bound"."""
    rng = np.random.default_rng(seed)
    theta = np.radians(top_deg) * (0.5 - 0.5 * np.cos(np.linspace(0.0, 2.0 * np.pi, FRAMES)))
    exact = joint_poses(theta, np.zeros(FRAMES))
    noise = [PoseNoise(covariance=pose_covariance(m), source="known", marker_noise=None) for m in (ARM, FOREARM)]
    near = dq.pose_from_dual_quat(START)[1]
    covariance = joint_covariance(exact, *noise)
    bound = np.linalg.inv(fit_joint(exact, covariance, LINE, near).information)
    found: dict[str, list[float]] = {}

    def note(name: str, line: Float) -> None:
        sine = float(np.linalg.norm(np.cross(line[:3], LINE[:3])))
        found.setdefault(name, []).append(float(np.arcsin(min(1.0, sine))))

    for _ in range(trials):
        joint = noisy_joint(exact, rng)
        D = dq.multiply(dq.conjugate(joint[0]), joint)
        sense = sense_of(D[:, :4], np.arange(len(D)) / 100.0, 0)
        series = helical_series(D, np.radians(10.0), sense.angle, sense.sign)
        lines = series.line[np.isfinite(series.line).all(axis=1)]
        weighted = mean_axis_of(series.angle, series.line, np.zeros(3))
        note("plain mean", dq.transform_lines(joint[0], lines.mean(axis=0)) / np.linalg.norm(lines.mean(axis=0)[:3]))
        note("weighted mean", dq.transform_lines(joint[0], np.concatenate([weighted.direction, np.zeros(3)])))
        note("SARA", sara_lines(joint, theta)[0])
        S = joint_covariance(joint, *noise)
        note("maximum likelihood", dq.transform_lines(fit_joint(joint, S, LINE, near).proximal, _Z))
        if robust_too:
            stray = dq.exp(0.5 * (rng.random(FRAMES) < 0.1)[:, None] * rng.normal(size=(FRAMES, 6)) * OUTLIERS)
            bad = dq.multiply(joint, stray)
            S_bad = joint_covariance(bad, *noise)
            note("robust, clean", dq.transform_lines(fit_joint(joint, S, LINE, near, robust=True).proximal, _Z))
            note(
                "robust, 10 % outliers", dq.transform_lines(fit_joint(bad, S_bad, LINE, near, robust=True).proximal, _Z)
            )
            note("least squares, 10 % outliers", dq.transform_lines(fit_joint(bad, S_bad, LINE, near).proximal, _Z))
    errors = {name: np.array(values) for name, values in found.items()}
    errors["bound"] = np.array([np.sqrt(bound[0, 0] + bound[1, 1])])
    return errors
