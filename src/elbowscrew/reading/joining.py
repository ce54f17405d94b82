"""Two recordings of one body each, joined into one of both: the proximal body and the distal one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from elbowscrew.errors import RecordingError
from elbowscrew.model import Recording


def joined(proximal: Recording, distal: Recording) -> Recording:
    """Join two recordings that were read from files, in this order.

    Raises
    ------
    RecordingError
        If one has not exactly one body, or they are not of the same frames at the same times.
    """
    paths = [one.source.path if one.source is not None else "" for one in (proximal, distal)]
    for path, one in zip(paths, (proximal, distal), strict=True):
        if len(one.bodies) != 1:
            msg = (
                f"{path}: expected one body in each of two files, found {len(one.bodies)}; give a file of several alone"
            )
            raise RecordingError(msg)
    if not (np.array_equal(proximal.frame, distal.frame) and np.array_equal(proximal.time_s, distal.time_s)):
        found = " and ".join(f"{one.frame.size} from {one.time_s[0]:g} s" for one in (proximal, distal))
        msg = (
            f"{paths[1]}: expected the frames and times of {paths[0]}, found {found}; export the same frames of both "
            "bodies"
        )
        raise RecordingError(msg)
    first, second = proximal.bodies[0], distal.bodies[0]
    if first.name == second.name:  # files of one name in two folders
        first, second = replace(first, name="proximal"), replace(second, name="distal")
    return replace(
        proximal,
        bodies=(first, second),
        ordered=True,
        source=None if proximal.source is None else replace(proximal.source, distal=distal.source),
        warnings=proximal.warnings + tuple(one for one in distal.warnings if one not in proximal.warnings),
    )
