"""
Angle of a joint, measured and modeled
======================================

The angle since the reference, and a model that goes through three poses under a cycloidal law.
"""

import matplotlib.pyplot as plt
import numpy as np

import elbowscrew

analysis = elbowscrew.analyze(elbowscrew.simulate_trial(seed=1).recording)

figure, ax = plt.subplots()
ax.plot(analysis.elapsed, np.degrees(analysis.screw.angle), "k", label="measured")
ax.plot(analysis.elapsed, np.degrees(analysis.interpolated.angle), "--", label="DLB through 3 poses")
ax.set(xlabel="Time (s)", ylabel="Angle (deg)")
_ = ax.legend()
