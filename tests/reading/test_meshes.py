"""Surfaces of bones: the same triangles out of every format, and errors in place of what a file cannot hold."""

from __future__ import annotations

import os
import struct
import tracemalloc
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from elbowscrew import read_mesh
from elbowscrew.errors import UsageError
from elbowscrew.geometry.arrays import Float
from elbowscrew.reading.meshes import MOST_TRIANGLES

# A tetrahedron, millimeters.
CORNERS = np.array([[0.0, 0.0, 0.0], [30.0, 0.0, 0.0], [0.0, 20.0, 0.0], [0.0, 0.0, -12.5]])
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


def stl() -> bytes:
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *CORNERS[face].ravel(), 0) for face in FACES)
    return b"solid of binary bytes".ljust(80) + struct.pack("<I", len(FACES)) + body


def stl_text() -> bytes:
    facet = "facet normal 0 0 0\n outer loop\n{}\n endloop\nendfacet"
    corner = "  vertex {:.6e} {:g}\t{:g}"
    loops = [facet.format("\n".join(corner.format(*CORNERS[k]) for k in face)) for face in FACES]
    return "\r\n".join(["solid bone", *loops, "endsolid"]).encode()


def obj() -> bytes:
    lines = ["# a bone", "mtllib none", *("v {} {} {}".format(*corner) for corner in CORNERS), "vn 0 0 1"]
    return "\n".join([*lines, *(f"f {a + 1}/1/1 {b + 1}//1 {c - 4}" for a, b, c in FACES)]).encode()


def ply(order: str, *, mixed: bool = False) -> bytes:
    """With a normal before the place, a color behind each face's corners, and an element that is none of ours."""
    name = {"": "ascii", "<": "binary_little_endian", ">": "binary_big_endian"}[order]
    head = [
        "ply", f"format {name} 1.0", "comment made by hand", "element material 1", "property list uchar short parts",
        f"element vertex {len(CORNERS)}", "property float nx", "property double x", "property float y",
        "property float z", f"element face {len(FACES)}", "property list uchar int vertex_indices",
        *(["property uchar red"] if mixed else []), "end_header",
    ]  # fmt: skip
    if order:
        body = struct.pack(order + "B2h", 2, 5, -6)
        body += b"".join(struct.pack(order + "fdff", 1.0, *corner) for corner in CORNERS)
        body += b"".join(struct.pack(order + "B3i", 3, *face) + b"\7" * mixed for face in FACES)
    else:
        rows = ["2 5 -6", *("1 {} {} {}".format(*corner) for corner in CORNERS)]
        body = "\n".join([*rows, *("3 {} {} {}".format(*face) + " 7" * mixed for face in FACES), ""]).encode()
    return "\n".join(head).encode() + b"\n" + body


FILES = {
    "binary.stl": stl(), "text.STL": stl_text(), "a.obj": obj(), "text.ply": ply(""), "little.ply": ply("<"),
    "big.ply": ply(">"), "colored.ply": ply(">", mixed=True), "colored_text.ply": ply("", mixed=True),
}  # fmt: skip


def corners_of(mesh: Any) -> Float:
    return np.asarray(1000.0 * mesh.vertices[mesh.faces])


@pytest.mark.parametrize("name", FILES)
def test_every_format_gives_the_same_triangles(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_bytes(FILES[name])
    found = read_mesh(tmp_path / name)
    assert corners_of(found) == pytest.approx(CORNERS[FACES], abs=1e-5)
    assert (found.triangles, found.file, len(found.sha256)) == (4, name, 64)
    for cut in range(0, len(FILES[name]), 7):
        (tmp_path / name).write_bytes(FILES[name][:cut])
        with suppress(UsageError):  # and nothing else
            assert read_mesh(tmp_path / name).triangles <= 4


def test_polygons_are_cut_into_triangles_from_their_first_corner(tmp_path: Path) -> None:
    corners = [[0, 0, 0], [4, 0, 0], [5, 3, 0], [2, 5, 0], [-1, 3, 0]]
    rows = "\n".join("v {} {} {}".format(*corner) for corner in corners)
    (tmp_path / "p.obj").write_text(f"{rows}\nf 1 2 3 4 5\nf 1 3 4\n")
    head = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
    rows = "\n".join("{} {} {}".format(*corner) for corner in corners)
    (tmp_path / "p.ply").write_text(
        f"{head}element face 2\nproperty list uchar int vertex_index\nend_header\n{rows}\n5 0 1 2 3 4\n3 0 2 3\n"
    )
    for name in ("p.obj", "p.ply"):
        assert read_mesh(tmp_path / name).faces.tolist() == [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 2, 3]]


def test_many_triangles_become_few_that_lie_where_they_lay(tmp_path: Path) -> None:
    """A sphere of 44,402 triangles: within a cell of its radius everywhere, and its area within a few percent."""
    n, m = 150, 150
    polar, around = np.meshgrid(np.linspace(0.0, np.pi, n), np.linspace(0.0, 2.0 * np.pi, m), indexing="ij")
    points = 25.0 * np.stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)], axis=-1)
    points += [300.0, -40.0, 7.0]
    a, b, c, d = points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]
    corners = np.concatenate([np.stack([a, b, c], axis=2), np.stack([a, c, d], axis=2)]).reshape(-1, 3, 3)
    rows = np.zeros(len(corners), np.dtype([("n", "<f4", 3), ("c", "<f4", (3, 3)), ("m", "<u2")]))
    rows["c"] = corners
    (tmp_path / "s.stl").write_bytes(bytes(80) + struct.pack("<I", len(rows)) + rows.tobytes())
    found = read_mesh(tmp_path / "s.stl")
    assert found.triangles == len(rows)
    assert MOST_TRIANGLES / 3 < len(found.faces) <= MOST_TRIANGLES
    radius = np.linalg.norm(1000.0 * found.vertices - [300.0, -40.0, 7.0], axis=1)
    assert radius.max() < 25.01
    assert radius.min() > 24.8
    u, v = (corners_of(found)[:, k] - corners_of(found)[:, 0] for k in (1, 2))
    assert 0.5 * np.linalg.norm(np.cross(u, v), axis=1).sum() == pytest.approx(4.0 * np.pi * 25.0**2, rel=0.05)


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("a.stl", b"", "it states -1 triangles"),
        ("a.stl", bytes(80) + struct.pack("<I", 4_000_000_000) + bytes(100), "4000000000 triangles, and there is room"),
        ("a.stl", b"solid x\nendsolid", "no triangles"),
        ("a.stl", b"solid x\nvertex 1 2 3\nvertex 1 2 " + b"9" * 100_000, "make no whole triangles"),
        ("a.obj", b"v 1 2 3\nf 1 2 3", "names a vertex that is not there: there are 1"),
        ("a.obj", b"v 1 2 3\nv 1 2 4\nf 0 1 2", "names a vertex that is not there"),
        ("a.obj", b"v 1 2\nf 1 1 1", "not three coordinates"),
        ("a.obj", b"v 1 2 x", "line 1: could not convert"),
        ("a.obj", b"v 1 2 nan\nf 1 1 1", "no finite number"),
        ("a.obj", b"v 1 2 3\nf 1 1 1", "reach 0.003 m with the unit mm: expected a bone"),
        ("a.obj", b"v 1 2 3\nv 0 0 90000\nf 1 1 2", "reach 90 m with the unit mm"),
        ("a.obj", b"v 1 2 3\nf 1 99999999999999999999999 1", "no mesh"),
        ("a.ply", ply("").replace(b"vertex 4", b"vertex 999999999"), "it ends within its element vertex"),
        ("a.ply", ply("<").replace(b"vertex 4", b"vertex 99999999999"), "it ends within its element vertex"),
        ("a.ply", ply("<").replace(b"face 4", b"face 4000000000"), "it ends within its element face"),
        ("a.ply", ply("<").replace(b"float y", b"float16 y"), "its header says 'property float16 y'"),
        ("a.ply", ply("<").replace(b"double x", b"double w"), "no x, y, z"),
        ("a.ply", ply("").replace(b"ascii", b"utf-8"), "no format that is known"),
        ("a.ply", b"ply\nformat ascii 1.0\n" + b"x" * 300_000, "no header of PLY"),
        ("a.vtk", b"", "a mesh is a file .stl, .obj, .ply, found '.vtk'"),
    ],
)  # fmt: skip
def test_what_is_no_mesh_is_an_error_of_one_line(tmp_path: Path, name: str, content: bytes, says: str) -> None:
    (tmp_path / name).write_bytes(content)
    tracemalloc.start()
    try:
        with pytest.raises(UsageError) as caught:
            read_mesh(tmp_path / name)
        assert tracemalloc.get_traced_memory()[1] < 20_000_000  # whatever counts it states
    finally:
        tracemalloc.stop()
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 1000


def test_a_pipe_and_what_is_not_there_are_errors_at_once(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.stl")
    for name, says in (("pipe.stl", "no regular file"), ("none.stl", "cannot be read as a mesh")):
        with pytest.raises(UsageError, match=says):
            read_mesh(tmp_path / name)


def test_bytes_at_random_are_read_or_refused(tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    for name, content in FILES.items():
        for _ in range(40):
            data = bytearray(content)
            for at in rng.integers(len(data), size=rng.integers(1, 5)):
                data[at] = rng.integers(256)
            (tmp_path / name).write_bytes(data)
            try:
                found = read_mesh(tmp_path / name)
            except UsageError:
                continue
            assert found.faces.max() < len(found.vertices)
            assert np.isfinite(found.vertices).all()
