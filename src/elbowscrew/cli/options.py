"""Options that several commands share, and lists that the shell gives as text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from elbowscrew.choices import LengthUnit
from elbowscrew.errors import UsageError, shown

if TYPE_CHECKING:
    from elbowscrew.model.mesh import Mesh
    from elbowscrew.motion.interpolation.keyframe_sources import ComparisonPlan

LandmarksFile = Annotated[
    Path | None,
    typer.Option(metavar="FILE.toml", rich_help_panel="Bodies and file", help="Landmarks, for the anatomical angles."),
]

MeshFiles = Annotated[
    list[str] | None,
    typer.Option(
        metavar="BODY=FILE",
        rich_help_panel="Bones in space",
        help="A bone's surface (stl, obj, ply) in the frame of its body, as in thigh=femur.stl. Repeat the option.",
    ),
]
MeshUnit = Annotated[
    LengthUnit | None,
    typer.Option(
        rich_help_panel="Bones in space", help="Unit of the meshes, which they do not state.", show_default="mm"
    ),
]

Quiet = Annotated[
    bool, typer.Option("--quiet", "-q", rich_help_panel="Output", help="Print neither table nor progress.")
]
QuietPaths = Annotated[bool, typer.Option("--quiet", "-q", help="Print neither paths nor progress.")]

TrialFile = Annotated[
    Path,
    typer.Argument(
        metavar="TRIAL",
        help="A recording: Motive, plain table, TRC, C3D, Qualisys or 4 x 4.",
        show_default=False,
    ),
]

DistalFile = Annotated[
    Path | None,
    typer.Argument(
        metavar="[DISTAL]",
        help="The distal body's file, where TRIAL holds the proximal body alone.",
        show_default=False,
    ),
]


def meshes(given: Sequence[str] | None, unit: LengthUnit | None) -> dict[str, Mesh]:
    """Read the bones that ``--mesh`` names, by their bodies.

    Raises
    ------
    UsageError
        If one is not ``BODY=FILE``, a body is named twice, or a file is no mesh.
    """
    from elbowscrew.reading.meshes import read_mesh

    if unit is not None and not given:
        msg = "--mesh-unit: belongs to --mesh; give it, too"
        raise UsageError(msg)
    found: dict[str, Mesh] = {}
    for text in given or ():
        body, sign, file = text.partition("=")
        if not (body.strip() and sign and file.strip()):
            msg = f"--mesh {shown(text)}: expected a body and a file, as in thigh=femur.stl"
            raise UsageError(msg)
        if body.strip() in found:
            msg = f"--mesh: {shown(body.strip())} is given twice; a body has one mesh"
            raise UsageError(msg)
        found[body.strip()] = read_mesh(Path(file.strip()), unit or "mm")
    return found


def parts(option: str, given: Sequence[str] | None, *, once: bool = True) -> tuple[str, ...] | None:
    """Split a list at its commas; an option may be given more than once, and all it is given counts.

    Parts that are repeated are left out, unless each counts, as of numbers.

    Raises
    ------
    UsageError
        If nothing is left.
    """
    if not given:
        return None
    found = tuple(part.strip() for text in given for part in text.split(",") if part.strip())
    found = tuple(dict.fromkeys(found)) if once else found
    if not found:
        msg = f"--{option}: expected one or more with commas between them, found {','.join(given)!r}"
        raise UsageError(msg)
    return found


def whole_numbers(option: str, given: Sequence[str] | None) -> tuple[int, ...] | None:
    """Read whole numbers, as frames are.

    Raises
    ------
    UsageError
        If one is none.
    """
    if given is None:
        return None
    try:
        return tuple(int(part) for part in given)
    except ValueError as error:
        what = "frame numbers" if option == "keyframes" else "whole numbers"
        msg = f"--{option} {','.join(given)!r}: expected {what} with commas between them, as in 2,3,4"
        raise UsageError(msg) from error


def comparison_plan(
    words: Mapping[str, Sequence[str] | None], numbers: Mapping[str, Sequence[str] | None]
) -> ComparisonPlan:
    """Make the plan of a comparison of lists; what is not given stays as it is.

    Raises
    ------
    UsageError
        If a list has something that is no number, or no choice.
    """
    from elbowscrew.motion.interpolation.keyframe_sources import ComparisonPlan

    given: dict[str, tuple[str, ...] | tuple[int, ...] | None] = {
        **{name: parts(name, one) for name, one in words.items()},
        **{name: whole_numbers(name, parts(name, one)) for name, one in numbers.items()},
    }
    try:
        return ComparisonPlan(**{name: one for name, one in given.items() if one is not None})  # type: ignore[arg-type]
    except UsageError as error:  # in the fields' names, which the options have
        msg = f"--{error}"
        raise UsageError(msg) from error
