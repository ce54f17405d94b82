"""``elbowscrew analyze``: one trial into one folder."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from elbowscrew.cli import options
from elbowscrew.cli.analysis_options import OUTPUT, settings_options


@settings_options()
def analyze(
    trial: options.TrialFile,
    distal_path: options.DistalFile = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="DIR",
            rich_help_panel=OUTPUT,
            help="Result folder.",
            show_default="<trial>_elbowscrew in the current folder",
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an earlier result.", rich_help_panel=OUTPUT)] = False,
    *,
    given: dict[str, Any],
    landmarks: options.LandmarksFile = None,
    mesh: options.MeshFiles = None,
    mesh_unit: options.MeshUnit = None,
    page: Annotated[
        bool,
        typer.Option(
            "--report/--no-report", rich_help_panel=OUTPUT, help="Write the page report.html and methods.txt."
        ),
    ] = True,
    config: Annotated[
        Path | None, typer.Option(metavar="FILE.toml", rich_help_panel=OUTPUT, help="Settings; options override them.")
    ] = None,
    json_output: Annotated[
        bool, typer.Option("--json", help="Print summary.json instead of the table.", rich_help_panel=OUTPUT)
    ] = False,
    quiet: options.Quiet = False,
    verbose: Annotated[
        bool, typer.Option("--verbose", "-v", help="Name every file written.", rich_help_panel=OUTPUT)
    ] = False,
) -> None:
    """Analyze one trial into a result folder.

    Screw axis, angle and slide of every frame, a model through a few poses, tables, a summary and figures.
    """
    from elbowscrew.cli import render
    from elbowscrew.cli.progress import shown_stages
    from elbowscrew.configuring import settings_from
    from elbowscrew.reading.landmarks import read_landmarks
    from elbowscrew.results.staging import check_result_folder
    from elbowscrew.saving import analyze_file, check_output, check_written, write_result

    settings = settings_from(config, given)
    target = output if output is not None else Path(f"{trial.stem}_elbowscrew")
    check_result_folder(target, force=force)  # before the work, not after it
    check_output(settings)
    placed = None if landmarks is None else read_landmarks(landmarks)
    bones = options.meshes(mesh, mesh_unit)
    with shown_stages(quiet=quiet) as begin:
        begin(f"Analyzing {trial.name}")
        analysis = analyze_file(trial, settings, distal_path=distal_path, landmarks=placed)
        begin(f"Writing {target}")
        summary = write_result(analysis, target, force=force, report=page, meshes=bones)
    render.warnings(summary["warnings"])
    if json_output:
        render.json_object(summary)
    elif not quiet:
        render.analysis_table(summary, target)
    if verbose:
        render.files(target)
    check_written(summary, target)
