"""What ``meshes.json`` holds."""

from __future__ import annotations

from typing_extensions import TypedDict


class MeshSummary(TypedDict):
    """The surface of one bone, as it is drawn."""

    file: str
    sha256: str
    """Of the file."""
    triangles: int
    """Of the file; fewer are drawn where it has many."""
    vertices_mm: list[list[float]]
    """In the frame of its body."""
    faces: list[list[int]]
    """Three rows of the vertices each, from 0 on."""


class MeshesSummary(TypedDict):
    """The bones of both bodies, None where a body has none."""

    about: str
    elbowscrew: str
    """Version of the program."""
    proximal: MeshSummary | None
    distal: MeshSummary | None
