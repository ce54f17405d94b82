"""Error of the instantaneous axis of a synthetic elbow, unfiltered and filtered.

    python benchmarks/instantaneous.py

120 Hz, one flexion in two seconds from 0 to 130 deg and back, forearm poses with 0.2 mm and 0.15 deg of noise about
each axis, their origin 150 mm from the joint's line. Frames slower than the gate have no axis.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from elbowscrew import Recording, RigidBody, Settings, analyze
from elbowscrew.geometry import dual_quat_from_screw, line_through
from elbowscrew.geometry import dual_quaternion as dq

RATE_HZ, SECONDS, TRIALS = 120.0, 10.0, 40
LINE = line_through([0.004, -0.132, 0.011], [0.986, 0.104, -0.131])
START = dq.dual_quat_from_pose([1.0, 0.0, 0.0, 0.0], np.array([0.0, -0.282, 0.0]))
NOISE = np.array([np.radians(0.15)] * 3 + [2e-4] * 3)


def errors(lowpass_hz: float | Literal["auto"], seed: int) -> np.ndarray:
    """Angles (deg) and distances (mm) of the axes from the true line, shape (F, 2)."""
    rng = np.random.default_rng(seed)
    time = np.arange(int(RATE_HZ * SECONDS)) / RATE_HZ
    angle = np.radians(65.0) * (1.0 - np.cos(np.pi * time))
    exact = dq.multiply(dual_quat_from_screw(angle, 0.0, LINE[:3], LINE[3:]), START)
    noisy = dq.multiply(exact, dq.exp(0.5 * NOISE * rng.normal(size=(time.size, 6))))
    body = RigidBody(name="distal", dual_quat_lab_body=noisy, loss=np.zeros(time.size, dtype=np.uint8))
    settings = Settings(express_in="lab", lowpass_hz=lowpass_hz, noise="none")
    found = analyze(Recording.from_bodies([body], rate_hz=RATE_HZ), settings).instantaneous
    known = np.isfinite(found.axis_direction[:, 0])
    n, p = found.axis_direction[known], found.axis_point[known]
    tilt = np.degrees(np.arcsin(np.minimum(np.linalg.norm(np.cross(n, LINE[:3]), axis=1), 1.0)))
    # Between the true line and the one found, near the forearm.
    near = np.cross(LINE[:3], LINE[3:])
    near = near + ((START_PLACE - near) @ LINE[:3]) * LINE[:3]
    foot = p + ((near - p) * n).sum(axis=1, keepdims=True) * n - near
    across = foot - (foot @ LINE[:3])[:, None] * LINE[:3]
    return np.stack([tilt, 1000.0 * np.linalg.norm(across, axis=1)], axis=1)


START_PLACE = dq.pose_from_dual_quat(START)[1]


def main() -> None:
    """Print RMS errors as a table in Markdown."""
    print("| filter | direction deg | place mm |")
    print("| --- | --- | --- |")
    for cutoff in (59.9, 12.0, 8.0, 6.0, 4.0, 3.0, "auto"):
        found = np.concatenate([errors(cutoff, seed) for seed in range(TRIALS)])
        tilt, place = np.sqrt(np.mean(found**2, axis=0))
        name = "none" if cutoff == 59.9 else cutoff if cutoff == "auto" else f"{cutoff:g} Hz"
        print(f"| {name} | {tilt:.2f} | {place:.2f} |")


if __name__ == "__main__":
    main()
