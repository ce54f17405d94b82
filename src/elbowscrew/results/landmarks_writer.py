"""Landmarks as the TOML file that `elbowscrew.reading.landmarks` reads."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from elbowscrew.model.anatomy import LANDMARKS, Landmark, LandmarkFrame, Landmarks

_BODIES: Final[dict[LandmarkFrame, str]] = {"proximal": "arm", "distal": "forearm", "lab": "lab"}


def landmarks_lines(landmarks: Landmarks, about: str) -> Iterator[str]:
    """Give the file's lines, the first a remark of what they are about."""
    yield f"# {about}"
    yield f'side = "{landmarks.side}"'
    yield ""
    yield "[landmarks]"
    for name, landmark in landmarks.by_name.items():
        yield f"{name} = {_value(landmark)}  # {LANDMARKS[name]}"


def _value(landmark: Landmark) -> str:
    if landmark.point is None or landmark.frame is None:
        return str([*landmark.markers])
    mm = ", ".join(f"{1000.0 * value:.2f}" for value in landmark.point)
    return f'{{ body = "{_BODIES[landmark.frame]}", mm = [{mm}] }}'
