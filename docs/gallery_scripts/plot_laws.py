"""
Laws of motion
==============

How the share of a phase goes from 0 to 1, and how fast. The cycloidal law is that of the paper; polynomial 3-4-5
is minimum jerk, which is close to how people move.
"""

import matplotlib.pyplot as plt
import numpy as np

from elbowscrew.choices import CLOSED_LAWS
from elbowscrew.motion.interpolation.laws import LAWS

tau = np.linspace(0.0, 1.0, 200)
figure, (position, velocity) = plt.subplots(1, 2, figsize=(8, 3.5), layout="constrained")
for name in CLOSED_LAWS:
    position.plot(tau, LAWS[name].position(tau), lw=1)
    velocity.plot(tau, LAWS[name].velocity(tau), lw=1, label=name)
position.set(xlabel="Time in the phase", ylabel="Share of the motion")
velocity.set(xlabel="Time in the phase", ylabel="Speed")
_ = velocity.legend(fontsize=7)
