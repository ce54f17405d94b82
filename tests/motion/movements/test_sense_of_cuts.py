"""The cuts turn where theta turns, whatever makes one of two like excursions the larger."""

from __future__ import annotations

import numpy as np
import pytest

from elbowscrew import analyze, simulate_trial
from elbowscrew.settings import Settings


@pytest.mark.parametrize("express_in", ["distal", "proximal", "lab"])
def test_a_reference_window_that_moves_leaves_cycles_out_and_back(express_in: str) -> None:
    """From the window's own mean the other side is the farther one than from its first frame."""
    trial = simulate_trial(joint_type="hinge", top_deg=90.0, frames=800, inversion=200, repetitions=2, seed=3)
    found = analyze(trial.recording, Settings(reference=70, reference_window=100, express_in=express_in))
    repetitions = found.repetitions
    theta = np.interp(repetitions.start_time_s, found.screw.time_s, found.screw.angle)
    top = found.screw.angle[repetitions.inversion_frame - found.screw.frame[0]]
    assert (np.degrees(top - theta) > 80.0).all()
    # 90 deg in 2 and in 6 s by minimum jerk: 1.5 and 0.49 rad/s
    assert (repetitions.outward_speed > 0.4).all()
    assert (repetitions.back_speed > 0.4).all()
