"""Lines in space: the angles and distances between them, and where they pierce a plane."""

from __future__ import annotations

import numpy as np

from elbowscrew.geometry._small_angle import divide, length
from elbowscrew.geometry.arrays import Float


def direction_between(line_a: Float, line_b: Float) -> Float:
    """Angle between the directions of two lines (..., 6) or two vectors (..., 3), radians in [0, pi], shape (...)."""
    a, b = line_a[..., :3], line_b[..., :3]
    angle: Float = np.arctan2(length(np.cross(a, b)), np.sum(a * b, axis=-1))
    return angle


def angle_of_lines(line_a: Float, line_b: Float) -> Float:
    """Angle between lines (..., 6) or vectors (..., 3), whichever way round, radians in [0, pi/2], shape (...)."""
    angle = direction_between(line_a, line_b)
    return np.minimum(angle, np.pi - angle)


def distance_across(line: Float, other: Float, near: Float) -> Float:
    """Distance (..., ) of a line from another, across the former where it passes a point (3,); lines (..., 6)."""
    direction = line[..., :3]
    foot = np.cross(direction, line[..., 3:])
    center = foot + np.sum((near - foot) * direction, axis=-1, keepdims=True) * direction
    return length(piercing(other[..., :3], np.cross(other[..., :3], other[..., 3:]), direction, center) - center)


def piercing(direction: Float, point: Float, normal: Float, center: Float) -> Float:
    """Where lines, by direction and point, pierce the plane across a normal through a center; all of shape (..., 3)."""
    ahead = np.sum((center - point) * normal, axis=-1)
    return point + divide(ahead, np.sum(direction * normal, axis=-1))[..., None] * direction
