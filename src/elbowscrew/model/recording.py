"""Recordings: rigid bodies of one take on one clock, in meters and seconds."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from elbowscrew.geometry import dual_quaternion, quaternion

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]


class TrackingLoss(IntEnum):
    """Why a body has no measured pose in a frame."""

    NONE = 0
    BLANK = 1
    """The export's cells are empty."""
    ABSENT = 2
    """The body is missing from the frame's row (row-tagged layout)."""
    ZERO = 3
    """A quaternion of zeros, or no rotation at the very origin: what is written for a body that was not solved."""
    FROZEN = 4
    """The pose repeats the one before to the last digit."""


@dataclass(frozen=True, slots=True, kw_only=True)
class QualityWarning:
    """Something about the recording or the analysis that the reader of a result must know."""

    code: str
    message: str


@dataclass(frozen=True, slots=True, kw_only=True)
class RigidBody:
    """The poses of one rigid body.

    Attributes
    ----------
    name, identifier : str
        As in the file; the identifier tells bodies of one name apart.
    dual_quat_lab_body : ndarray, shape (N, 8)
        Pose of the body in the laboratory frame, meters; NaN where there is none.
    loss : ndarray of uint8, shape (N,)
        `TrackingLoss` of each frame.
    marker_offsets : ndarray, shape (M, 3), optional
        The markers in the body's frame, meters.
    """

    name: str
    identifier: str = ""
    dual_quat_lab_body: Float
    loss: NDArray[np.uint8]
    marker_offsets: Float | None = None

    @classmethod
    def from_quaternions(
        cls,
        name: str,
        quat: ArrayLike,
        position: ArrayLike,
        *,
        identifier: str = "",
        loss: NDArray[np.uint8] | None = None,
        marker_offsets: ArrayLike | None = None,
    ) -> RigidBody:
        """Build a body from Euler parameters (N, 4), scalar first and of any length but 0, and positions (N, 3) in m.

        Frames with NaN, or with a quaternion of zeros, have no pose.
        """
        q = np.asarray(quat, dtype=np.float64)
        d = np.asarray(position, dtype=np.float64)
        if q.ndim != 2 or q.shape[1] != 4 or d.shape != (q.shape[0], 3):
            msg = f"body {name!r}: expected quaternions (N, 4) and positions (N, 3), found {q.shape} and {d.shape}"
            raise ValueError(msg)
        reason = np.zeros(q.shape[0], dtype=np.uint8) if loss is None else loss.copy()
        blank = ~(np.isfinite(q).all(axis=1) & np.isfinite(d).all(axis=1))
        zero = ~blank & (q == 0.0).all(axis=1)
        reason[(reason == TrackingLoss.NONE) & blank] = TrackingLoss.BLANK
        reason[(reason == TrackingLoss.NONE) & zero] = TrackingLoss.ZERO
        lost = (reason != TrackingLoss.NONE)[:, None]
        pose = dual_quaternion.dual_quat_from_pose(
            quaternion.normalize(np.where(lost, np.nan, q)), np.where(lost, np.nan, d)
        )
        offsets = None if marker_offsets is None else np.asarray(marker_offsets, dtype=np.float64)
        return cls(name=name, identifier=identifier, dual_quat_lab_body=pose, loss=reason, marker_offsets=offsets)

    @classmethod
    def from_matrices(cls, name: str, rotation: ArrayLike, position: ArrayLike, *, identifier: str = "") -> RigidBody:
        """Build a body from rotation matrices (N, 3, 3), body to laboratory, and positions (N, 3) in meters."""
        R = np.asarray(rotation, dtype=np.float64)
        quat = np.full((*R.shape[:-2], 4), np.nan)
        known = np.isfinite(R).all(axis=(-1, -2))
        quat[known] = quaternion.quat_from_rotation_matrix(R[known])
        return cls.from_quaternions(name, quat, position, identifier=identifier)

    @property
    def tracked(self) -> Bool:
        """Frames with a measured pose, shape (N,)."""
        return np.equal(self.loss, TrackingLoss.NONE)

    def loss_counts(self) -> dict[str, int]:
        """Count the lost frames by reason, as in ``{"blank": 12}``."""
        counts = Counter(self.loss[self.loss != TrackingLoss.NONE].tolist())
        return {TrackingLoss(reason).name.lower(): counts[reason] for reason in sorted(counts)}


@dataclass(frozen=True, slots=True, kw_only=True)
class Source:
    """Where a recording came from."""

    path: str
    sha256: str
    layout: str
    take_name: str = ""
    length_unit: str = ""
    rotation_type: str = ""
    metadata: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class Recording:
    """The rigid bodies of one take on one clock.

    Attributes
    ----------
    bodies : tuple of RigidBody
    frame : ndarray of int64, shape (N,)
        Frame numbers of the file.
    time_s : ndarray, shape (N,)
        Times of the file, seconds.
    rate_hz : float
        Frames per second.
    """

    bodies: tuple[RigidBody, ...]
    frame: NDArray[np.int64]
    time_s: Float
    rate_hz: float
    source: Source | None = None
    warnings: tuple[QualityWarning, ...] = ()

    @classmethod
    def from_bodies(cls, bodies: Sequence[RigidBody], *, rate_hz: float) -> Recording:
        """Build a recording from bodies of equally many frames, numbered from 0 at a fixed rate."""
        lengths = {body.loss.shape[0] for body in bodies}
        if len(lengths) != 1 or not rate_hz > 0.0:
            msg = f"expected bodies of equally many frames and a positive rate, found {sorted(lengths)} and {rate_hz}"
            raise ValueError(msg)
        frame = np.arange(lengths.pop(), dtype=np.int64)
        return cls(bodies=tuple(bodies), frame=frame, time_s=frame / rate_hz, rate_hz=rate_hz)
