"""
Lost frames
===========

Short gaps are filled along a screw motion and marked; longer ones stay open.
"""

import matplotlib.pyplot as plt
import numpy as np

import elbowscrew

trial = elbowscrew.simulate_trial(frames=200, inversion=90, gaps=4, gap_frames=8, seed=10)
figure, ax = plt.subplots()
for limit, color, label in ((0.0, "k", "measured"), (0.1, "C1", "filled")):
    screw = elbowscrew.analyze(trial.recording, elbowscrew.Settings(max_gap_s=limit)).screw
    angle = np.where(screw.filled if limit else screw.valid, np.degrees(screw.angle), np.nan)
    ax.plot(screw.time_s, angle, ".", ms=3, color=color, label=label)
ax.set(xlabel="Time (s)", ylabel="Angle (deg)")
_ = ax.legend()
