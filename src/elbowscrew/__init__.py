"""Screw motion of a joint from OptiTrack recordings, by dual quaternions.

>>> import elbowscrew
>>> recording = elbowscrew.simulate_trial(top_deg=120, seed=1).recording
>>> analysis = elbowscrew.analyze(recording, elbowscrew.Settings(express_in="arm"))
>>> bool(119 < analysis.screw.to_frame()["theta_deg"].max() < 121)
True
"""

from __future__ import annotations

from elbowscrew._version import __version__

TYPE_CHECKING = False  # typing itself would double the time of `elbowscrew --version`
if TYPE_CHECKING:
    from typing import Any

    from elbowscrew.comparing import compare_trials
    from elbowscrew.errors import ElbowscrewError
    from elbowscrew.model import Analysis, Comparison, Landmark, Landmarks, Recording, RigidBody, TrialsComparison
    from elbowscrew.motion.analysis import analyze
    from elbowscrew.motion.interpolation.comparison import compare
    from elbowscrew.motion.interpolation.keyframe_sources import ComparisonPlan
    from elbowscrew.motion.interpolation.rebuilding import interpolate, keyframes_of
    from elbowscrew.reading.landmarks import read_landmarks
    from elbowscrew.reading.registry import read_recording
    from elbowscrew.results.keyframe_table import read_keyframes
    from elbowscrew.results.summary import summary_from_analysis
    from elbowscrew.saving import save_analysis, save_comparison, save_motion, save_simulation
    from elbowscrew.settings import Settings
    from elbowscrew.simulate import Simulation, simulate_trial

__all__ = [
    "Analysis",
    "Comparison",
    "ComparisonPlan",
    "ElbowscrewError",
    "Landmark",
    "Landmarks",
    "Recording",
    "RigidBody",
    "Settings",
    "Simulation",
    "TrialsComparison",
    "__version__",
    "analyze",
    "compare",
    "compare_trials",
    "interpolate",
    "keyframes_of",
    "read_keyframes",
    "read_landmarks",
    "read_recording",
    "save_analysis",
    "save_comparison",
    "save_motion",
    "save_simulation",
    "simulate_trial",
    "summary_from_analysis",
]

# Names are loaded when first used, so that `elbowscrew --help` starts without NumPy.
_HOME = {
    "Analysis": "model",
    "Comparison": "model",
    "ComparisonPlan": "motion.interpolation.keyframe_sources",
    "ElbowscrewError": "errors",
    "Landmark": "model",
    "Landmarks": "model",
    "Recording": "model",
    "RigidBody": "model",
    "Settings": "settings",
    "Simulation": "simulate",
    "TrialsComparison": "model",
    "analyze": "motion.analysis",
    "compare": "motion.interpolation.comparison",
    "compare_trials": "comparing",
    "interpolate": "motion.interpolation.rebuilding",
    "keyframes_of": "motion.interpolation.rebuilding",
    "read_keyframes": "results.keyframe_table",
    "read_landmarks": "reading.landmarks",
    "read_recording": "reading.registry",
    "save_analysis": "saving",
    "save_comparison": "saving",
    "save_motion": "saving",
    "save_simulation": "saving",
    "simulate_trial": "simulate",
    "summary_from_analysis": "results.summary",
}


def __getattr__(name: str) -> Any:
    if name in _HOME:
        from importlib import import_module

        return getattr(import_module(f"elbowscrew.{_HOME[name]}"), name)
    msg = f"module 'elbowscrew' has no attribute {name!r}"
    raise AttributeError(msg)


def __dir__() -> list[str]:
    return sorted(__all__)
