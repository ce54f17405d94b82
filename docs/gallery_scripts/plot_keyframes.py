"""
How many poses a motion needs
=============================

The largest error of the best set of so many measured poses, with an even screw motion between them.
"""

import matplotlib.pyplot as plt

import elbowscrew

figure, ax = plt.subplots()
for name, noise in (("a hinge, markers to 0.1 mm", 0.1), ("a hinge, markers to 1.5 mm", 1.5)):
    recording = elbowscrew.simulate_trial(frames=200, inversion=90, marker_noise_mm=noise, seed=7).recording
    selection = elbowscrew.analyze(recording, elbowscrew.Settings(tolerance_mm=2)).selection
    assert selection is not None
    ax.semilogy(selection.count, 1000 * selection.largest, "o-", label=name)
ax.axhline(2, ls=":", color="k", label="tolerance")
ax.set(xlabel="Keyframes", ylabel="Largest RMS displacement (mm)")
_ = ax.legend()
