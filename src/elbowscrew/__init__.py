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
    from elbowscrew import geometry as geometry
    from elbowscrew import plots as plots
    from elbowscrew import samples as samples
    from elbowscrew.errors import ElbowscrewError, RecordingError
    from elbowscrew.interface.analysis import Analysis
    from elbowscrew.interface.calls import (
        analyze,
        batch,
        compare,
        compare_trials,
        interpolate,
        read_result,
        simulate_trial,
    )
    from elbowscrew.interface.study import StudyResult
    from elbowscrew.model import (
        Comparison,
        KeyframeSet,
        Landmark,
        Landmarks,
        Mesh,
        Recording,
        RigidBody,
        TrialsComparison,
    )
    from elbowscrew.motion.interpolation.keyframe_sources import ComparisonPlan
    from elbowscrew.motion.interpolation.rebuilding import keyframes_of
    from elbowscrew.reading.landmarks import read_landmarks
    from elbowscrew.reading.meshes import read_mesh
    from elbowscrew.reading.options import ReadOptions
    from elbowscrew.reading.plugged import Reader
    from elbowscrew.reading.registry import read_recording
    from elbowscrew.results.keyframe_table import read_keyframes
    from elbowscrew.results.plugged import ExportedTrial
    from elbowscrew.results.summary import summary_from_analysis
    from elbowscrew.saving import save_analysis, save_comparison, save_motion, save_simulation
    from elbowscrew.settings import Settings
    from elbowscrew.simulate import SimulatedTrial, Simulation

__all__ = [
    "Analysis",
    "Comparison",
    "ComparisonPlan",
    "ElbowscrewError",
    "ExportedTrial",
    "KeyframeSet",
    "Landmark",
    "Landmarks",
    "Mesh",
    "ReadOptions",
    "Reader",
    "Recording",
    "RecordingError",
    "RigidBody",
    "Settings",
    "SimulatedTrial",
    "Simulation",
    "StudyResult",
    "TrialsComparison",
    "__version__",
    "analyze",
    "batch",
    "compare",
    "compare_trials",
    "interpolate",
    "keyframes_of",
    "read_keyframes",
    "read_landmarks",
    "read_mesh",
    "read_recording",
    "read_result",
    "save_analysis",
    "save_comparison",
    "save_motion",
    "save_simulation",
    "simulate_trial",
    "summary_from_analysis",
]

# Names are loaded when first used, so that `elbowscrew --help` starts without NumPy.
_HOME = {
    "Analysis": "interface.analysis",
    "Comparison": "model",
    "ComparisonPlan": "motion.interpolation.keyframe_sources",
    "ElbowscrewError": "errors",
    "ExportedTrial": "results.plugged",
    "KeyframeSet": "model",
    "Landmark": "model",
    "Landmarks": "model",
    "Mesh": "model",
    "ReadOptions": "reading.options",
    "Reader": "reading.plugged",
    "Recording": "model",
    "RecordingError": "errors",
    "RigidBody": "model",
    "Settings": "settings",
    "SimulatedTrial": "simulate",
    "Simulation": "simulate",
    "StudyResult": "interface.study",
    "TrialsComparison": "model",
}
_FUNCTIONS = {
    "analyze": "interface.calls",
    "batch": "interface.calls",
    "compare": "interface.calls",
    "compare_trials": "interface.calls",
    "interpolate": "interface.calls",
    "keyframes_of": "motion.interpolation.rebuilding",
    "read_keyframes": "results.keyframe_table",
    "read_landmarks": "reading.landmarks",
    "read_mesh": "reading.meshes",
    "read_recording": "reading.registry",
    "read_result": "interface.calls",
    "save_analysis": "saving",
    "save_comparison": "saving",
    "save_motion": "saving",
    "save_simulation": "saving",
    "simulate_trial": "interface.calls",
    "summary_from_analysis": "results.summary",
}
_MODULES = ("geometry", "plots", "samples")


def __getattr__(name: str) -> object:
    from importlib import import_module

    if name in _MODULES:
        return import_module(f"elbowscrew.{name}")
    if name in _HOME:
        return getattr(import_module(f"elbowscrew.{_HOME[name]}"), name)
    if name in _FUNCTIONS:
        from elbowscrew.interface.python_words import public

        globals()[name] = public(getattr(import_module(f"elbowscrew.{_FUNCTIONS[name]}"), name))
        return globals()[name]
    hint = "" if name.startswith("_") else _hint(name)
    msg = f"module 'elbowscrew' has no attribute {name!r}{hint}"
    raise AttributeError(msg)


def _hint(name: str) -> str:
    import os

    place = os.path.join(os.path.dirname(__file__), name)  # noqa: PTH118, PTH120 - pathlib is not loaded for this
    if os.path.exists(place) or os.path.exists(f"{place}.py"):  # noqa: PTH110 - a module that is about to be imported
        return ""
    from elbowscrew.errors import did_you_mean

    return did_you_mean(name, __dir__())


def __dir__() -> list[str]:
    return sorted((*__all__, *_MODULES))
