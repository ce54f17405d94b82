"""Trials of all kinds that figures have to cope with, by name."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from elbowscrew import Settings, analyze, simulate_trial
from elbowscrew.model import Landmark, Landmarks, Recording, RigidBody
from elbowscrew.results.trial_views import view_of
from elbowscrew.view.trial_view import TrialView

SIMULATED: dict[str, dict[str, Any]] = {
    "short": {"frames": 120, "inversion": 55},
    "long": {"frames": 900, "inversion": 420, "repetitions": 25, "gaps": 40, "gap_frames": 30},
    "flat": {"frames": 200, "inversion": 90, "top_deg": 4.0, "marker_noise_mm": 0.02},
    "multi-cycle": {"frames": 150, "inversion": 70, "repetitions": 6, "proximal": "moving"},
    "gappy": {"frames": 300, "inversion": 140, "repetitions": 2, "gaps": 9, "gap_frames": 17, "proximal": "moving"},
    "two axes": {"frames": 240, "inversion": 110, "repetitions": 3, "joint_type": "two-axes", "proximal": "moving"},
    "wandering": {"frames": 150, "inversion": 70, "joint_type": "hinge", "wander_deg": 12.0, "proximal": "moving"},
    "noise-free": {"frames": 120, "inversion": 55, "joint_type": "hinge", "marker_noise_mm": 0.0},
    "still": {"frames": 120, "inversion": 55, "joint_type": "hinge", "top_deg": 0.01},
    "exact": {"frames": 120, "inversion": 55, "joint_type": "two-axes", "marker_noise_mm": 0.0},
    "orientations": {"frames": 150, "inversion": 70, "joint_type": "two-axes", "proximal": "moving"},
    "ball": {"frames": 200, "inversion": 90, "joint_type": "ball", "joint": "hip", "top_deg": 70.0},
}
SETTINGS: dict[str, dict[str, Any]] = {
    "flat": {"min_angle_deg": 1.0, "tolerance_mm": 0.1},
    "still": {"min_angle_deg": 0.3, "tolerance_mm": 0.1},
    "gappy": {"angle_unit": "rad", "length_unit": "m", "tolerance_mm": 2.0},
    "multi-cycle": {"express_in": "lab"},
    "wandering": {"express_in": "proximal"},
}
KINDS = tuple(SIMULATED)


@cache
def drawn_trial(kind: str) -> TrialView:
    """What is shown of a trial of a kind; the long one has 22,500 frames."""
    recording = simulate_trial(**{"seed": 7, **SIMULATED[kind]}).recording
    if kind == "orientations":
        turning = [
            RigidBody.from_quaternions(one.name, one.dual_quat_lab_body[:, :4], None) for one in recording.bodies
        ]
        recording = Recording.from_bodies(turning, rate_hz=100.0)
    landmarks = elbow_landmarks() if kind in ("two axes", "multi-cycle", "long") else None
    return view_of(analyze(recording, Settings(**SETTINGS.get(kind, {})), landmarks=landmarks))


def elbow_landmarks() -> Landmarks:
    """Landmarks about where an elbow of a synthetic trial has its bones, in the laboratory."""
    points: dict[str, Any] = {
        "EL": (0.36, 1.00, -0.18), "EM": (0.28, 1.00, -0.16), "US": (0.33, 0.76, -0.15), "RS": (0.38, 0.76, -0.17),
        "GH": (0.31, 1.30, -0.18),
    }  # fmt: skip
    found: dict[str, Any] = {name: Landmark(point=np.array(point), frame="lab") for name, point in points.items()}
    return Landmarks(side="right", **found)
