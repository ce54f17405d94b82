"""``elbowscrew info``: what a file holds."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from elbowscrew.cli import options


def info(
    trial: Annotated[
        Path, typer.Argument(metavar="TRIAL", help="An OptiTrack export, plain table, TRC or C3D.", show_default=False)
    ],
    units: Annotated[options.Units | None, typer.Option(help="Unit of length, if the file states none.")] = None,
    rotation: Annotated[options.Rotation | None, typer.Option(help="Rotation type, if the file states none.")] = None,
    markers: Annotated[
        list[str] | None, typer.Option(metavar="NAMES", help="Markers to tell of, or patterns; with commas.")
    ] = None,
    frozen: Annotated[
        Literal["lost", "keep"] | None, typer.Option(help="Poses that repeat to the last digit.", show_default="lost")
    ] = None,
    max_turn: Annotated[
        float | None, typer.Option(metavar="DEG/S", help="Fastest turn; more is a leap.", show_default="3000")
    ] = None,
    max_speed: Annotated[
        float | None, typer.Option(metavar="M/S", help="Fastest motion; more is a leap.", show_default="15")
    ] = None,
    json_output: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
) -> None:
    """Say what a file holds; analyze nothing.

    Layout, clock, bodies and their tracking, markers.
    """
    from elbowscrew.cli import render
    from elbowscrew.errors import NoBodiesError
    from elbowscrew.reading.registry import read_recording
    from elbowscrew.results.summary import summary_from_recording
    from elbowscrew.settings import settings_from

    settings = settings_from(None, {"frozen": frozen, "max_turn": max_turn, "max_speed": max_speed})
    wanted = options.names(markers) or ()
    try:
        recording = read_recording(trial, units=units, rotation=rotation, markers=wanted)
    except NoBodiesError:
        # Its markers are what there is to tell of.
        recording = read_recording(trial, units=units, rotation=rotation, markers=wanted or ("*",))
    summary = summary_from_recording(recording, settings)
    render.warnings(summary["warnings"])
    if json_output:
        render.json_object(summary)
    else:
        render.info_table(summary)
