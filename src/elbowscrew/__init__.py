"""Screw motion of a joint from OptiTrack recordings, by dual quaternions.

>>> import elbowscrew
>>> recording = elbowscrew.simulate_recording(top_deg=120, seed=1).recording
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
    from elbowscrew.io.reading import read_recording
    from elbowscrew.model import Analysis, Recording, RigidBody
    from elbowscrew.motion.analysis import analyze
    from elbowscrew.results import save_analysis
    from elbowscrew.settings import Settings
    from elbowscrew.simulate import Simulation, simulate_recording

__all__ = [
    "Analysis",
    "ElbowscrewError",
    "Recording",
    "RigidBody",
    "Settings",
    "Simulation",
    "__version__",
    "analyze",
    "read_recording",
    "save_analysis",
    "simulate_recording",
]

# Names are loaded when first used, so that `elbowscrew --help` starts without NumPy.
_HOME = {
    "Analysis": "model",
    "ElbowscrewError": "errors",
    "Recording": "model",
    "RigidBody": "model",
    "Settings": "settings",
    "Simulation": "simulate",
    "analyze": "motion.analysis",
    "read_recording": "io.reading",
    "save_analysis": "results",
    "simulate_recording": "simulate",
}


def __getattr__(name: str) -> Any:
    if name in _HOME:
        from importlib import import_module

        return getattr(import_module(f"elbowscrew.{_HOME[name]}"), name)
    msg = f"module 'elbowscrew' has no attribute {name!r}"
    raise AttributeError(msg)


def __dir__() -> list[str]:
    return sorted(__all__)
