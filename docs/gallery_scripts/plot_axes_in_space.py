"""
Screw axes of single frames
===========================

Each frame's displacement from the reference turns about an axis. The axes scatter most where the angle is small, which
is why none is given below 10 deg.
"""

import matplotlib.pyplot as plt
import numpy as np

import elbowscrew

recording = elbowscrew.simulate_trial(marker_noise_mm=0.5, wander_deg=6, seed=2).recording
screw = elbowscrew.analyze(recording, elbowscrew.Settings(express_in="proximal")).screw

known = np.flatnonzero(np.isfinite(screw.axis_direction[:, 0]))[::6]
middle = 1000 * screw.axis_point[known]
reach = 80 * screw.axis_direction[known]
colors = plt.get_cmap("viridis")(screw.angle[known] / np.nanmax(screw.angle))

figure = plt.figure()
ax = figure.add_subplot(projection="3d")
for start, end, color in zip(middle - reach, middle + reach, colors, strict=True):
    ax.plot(*np.stack([start, end]).T, color=color, lw=0.8)
_ = ax.set(xlabel="x (mm)", ylabel="y (mm)", zlabel="z (mm)")
