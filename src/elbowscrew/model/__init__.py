"""What flows through the program: recordings in, results out; frozen, in SI units and radians."""

from elbowscrew.model.anatomy import AnatomicalMotion, Landmark, Landmarks
from elbowscrew.model.axes import HelicalSteps, InstantaneousMotion
from elbowscrew.model.comparison import ComparedModels, ComparedOverTrials, Comparison, TrialsComparison
from elbowscrew.model.joint_axis import AxisPath, AxisWander, FittedJoint, JointAxis, LineEstimate, MeanLine, PoseNoise
from elbowscrew.model.mesh import Mesh
from elbowscrew.model.modeled import (
    BodyPoints,
    InterpolatedMotion,
    Keyframes,
    KeyframeSet,
    ModelPhases,
    PhaseLaw,
    RebuiltMotion,
    Selection,
)
from elbowscrew.model.quality import BodyQuality, ClockQuality, Spread
from elbowscrew.model.recording import (
    Marker,
    MarkerMotion,
    QualityWarning,
    Recording,
    RigidBody,
    Source,
    TrackingLoss,
    at_origin,
    invalid_marker_warning,
    invalid_warning,
    marker_matches,
    out_of_reach,
)
from elbowscrew.model.repetitions import CycleCurves, MovementPhases, Repeatability, Repetitions
from elbowscrew.model.results import Analysis, JointMotion, MeanAxis, ScrewMotion
from elbowscrew.model.sense import Sense

__all__ = [
    "Analysis",
    "AnatomicalMotion",
    "AxisPath",
    "AxisWander",
    "BodyPoints",
    "BodyQuality",
    "ClockQuality",
    "ComparedModels",
    "ComparedOverTrials",
    "Comparison",
    "CycleCurves",
    "FittedJoint",
    "HelicalSteps",
    "InstantaneousMotion",
    "InterpolatedMotion",
    "JointAxis",
    "JointMotion",
    "KeyframeSet",
    "Keyframes",
    "Landmark",
    "Landmarks",
    "LineEstimate",
    "Marker",
    "MarkerMotion",
    "MeanAxis",
    "MeanLine",
    "Mesh",
    "ModelPhases",
    "MovementPhases",
    "PhaseLaw",
    "PoseNoise",
    "QualityWarning",
    "RebuiltMotion",
    "Recording",
    "Repeatability",
    "Repetitions",
    "RigidBody",
    "ScrewMotion",
    "Selection",
    "Sense",
    "Source",
    "Spread",
    "TrackingLoss",
    "TrialsComparison",
    "at_origin",
    "invalid_marker_warning",
    "invalid_warning",
    "marker_matches",
    "out_of_reach",
]
