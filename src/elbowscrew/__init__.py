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

    from elbowscrew.errors import ElbowscrewError
    from elbowscrew.io.landmarks import read_landmarks
    from elbowscrew.io.reading import read_recording
    from elbowscrew.io.summary import summary_from_analysis
    from elbowscrew.model import Analysis, Landmark, Landmarks, Recording, RigidBody
    from elbowscrew.motion.analysis import analyze
    from elbowscrew.results import save_analysis, save_simulation
    from elbowscrew.settings import Settings
    from elbowscrew.simulate import Simulation, simulate_trial

__all__ = [
    "Analysis",
    "ElbowscrewError",
    "Landmark",
    "Landmarks",
    "Recording",
    "RigidBody",
    "Settings",
    "Simulation",
    "__version__",
    "analyze",
    "read_landmarks",
    "read_recording",
    "save_analysis",
    "save_simulation",
    "simulate_trial",
    "summary_from_analysis",
]

# Names are loaded when first used, so that `elbowscrew --help` starts without NumPy.
_HOME = {
    "Analysis": "model",
    "ElbowscrewError": "errors",
    "Landmark": "model",
    "Landmarks": "model",
    "Recording": "model",
    "RigidBody": "model",
    "Settings": "settings",
    "Simulation": "simulate",
    "analyze": "motion.analysis",
    "read_landmarks": "io.landmarks",
    "read_recording": "io.reading",
    "save_analysis": "results",
    "save_simulation": "results",
    "simulate_trial": "simulate",
    "summary_from_analysis": "io.summary",
}


def __getattr__(name: str) -> Any:
    if name in _HOME:
        from importlib import import_module

        return getattr(import_module(f"elbowscrew.{_HOME[name]}"), name)
    msg = f"module 'elbowscrew' has no attribute {name!r}"
    raise AttributeError(msg)


def __dir__() -> list[str]:
    return sorted(__all__)
