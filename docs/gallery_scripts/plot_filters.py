"""
Angular velocity, with and without a filter
===========================================

Speeds are always taken from filtered poses, at a cut-off that the recording itself tells. Differences of unfiltered
poses show why.
"""

import matplotlib.pyplot as plt
import numpy as np

import elbowscrew

analysis = elbowscrew.analyze(elbowscrew.simulate_trial(marker_noise_mm=0.5, seed=6).recording)
differences = np.gradient(np.degrees(analysis.screw.angle), analysis.elapsed)
filtered = np.degrees(analysis.instantaneous.angular_velocity)

figure, ax = plt.subplots()
ax.plot(analysis.elapsed, differences, "0.7", lw=0.8, label="differences of the angle")
ax.plot(analysis.elapsed, filtered, "C0", label=f"filtered at {analysis.instantaneous.lowpass_hz:.1f} Hz")
ax.set(xlabel="Time (s)", ylabel="Angular velocity (deg/s)")
_ = ax.legend()
