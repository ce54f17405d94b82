"""What a study takes of each finished result: the mean curve of its cycles, and its axis in the bones' frame."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from elbowscrew import tables
from elbowscrew.choices import AngleUnit, LengthUnit
from elbowscrew.geometry.arrays import Float
from elbowscrew.group.axes import in_bone
from elbowscrew.group.curves import PERCENT, curve_of_cycles
from elbowscrew.model.joint_summary_types import EstimateSummary, JointSummary
from elbowscrew.results.joint_summary import preferred_fit
from elbowscrew.results.proof import Proof
from elbowscrew.results.table_reading import read_attributes

JOINT_AXIS, FIRST_AXIS = "joint axis", "first of two axes"
_M_PER_MM: Final = 1e-3


class TrialAxis(NamedTuple):
    """The joint's axis in a trial.

    Attributes
    ----------
    kind : str
        `JOINT_AXIS`, or `FIRST_AXIS` of a joint that has two: the two are not averaged.
    direction, point : ndarray, shape (3,)
        From `elbowscrew.group.axes.in_bone`; the point in meters.
    """

    kind: str
    direction: Float
    point: Float


def axis_of(joint: JointSummary) -> TrialAxis | None:
    """Give the axis that stands in the proximal body, in its bone's frame; None without landmarks or an axis."""
    anatomy, two = joint["anatomy"], joint["two_axes"]
    line: EstimateSummary | None
    if two is not None:
        kind, line = FIRST_AXIS, two["axis1"] if two["axis1"]["determined"] else None
    else:
        kind, line = JOINT_AXIS, joint["mean_axis"] or preferred_fit(joint)
    if anatomy is None or line is None:
        return None
    point_mm = line["point_in_proximal_mm"]
    point = np.full(3, np.nan) if point_mm is None else _M_PER_MM * np.array(point_mm)
    landmarks = {name: _M_PER_MM * np.array(place) for name, place in anatomy["landmarks_mm"].items()}
    axis = in_bone(np.array(line["direction_in_proximal"]), point, landmarks, anatomy["side"], anatomy["joint"])
    return TrialAxis(kind, *axis)


def curve_of_result(proof: Proof, angle_unit: AngleUnit, length_unit: LengthUnit) -> tuple[Float | None, int]:
    """Read the mean of a result's cycles, radians, shape (101,), and how many they are.

    None if no cycle is complete and known throughout.

    Raises
    ------
    ResultError
        If a table is not as it was written.
    """
    if not proof.has("cycles.csv"):
        return None, 0
    units = angle_unit, length_unit
    angle = read_attributes(proof.file("cycles.csv"), tables.CYCLE_COLUMNS, ("angle",), *units)["angle"]
    cycles = read_attributes(proof.file("repetitions.csv"), tables.REPETITION_COLUMNS, ("incomplete",), *units)
    return curve_of_cycles(angle.reshape(-1, PERCENT.size), cycles["incomplete"])
