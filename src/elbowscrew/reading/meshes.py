"""Surfaces of bones out of STL, OBJ and PLY files, as text or binary; no library is needed.

None of the three states a unit: it is told, and millimeters otherwise. What a file says of itself is believed only as
far as its bytes go: counts beyond them are refused before anything is made of them.
"""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowscrew.choices import LengthUnit
from elbowscrew.errors import UsageError, unreadable
from elbowscrew.geometry.arrays import Float
from elbowscrew.model.mesh import Mesh
from elbowscrew.opening import read_bytes
from elbowscrew.quantities import METERS, in_digits

MOST_TRIANGLES: Final = 6000
"""Triangles of a bone that are kept to be drawn."""
_LARGEST: Final = 200_000_000
_FARTHEST_M: Final = 10.0
_STL_HEAD: Final = 84
_STL: Final = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
_VERTEX: Final = re.compile(
    rb"^[ \t]*vertex[ \t]+(\S{1,40})[ \t]+(\S{1,40})[ \t]+(\S{1,40})[ \t\r]*$", re.MULTILINE | re.IGNORECASE
)
_PLY_TYPES: Final = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
    "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
    "double": "f8", "float64": "f8",
}  # fmt: skip
_PLY_ORDERS: Final = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_PLY_HEAD: Final = 100_000
_LISTS: Final = ("vertex_indices", "vertex_index")

_Surface = tuple[Float, NDArray[np.int64]]


def read_mesh(path: str | os.PathLike[str], unit: LengthUnit = "mm") -> Mesh:
    """Read the surface of a bone, for the view in space.

    Parameters
    ----------
    path : path-like
        ``.stl``, ``.obj`` or ``.ply``; coordinates in the frame of the body that the bone belongs to.
    unit : {"mm", "m"}
        Unit of the coordinates, which these files do not state.

    Returns
    -------
    Mesh
        Of many triangles at most `MOST_TRIANGLES`.

    Raises
    ------
    UsageError
        If the file cannot be read, is no such file, or its triangles are none of a bone.
    RecordingError
        If the disk does not give it.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "bone.obj")
    ...     _ = path.write_text(chr(10).join(("v 0 0 0", "v 9 0 0", "v 0 9 0", "f 1 2 3")))
    ...     round(read_mesh(path).vertices.max().item(), 6)
    0.009
    """
    file = Path(path)
    reader = _READERS.get(file.suffix.casefold())
    if reader is None:
        msg = f"{file}: a mesh is a file {', '.join(_READERS)}, found {file.suffix or 'no ending'!r}"
        raise UsageError(msg)
    try:
        content = read_bytes(file, _LARGEST)
    except OSError as error:
        raise unreadable(file, "a mesh", error) from error
    try:
        vertices, faces = reader(content)
        vertices = _checked(vertices, faces) * METERS[unit]
        _check_size(vertices, unit)
    except (ValueError, OverflowError) as error:
        msg = f"{file}: no mesh: {error}"
        raise UsageError(" ".join(msg.split())) from error
    whole = Mesh(
        vertices=vertices,
        faces=faces,
        triangles=len(faces),
        file=file.name,
        sha256=hashlib.sha256(content).hexdigest(),
    )
    return whole.thinned(MOST_TRIANGLES)


def _checked(vertices: Float, faces: NDArray[np.int64]) -> Float:
    if not len(faces):
        msg = "there are no triangles in it"
        raise ValueError(msg)
    if faces.min() < 0 or faces.max() >= len(vertices):
        msg = f"a triangle names a vertex that is not there: there are {len(vertices)}"
        raise ValueError(msg)
    if not np.isfinite(vertices).all():
        msg = "a coordinate is no finite number"
        raise ValueError(msg)
    return vertices


def _check_size(vertices: Float, unit: str) -> None:
    farthest = float(np.abs(vertices).max())
    if farthest > _FARTHEST_M or not np.ptp(vertices, axis=0).max() > 0.0:
        msg = (
            f"its coordinates reach {in_digits(farthest, 3)} m with the unit {unit}: expected a bone within "
            f"{_FARTHEST_M:g} m of its body's origin; give --mesh-unit mm or m"
        )
        raise ValueError(msg)


def _stl(content: bytes) -> _Surface:
    """Read STL: binary if its count goes with its length, else text."""
    count = int.from_bytes(content[80:_STL_HEAD], "little") if len(content) >= _STL_HEAD else -1
    room = (len(content) - _STL_HEAD) // _STL.itemsize
    if count == room or (0 <= count <= room and content.lstrip()[:5].lower() != b"solid"):
        corners = np.frombuffer(content, _STL, count, _STL_HEAD)["corners"].reshape(-1, 3).astype(np.float64)
        return corners, np.arange(len(corners), dtype=np.int64).reshape(-1, 3)
    if content.lstrip()[:5].lower() != b"solid":
        msg = f"it states {count} triangles, and there is room for {max(room, 0)}: it is cut, or no STL"
        raise ValueError(msg)
    corners = np.array([float(word) for found in _VERTEX.findall(content) for word in found]).reshape(-1, 3)
    if len(corners) % 3:
        msg = f"{len(corners)} vertices make no whole triangles: it is cut"
        raise ValueError(msg)
    return corners, np.arange(len(corners), dtype=np.int64).reshape(-1, 3)


def _obj(content: bytes) -> _Surface:
    """Read the vertices and faces of OBJ; polygons are cut into triangles from their first corner."""
    vertices: list[list[float]] = []
    faces: list[tuple[int, int, int]] = []
    for number, line in enumerate(content.splitlines(), 1):
        parts = line.split()
        if not parts or parts[0] not in (b"v", b"f"):
            continue
        try:
            if parts[0] == b"v":
                vertices.append([float(part) for part in parts[1:4]])
                continue
            corners = [_place(part, len(vertices)) for part in parts[1:]]
        except ValueError as error:
            msg = f"line {number}: {error}"
            raise ValueError(msg) from error
        faces += [(corners[0], one, other) for one, other in pairwise(corners[1:])]
    if any(len(vertex) != 3 for vertex in vertices):
        msg = "a vertex has not three coordinates"
        raise ValueError(msg)
    return np.array(vertices, dtype=np.float64).reshape(-1, 3), np.array(faces, dtype=np.int64).reshape(-1, 3)


def _place(corner: bytes, count: int) -> int:
    """Row of a corner such as ``3/1/2``; from 1 on, negative ones from the last vertex back."""
    number = int(corner.split(b"/", 1)[0])
    return number - 1 if number > 0 else count + number if number < 0 else -1


class _Element(NamedTuple):
    """An element of a PLY file: scalar properties with no count, lists with the type of theirs."""

    name: str
    rows: int
    properties: list[tuple[str, str, str]]


def _ply(content: bytes) -> _Surface:
    head, separator, body = content[:_PLY_HEAD].partition(b"end_header")
    line_end = body.find(b"\n")
    if not content.startswith(b"ply") or not separator or line_end < 0:
        msg = "no header of PLY"
        raise ValueError(msg)
    order, elements = _ply_header(head.decode("ascii", "replace"))
    rest = content[len(head) + len(separator) + line_end + 1 :]
    source = _PlyText(rest) if order == "" else _PlyBinary(rest, order)
    vertices, faces = np.empty((0, 3)), np.empty((0, 3), dtype=np.int64)
    for element in elements:
        if element.name == "vertex":
            vertices = source.scalars(element)
        elif element.name == "face":
            faces = _triangles(*source.lists(element))
        else:
            source.skip(element)
    return vertices, faces


def _ply_header(text: str) -> tuple[str, list[_Element]]:
    order: str | None = None
    elements: list[_Element] = []
    for line in text.splitlines():
        match line.split():
            case ["format", kind, _]:
                order = _PLY_ORDERS.get(kind)
            case ["element", name, count] if count.isdigit() and len(count) < 12:
                elements.append(_Element(name, int(count), []))
            case ["property", "list", size, kind, name] if elements and {size, kind} <= set(_PLY_TYPES):
                elements[-1].properties.append((name, _PLY_TYPES[kind], _PLY_TYPES[size]))
            case ["property", kind, name] if elements and kind in _PLY_TYPES:
                elements[-1].properties.append((name, _PLY_TYPES[kind], ""))
            case ["element" | "property" | "format", *_]:
                msg = f"its header says {line.strip()!r}"
                raise ValueError(msg)
    if order is None:
        msg = "its header names no format that is known"
        raise ValueError(msg)
    return order, elements


def _triangles(counts: NDArray[np.int64], places: NDArray[np.int64]) -> NDArray[np.int64]:
    """Cut polygons, given by how many corners each has and all corners in turn, into triangles."""
    starts = np.cumsum(counts) - counts
    of = np.repeat(np.arange(len(counts)), np.maximum(counts - 2, 0))
    step = np.arange(len(of)) - np.searchsorted(of, of)
    first = starts[of]
    return np.stack([places[first], places[first + step + 1], places[first + step + 2]], axis=1)


class _PlyBinary:
    """Elements out of the bytes after the header, one after the other."""

    def __init__(self, content: bytes, order: str) -> None:
        self.content, self.order, self.at = content, order, 0

    def scalars(self, element: _Element) -> Float:
        rows = self._rows(element)
        return np.stack([rows[axis].astype(np.float64) for axis in _axes(element)], axis=1)

    def skip(self, element: _Element) -> None:
        if any(size for _, _, size in element.properties):
            self.lists(element)
        else:
            self._rows(element)

    def _rows(self, element: _Element) -> NDArray[Any]:
        names = [name for name, _, _ in element.properties]
        if len(set(names)) < len(names) or any(size for _, _, size in element.properties):
            msg = f"its element {element.name} has lists, or properties of one name"
            raise ValueError(msg)
        kind = np.dtype([(name, self.order + of) for name, of, _ in element.properties])
        self._need(element.rows * kind.itemsize, element)
        rows = np.frombuffer(self.content, kind, element.rows, self.at) if kind.itemsize else np.zeros(0, kind)
        self.at += element.rows * kind.itemsize
        return rows

    def lists(self, element: _Element) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        least = sum(np.dtype(size or of).itemsize for _, of, size in element.properties)
        self._need(element.rows * max(least, 1), element)
        if (triangles := self._triangles_at_once(element)) is not None:
            return np.full(element.rows, 3), triangles
        counts, places = np.zeros(element.rows, dtype=np.int64), []
        for row in range(element.rows):
            for name, of, size in element.properties:
                kind = np.dtype(self.order + of)
                count = 1
                if size:
                    one = np.dtype(self.order + size)
                    self._need(one.itemsize, element)
                    count = int(np.frombuffer(self.content, one, 1, self.at)[0])
                    self.at += one.itemsize
                if count < 0:
                    msg = f"a list of its element {element.name} has {count} entries"
                    raise ValueError(msg)
                self._need(count * kind.itemsize, element)
                if name in _LISTS:
                    counts[row] = count
                    places.append(np.frombuffer(self.content, kind, count, self.at))
                self.at += count * kind.itemsize
        return counts, np.concatenate(places).astype(np.int64) if places else np.empty(0, dtype=np.int64)

    def _triangles_at_once(self, element: _Element) -> NDArray[np.int64] | None:
        """Corners of faces that are all triangles and nothing else, as almost all files have them."""
        if len(element.properties) != 1 or element.properties[0][0] not in _LISTS:
            return None
        _, of, size = element.properties[0]
        if not size:
            return None
        kind = np.dtype([("count", self.order + size), ("corners", self.order + of, 3)])
        if self.at + element.rows * kind.itemsize > len(self.content):
            return None
        rows = np.frombuffer(self.content, kind, element.rows, self.at)
        if not (rows["count"] == 3).all():
            return None
        self.at += element.rows * kind.itemsize
        return rows["corners"].reshape(-1).astype(np.int64)

    def _need(self, size: int, element: _Element) -> None:
        if self.at + size > len(self.content):
            msg = f"it ends within its element {element.name}, of which it states {element.rows}"
            raise ValueError(msg)


class _PlyText:
    """Elements out of the words after the header, a line each."""

    def __init__(self, content: bytes) -> None:
        self.lines = [line for line in content.splitlines() if line.strip()]
        self.at = 0

    def scalars(self, element: _Element) -> Float:
        columns = [[name for name, _, _ in element.properties].index(axis) for axis in _axes(element)]
        rows = [line.split() for line in self._next(element)]
        if any(len(row) < len(element.properties) for row in rows):
            msg = "a vertex has fewer numbers than its header says"
            raise ValueError(msg)
        return np.array([[float(row[column]) for column in columns] for row in rows]).reshape(-1, 3)

    def skip(self, element: _Element) -> None:
        self._next(element)

    def lists(self, element: _Element) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        counts, places = [], []
        for line in self._next(element):
            words, at = line.split(), 0
            for name, _, size in element.properties:
                count = int(words[at]) if size and at < len(words) else 1
                at += bool(size)
                if count < 0 or at + count > len(words):
                    msg = "a face has fewer numbers than it says"
                    raise ValueError(msg)
                if name in _LISTS:
                    counts.append(count)
                    places += [int(word) for word in words[at : at + count]]
                at += count
        return np.array(counts, dtype=np.int64), np.array(places, dtype=np.int64)

    def _next(self, element: _Element) -> list[bytes]:
        found = self.lines[self.at : self.at + element.rows]
        if len(found) < element.rows:
            msg = f"it ends within its element {element.name}, of which it states {element.rows}"
            raise ValueError(msg)
        self.at += element.rows
        return found


def _axes(element: _Element) -> tuple[str, str, str]:
    names = [name for name, _, _ in element.properties]
    if not {"x", "y", "z"} <= set(names):
        msg = "its vertices have no x, y, z"
        raise ValueError(msg)
    return ("x", "y", "z")


_READERS: Final[dict[str, Callable[[bytes], _Surface]]] = {".stl": _stl, ".obj": _obj, ".ply": _ply}
