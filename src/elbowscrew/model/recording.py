"""Recordings: rigid bodies of one take on one clock, in meters and seconds."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import IntEnum
from fnmatch import fnmatchcase
from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from elbowscrew.choices import LengthUnit
from elbowscrew.column_file import ColumnFile
from elbowscrew.errors import UsageError, did_you_mean, shown
from elbowscrew.geometry import dual_quaternion, nonrigid_coordinates, quaternion
from elbowscrew.geometry._blocks import evenly_thinned
from elbowscrew.geometry.arrays import Bool, Float, Index
from elbowscrew.model.array_record import ArrayRecord
from elbowscrew.quantities import in_digits

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

# Exports print six decimals, so that a norm is off by 1e-6; a digit or a cell gone wrong shows above this.
_NORM_TOLERANCE: Final = 5e-3
_FARTHEST_M: Final = 1e4
_MOST_KEPT: Final = 65_536


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
    INVALID = 5
    """No pose can be so: a quaternion far from unit length, a position kilometers away."""
    LEAP = 6
    """The pose leaps out of the motion and back: a flip, a swap or a spike."""


@dataclass(frozen=True, slots=True, kw_only=True)
class QualityWarning:
    """Something about the recording or the analysis that the reader of a result must know.

    Attributes
    ----------
    code, message : str
    severity : {"warning", "note"}
        A note tells of what is harmless or has been put right without loss.
    frames : tuple of int
        The first frames concerned, ten at most.
    count : int
        How many are concerned; 0 where it is not a matter of frames.
    """

    code: str
    message: str
    severity: Literal["warning", "note"] = "warning"
    frames: tuple[int, ...] = ()
    count: int = 0


def invalid_warning(body: str, frames: int) -> QualityWarning:
    """Say that a body has poses that cannot be."""
    message = (
        f"body {body!r} has in {frames} frames a quaternion far from unit length or a position over "
        f"{_FARTHEST_M / 1000:g} km away: taken as lost"
    )
    return QualityWarning(code="invalid-pose", message=message)


def out_of_reach(position: Float) -> Bool:
    """Positions (..., 3), in meters, that no camera sees, as they are over 10 km away: shape (...); none where NaN."""
    farther: Bool = np.any(np.abs(position) > _FARTHEST_M, axis=-1)
    return farther


def at_origin(position: Float) -> Bool:
    """Positions (..., 3) at the very origin, which some systems write for a marker not seen: shape (...)."""
    origin: Bool = (position == 0.0).all(axis=-1)
    return origin


def invalid_marker_warning(owner: str, positions: int) -> QualityWarning:
    """Say that markers have positions that cannot be."""
    message = f"{owner} has {positions} positions over {_FARTHEST_M / 1000:g} km away: taken as not seen"
    return QualityWarning(code="invalid-marker", message=message)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class MarkerMotion(ArrayRecord):
    """How a body's markers move among themselves, which no pose of the body explains.

    Attributes
    ----------
    shape : ndarray, shape (M, 3)
        The markers in the body's frame, meters.
    row : ndarray, shape (K,)
        Rows of the recording that are kept, ascending: all of them, or of a long recording some, evenly spread. After a
        change of rate they are no whole numbers.
    nonrigid : ndarray, shape (K, 3 M - 6)
        `elbowscrew.geometry.nonrigid_coordinates`, meters; NaN where a marker is not seen.
    own_shape : bool
        Whether the shape is the trial's own, so that a constant misfit is not seen.
    """

    shape: Float
    row: Float
    nonrigid: Float
    own_shape: bool

    @classmethod
    def of_markers(cls, pose: Float, seen: Float, shape: Float, *, own_shape: bool) -> MarkerMotion:
        """Take it from a body's poses (N, 8) and its markers (N, M, 3) in the laboratory, of a long recording in some.

        The shape (M, 3) is that of the markers in the body's frame.
        """
        rows = evenly_thinned(np.arange(len(pose)), _MOST_KEPT)
        in_body = dual_quaternion.transform_points(dual_quaternion.conjugate(pose[rows])[:, None, :], seen[rows])
        nonrigid = nonrigid_coordinates(in_body, shape)
        return cls(shape=shape, row=rows.astype(np.float64), nonrigid=nonrigid, own_shape=own_shape)

    def at(self, rows: Index) -> Float:
        """Non-rigid coordinates (F, 3 M - 6) of the kept rows nearest these (F,)."""
        return np.asarray(self.nonrigid[np.searchsorted(0.5 * (self.row[1:] + self.row[:-1]), rows)])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class RigidBody(ArrayRecord):
    """The poses of one rigid body.

    Attributes
    ----------
    name, identifier : str
        As in the file; the identifier tells bodies of one name apart.
    dual_quat_lab_body : ndarray, shape (N, 8)
        Pose of the body in the laboratory frame, meters; NaN where there is none.
    loss : ndarray of uint8, shape (N,)
        `TrackingLoss` of each frame.
    located : bool
        Whether positions were measured; else the poses are rotations alone, and their dual parts 0.
    marker_offsets : ndarray, shape (M, 3), optional
        The markers in the body's frame, meters.
    reported_error : ndarray, shape (N,), optional
        Mean marker error as the file has it, meters.
    marker_residual : ndarray, shape (N,), optional
        RMS distance between the markers seen and the body's own, meters: how rigid the cluster was.
    marker_motion : MarkerMotion, optional
        How the markers seen move among themselves.
    shape_deviation : ndarray, shape (N,), optional
        Departure of the dual QR decomposition's triangular factor from the identity, a pure number (P 28).
    coarse_step : float, optional
        Size of the steps of its markers' coordinates, meters, if they are so coarse that the pose may repeat at rest.
    """

    name: str
    identifier: str = ""
    dual_quat_lab_body: Float
    loss: NDArray[np.uint8]
    located: bool = True
    marker_offsets: Float | None = None
    reported_error: Float | None = None
    marker_residual: Float | None = None
    marker_motion: MarkerMotion | None = None
    shape_deviation: Float | None = None
    coarse_step: float | None = None

    def __repr__(self) -> str:
        tracked = int(self.tracked.sum())
        return f"RigidBody({self.name!r}; tracked in {tracked} of {self.loss.size} frames)"

    def _shown_fields(self) -> list[tuple[str, str]]:
        return [("name", self.name), *([("identifier", self.identifier)] if self.identifier else []), *self._told()]

    def _told(self) -> Iterator[tuple[str, str]]:
        lost = ", ".join(f"{count} {reason}" for reason, count in self.loss_counts().items())
        yield "tracked", f"{int(self.tracked.sum())} of {self.loss.size} frames" + (f"; lost: {lost}" if lost else "")
        if not self.located:
            yield "positions", "not measured: orientations alone"
        if self.marker_offsets is not None:
            yield "markers", f"{len(self.marker_offsets)}"
        if self.marker_residual is not None and np.isfinite(self.marker_residual).any():
            misfit = 1e3 * np.nanmedian(self.marker_residual)
            yield "misfit", f"{in_digits(misfit)} mm, the median of the RMS over its markers"

    def to_frame(self, length_unit: LengthUnit = "mm") -> pd.DataFrame:
        """Return the poses as a pandas data frame, a row a frame.

        ``e0`` to ``e3`` are the Euler parameters, body to laboratory, ``x_mm``, ``y_mm`` and ``z_mm`` the origin's
        place, if positions were measured; ``lost`` says why there is no pose.
        """
        from elbowscrew.model.recording_tables import frame_of_body

        return frame_of_body(self, length_unit)

    @classmethod
    def from_quaternions(
        cls,
        name: str,
        quat: ArrayLike,
        position: ArrayLike | None,
        *,
        identifier: str = "",
        loss: NDArray[np.uint8] | None = None,
        marker_offsets: ArrayLike | None = None,
        only_plausible: bool = False,
    ) -> RigidBody:
        """Build a body from Euler parameters (N, 4), scalar first and of any length but 0, and positions (N, 3) in m.

        Positions of None are not measured: what is found of such a body are directions and angles alone.
        Frames with NaN, or with a quaternion of zeros, have no pose; with `only_plausible`, as for a file, nor have
        those with a quaternion that is not of unit length within 0.5 %, or farther away than 10 km.
        """
        q = np.asarray(quat, dtype=np.float64)
        d = np.asarray(np.zeros((len(q), 3)) if position is None else position, dtype=np.float64)
        if q.ndim != 2 or q.shape[1] != 4 or d.shape != (q.shape[0], 3):
            msg = f"body {name!r}: expected quaternions (N, 4) and positions (N, 3), found {q.shape} and {d.shape}"
            raise ValueError(msg)
        reason = np.zeros(q.shape[0], dtype=np.uint8) if loss is None else loss.copy()
        blank: Bool = ~np.isfinite(np.concatenate([q, d], axis=1)).all(axis=1)
        zero = ~blank & (q == 0.0).all(axis=1)
        reason[(reason == TrackingLoss.NONE) & blank] = TrackingLoss.BLANK
        reason[(reason == TrackingLoss.NONE) & zero] = TrackingLoss.ZERO
        if only_plausible:
            size = quaternion.norm(np.where(blank[:, None], 1.0, q))
            invalid = (np.abs(size - 1.0) > _NORM_TOLERANCE) | out_of_reach(d)
            reason[(reason == TrackingLoss.NONE) & invalid] = TrackingLoss.INVALID
        lost = (reason != TrackingLoss.NONE)[:, None]
        pose = dual_quaternion.dual_quat_from_pose(
            quaternion.normalize(np.where(lost, np.nan, q)), np.where(lost, np.nan, d)
        )
        offsets = None if marker_offsets is None else np.asarray(marker_offsets, dtype=np.float64)
        return cls(
            name=name,
            identifier=identifier,
            dual_quat_lab_body=pose,
            loss=reason,
            located=position is not None,
            marker_offsets=offsets,
        )

    @classmethod
    def from_matrices(
        cls, name: str, rotation: ArrayLike, position: ArrayLike | None, *, identifier: str = ""
    ) -> RigidBody:
        """Build a body from rotation matrices (N, 3, 3), body to laboratory, and positions (N, 3) in m, or None."""
        R = np.asarray(rotation, dtype=np.float64)
        whole = R[np.isfinite(R).all(axis=(-1, -2))]
        if (
            np.abs(np.swapaxes(whole, -1, -2) @ whole - np.eye(3)).max(initial=0.0) > _NORM_TOLERANCE
            or (np.linalg.det(whole) < 0.0).any()
        ):
            msg = f"body {name!r}: expected rotation matrices, orthogonal and of determinant 1"
            raise ValueError(msg)
        quat = np.full((*R.shape[:-2], 4), np.nan)
        known = np.isfinite(R).all(axis=(-1, -2))
        quat[known] = quaternion.quat_from_rotation_matrix(R[known])
        return cls.from_quaternions(name, quat, position, identifier=identifier)

    def without_positions(self) -> RigidBody:
        """Give the same body with its orientations alone, and nothing that tells where it, or a marker of it, is."""
        rotation = self.dual_quat_lab_body.copy()
        rotation[np.isfinite(rotation[:, 0]), 4:] = 0.0
        return RigidBody(
            name=self.name,
            identifier=self.identifier,
            dual_quat_lab_body=rotation,
            loss=self.loss,
            located=False,
        )

    @property
    def tracked(self) -> Bool:
        """Frames with a measured pose, shape (N,)."""
        return np.equal(self.loss, TrackingLoss.NONE)

    def loss_labels(self) -> NDArray[np.str_]:
        """Give the reason of each lost frame in a word, shape (N,); empty for tracked ones."""
        if not self.loss.any():
            return np.broadcast_to(np.array("", dtype=np.str_), self.loss.shape)  # of no size, however long
        words = ["", *(reason.name.lower() for reason in TrackingLoss if reason != TrackingLoss.NONE)]
        return np.array(words)[self.loss]

    def loss_counts(self) -> dict[str, int]:
        """Count the lost frames by reason, as in ``{"blank": 12}``."""
        counts = Counter(self.loss[self.loss != TrackingLoss.NONE].tolist())
        return {TrackingLoss(reason).name.lower(): counts[reason] for reason in sorted(counts)}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Marker(ArrayRecord):
    """One marker: its name and its positions in the laboratory, shape (N, 3), meters; NaN where not seen."""

    name: str
    position: Float


def marker_matches(name: str, patterns: Iterable[str]) -> bool:
    """Whether a name is one of the names, or fits one of the patterns (``*``, ``?``, ``[...]``), in any case."""
    folded = name.casefold()
    return any(folded == pattern.casefold() or fnmatchcase(folded, pattern.casefold()) for pattern in patterns)


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
    distal: Source | None = None
    """The distal body's file, where it has one of its own."""
    columns: ColumnFile | None = None
    """What said which columns hold what, where the file does not."""
    markers: tuple[str, ...] = ()
    """Names of all markers in the file, read or not."""
    bones: tuple[str, ...] = ()
    """Names of all bones of skeletons in the file, read or not."""
    plug_in: Mapping[str, str] = field(default_factory=dict)
    """The distribution that brought the reader, if it was not one of ours, and its version."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Recording(ArrayRecord):
    """The rigid bodies of one take on one clock.

    Attributes
    ----------
    bodies : tuple of RigidBody
        In the order of the file.
    frame : ndarray of int64, shape (N,)
        Frame numbers of the file.
    time_s : ndarray, shape (N,)
        Times of the file, seconds.
    rate_hz : float
        Frames per second.
    markers : tuple of Marker
        Those that were asked for.
    source : Source or None
        The file it was read from.
    warnings : tuple of QualityWarning
        What was doubtful in the file.
    ordered : bool
        Whether the first body is said to be the proximal one and the second the distal one.
    """

    bodies: tuple[RigidBody, ...]
    frame: NDArray[np.int64]
    time_s: Float
    rate_hz: float
    markers: tuple[Marker, ...] = ()
    source: Source | None = None
    warnings: tuple[QualityWarning, ...] = ()
    ordered: bool = False

    @property
    def duration_s(self) -> float:
        """Seconds from the first frame to the last."""
        return float(self.time_s[-1] - self.time_s[0]) if self.time_s.size else 0.0

    def __getitem__(self, name: str) -> RigidBody | Marker:
        """Give a body or a marker by its name.

        Raises
        ------
        KeyError
            If there is none of that name, or several; it asks back, or names those that there are.
        """
        every: list[RigidBody | Marker] = [*self.bodies, *self.markers]
        found = [one for one in every if one.name == name]
        if len(found) == 1:
            return found[0]
        if found:
            raise KeyError(f"{len(found)} are called {name!r}: take them from bodies and markers")
        names = [one.name for one in every]
        hint = did_you_mean(name, names) or f"; there are {', '.join(map(repr, names)) or 'none'}"
        raise KeyError(f"no body or marker {name!r}{hint}")

    def __iter__(self) -> Iterator[str]:
        """Names of the bodies, then of the markers."""
        return iter([one.name for one in self.bodies] + [one.name for one in self.markers])

    def __repr__(self) -> str:
        named = ", ".join(repr(body.name) for body in self.bodies)
        return f"Recording({self.frame.size} frames at {self.rate_hz:g} Hz; bodies {named})"

    def _shown_fields(self) -> list[tuple[str, str]]:
        frames, source = self.frame.size, self.source
        told = f"{frames} at {self.rate_hz:g} Hz" + (
            f", numbered {self.frame[0]} to {self.frame[-1]}" if frames else ""
        )
        origin = "in memory" if source is None else f"{Path(source.path).name} ({source.layout})"
        bodies = [
            (f"body {body.name}", "; ".join(f"{name}: {text}" for name, text in body._told())) for body in self.bodies
        ]
        markers = [("markers", ", ".join(one.name for one in self.markers))] if self.markers else []
        warned = [(one.severity, f"{one.message} ({one.code})") for one in self.warnings]
        return [("source", origin), ("frames", told), *bodies, *markers, *warned]

    def to_frame(self, length_unit: LengthUnit = "mm") -> pd.DataFrame:
        """Return clock, poses and markers as a pandas data frame, a row a frame.

        It is a plain table: what its ``to_csv(path, index=False)`` writes can be analyzed again.
        Lost frames are NaN; of a body without positions there are the Euler parameters alone.
        """
        from elbowscrew.model.recording_tables import frame_of_recording

        return frame_of_recording(self, length_unit)

    def to_xarray(self, length_unit: LengthUnit = "mm") -> xr.Dataset:
        """Return poses and markers as an xarray Dataset along ``frame``, ``body`` and ``marker``, with ``time``.

        Raises
        ------
        UsageError
            If xarray is not installed.
        """
        from elbowscrew.model.recording_tables import dataset_of_recording

        return dataset_of_recording(self, length_unit)

    @classmethod
    def from_bodies(cls, bodies: Sequence[RigidBody], *, rate_hz: float) -> Recording:
        """Build a recording from bodies of equally many frames, numbered from 0 at a fixed rate."""
        strange = next((one for one in bodies if not isinstance(one, RigidBody)), None)
        if strange is not None:
            msg = f"expected bodies, from RigidBody.from_quaternions or RigidBody.from_matrices, found {shown(strange)}"
            raise UsageError(msg)
        lengths = {body.loss.shape[0] for body in bodies}
        if len(lengths) != 1 or not rate_hz > 0.0:
            msg = f"expected bodies of equally many frames and a positive rate, found {sorted(lengths)} and {rate_hz}"
            raise ValueError(msg)
        frame = np.arange(lengths.pop(), dtype=np.int64)
        return cls(bodies=tuple(bodies), frame=frame, time_s=frame / rate_hz, rate_hz=rate_hz)
