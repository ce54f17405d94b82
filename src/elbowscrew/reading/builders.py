"""Arrays and bodies that grow block by block, in place: reading needs little more memory than what is kept."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew.geometry.arrays import Bool, Float
from elbowscrew.geometry.quaternion import quat_from_rotation_matrix
from elbowscrew.model import (
    Marker,
    QualityWarning,
    RigidBody,
    TrackingLoss,
    at_origin,
    invalid_marker_warning,
    invalid_warning,
    out_of_reach,
)

# More than a joint is fitted to; of four markers 3 MB.
_MOST_THINNED: Final = 65_536

# As far as a quaternion may be from unit length: matrices are printed with three decimals, too.
_ORTHOGONAL: Final = 5e-3


class ArrayBuilder:
    """An array that grows by blocks of rows."""

    def __init__(self, row_shape: tuple[int, ...] = (), dtype: Any = np.float64) -> None:
        self._rows = 0
        self._store: NDArray[Any] = np.empty((0, *row_shape), dtype=dtype)

    def append(self, block: NDArray[Any]) -> None:
        """Add rows at the end."""
        needed = self._rows + len(block)
        if needed > len(self._store):
            self._resize(max(needed, len(self._store) + len(self._store) // 8))
        self._store[self._rows : needed] = block
        self._rows = needed

    def thin(self) -> None:
        """Keep every other row."""
        kept = self._store[: self._rows : 2].copy()
        self._rows = len(kept)
        self._store[: self._rows] = kept

    def finish(self) -> NDArray[Any]:
        """Give the array, with no row to spare."""
        self._resize(self._rows)
        return self._store

    def _resize(self, rows: int) -> None:
        self._store.resize((rows, *self._store.shape[1:]), refcheck=False)


class ThinnedBuilder:
    """Of rows that come by blocks every k-th, k a power of two, so that what is kept has a bound."""

    def __init__(self, width: int) -> None:
        self._kept = ArrayBuilder((width,))
        self._rows = self._count = 0
        self._step = 1

    def wanted(self, count: int) -> slice:
        """Which rows of the next block, of so many, are to be appended."""
        return slice(-self._rows % self._step, count, self._step)

    def append(self, wanted: Float, count: int) -> None:
        """Add the rows wanted of a block of so many."""
        self._kept.append(wanted)
        self._rows += count
        self._count += len(wanted)
        while self._count > _MOST_THINNED:
            self._kept.thin()
            self._count = -(-self._count // 2)
            self._step *= 2

    def finish(self) -> tuple[Float, Float]:
        """Give the numbers (K,) of the rows that are kept, and the rows (K, width)."""
        return np.arange(0.0, self._rows, self._step), self._kept.finish()


class BodyBuilder:
    """The poses of one body of a file, of which only plausible ones count; `located` if it has positions."""

    def __init__(self, name: str, *, located: bool = True) -> None:
        self._name, self._located = name, located
        self._pose, self._loss = ArrayBuilder((8,)), ArrayBuilder(dtype=np.uint8)
        self._invalid = 0

    def append(self, quat: Float, position: Float | None, loss: NDArray[np.uint8] | None = None) -> Float:
        """Add frames: Euler parameters (n, 4), positions (n, 3) in meters, and why a pose is lost; give the poses.

        Positions are None, all of them, of a body that has none.
        """
        block = RigidBody.from_quaternions(self._name, quat, position, loss=loss, only_plausible=True)
        self._pose.append(block.dual_quat_lab_body)
        self._loss.append(block.loss)
        self._invalid += int((block.loss == TrackingLoss.INVALID).sum())
        return block.dual_quat_lab_body

    def append_matrices(self, rotation: Float, position: Float | None) -> None:
        """Add frames: rotation matrices (n, 3, 3), body to laboratory, and positions as in `append`.

        Zeros and blanks are what is written for a body that was not solved; any other matrix that is no rotation is
        damage.
        """
        known: Bool = np.all(np.isfinite(rotation), axis=(1, 2))
        R = np.where(known[:, None, None], rotation, 0.0)
        with np.errstate(all="ignore"):
            departure = np.abs(np.swapaxes(R, 1, 2) @ R - np.eye(3)).max(axis=(1, 2))
            proper = (departure < _ORTHOGONAL) & _right_handed(R)
        loss = np.where(known & ~proper, TrackingLoss.INVALID, TrackingLoss.NONE).astype(np.uint8)
        loss[known & ~R.any(axis=(1, 2))] = TrackingLoss.ZERO
        quat = np.full((len(R), 4), np.nan)
        quat[proper] = quat_from_rotation_matrix(R[proper])
        self.append(quat, position, loss)

    def finish(self, *, identifier: str = "", marker_offsets: Float | None = None) -> RigidBody:
        """Give the body."""
        return RigidBody(
            name=self._name,
            identifier=identifier,
            dual_quat_lab_body=self._pose.finish(),
            loss=self._loss.finish(),
            located=self._located,
            marker_offsets=marker_offsets,
        )

    def warnings(self) -> list[QualityWarning]:
        """Tell of poses that cannot be."""
        return [invalid_warning(self._name, self._invalid)] if self._invalid else []


def _right_handed(R: Float) -> Bool:
    """Whether the columns of matrices (n, 3, 3) are: in a fifth of the time of their determinants."""
    x, y, z = R[:, 0], R[:, 1], R[:, 2]
    volume = (
        x[:, 0] * (y[:, 1] * z[:, 2] - y[:, 2] * z[:, 1])
        + x[:, 1] * (y[:, 2] * z[:, 0] - y[:, 0] * z[:, 2])
        + x[:, 2] * (y[:, 0] * z[:, 1] - y[:, 1] * z[:, 0])
    )
    positive: Bool = volume > 0.0
    return positive


class MarkerBuilder:
    """The positions of one marker of a file, of which only plausible ones count."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._position = ArrayBuilder((3,))
        self._far = 0

    def append(self, position: Float) -> None:
        """Add frames: positions (n, 3) in meters."""
        far = out_of_reach(position)
        self._position.append(np.where((far | at_origin(position))[:, None], np.nan, position))
        self._far += int(far.sum())

    def finish(self) -> Marker:
        """Give the marker."""
        return Marker(name=self._name, position=self._position.finish())

    def warnings(self) -> list[QualityWarning]:
        """Tell of positions that cannot be."""
        return [invalid_marker_warning(f"marker {self._name!r}", self._far)] if self._far else []
