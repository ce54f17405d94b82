"""``elbowscrew info``: what a file holds."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from elbowscrew.cli import options
from elbowscrew.cli.analysis_options import settings_options


@settings_options("units", "rotation", "rate", "columns", "frozen", "max-turn", "max-speed")
def info(
    trial: options.TrialFile,
    distal_path: options.DistalFile = None,
    markers: Annotated[
        list[str] | None, typer.Option(metavar="NAMES", help="Markers to describe: names or patterns, with commas.")
    ] = None,
    *,
    given: dict[str, Any],
    json_output: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
) -> None:
    """Show what a file contains, without analyzing it.

    Layout, clock, bodies and their tracking, markers.
    """
    from elbowscrew.cli import render
    from elbowscrew.configuring import settings_from
    from elbowscrew.errors import NoBodiesError
    from elbowscrew.reading.registry import read_recording
    from elbowscrew.results.recording_summary import summary_from_recording

    settings = settings_from(None, given)
    wanted = options.parts("markers", markers) or ()
    stated: dict[str, Any] = {"distal_path": distal_path, **settings.statements}
    try:
        recording = read_recording(trial, **stated, markers=wanted)
    except NoBodiesError:
        # Its markers are what there is to tell of.
        recording = read_recording(trial, **stated, markers=wanted or ("*",))
    summary = summary_from_recording(recording, settings)
    render.warnings(summary["warnings"])
    if json_output:
        render.json_object(summary)
    else:
        render.info_table(summary)
