"""Lines in space: the angles and distances between them, and where they pierce a plane."""

from __future__ import annotations

import numpy as np

from elbowscrew.geometry._small_angle import divide, length
from elbowscrew.geometry.arrays import Float


def direction_between(line_a: Float, line_b: Float) -> Float:
    """Angle between the directions of two lines.

    Parameters
    ----------
    line_a, line_b : ndarray, shape (..., 6) or (..., 3)
        Plücker vectors, or vectors of any length.

    Returns
    -------
    ndarray, shape (...)
        Radians in [0, pi], correct near both ends.

    References
    ----------
    P 19: the first three numbers of a Plücker vector are the direction.

    Examples
    --------
    >>> float(np.degrees(direction_between(np.array([0.0, 0, 1]), np.array([0.0, 2, -2]))).round(9))
    135.0
    """
    a, b = line_a[..., :3], line_b[..., :3]
    angle: Float = np.arctan2(length(np.cross(a, b)), np.sum(a * b, axis=-1))
    return angle


def angle_of_lines(line_a: Float, line_b: Float) -> Float:
    """Angle between lines, whichever way round they are given.

    Parameters
    ----------
    line_a, line_b : ndarray, shape (..., 6) or (..., 3)
        Plücker vectors, or vectors of any length.

    Returns
    -------
    ndarray, shape (...)
        Radians in [0, pi/2].

    References
    ----------
    P 19, of lines without a sense.

    Examples
    --------
    >>> float(np.degrees(angle_of_lines(np.array([0.0, 0, 1]), np.array([0.0, 2, -2]))).round(9))
    45.0
    """
    angle = direction_between(line_a, line_b)
    return np.minimum(angle, np.pi - angle)


def distance_across(line: Float, other: Float, near: Float) -> Float:
    """Distance of a line from another, across the former where it passes a point.

    Parameters
    ----------
    line, other : ndarray, shape (..., 6)
        Plücker vectors.
    near : ndarray, shape (3,)

    Returns
    -------
    ndarray, shape (...)
        NaN where the other line never meets the plane across the former.

    References
    ----------
    P 14 and 19: the line's point nearest the origin, and from there along it to that nearest the point given.

    Examples
    --------
    >>> along_z, beside_it = np.array([0.0, 0, 1, 0, 0, 0]), np.array([0.0, 0, 1, 0, -3, 0])
    >>> float(distance_across(along_z, beside_it, np.zeros(3)))
    3.0
    """
    direction = line[..., :3]
    foot = np.cross(direction, line[..., 3:])
    center = foot + np.sum((near - foot) * direction, axis=-1, keepdims=True) * direction
    return length(piercing(other[..., :3], np.cross(other[..., :3], other[..., 3:]), direction, center) - center)


def piercing(direction: Float, point: Float, normal: Float, center: Float) -> Float:
    """Where lines pierce the plane across a normal through a center.

    Parameters
    ----------
    direction, point : ndarray, shape (..., 3)
        Of the lines.
    normal, center : ndarray, shape (..., 3)
        Of the planes; the normal may have any length.

    Returns
    -------
    ndarray, shape (..., 3)
        NaN where a line lies across the normal.

    References
    ----------
    ``p + ((c - p) . n / h . n) h``, with p the point, h the direction, c the center and n the normal.

    Examples
    --------
    >>> piercing(np.array([0.0, 1, 1]), np.zeros(3), np.array([0.0, 0, 1]), np.array([0.0, 0, 2]))
    array([0., 2., 2.])
    """
    ahead = np.sum((center - point) * normal, axis=-1)
    return point + divide(ahead, np.sum(direction * normal, axis=-1))[..., None] * direction
