"""``elbowscrew info``: what a file holds."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from elbowscrew.cli import options


def info(
    trial: Annotated[Path, typer.Argument(metavar="TRIAL", help="An OptiTrack export (CSV).", show_default=False)],
    units: Annotated[options.Units | None, typer.Option(help="Unit of length, if the file states none.")] = None,
    rotation: Annotated[options.Rotation | None, typer.Option(help="Rotation type, if the file states none.")] = None,
    markers: Annotated[
        list[str] | None, typer.Option(metavar="NAMES", help="Markers to tell of, or patterns; with commas.")
    ] = None,
    json_output: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
) -> None:
    """Say what a file holds; analyze nothing.

    Layout, clock, bodies and their tracking.
    """
    from elbowscrew.cli import render
    from elbowscrew.io.reading import read_recording
    from elbowscrew.io.summary import summary_from_recording

    summary = summary_from_recording(
        read_recording(trial, units=units, rotation=rotation, markers=options.names(markers) or ())
    )
    render.warnings(summary["warnings"])
    if json_output:
        render.json_object(summary)
    else:
        render.info_table(summary)
