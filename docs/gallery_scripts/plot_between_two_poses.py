"""
ScLERP and dual quaternion blending between two poses
=====================================================

Both go along the same screw, at other speeds: how far blending runs ahead and behind, for turns of several sizes.
"""

import matplotlib.pyplot as plt
import numpy as np

from elbowscrew.geometry import dual_quat_from_screw, sclerp, screw_from_dual_quat, sdlb

t = np.linspace(0.0, 1.0, 101)
start = dual_quat_from_screw(0.0, 0.0, [0, 0, 1], [0, 0, 0])
figure, ax = plt.subplots()
for degrees in (45, 90, 135):
    end = dual_quat_from_screw(np.radians(degrees), 0.01, [0, 0, 1], [0, 0, 0])
    even = screw_from_dual_quat(sclerp(start, end, t)).angle
    blended = screw_from_dual_quat(sdlb(start, end, t)).angle
    ax.plot(t, np.degrees(blended - even), label=f"a turn of {degrees} deg")
ax.set(xlabel="t", ylabel="Angle of the blend less that of ScLERP (deg)")
_ = ax.legend()
