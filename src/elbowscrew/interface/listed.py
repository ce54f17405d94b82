"""Tables of what is no file of a result: the estimates of the joint, and the warnings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Final, Literal

import numpy as np
from numpy.typing import NDArray

from elbowscrew.geometry.arrays import Bool, Float
from elbowscrew.model.joint_summary_types import JointSummary, Vector
from elbowscrew.model.summary_types import WarningSummary
from elbowscrew.model.table_record import TableRecord
from elbowscrew.quantities import Quantity
from elbowscrew.tables import Column


def _columns(*named: tuple[str, str, int | None, Quantity]) -> tuple[Column, ...]:
    return tuple(Column(name=name, attribute=at, component=k, quantity=kind) for name, at, k, kind in named)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class JointEstimates(TableRecord):
    """The joint's axes and center by all estimators, in the frame the screws are expressed in; NaN where not known.

    Attributes
    ----------
    estimate : ndarray of str, shape (K,)
        "hinge", "screw_hinge", "mean_axis", "axis1", "axis2", "center", "weighted_mean" or "sara".
    preferred : ndarray of bool, shape (K,)
        What is to be told first of this joint.
    direction, point : ndarray, shape (K, 3)
        Unit vector, and point (m) nearest the origin; of a center, which has no direction, itself.
    axis_cone, point_radius : ndarray, shape (K,)
        Half-angle (rad) and radius (m) that hold 95 % of the errors.
    slide_per_radian : ndarray, shape (K,)
        m; of a screw-hinge.
    residual_rotation, residual_translation : ndarray, shape (K,)
        RMS that a fit leaves, rad and m.
    """

    table: ClassVar = _columns(
        ("estimate", "estimate", None, Quantity.LABEL),
        ("preferred", "preferred", None, Quantity.FLAG),
        *((f"axis_{'xyz'[k]}", "direction", k, Quantity.NUMBER) for k in range(3)),
        *((f"point_{'xyz'[k]}", "point", k, Quantity.LENGTH) for k in range(3)),
        ("axis_cone95", "axis_cone", None, Quantity.ANGLE),
        ("point_radius95", "point_radius", None, Quantity.LENGTH),
        ("slide_per_radian", "slide_per_radian", None, Quantity.LENGTH),
        ("residual_rotation", "residual_rotation", None, Quantity.ANGLE),
        ("residual_translation", "residual_translation", None, Quantity.LENGTH),
    )

    estimate: NDArray[np.str_]
    preferred: Bool
    direction: Float
    point: Float
    axis_cone: Float
    point_radius: Float
    slide_per_radian: Float
    residual_rotation: Float
    residual_translation: Float


_ESTIMATES: Final[tuple[Literal["hinge", "screw_hinge", "mean_axis", "weighted_mean", "sara"], ...]] = (
    "hinge", "screw_hinge", "mean_axis", "weighted_mean", "sara"
)  # fmt: skip
_NUMBERS: Final = {
    "cone95_deg": "axis_cone95_deg",
    "radius95_mm": "point_radius95_mm",
}
"""What the axes of two call what all other estimates call otherwise."""


def joint_estimates(joint: JointSummary) -> JointEstimates:
    """List the estimates that ``joint.json`` has."""
    found: dict[str, dict[str, object]] = {}
    for name in _ESTIMATES:
        line = joint[name]
        if line is not None:
            found[name] = dict(line)
    first: list[str | None] = ["mean_axis" if joint["mean_axis"] is not None else joint["preferred"]]
    two, ball = joint["two_axes"], joint["ball"]
    if two is not None:
        lines = {"axis1": dict(two["axis1"]), "axis2": dict(two["axis2"])}
        found |= {name: {_NUMBERS.get(key, key): one for key, one in line.items()} for name, line in lines.items()}
        first = ["axis1", "axis2"]
    if ball is not None:
        found["center"] = {"point_mm": _center(joint), "point_radius95_mm": ball["radius95_mm"]}
        first = ["center"]
    rows = list(found.values())
    return JointEstimates(
        estimate=np.array(list(found)),
        preferred=np.array([name in first for name in found]),
        direction=_vectors(rows, "direction"),
        point=0.001 * _vectors(rows, "point_mm"),
        axis_cone=np.radians(_numbers(rows, "axis_cone95_deg")),
        point_radius=0.001 * _numbers(rows, "point_radius95_mm"),
        slide_per_radian=0.001 * _numbers(rows, "pitch_mm_per_rad"),
        residual_rotation=np.radians(_numbers(rows, "residual_rotation_deg")),
        residual_translation=0.001 * _numbers(rows, "residual_translation_mm"),
    )


def _center(joint: JointSummary) -> Vector | None:
    """The center in the frame the screws are expressed in; None in the laboratory, whose place ``joint.json`` tells."""
    ball, frame = joint["ball"], joint["expressed_in"]
    if ball is None or frame == "lab":
        return None
    return ball["center_in_proximal_mm"] if frame == "proximal" else ball["center_in_distal_mm"]


def _vectors(rows: Sequence[dict[str, object]], key: str) -> Float:
    nothing = [np.nan] * 3
    return np.array([row.get(key) or nothing for row in rows], dtype=np.float64).reshape(-1, 3)


def _numbers(rows: Sequence[dict[str, object]], key: str) -> Float:
    return np.array([row.get(key) for row in rows], dtype=np.float64)  # None becomes NaN


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ListedWarnings(TableRecord):
    """Warnings and notes, one a row.

    Attributes
    ----------
    code, severity, message : ndarray of str, shape (W,)
    count : ndarray of int, shape (W,)
        Frames concerned; 0 where it is not a matter of frames.
    """

    table: ClassVar = _columns(
        ("code", "code", None, Quantity.LABEL),
        ("severity", "severity", None, Quantity.LABEL),
        ("message", "message", None, Quantity.LABEL),
        ("count", "count", None, Quantity.INTEGER),
    )

    code: NDArray[np.str_]
    severity: NDArray[np.str_]
    message: NDArray[np.str_]
    count: NDArray[np.int64]


def listed_warnings(warnings: Sequence[WarningSummary]) -> ListedWarnings:
    """List the warnings of a summary."""
    return ListedWarnings(
        code=np.array([one["code"] for one in warnings], dtype=np.str_),
        severity=np.array([one["severity"] for one in warnings], dtype=np.str_),
        message=np.array([one["message"] for one in warnings], dtype=np.str_),
        count=np.array([one["count"] for one in warnings], dtype=np.int64),
    )
