"""
Why small angles have no axis
=============================

The direction of a rotation's axis is as uncertain as the noise of the poses over sin(angle/2). Dots are what happened
on a synthetic hinge, whose axis is known; the line is the standard deviation that each frame is given.
"""

import matplotlib.pyplot as plt
import numpy as np

import elbowscrew

trial = elbowscrew.simulate_trial(joint_type="hinge", marker_noise_mm=0.5, seed=3)
screw = elbowscrew.analyze(trial.recording, elbowscrew.Settings(min_angle_deg=1, marker_noise_mm=0.5)).screw
truth = np.array(trial.truth["axis"]["distal"]["direction"])

angle = np.degrees(screw.angle)
off = np.degrees(np.arccos(np.clip(np.abs(screw.axis_direction @ truth), 0, 1)))

figure, ax = plt.subplots()
ax.semilogy(angle, off, ".", ms=3, color="0.5", label="error of the frame's axis")
ax.semilogy(angle, np.degrees(screw.axis_sd), "C1", label="standard deviation that is stated")
ax.axvline(10, ls=":", color="k", label="--min-angle")
ax.set(xlabel="Angle (deg)", ylabel="Direction (deg)")
_ = ax.legend()
