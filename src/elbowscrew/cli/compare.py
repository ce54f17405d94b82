"""``elbowscrew compare``: models of one motion, or of a folder of them, beside each other."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from elbowscrew.cli import options

_MODELS, _RECORDING, _OUTPUT = "Models", "Recording", "Output"


def compare(
    trial: Annotated[
        Path, typer.Argument(metavar="TRIAL", help="A recording, or a folder of recordings.", show_default=False)
    ],
    methods: Annotated[
        str | None,
        typer.Option(metavar="M1,M2,...", rich_help_panel=_MODELS, help="Interpolations of poses.", show_default="all"),
    ] = None,
    laws: Annotated[
        str | None,
        typer.Option(
            metavar="L1,L2,...",
            rich_help_panel=_MODELS,
            help="Laws of motion, best and empirical among them.",
            show_default="all",
        ),
    ] = None,
    blends: Annotated[
        str | None,
        typer.Option(
            metavar="B1,B2", rich_help_panel=_MODELS, help="piecewise, global.", show_default="piecewise,global"
        ),
    ] = None,
    knots: Annotated[
        str | None,
        typer.Option(
            metavar="K1,K2,...", rich_help_panel=_MODELS, help="law, chord, uniform, angle.", show_default="law"
        ),
    ] = None,
    counts: Annotated[
        str | None,
        typer.Option(metavar="N1,N2,...", rich_help_panel=_MODELS, help="Keyframes a phase.", show_default="2,3,4,5"),
    ] = None,
    data: Annotated[
        str | None,
        typer.Option(
            metavar="D1,D2,...",
            rich_help_panel=_MODELS,
            help="Keyframes from raw, lowpass, decimated.",
            show_default="all",
        ),
    ] = None,
    decimation: Annotated[
        str | None,
        typer.Option(
            metavar="N1,N2,...", rich_help_panel=_MODELS, help="Take every so many-th frame.", show_default="2,4"
        ),
    ] = None,
    tolerance: Annotated[
        str | None,
        typer.Option(
            metavar="LENGTH", rich_help_panel=_MODELS, help="Of the fewest keyframes, as 2mm.", show_default="2mm"
        ),
    ] = None,
    phases: Annotated[
        Literal["movement", "whole"] | None,
        typer.Option(
            rich_help_panel=_MODELS, help="Between the movement's rests, or the whole take.", show_default="movement"
        ),
    ] = None,
    inversion: Annotated[
        int | None,
        typer.Option(metavar="FRAME", rich_help_panel=_MODELS, help="Where the motion turns.", show_default="found"),
    ] = None,
    lowpass: Annotated[
        str | None,
        typer.Option(
            metavar="HZ",
            rich_help_panel=_MODELS,
            help="Filter of the filtered keyframes.",
            show_default="by residual analysis, 6 at most",
        ),
    ] = None,
    radius: Annotated[
        float | None,
        typer.Option(
            metavar="MM",
            rich_help_panel=_MODELS,
            help="Radius of gyration for the RMS displacement.",
            show_default="the distal body's markers, else 50",
        ),
    ] = None,
    proximal: Annotated[
        str | None,
        typer.Option("--proximal", "--arm", metavar="NAME", rich_help_panel=_RECORDING, help="Name, id, or none."),
    ] = None,
    distal: Annotated[
        str | None,
        typer.Option("--distal", "--forearm", metavar="NAME", rich_help_panel=_RECORDING, help="Name or id."),
    ] = None,
    proximal_markers: Annotated[
        list[str] | None,
        typer.Option(
            "--proximal-markers",
            "--arm-markers",
            metavar="NAMES",
            rich_help_panel=_RECORDING,
            help="Names or patterns.",
        ),
    ] = None,
    distal_markers: Annotated[
        list[str] | None,
        typer.Option(
            "--distal-markers",
            "--forearm-markers",
            metavar="NAMES",
            rich_help_panel=_RECORDING,
            help="Names or patterns.",
        ),
    ] = None,
    units: Annotated[
        options.Units | None,
        typer.Option(rich_help_panel=_RECORDING, help="Unit of length, if the file states none."),
    ] = None,
    rotation: Annotated[
        options.Rotation | None,
        typer.Option(rich_help_panel=_RECORDING, help="Rotation type, if the file states none."),
    ] = None,
    config: Annotated[
        Path | None,
        typer.Option(metavar="FILE.toml", rich_help_panel=_RECORDING, help="Settings of analyze, as a file."),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="DIR",
            rich_help_panel=_OUTPUT,
            help="Result folder.",
            show_default="<trial>_compare in the current folder",
        ),
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Replace an earlier comparison.", rich_help_panel=_OUTPUT)
    ] = False,
    figure_format: Annotated[
        list[options.FigureFormat] | None,
        typer.Option(rich_help_panel=_OUTPUT, help="Format of the figure; may be given again.", show_default="png"),
    ] = None,
    json_output: Annotated[
        bool, typer.Option("--json", help="Print compare.json instead of the table.", rich_help_panel=_OUTPUT)
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print no table.", rich_help_panel=_OUTPUT)] = False,
) -> None:
    """Compare models of one motion, or of a folder of recordings.

    Methods, laws of motion and numbers of keyframes, ranked by the displacement they leave, and the fewest keyframes
    that keep it under a tolerance.
    """
    from elbowscrew.cli import render
    from elbowscrew.errors import ElbowscrewError
    from elbowscrew.reading.registry import read_recording, recordings_in
    from elbowscrew.results.comparison_summary import comparison_summary, trials_summary
    from elbowscrew.results.staging import COMPARISON, check_result_folder
    from elbowscrew.saving import save_comparison
    from elbowscrew.settings import settings_from

    settings = settings_from(
        config,
        {
            "tolerance": tolerance,
            "phases": phases,
            "inversion": inversion,
            "lowpass": lowpass,
            "radius": radius,
            "proximal": proximal,
            "distal": distal,
            "proximal_markers": options.names(proximal_markers),
            "distal_markers": options.names(distal_markers),
            "units": units,
            "rotation": rotation,
            "figure_format": [kind.value for kind in figure_format] if figure_format else None,
        },
    )
    plan = options.comparison_plan(
        {"methods": methods, "laws": laws, "blends": blends, "knots": knots, "data": data},
        {"counts": counts, "decimation": decimation},
    )
    target = output if output is not None else Path(f"{trial.resolve().name.removesuffix(trial.suffix)}_compare")
    check_result_folder(target, force=force, kind=COMPARISON)  # before the work, not after it
    if trial.is_dir():
        from elbowscrew.comparing import compare_trials

        over_trials = compare_trials(recordings_in(trial), settings, plan)
        save_comparison(over_trials, target, force=force)
        for path, error in over_trials.failures:
            render.note(f"{path}: {error}" if path not in str(error) else str(error))
        summary = trials_summary(over_trials)
        failed = bool(over_trials.failures)
    else:
        from elbowscrew.motion.interpolation.comparison import compare as compare_recording

        recording = read_recording(trial, units=settings.units, rotation=settings.rotation, markers=settings.markers)
        try:
            comparison = compare_recording(recording, settings, plan)
        except ElbowscrewError as error:
            msg = f"{trial}: {error}"
            raise type(error)(msg) from error
        save_comparison(comparison, target, force=force)
        summary = comparison_summary(comparison)
        render.warnings(summary["warnings"])
        failed = False
    if json_output:
        render.json_object(summary)
    elif not quiet:
        render.comparison_table(summary, target)
    if failed:
        raise typer.Exit(7)
