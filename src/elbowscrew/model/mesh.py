"""The surface of a bone, to be drawn in space; frozen, in SI units."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowscrew.geometry.arrays import Float
from elbowscrew.model.array_record import ArrayRecord


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Mesh(ArrayRecord):
    """Triangles in the frame of the body that the bone belongs to.

    Attributes
    ----------
    vertices : ndarray, shape (V, 3)
        Meters.
    faces : ndarray of int, shape (F, 3)
        Rows of the vertices.
    triangles : int
        How many there are in the file: of many, fewer are kept.
    file, sha256 : str
        Name of the file, and its digest.
    """

    vertices: Float
    faces: NDArray[np.int64]
    triangles: int
    file: str = ""
    sha256: str = ""

    def thinned(self, most: int) -> Mesh:
        """Give at most so many triangles, by merging the vertices in each cell of a grid.

        Parameters
        ----------
        most : int
            At least 100.

        Returns
        -------
        Mesh
            Itself if it has no more.

        References
        ----------
        Rossignac and Borrel 1993, Multi-resolution 3D approximations for rendering complex scenes.
        """
        if len(self.faces) <= most:
            return self
        low = self.vertices.min(axis=0)
        span = float(np.ptp(self.vertices, axis=0).max())
        cells = 2.0 * np.sqrt(most)
        while True:
            found = self._clustered(low, span / cells)
            if len(found.faces) <= most:
                return found
            cells = max(min(0.95, np.sqrt(most / len(found.faces))) * cells, 1.0)  # of a surface they go by its square

    def _clustered(self, low: Float, size: float) -> Mesh:
        cell = np.floor((self.vertices - low) / size).astype(np.int64)
        wide = int(cell.max()) + 1
        key = (cell[:, 0] * wide + cell[:, 1]) * wide + cell[:, 2]
        _, of, count = np.unique(key, return_inverse=True, return_counts=True)
        merged = np.stack([np.bincount(of, self.vertices[:, k]) / count for k in range(3)], axis=1)
        faces = of.reshape(-1)[self.faces]
        whole = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
        faces = faces[whole]
        # Two triangles of the same corners, either way round, look like one.
        _, once = np.unique(np.sort(faces, axis=1), axis=0, return_index=True)
        used, renumbered = np.unique(faces[np.sort(once)], return_inverse=True)
        return Mesh(
            vertices=merged[used],
            faces=renumbered.reshape(-1, 3).astype(np.int64),
            triangles=self.triangles,
            file=self.file,
            sha256=self.sha256,
        )
