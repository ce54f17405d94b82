"""
An elbow with two axes
======================

An elbow that flexes and pronates has two axes. Its two angles are independent here: it pronates one way going up, and
the other way coming down.
"""

import matplotlib.pyplot as plt
import numpy as np

import elbowscrew

analysis = elbowscrew.analyze(
    elbowscrew.simulate_trial(joint_type="two-axes", frames=300, inversion=140, seed=4).recording
)
angles = analysis.joint_angles
assert angles is not None

figure, (over_time, together) = plt.subplots(1, 2, figsize=(8, 3.5), layout="constrained")
over_time.plot(angles.time_s, np.degrees(angles.angle), label=["about axis 1", "about axis 2"])
over_time.set(xlabel="Time (s)", ylabel="Angle (deg)")
over_time.legend()
together.plot(*np.degrees(angles.angle).T)
_ = together.set(xlabel="About axis 1 (deg)", ylabel="About axis 2 (deg)")
