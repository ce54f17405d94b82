"""Where anatomical landmarks lie in the bodies they rest in."""

from __future__ import annotations

from typing import Final

import numpy as np

from elbowscrew.errors import SettingError, did_you_mean, told_names
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import conjugate, multiply, transform_points
from elbowscrew.joints import joints_of
from elbowscrew.model import JointMotion, Marker, QualityWarning, Recording, RigidBody
from elbowscrew.model.anatomy import LANDMARK_BODIES, Landmark, Landmarks
from elbowscrew.motion.screws.relative import IDENTITY

_LARGEST_RMS: Final = 0.020


def landmark_points(
    landmarks: Landmarks, recording: Recording, bodies: dict[str, RigidBody | None], joint: JointMotion
) -> tuple[dict[str, Float], tuple[QualityWarning, ...]]:
    """Find each landmark in the frame of its own body, shape (3,).

    Raises
    ------
    SettingError
        Naming all that cannot be found.
    """
    proximal_from = {
        "proximal": IDENTITY,
        "distal": joint.reference,
        "lab": conjugate(joint.dual_quat_lab_proximal),
    }
    words = joints_of(landmarks.joint)[0]
    spoken = {"proximal": words.proximal.short, "distal": words.distal.short}
    points: dict[str, Float] = {}
    faults: list[str] = []
    warnings: list[QualityWarning] = []
    for name, landmark in landmarks.by_name.items():
        role = LANDMARK_BODIES[name]
        if landmark.point is not None and landmark.frame is not None:
            change = multiply(conjugate(proximal_from[role]), proximal_from[landmark.frame])
            points[name] = transform_points(change, landmark.point)
            continue
        try:
            points[name], moving = _point_of_markers(recording, landmark, bodies[role], name, spoken[role])
            warnings += moving
        except SettingError as error:
            faults.append(f"{name}: {error}")
    if faults:
        msg = (
            f"{landmarks.source}: {'; '.join(faults)}; the recording's markers: "
            f"{told_names(_names(recording)) or 'none'}. Name others of them, or give coordinates, "
            f'{{ body = "{spoken["proximal"]}", mm = [x, y, z] }}'
        )
        raise SettingError(msg)
    return points, tuple(warnings)


def _point_of_markers(
    recording: Recording, landmark: Landmark, body: RigidBody | None, name: str, spoken: str
) -> tuple[Float, list[QualityWarning]]:
    """Middle of the points, shape (3,), that markers have in their body in the median of the frames that see both."""
    points, warnings = [], []
    for wanted in landmark.markers:
        seen = _marker(recording, wanted).position
        # The very origin is what some systems write for a marker that they do not see.
        seen = np.where((seen == 0.0).all(axis=1, keepdims=True), np.nan, seen)
        inside = seen
        if body is not None:
            inside = transform_points(conjugate(body.dual_quat_lab_body), seen)[body.tracked]
        inside = inside[np.isfinite(inside).all(axis=1)]
        if not len(inside):
            msg = f"marker {wanted!r} is never seen together with the {spoken}"
            raise SettingError(msg)
        point = np.median(inside, axis=0)
        points.append(point)
        rms = float(np.sqrt(np.mean(np.sum((inside - point) ** 2, axis=1))))
        if rms > _LARGEST_RMS:
            message = (
                f"the marker {wanted!r} of landmark {name} moves in the {spoken} by {1000.0 * rms:.0f} mm RMS: "
                "it sits loosely or on another segment, or is mistaken for another; its median point is taken"
            )
            warnings.append(QualityWarning(code="landmark-moves", message=message))
    return np.mean(points, axis=0), warnings


def _marker(recording: Recording, wanted: str) -> Marker:
    """Find a marker by its exact name, or by its name in any case."""
    exact = [marker for marker in recording.markers if marker.name == wanted]
    found = exact or [marker for marker in recording.markers if marker.name.casefold() == wanted.casefold()]
    if len(found) == 1:
        return found[0]
    if found:
        msg = f"{len(found)} markers of the recording are named {wanted!r}"
        raise SettingError(msg)
    msg = f"there is no marker {wanted!r}{did_you_mean(wanted, _names(recording))}"
    raise SettingError(msg)


def _names(recording: Recording) -> tuple[str, ...]:
    """Names of all markers, of a file also of those that were not read."""
    every = () if recording.source is None else recording.source.markers
    return every or tuple(marker.name for marker in recording.markers)
