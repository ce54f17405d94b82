"""``elbowscrew report``: pages and publication figures from finished results."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from elbowscrew.choices import DRAWN_FORMATS, OverlayBy
from elbowscrew.cli import options
from elbowscrew.report.names import WIDTHS_MM
from elbowscrew.view.figure_names import ALL, FIGURE_CHOICES, FIGURE_ENTRIES, OVERLAY

if TYPE_CHECKING:
    from elbowscrew.errors import ElbowscrewError
    from elbowscrew.model.mesh import Mesh

_PAGES, _FIGURES = "Pages", "Figures for publication"


def report(
    results: Annotated[
        list[Path],
        typer.Argument(
            metavar="RESULTS...",
            help="Result folders, or folders that contain them, such as a batch's output.",
            show_default=False,
        ),
    ],
    mesh: options.MeshFiles = None,
    mesh_unit: options.MeshUnit = None,
    clip: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            rich_help_panel="Bones in space",
            help="Write the view in space in place of pages: a clip (gif, or webm with ffmpeg) or a still (png).",
            show_default=False,
        ),
    ] = None,
    figures: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAMES",
            rich_help_panel=_FIGURES,
            help=f"Write these figures in place of pages, with commas: {', '.join(FIGURE_ENTRIES)} (the last four "
            "the paper's), "
            f"{OVERLAY} (all trials, mean and deviation); {ALL}.",
        ),
    ] = None,
    by: Annotated[
        OverlayBy | None,
        typer.Option(
            rich_help_panel=_FIGURES,
            help=f"What {OVERLAY} shows: the conditions' means, or the subjects of each, by the manifest's columns.",
            show_default="all trials",
        ),
    ] = None,
    figure_format: Annotated[
        list[str] | None,
        typer.Option(
            metavar="png,svg,pdf,tiff,eps",
            rich_help_panel=_FIGURES,
            help="Separate with commas, or repeat the option.",
            show_default="pdf",
        ),
    ] = None,
    width: Annotated[
        str,
        typer.Option(
            metavar="WIDTH",
            rich_help_panel=_FIGURES,
            help=f"Millimeters, or a name: {', '.join(WIDTHS_MM)}.",
        ),
    ] = "double",
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="DIR",
            rich_help_panel=_FIGURES,
            help="Folder of the figures.",
            show_default="elbowscrew_figures in the current folder",
        ),
    ] = None,
    font: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            rich_help_panel=_FIGURES,
            help="Font: the name of an installed family.",
            show_default="that of the analysis",
        ),
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", rich_help_panel=_FIGURES, help="Replace figures of the same names.")
    ] = False,
    quiet: options.QuietPaths = False,
) -> None:
    """Make report.html and index.html anew, or figures for publication.

    From finished results, without analyzing again: a page for every trial, and one over those of a batch.
    """
    from elbowscrew.cli.progress import shown_steps
    from elbowscrew.cli.text import emit, one_line, printable, tell
    from elbowscrew.errors import UsageError
    from elbowscrew.report import remake_pages, results_in
    from elbowscrew.report.names import figure_names, width_mm

    bones = options.meshes(mesh, mesh_unit)
    if clip is not None and figures:
        msg = "--clip, --figures: each is written in place of pages; ask for them one after the other"
        raise UsageError(msg)
    if not figures:
        given = {
            "--by": by,
            "--figure-format": figure_format,
            "--output": output,
            "--font": font,
            "--force": (force and clip is None) or None,
        }
        idle = [name for name, value in given.items() if value is not None]
        if idle or width != "double":
            msg = f"{', '.join(idle or ['--width'])}: belongs to --figures; name some of {', '.join(FIGURE_CHOICES)}"
            raise UsageError(msg)
        written: tuple[Path, ...]
        errors: tuple[ElbowscrewError, ...] = ()
        if clip is not None:
            written = (_clip(results, clip, bones, force=force),)
        else:
            with shown_steps("Pages", quiet=quiet) as step:
                written, errors = remake_pages(results, report=step, meshes=bones)
    else:
        from elbowscrew.report.publication import save_publication_figures

        if bones:
            msg = "--mesh: bones are drawn in the pages, and --figures makes none; leave one of the two out"
            raise UsageError(msg)
        errors = ()
        names, wide = figure_names(figures), width_mm(width)
        formats = list(options.parts("figure-format", figure_format) or ("pdf",))
        strange = [one for one in formats if one not in DRAWN_FORMATS]
        if strange:
            msg = (
                f"--figure-format {', '.join(strange)}: expected {', '.join(DRAWN_FORMATS)}, as --figures asks for "
                "figures"
            )
            raise UsageError(msg)
        if by is not None and OVERLAY not in names:
            msg = f"--by {by}: belongs to --figures {OVERLAY}; name it, too"
            raise UsageError(msg)
        folder = output if output is not None else Path("elbowscrew_figures")
        with shown_steps("Results", quiet=quiet) as step:
            published = save_publication_figures(
                results_in(results), folder, names, formats, width_mm=wide, by=by, font=font, force=force, report=step
            )
        written = published.files
        wanted = "whole movement out and back" + ("" if by is None else ", or nothing says its condition or subject")
        for path in published.left_out:
            name = one_line(str(path))
            tell(f"elbowscrew: warning: {name}: has no {wanted}, and is left out of the overlay")
        asked_for_all = any(ALL in text.split(",") for text in figures)
        for path, figure in () if asked_for_all else published.not_drawn:
            tell(f"elbowscrew: warning: {one_line(str(path))}: has nothing for the figure {figure}, which is left out")
    if not quiet:
        for path in written:
            emit(f"{printable(str(path))}\n")
    for error in errors[1:]:
        tell(f"elbowscrew: error: {one_line(str(error))}")
    if errors:
        raise errors[0]


def _clip(results: list[Path], clip: Path, bones: dict[str, Mesh], *, force: bool) -> Path:
    from elbowscrew.errors import UsageError
    from elbowscrew.report import results_in
    from elbowscrew.report.clip import write_clip

    inside = results_in(results)
    if len(inside) != 1:
        msg = f"--clip: shows one trial, and there are {len(inside)} results; give the folder of one"
        raise UsageError(msg)
    return write_clip(inside[0], clip, meshes=bones, force=force)
