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
    everything: Annotated[
        bool, typer.Option("--all", help="Describe every body, bone and marker, however many there are.")
    ] = False,
    *,
    given: dict[str, Any],
    json_output: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
) -> None:
    """Show what a file contains, without analyzing it.

    Layout, clock, bodies and their tracking, bones and markers, what the file does not say, and the next command.
    """
    from elbowscrew.cli import render, render_file
    from elbowscrew.cli.next_command import next_command, too_seldom_tracked
    from elbowscrew.configuring import settings_from
    from elbowscrew.reading.options import check_patterns
    from elbowscrew.reading.unstated import read_what_is_stated
    from elbowscrew.results.recording_summary import summary_from_recording

    settings = settings_from(None, given)
    wanted = options.parts("markers", markers) or ()
    recording, missing = read_what_is_stated(
        trial,
        **settings.statements
        | {"distal_path": distal_path, "markers": ("*",) if everything else wanted, "bones": "*" if everything else ()},
    )
    check_patterns(trial, wanted, [] if recording.source is None else recording.source.markers)
    summary = summary_from_recording(recording, settings, missing)
    command, guessed = next_command([trial, *([] if distal_path is None else [distal_path])], given, summary)
    render.warnings(summary["warnings"])
    if json_output:
        render.json_object({**summary, "next": command})
    else:
        render_file.info_table(summary, everything=everything)
        least = settings.min_tracked_percent
        seldom = too_seldom_tracked(summary, least)
        render_file.next_line(command, guessed=guessed, seldom=seldom, least_percent=least)
