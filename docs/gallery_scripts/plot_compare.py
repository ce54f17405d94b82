"""
Methods and laws side by side
=============================

The error that each method leaves, under two laws of motion, with two to four keyframes in each phase.
"""

import matplotlib.pyplot as plt

import elbowscrew

recording = elbowscrew.simulate_trial(frames=200, inversion=90, seed=8).recording
plan = elbowscrew.ComparisonPlan(
    methods=("dlb", "sclerp"), laws=("cycloidal", "best"), blends=("piecewise",), counts=(2, 3, 4), data=("raw",)
)
models = elbowscrew.compare(recording, plan=plan).models.to_frame()

figure, ax = plt.subplots()
for (method, law), rows in models.groupby(["method", "law"]):
    by_count = rows.sort_values("keyframes_per_phase")
    ax.plot(by_count["keyframes_per_phase"], by_count["rms_displacement_mm"], "o-", label=f"{method}, {law}")
ax.set(yscale="log", xticks=[2, 3, 4], xlabel="Keyframes in each phase", ylabel="RMS displacement (mm)")
_ = ax.legend()
