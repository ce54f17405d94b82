"""
An axis that wanders
====================

How far the axis turns with the angle, where that is surely more than noise.
"""

import matplotlib.pyplot as plt
import numpy as np

import elbowscrew

recording = elbowscrew.simulate_trial(joint_type="hinge", wander_deg=10, frames=300, inversion=150, seed=11).recording
path = elbowscrew.analyze(recording).joint_axis.path
assert path is not None
tilt = np.degrees(np.arccos(np.clip(path.direction @ path.direction[0], -1, 1)))

figure, ax = plt.subplots()
ax.errorbar(np.degrees(path.angle), tilt, 1.96 * np.degrees(path.axis_sd), fmt="o-", capsize=3)
_ = ax.set(xlabel="Angle (deg)", ylabel="Tilt since the first part (deg)")
