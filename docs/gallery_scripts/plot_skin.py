"""
What skin motion does to the interval
=====================================

If clusters move on their bones with the motion, no trial can show it. Stating how much (``--skin-motion``) widens the
interval of the axis; a larger range of motion narrows it.
"""

import matplotlib.pyplot as plt
import numpy as np

import elbowscrew

stated = (0.0, 1.0, 2.0, 4.0)
figure, ax = plt.subplots()
for top in (40, 80, 140):
    recording = elbowscrew.simulate_trial(joint_type="hinge", top_deg=top, frames=160, inversion=80, seed=5).recording
    cones = []
    for turn in stated:
        settings = elbowscrew.Settings(joint_type="hinge", skin_motion=(0.0, turn))
        hinge = elbowscrew.analyze(recording, settings).joint_axis.hinge
        assert hinge is not None
        cones.append(np.degrees(hinge.axis_cone))
    ax.plot(stated, cones, "o-", label=f"range of {top} deg")
ax.set(xlabel="Stated turn of the cluster on its bone (deg)", ylabel="95 % cone of the axis (deg)")
_ = ax.legend()
