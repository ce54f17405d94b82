"""What flows through the program: recordings in, results out; frozen, in SI units and radians."""

from elbowscrew.model.anatomy import AnatomicalMotion, Landmark, Landmarks
from elbowscrew.model.axes import HelicalSteps, InstantaneousMotion
from elbowscrew.model.joint_axis import FittedJoint, JointAxis, LineEstimate, PoseNoise
from elbowscrew.model.quality import BodyQuality, ClockQuality, Spread
from elbowscrew.model.recording import (
    Marker,
    QualityWarning,
    Recording,
    RigidBody,
    Source,
    TrackingLoss,
    invalid_marker_warning,
    invalid_warning,
    marker_matches,
    out_of_reach,
)
from elbowscrew.model.repetitions import MovementPhases, Repeatability, Repetitions
from elbowscrew.model.results import (
    Analysis,
    BodyPoints,
    InterpolatedMotion,
    JointMotion,
    Keyframes,
    MeanAxis,
    ScrewMotion,
)

__all__ = [
    "Analysis",
    "AnatomicalMotion",
    "BodyPoints",
    "BodyQuality",
    "ClockQuality",
    "FittedJoint",
    "HelicalSteps",
    "InstantaneousMotion",
    "InterpolatedMotion",
    "JointAxis",
    "JointMotion",
    "Keyframes",
    "Landmark",
    "Landmarks",
    "LineEstimate",
    "Marker",
    "MeanAxis",
    "MovementPhases",
    "PoseNoise",
    "QualityWarning",
    "Recording",
    "Repeatability",
    "Repetitions",
    "RigidBody",
    "ScrewMotion",
    "Source",
    "Spread",
    "TrackingLoss",
    "invalid_marker_warning",
    "invalid_warning",
    "marker_matches",
    "out_of_reach",
]
