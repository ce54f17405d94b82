"""Whether a unit of length that somebody has given, or the file states, can be the file's."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from elbowscrew.errors import SettingError
from elbowscrew.geometry.dual_quaternion import pose_from_dual_quat
from elbowscrew.model import QualityWarning, Recording
from elbowscrew.quantities import METERS, in_digits

DOUBTFUL: Final = "units-doubtful"
# Farther from the origin no laboratory reaches; beyond these two it is rare.
_FARTHEST_M: Final = 100.0
_FAR_M: Final = 15.0
_NEAR_M: Final = 0.005
# Formats whose unit is a word that another program may have written beside numbers of its own.
_OFTEN_WRONG: Final = ("TRC", "C3D", "named columns")


def with_scale_checked(recording: Recording, given: str | None) -> Recording:
    """Warn where bodies or markers stand where the unit that was given, or is stated, hardly puts them.

    Raises
    ------
    SettingError
        If the one that was given puts them where they cannot be, and which units would not.
    """
    source = recording.source
    units = given or (source.length_unit if source is not None and source.layout in _OFTEN_WRONG else "")
    if units not in METERS:
        return recording
    places = [pose_from_dual_quat(body.dual_quat_lab_body)[1] for body in recording.bodies if body.located]
    places += [marker.position for marker in recording.markers]
    distances = [np.linalg.norm(place[np.isfinite(place).all(axis=1)], axis=1) for place in places]
    medians = [float(np.median(one)) for one in distances if one.size]
    distance = float(np.median(medians)) if medians else 0.0
    if distance == 0.0 or _NEAR_M <= distance <= _FAR_M:
        return recording
    fitting = [unit for unit, meters in METERS.items() if _NEAR_M <= distance * meters / METERS[units] <= _FAR_M]
    what = f"--units {units}" if given else f"the unit that is stated, {units},"
    message = f"{what} puts what is in the file {in_digits(distance, 3)} m from the origin: " + (
        f"is its unit {' or '.join(fitting)}?" if fitting else "is its unit another one?"
    )
    if given and distance > _FARTHEST_M:
        raise SettingError(message)
    warning = QualityWarning(code=DOUBTFUL, message=message)
    return replace(recording, warnings=(warning, *recording.warnings))
