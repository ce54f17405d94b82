"""Rigid bodies out of blocks of Motive's columns: poses, what the file says of their error, their markers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from elbowscrew.geometry import nonrigid_coordinates, quaternion
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import conjugate, transform_points
from elbowscrew.model import MarkerMotion, QualityWarning, RigidBody, invalid_marker_warning, out_of_reach
from elbowscrew.reading.builders import ArrayBuilder, BodyBuilder, ThinnedBuilder
from elbowscrew.reading.cells import read_blocks
from elbowscrew.reading.cluster_shapes import ClusterMismatch
from elbowscrew.reading.motive_header import BodyColumns, Header
from elbowscrew.reading.source import TextSource

_MIRRORED_VERSION: Final = "1.1"
_SAMPLE_ROWS: Final = 1024
# Fitted markers rest in their body to some micrometers, seen ones to a millimeter; mirrored, they move by centimeters.
_AT_REST_M: Final = 2e-3
_FEWEST_OF_A_SHAPE: Final = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class BodySample:
    """What the first frames tell of a body.

    Attributes
    ----------
    offsets : dict of int to ndarray, shape (3,)
        Its markers in its own frame, meters, by their numbers; empty if the file has none at rest in it.
    mirrored : bool
        The pose is written mirrored in z against the markers.
    by_version : bool
        Nothing but the version says so.
    """

    offsets: dict[int, Float]
    mirrored: bool
    by_version: bool


def sample_bodies(
    source: TextSource, header: Header, bodies: Sequence[BodyColumns], scale: float, order: str
) -> list[BodySample]:
    """Find the bodies' markers in their own frames, and whether the poses are mirrored against them.

    Format version 1.1 writes rigid bodies mirrored in z against the markers of the same file; the markers decide where
    there are any.
    """
    columns = sorted({k for body in bodies for k in _sampled_columns(body)})
    index = {column: k for k, column in enumerate(columns)}
    samples = {k: ArrayBuilder((len(columns),)) for k, body in enumerate(bodies) if _sampled_columns(body)}
    wanted = dict.fromkeys(samples, _SAMPLE_ROWS)
    if columns:
        for block in read_blocks(source, header.lines, columns, header.width, exact=header.whole):
            # A body may be found late: its sample is of the first frames that have it.
            for k in [k for k, rows in wanted.items() if rows > 0]:
                own = [index[column] for column in (*bodies[k].rotation.values(), *bodies[k].position.values())]
                rows = np.flatnonzero(np.isfinite(block[:, own]).all(axis=1))[: wanted[k]]
                samples[k].append(block[rows])
                wanted[k] -= rows.size
            if not any(rows > 0 for rows in wanted.values()):
                break
    nothing = np.empty((0, len(columns)))
    return [
        _sample(header, body, samples[k].finish() if k in samples else nothing, index, scale, order)
        for k, body in enumerate(bodies)
    ]


def _sampled_columns(body: BodyColumns) -> set[int]:
    triples = body.fitted or body.seen
    own = {*body.rotation.values(), *body.position.values(), *(k for xyz in triples.values() for k in xyz)}
    return own if triples else set()


def _sample(
    header: Header, body: BodyColumns, cells: Float, index: dict[int, int], scale: float, order: str
) -> BodySample:
    by_version = header.version == _MIRRORED_VERSION
    triples = body.fitted or body.seen
    if not triples or not len(cells):
        return BodySample(offsets={}, mirrored=by_version, by_version=by_version)
    numbers = list(triples)
    markers = scale * np.stack([cells[:, [index[k] for k in xyz]] for xyz in triples.values()], axis=1)
    markers = np.where(out_of_reach(markers)[..., None], np.nan, markers)
    if body.fitted and header.pairs.get("Coordinate Space", "").casefold() == "local":
        # There the Rigid Body Marker columns are the offsets themselves.
        offsets = _median_where_known(markers)
        known = {n: offset for n, offset in zip(numbers, offsets, strict=True) if np.isfinite(offset).all()}
        return BodySample(offsets=known, mirrored=by_version, by_version=by_version)
    found = {}
    for mirrored in (False, True):
        quat, position = _pose_cells(cells, index, body, scale, order, mirrored=mirrored)
        pose = RigidBody.from_quaternions(body.name, quat, position, only_plausible=True).dual_quat_lab_body
        found[mirrored] = _offsets_at_rest(transform_points(conjugate(pose)[:, None, :], markers))
    undecided = bool(found[False]) == bool(found[True])  # a body that does not move rests either way
    mirrored = by_version if undecided else bool(found[True])
    known = {numbers[k]: offset for k, offset in found[mirrored].items()}
    return BodySample(offsets=known, mirrored=mirrored, by_version=undecided and by_version)


def _median_where_known(markers: Float) -> Float:
    """Median over frames, shape (M, 3), NaN for a marker that is never there."""
    result = np.full(markers.shape[1:], np.nan)
    for k in range(markers.shape[1]):
        known = markers[np.isfinite(markers[:, k]).all(axis=1), k]
        if len(known):
            result[k] = np.median(known, axis=0)
    return result


def _offsets_at_rest(in_body: Float) -> dict[int, Float]:
    """Median position in the body of each marker that is seen, by its index; none if one of them moves in it."""
    offsets = _median_where_known(in_body)
    seen = np.flatnonzero(np.isfinite(offsets).all(axis=1))
    spread = _median_where_known(np.abs(in_body - offsets))
    at_rest = (spread[seen] < _AT_REST_M).all()
    return {int(k): offsets[k] for k in seen} if at_rest else {}


def _pose_cells(
    cells: Float, index: dict[int, int], body: BodyColumns, scale: float, order: str, *, mirrored: bool
) -> tuple[Float, Float]:
    """Quaternions, scalar first, and positions in meters, from columns taken by their labels.

    Motive writes X, Y, Z, W, or angles in degrees.
    """
    by_label = {label: cells[:, index[k]] for label, k in body.rotation.items()}
    if order == "quaternion":
        quat = np.stack([by_label[label] for label in "WXYZ"], axis=1)
    else:
        angles = np.radians(np.stack([by_label[label] for label in order], axis=1))
        quat = quaternion.quat_from_euler_angles(angles, order)
    position = scale * np.stack([cells[:, index[body.position[axis]]] for axis in "XYZ"], axis=1)
    if mirrored:
        quat, position = quat * [1.0, -1.0, -1.0, 1.0], position * [1.0, 1.0, -1.0]
    return quat, position


class MotiveBody:
    """Builds one rigid body from blocks of cells."""

    def __init__(self, body: BodyColumns, scale: float, order: str, sample: BodySample) -> None:
        self._body, self._scale, self._order, self._sample = body, scale, order, sample
        self._store = BodyBuilder(body.name)
        self._error, self._residual = ArrayBuilder(), ArrayBuilder()
        self._seen = {number: xyz for number, xyz in body.seen.items() if number in sample.offsets}
        self._partly_blank = self._far_markers = 0
        self._shape = np.array([sample.offsets[number] for number in self._seen]).reshape(-1, 3)
        clustered = len(self._shape) >= _FEWEST_OF_A_SHAPE
        self.cluster_mismatch = ClusterMismatch(body.name, self._shape) if clustered else None
        self._nonrigid = ThinnedBuilder(3 * len(self._shape) - 6) if clustered else None

    @property
    def columns(self) -> set[int]:
        """The columns needed."""
        own = {*self._body.rotation.values(), *self._body.position.values()}
        own.update(k for xyz in self._seen.values() for k in xyz)
        return own if self._body.error is None else own | {self._body.error}

    def append(self, block: Float, columns: list[int]) -> None:
        """Take a block of rows; `columns` says which columns it has."""
        index = {column: k for k, column in enumerate(columns)}
        body = self._body
        quat, position = _pose_cells(block, index, body, self._scale, self._order, mirrored=self._sample.mirrored)
        known = np.isfinite(block[:, [index[k] for k in (*body.rotation.values(), *body.position.values())]])
        self._partly_blank += int((known.any(axis=1) & ~known.all(axis=1)).sum())
        pose = self._store.append(quat, position)
        if body.error is not None:
            self._error.append(self._scale * block[:, index[body.error]])
        if self._seen:
            seen = self._scale * np.stack([block[:, [index[k] for k in xyz]] for xyz in self._seen.values()], axis=1)
            far = out_of_reach(seen)
            self._far_markers += int(far.sum())
            seen = np.where(far[..., None], np.nan, seen)
            residual = self._rms_residual(pose, seen)
            self._residual.append(residual)
            if self.cluster_mismatch is not None:
                self.cluster_mismatch.append(seen, residual)
            if self._nonrigid is not None:
                rows = self._nonrigid.wanted(len(seen))
                in_body = transform_points(conjugate(pose[rows])[:, None, :], seen[rows])
                self._nonrigid.append(nonrigid_coordinates(in_body, self._shape), len(seen))

    def _rms_residual(self, pose: Float, seen: Float) -> Float:
        square = np.sum((seen - transform_points(pose[:, None, :], self._shape)) ** 2, axis=2)
        counted = np.isfinite(square)
        count = counted.sum(axis=1)
        mean = np.where(counted, square, 0.0).sum(axis=1) / np.maximum(count, 1)
        return np.where(count > 0, np.sqrt(mean), np.nan)

    def finish(self) -> RigidBody:
        """Give the body."""
        offsets = self._sample.offsets
        rigid = self._store.finish(
            identifier=self._body.identifier,
            marker_offsets=np.stack([offsets[n] for n in sorted(offsets)]) if offsets else None,
        )
        if self._body.error is not None:
            rigid = replace(rigid, reported_error=self._error.finish())
        return (
            replace(rigid, marker_residual=self._residual.finish(), marker_motion=self._motion())
            if self._seen
            else rigid
        )

    def _motion(self) -> MarkerMotion | None:
        if self._nonrigid is None:
            return None
        row, nonrigid = self._nonrigid.finish()
        # Where the file has no markers of the solved body, its shape is that of the markers seen.
        return MarkerMotion(shape=self._shape, row=row, nonrigid=nonrigid, own_shape=not self._body.fitted)

    def warnings(self, version: str) -> list[QualityWarning]:
        """What the reader of a result must know of this body's cells."""
        found = []
        name, offsets_known = self._body.name, bool(self._sample.offsets)
        if self._body.bone:
            message = (
                f"bone {name!r} is solved by the model of a skeleton, which constrains how bones move in their joints: "
                "axis, slide and type of the joint may be the model's, not the person's"
            )
            found.append(QualityWarning(code="skeleton-bone", message=message))
        if self._sample.mirrored:
            by = "as that format version does" if self._sample.by_version else "against its own markers"
            message = f"body {name!r} is written mirrored in z, {by} (format version {version}): corrected"
            code = "mirrored-by-version" if self._sample.by_version else "mirrored"
            found.append(QualityWarning(code=code, message=message))
        if self._partly_blank:
            message = (
                f"body {name!r} has some but not all cells of its pose in {self._partly_blank} frames: taken as lost"
            )
            found.append(QualityWarning(code="partly-blank", message=message))
        if self._far_markers:
            found.append(invalid_marker_warning(f"the markers of body {name!r}: together they", self._far_markers))
        if not offsets_known and (self._body.fitted or self._body.seen):
            message = f"the markers of body {name!r} move relative to it: they are not used"
            found.append(QualityWarning(code="markers-unused", message=message))
        return found + self._store.warnings()
