"""``elbowscrew compare``: models of one motion, or of a folder of them, beside each other."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from elbowscrew.choices import BLEND_NAMES, KEYFRAME_SOURCES, KNOT_NAMES, LAW_NAMES, METHOD_NAMES
from elbowscrew.cli import options
from elbowscrew.cli.analysis_options import OUTPUT, settings_options

_MODELS = "Model"


@settings_options(
    "joint", "proximal", "distal", "proximal-markers", "distal-markers", "units", "rotation", "rate", "columns",
    "lowpass", "inversion", "phases", "tolerance", "radius", "figure-format", "font",
    defaults={"lowpass": "by residual analysis, 6 at most", "tolerance": "2mm"},
)  # fmt: skip
def compare(
    trial: Annotated[
        Path, typer.Argument(metavar="TRIAL", help="A recording, or a folder of recordings.", show_default=False)
    ],
    methods: Annotated[
        list[str] | None,
        typer.Option(
            metavar="M1,M2,...",
            rich_help_panel=_MODELS,
            help=f"Interpolations: {', '.join(METHOD_NAMES)}.",
            show_default="all",
        ),
    ] = None,
    laws: Annotated[
        list[str] | None,
        typer.Option(
            metavar="L1,L2,...",
            rich_help_panel=_MODELS,
            help=f"Laws of motion: {', '.join(LAW_NAMES)}.",
            show_default="all",
        ),
    ] = None,
    blends: Annotated[
        list[str] | None,
        typer.Option(
            metavar="B1,B2",
            rich_help_panel=_MODELS,
            help=f"Phase by phase, or all poses at once: {', '.join(BLEND_NAMES)}.",
            show_default="all",
        ),
    ] = None,
    knots: Annotated[
        list[str] | None,
        typer.Option(
            metavar="K1,K2,...",
            rich_help_panel=_MODELS,
            help=f"Parameters of the keyframes: {', '.join(KNOT_NAMES)}.",
            show_default="law",
        ),
    ] = None,
    counts: Annotated[
        list[str] | None,
        typer.Option(metavar="N1,N2,...", rich_help_panel=_MODELS, help="Keyframes per phase.", show_default="2,3,4,5"),
    ] = None,
    data: Annotated[
        list[str] | None,
        typer.Option(
            metavar="D1,D2,...",
            rich_help_panel=_MODELS,
            help=f"What keyframes are taken from: {', '.join(KEYFRAME_SOURCES)}.",
            show_default="all",
        ),
    ] = None,
    decimation: Annotated[
        list[str] | None,
        typer.Option(
            metavar="N1,N2,...", rich_help_panel=_MODELS, help="Use every N-th frame only.", show_default="2,4"
        ),
    ] = None,
    *,
    given: dict[str, Any],
    config: Annotated[
        Path | None,
        typer.Option(metavar="FILE.toml", rich_help_panel=OUTPUT, help="Settings of analyze, as a file."),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="DIR",
            rich_help_panel=OUTPUT,
            help="Result folder.",
            show_default="<trial>_compare in the current folder",
        ),
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Replace an earlier comparison.", rich_help_panel=OUTPUT)
    ] = False,
    json_output: Annotated[
        bool, typer.Option("--json", help="Print compare.json instead of the table.", rich_help_panel=OUTPUT)
    ] = False,
    quiet: options.Quiet = False,
) -> None:
    """Compare models of one motion, or of a folder of recordings.

    Methods, laws of motion and numbers of keyframes, ranked by the displacement they leave, and the fewest keyframes
    that keep it under a tolerance.
    """
    from elbowscrew.cli import render
    from elbowscrew.cli.progress import shown_steps
    from elbowscrew.configuring import settings_from
    from elbowscrew.errors import ElbowscrewError
    from elbowscrew.reading.registry import TABLE_ENDINGS, read_recording, recordings_in
    from elbowscrew.results.recording_summary import warnings_summary
    from elbowscrew.results.result_files import COMPARISON
    from elbowscrew.results.staging import check_result_folder
    from elbowscrew.saving import check_output, write_comparison

    settings = settings_from(config, given)
    plan = options.comparison_plan(
        {"methods": methods, "laws": laws, "blends": blends, "knots": knots, "data": data},
        {"counts": counts, "decimation": decimation},
    )
    target = output if output is not None else Path(f"{trial.resolve().name.removesuffix(trial.suffix)}_compare")
    check_result_folder(target, force=force, kind=COMPARISON)  # before the work, not after it
    check_output(settings)
    if trial.is_dir():
        from elbowscrew.comparing import compare_trials

        files = recordings_in(trial, None if settings.columns is None else TABLE_ENDINGS)
        with shown_steps("Trials", quiet=quiet) as report:
            over_trials = compare_trials(files, settings, plan, report=report)
        summary = write_comparison(over_trials, target, force=force)
        for path, error in over_trials.failures:
            render.note(f"{path}: {error}" if path not in str(error) else str(error))
        failed = bool(over_trials.failures)
    else:
        from elbowscrew.motion.interpolation.comparison import compare as compare_recording

        with shown_steps("Steps", quiet=quiet) as report:
            recording = read_recording(trial, markers=settings.markers, **settings.statements)
            try:
                comparison = compare_recording(recording, settings, plan, report=report)
            except ElbowscrewError as error:
                msg = f"{trial}: {error}"
                raise type(error)(msg) from error
        summary = write_comparison(comparison, target, force=force)
        render.warnings(warnings_summary(comparison.warnings))
        failed = False
    if json_output:
        render.json_object(summary)
    elif not quiet:
        render.comparison_table(summary, target)
    if failed:
        raise typer.Exit(7)
