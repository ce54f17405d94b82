"""
Repetitions over their own time
===============================

Each cycle from 0 to 100 % of its time, with mean and standard deviation.
"""

import matplotlib.pyplot as plt
import numpy as np

import elbowscrew

recording = elbowscrew.simulate_trial(
    repetitions=6, frames=150, inversion=70, tremor_deg=6, tremor_hz=0.27, seed=9
).recording
curves = elbowscrew.analyze(recording).cycle_curves
angle = np.degrees(curves.angle).reshape(-1, 101)
percent = curves.percent[:101]
mean, deviation = np.nanmean(angle, axis=0), np.nanstd(angle, axis=0, ddof=1)

figure, ax = plt.subplots()
ax.plot(percent, angle.T, "0.7", lw=0.8)
ax.fill_between(percent, mean - deviation, mean + deviation, alpha=0.3)
ax.plot(percent, mean, "k")
_ = ax.set(xlabel="Cycle (%)", ylabel="Angle (deg)")
