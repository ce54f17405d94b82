"""The surfaces of bones in a result: ``meshes.json``, which pages and clips are made of at any later time."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from pydantic import TypeAdapter, ValidationError

from elbowscrew._version import __version__
from elbowscrew.errors import ResultError, UsageError, shown
from elbowscrew.model.mesh import Mesh
from elbowscrew.model.mesh_types import MeshesSummary, MeshSummary
from elbowscrew.results.proof import Proof
from elbowscrew.view.trial_view import ENDS, End, TrialView

MESHES: Final = "meshes.json"
MESHES_MARK: Final = '"meshes of elbowscrew"'
"""What stands at the beginning of the file, so that it may be replaced."""
_DECIMALS: Final = 2


def placed_meshes(view: TrialView, given: Mapping[str, Mesh]) -> dict[End, Mesh]:
    """Tell which of the two bodies each mesh belongs to.

    Parameters
    ----------
    view : TrialView
    given : mapping of str to Mesh
        By ``proximal`` or ``distal``, the segment's word such as ``thigh``, or the body's name in the recording.

    Raises
    ------
    UsageError
        If a name is none of them, or two are of one body.
    """
    words = view.named_joint
    names: dict[End, tuple[str | None, ...]] = {
        "proximal": (view.proximal_name, words.proximal.short, words.proximal.name, "proximal"),
        "distal": (view.distal_name, words.distal.short, words.distal.name, "distal"),
    }
    found: dict[End, Mesh] = {}
    for name, mesh in given.items():
        ends = [end for end, of in names.items() if name in of] or [
            end for end, of in names.items() if name.casefold() in [one.casefold() for one in of if one]
        ]
        if len(ends) != 1 or ends[0] in found:
            possible = ", ".join(dict.fromkeys(repr(one) for of in names.values() for one in of if one))
            what = "a second one of the same body" if ends and ends[0] in found else "no body of this trial"
            msg = f"--mesh {shown(name)}: {what}; possible: {possible}"
            raise UsageError(msg)
        found[ends[0]] = mesh
    return found


def meshes_file(meshes: Mapping[End, Mesh]) -> bytes:
    """Give the content of ``meshes.json``."""
    content: MeshesSummary = {
        "about": "meshes of elbowscrew",
        "elbowscrew": __version__,
        "proximal": _told(meshes.get("proximal")),
        "distal": _told(meshes.get("distal")),
    }
    return (json.dumps(content, ensure_ascii=True, allow_nan=False, separators=(",", ":")) + "\n").encode()


def kept_meshes(proof: Proof) -> dict[End, Mesh]:
    """Read the meshes of a result; none where it has none.

    Raises
    ------
    ResultError
        If the file is not as it was written.
    """
    if not proof.has(MESHES):
        return {}
    path = proof.folder / MESHES
    try:
        with proof.file(MESHES).opened() as stream:
            content = TypeAdapter(MeshesSummary).validate_python(json.loads(stream.read()), strict=True)
        return {end: _mesh(told) for end in ENDS if (told := content[end]) is not None}
    except OSError as error:
        msg = f"{path}: cannot be read: {error.strerror or error}; analyze the trial again"
        raise ResultError(msg) from error
    except (ValueError, OverflowError, RecursionError, ValidationError) as error:
        msg = f"{path}: not as it was written: {error}; analyze the trial again"
        raise ResultError(" ".join(msg.split())) from error


def _told(mesh: Mesh | None) -> MeshSummary | None:
    if mesh is None:
        return None
    return {
        "file": mesh.file,
        "sha256": mesh.sha256,
        "triangles": mesh.triangles,
        "vertices_mm": np.round(1000.0 * mesh.vertices, _DECIMALS).tolist(),
        "faces": mesh.faces.tolist(),
    }


def _mesh(told: MeshSummary) -> Mesh:
    vertices: Any = np.array(told["vertices_mm"], dtype=np.float64) / 1000.0
    faces = np.array(told["faces"], dtype=np.int64)
    if vertices.ndim != 2 or vertices.shape[1] != 3 or faces.ndim != 2 or faces.shape[1] != 3:
        msg = "vertices and faces are rows of three"
        raise ValueError(msg)
    if not np.isfinite(vertices).all() or faces.min() < 0 or faces.max() >= len(vertices):
        msg = "a face names a vertex that is not there"
        raise ValueError(msg)
    return Mesh(vertices=vertices, faces=faces, triangles=told["triangles"], file=told["file"], sha256=told["sha256"])
