"""The two bodies of the joint, chosen, and with only those poses left that are measurements."""

from __future__ import annotations

from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowscrew.errors import AnalysisError, SettingError
from elbowscrew.geometry.arrays import Float
from elbowscrew.joints import Joint
from elbowscrew.model import BodyQuality, QualityWarning, Recording, RigidBody, marker_matches
from elbowscrew.motion.tracking.body_pairs import no_positions_warnings, on_the_spot_warning, turns_on_the_spot
from elbowscrew.motion.tracking.marker_poses import body_from_markers
from elbowscrew.motion.tracking.quality import check_bodies
from elbowscrew.motion.tracking.selection import ChosenBodies, choose_bodies
from elbowscrew.settings import Settings

_NOT_ANALYZED: Final = ("same-pose",)


class TrackedBodies(NamedTuple):
    """Result of `tracked_bodies`.

    Attributes
    ----------
    proximal : RigidBody or None
        None if it stands still.
    distal : RigidBody
    joint : Joint
        What the joint is called.
    broken_rows : ndarray of int
        Rows that a body reaches by a leap.
    elapsed : ndarray, shape (N,)
        Clock, as by `elapsed_time`.
    quality : tuple of BodyQuality
    warnings : tuple of QualityWarning
        Those of the recording, too.
    """

    proximal: RigidBody | None
    distal: RigidBody
    joint: Joint
    broken_rows: NDArray[np.intp]
    elapsed: Float
    quality: tuple[BodyQuality, ...]
    warnings: tuple[QualityWarning, ...]


def tracked_bodies(recording: Recording, settings: Settings) -> TrackedBodies:
    """Choose the joint's bodies and take out what is not a measurement.

    Raises
    ------
    SettingError
        If the choice is not clear.
    AnalysisError
        If a body is tracked in too few frames.
    """
    chosen_bodies = _chosen_bodies(recording, settings)
    proximal, distal = chosen_bodies.proximal, chosen_bodies.distal
    chosen = (distal,) if proximal is None else (proximal, distal)
    checked = check_bodies(recording, chosen, settings)
    for found in checked.bodies:
        body = found.body
        share = 100.0 * float(body.tracked.mean()) if body.loss.size else 0.0
        if share < settings.min_tracked_percent or not body.tracked.any():
            reasons = ", ".join(f"{count} {reason}" for reason, count in body.loss_counts().items())
            msg = (
                f"body {body.name!r} is tracked in {share:.1f} % of {body.loss.size} frames ({reasons}); at least "
                f"{settings.min_tracked_percent:g} % are needed (--min-tracked; "
                "for leaps see --max-turn and --max-speed, for frozen poses --frozen)"
                + "".join(f"; {warning.message}" for warning in found.warnings if warning.code == "leap")
            )
            raise AnalysisError(msg)
    unusable = next((warning for warning in checked.warnings if warning.code in _NOT_ANALYZED), None)
    if unusable is not None:
        msg = f"{unusable.message}; choose other bodies, or export the take again"
        raise AnalysisError(msg)
    bodies = tuple(found.body for found in checked.bodies)
    doubts = tuple(on_the_spot_warning(body.name) for body in bodies if turns_on_the_spot(body))
    if not all(body.located for body in bodies):
        doubts += no_positions_warnings([body.name for body in bodies if body.located], settings.tolerance_mm)
        bodies = tuple(body.without_positions() for body in bodies)
    proximal = None if proximal is None else bodies[0]
    broken_rows = np.unique(np.concatenate([found.broken_rows for found in checked.bodies]))
    return TrackedBodies(
        proximal=proximal,
        distal=bodies[-1],
        joint=chosen_bodies.joint,
        broken_rows=broken_rows,
        elapsed=checked.elapsed,
        quality=checked.quality,
        warnings=(*recording.warnings, *chosen_bodies.warnings, *checked.warnings, *doubts),
    )


def _chosen_bodies(recording: Recording, settings: Settings) -> ChosenBodies:
    """Choose the joint's bodies among the bodies of the file and those built from markers."""
    patterns = {"proximal": settings.proximal_markers, "distal": settings.distal_markers}
    built = {
        role: body_from_markers(recording, f"{role} markers", wanted, settings.pose_method)
        for role, wanted in patterns.items()
        if wanted is not None
    }
    shared = [m.name for m in recording.markers if all(marker_matches(m.name, p or ()) for p in patterns.values())]
    if len(built) == 2 and shared:
        msg = f"markers {', '.join(shared)} are chosen for both bodies; give each marker to one of them"
        raise SettingError(msg)
    for role, body in built.items():
        if getattr(settings, role) is not None:
            msg = f"--{role} and --{role}-markers both say what the {role} is; give one of them (for {body.name!r})"
            raise SettingError(msg)
    names = {role: built[role].name if role in built else getattr(settings, role) for role in ("proximal", "distal")}
    bodies = (*recording.bodies, *built.values())
    if not bodies:
        msg = (
            "the recording has no rigid bodies and no markers were chosen: give --proximal-markers and --distal-markers"
        )
        raise SettingError(msg)
    return choose_bodies(replace(recording, bodies=bodies), names["proximal"], names["distal"], settings.joint)
