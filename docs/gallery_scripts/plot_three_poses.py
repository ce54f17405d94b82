"""
Through three poses: DLB, DIB and a Catmull-Rom spline
======================================================

The path of a point of the body, by methods that all pass through the same poses.
"""

import matplotlib.pyplot as plt
import numpy as np

from elbowscrew.geometry import catmull_rom, dib, dlb, dual_quat_from_screw, lagrange_weights
from elbowscrew.geometry.dual_quaternion import transform_points

angles, tilts = np.radians([0.0, 70.0, 120.0]), (0.0, 0.25, 0.1)
poses = np.stack(
    [
        dual_quat_from_screw(angle, 0.0, [np.sin(tilt), 0, np.cos(tilt)], [0, 0, 0])
        for angle, tilt in zip(angles, tilts, strict=True)
    ]
)
knots = np.array([0.0, 0.5, 1.0])
t = np.linspace(0.0, 1.0, 101)
weights = lagrange_weights(t, knots)

figure, ax = plt.subplots()
for name, made in {
    "DLB": dlb(poses, weights),
    "DIB": dib(poses, weights).dual_quat,
    "Catmull-Rom": catmull_rom(poses, knots, t),
}.items():
    path = transform_points(made, np.array([250.0, 0.0, 0.0]))
    ax.plot(path[:, 0], path[:, 2], label=name)
through = transform_points(poses, np.array([250.0, 0.0, 0.0]))
ax.plot(through[:, 0], through[:, 2], "ko", label="poses")
ax.set(xlabel="x (mm)", ylabel="z (mm)")
_ = ax.legend()
