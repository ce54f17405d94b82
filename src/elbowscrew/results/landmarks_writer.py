"""Landmarks as the TOML file that `elbowscrew.reading.landmarks` reads."""

from __future__ import annotations

from collections.abc import Iterator

from elbowscrew.joints import joints_of
from elbowscrew.model.anatomy import LANDMARKS, Landmark, LandmarkFrame, Landmarks


def landmarks_lines(landmarks: Landmarks, about: str) -> Iterator[str]:
    """Give the file's lines, the first a remark of what they are about."""
    words = joints_of(landmarks.joint)[0]
    bodies: dict[LandmarkFrame, str] = {"proximal": words.proximal.short, "distal": words.distal.short, "lab": "lab"}
    yield f"# {about}"
    yield f'side = "{landmarks.side}"'
    yield ""
    yield "[landmarks]"
    for name, landmark in landmarks.by_name.items():
        yield f"{name} = {_value(landmark, bodies)}  # {LANDMARKS[name]}"


def _value(landmark: Landmark, bodies: dict[LandmarkFrame, str]) -> str:
    if landmark.point is None or landmark.frame is None:
        return str([*landmark.markers])
    mm = ", ".join(f"{1000.0 * value:.2f}" for value in landmark.point)
    return f'{{ body = "{bodies[landmark.frame]}", mm = [{mm}] }}'
