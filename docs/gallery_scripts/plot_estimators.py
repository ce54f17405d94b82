"""
Three estimators of a hinge's axis
==================================

The mean of the frames' axes, SARA, and maximum likelihood, on twelve synthetic hinges of each range,
whose truth is known.
"""

import matplotlib.pyplot as plt
import numpy as np

import elbowscrew

ranges = (20, 60, 120)
errors: dict[str, list[list[float]]] = {"weighted mean": [], "SARA": [], "maximum likelihood": []}
for top in ranges:
    for found in errors.values():
        found.append([])
    for seed in range(12):
        trial = elbowscrew.simulate_trial(
            joint_type="hinge", top_deg=top, frames=120, inversion=60, marker_noise_mm=0.3, seed=seed
        )
        axis = elbowscrew.analyze(trial.recording, elbowscrew.Settings(joint_type="hinge")).joint_axis
        assert axis.hinge is not None
        truth = np.array(trial.truth["axis"]["distal"]["direction"])
        lines = (axis.weighted_mean, axis.sara, axis.hinge.line)
        for found, line in zip(errors.values(), lines, strict=True):
            found[-1].append(float(np.degrees(np.arccos(min(1.0, abs(line.direction @ truth))))))

figure, ax = plt.subplots()
for name, found in errors.items():
    ax.plot(ranges, [np.sqrt(np.mean(np.square(one))) for one in found], "o-", label=name)
ax.set(yscale="log", xlabel="Range (deg)", ylabel="RMS error of the direction (deg)")
_ = ax.legend()
