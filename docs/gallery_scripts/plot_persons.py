"""
Several trials in one picture
=============================

The largest angle of each trial with a box for each condition, from the table of a study.
"""

import matplotlib.pyplot as plt
import numpy as np

import elbowscrew

tops: dict[str, list[float]] = {"slow": [], "fast": []}
for person in range(5):
    for condition, frames in (("slow", 200), ("fast", 90)):
        top = 120 + 3 * person + (4 if condition == "fast" else 0)
        trial = elbowscrew.simulate_trial(frames=frames, inversion=frames // 2, top_deg=top, seed=person)
        tops[condition].append(float(np.degrees(np.nanmax(elbowscrew.analyze(trial.recording).screw.angle))))

figure, ax = plt.subplots()
ax.boxplot(list(tops.values()), tick_labels=list(tops))
for pair in zip(*tops.values(), strict=True):
    ax.plot([1, 2], pair, "o-", color="0.6", ms=4, lw=0.8)
_ = ax.set(ylabel="Largest angle (deg)")
