"""The settings as options: listed here once, and added to a command that analyzes by `analysis_options`."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from elbowscrew.cli import options

_BODIES, _MOTION, _MODEL, OUTPUT = "Bodies and file", "Motion", "Model", "Output"


def settings_given(
    joint: Annotated[
        Literal["elbow", "wrist", "knee", "ankle", "hip", "shoulder", "finger"] | None,
        typer.Option(rich_help_panel=_BODIES, help="What the joint is called.", show_default="by the bodies' names"),
    ] = None,
    proximal: Annotated[
        str | None,
        typer.Option(
            "--proximal",
            "--arm",
            metavar="NAME",
            rich_help_panel=_BODIES,
            help="Name or id; none if still.",
        ),
    ] = None,
    distal: Annotated[
        str | None,
        typer.Option("--distal", "--forearm", metavar="NAME", rich_help_panel=_BODIES, help="Name or id."),
    ] = None,
    proximal_markers: Annotated[
        list[str] | None,
        typer.Option(
            "--proximal-markers",
            "--arm-markers",
            metavar="NAMES",
            rich_help_panel=_BODIES,
            help="Names or patterns.",
        ),
    ] = None,
    distal_markers: Annotated[
        list[str] | None,
        typer.Option(
            "--distal-markers",
            "--forearm-markers",
            metavar="NAMES",
            rich_help_panel=_BODIES,
            help="Names or patterns.",
        ),
    ] = None,
    pose_method: Annotated[
        Literal["svd", "dual-qr"] | None,
        typer.Option(rich_help_panel=_BODIES, help="Poses from markers.", show_default="svd"),
    ] = None,
    landmarks: Annotated[
        Path | None,
        typer.Option(metavar="FILE.toml", rich_help_panel=_BODIES, help="Landmarks, for the anatomical angles."),
    ] = None,
    units: Annotated[
        options.Units | None, typer.Option(rich_help_panel=_BODIES, help="Unit of length, if the file states none.")
    ] = None,
    rotation: Annotated[
        options.Rotation | None, typer.Option(rich_help_panel=_BODIES, help="Rotation type, if the file states none.")
    ] = None,
    frozen: Annotated[
        Literal["lost", "keep"] | None,
        typer.Option(rich_help_panel=_BODIES, help="Poses that repeat to the last digit.", show_default="lost"),
    ] = None,
    max_turn: Annotated[
        float | None,
        typer.Option(
            metavar="DEG/S", rich_help_panel=_BODIES, help="Fastest turn; more is a leap.", show_default="3000"
        ),
    ] = None,
    max_speed: Annotated[
        float | None,
        typer.Option(metavar="M/S", rich_help_panel=_BODIES, help="Fastest motion; more is a leap.", show_default="15"),
    ] = None,
    min_tracked: Annotated[
        float | None,
        typer.Option(metavar="PERCENT", rich_help_panel=_BODIES, help="Least share of frames.", show_default="50"),
    ] = None,
    reference: Annotated[
        int | None,
        typer.Option(
            metavar="FRAME", rich_help_panel=_MOTION, help="Reference pose.", show_default="first tracked frame"
        ),
    ] = None,
    reference_window: Annotated[
        int | None,
        typer.Option(metavar="N", rich_help_panel=_MOTION, help="Mean of N frames as reference.", show_default="1"),
    ] = None,
    express_in: Annotated[
        Literal["distal", "proximal", "lab", "forearm", "arm"] | None,
        typer.Option(rich_help_panel=_MOTION, help="Frame the screw is written in.", show_default="distal"),
    ] = None,
    max_gap: Annotated[
        float | None,
        typer.Option(metavar="SECONDS", rich_help_panel=_MOTION, help="Longest gap filled.", show_default="0.1"),
    ] = None,
    min_angle: Annotated[
        float | None,
        typer.Option(metavar="DEG", rich_help_panel=_MOTION, help="Least angle for an axis.", show_default="10"),
    ] = None,
    lowpass: Annotated[
        str | None,
        typer.Option(
            metavar="HZ",
            rich_help_panel=_MOTION,
            help="Filter of the poses: HZ, auto or none.",
            show_default="none",
        ),
    ] = None,
    resample: Annotated[
        float | None,
        typer.Option(metavar="HZ", rich_help_panel=_MOTION, help="Rate to resample to.", show_default="the file's"),
    ] = None,
    min_rate: Annotated[
        float | None,
        typer.Option(
            metavar="RAD/S",
            rich_help_panel=_MOTION,
            help="Least angular velocity for an instantaneous axis.",
            show_default="0.25",
        ),
    ] = None,
    axis_sd: Annotated[
        str | None,
        typer.Option(
            metavar="DEG", rich_help_panel=_MOTION, help="Least precision of an axis, in place of --min-angle: 2deg."
        ),
    ] = None,
    step: Annotated[
        float | None,
        typer.Option(metavar="DEG", rich_help_panel=_MOTION, help="Axes from pose to pose, so far apart: steps.csv."),
    ] = None,
    marker_noise: Annotated[
        float | None,
        typer.Option(
            metavar="MM",
            rich_help_panel=_MOTION,
            help="Noise of each coordinate of a marker.",
            show_default="from the recording",
        ),
    ] = None,
    noise: Annotated[
        Literal["auto", "residuals", "still", "error-column", "none"] | None,
        typer.Option(rich_help_panel=_MOTION, help="Where the noise is known from.", show_default="auto"),
    ] = None,
    signed: Annotated[
        Literal["auto", "yes", "no"] | None,
        typer.Option(
            rich_help_panel=_MOTION, help="Give theta a sense; auto: where one axis dominates.", show_default="auto"
        ),
    ] = None,
    robust: Annotated[
        bool | None,
        typer.Option("--robust/--no-robust", rich_help_panel=_MOTION, help="Weigh outliers down in the joint's axis."),
    ] = None,
    cycle_swing: Annotated[
        float | None,
        typer.Option(
            metavar="DEG",
            rich_help_panel=_MOTION,
            help="Least swing between a cycle's turns.",
            show_default="by noise and range",
        ),
    ] = None,
    cycles: Annotated[
        str | None,
        typer.Option(
            metavar="FILE.CSV", rich_help_panel=_MOTION, help="Times of the cycles: start_time_s, end_time_s."
        ),
    ] = None,
    no_cycles: Annotated[
        bool | None, typer.Option("--no-cycles", rich_help_panel=_MOTION, help="Look for no cycles.")
    ] = None,
    keyframes: Annotated[
        str | None,
        typer.Option(
            metavar="F1,F2,...",
            rich_help_panel=_MODEL,
            help="Frames the model passes through.",
            show_default="start, inversion, end",
        ),
    ] = None,
    inversion: Annotated[
        int | None,
        typer.Option(
            metavar="FRAME", rich_help_panel=_MODEL, help="Where the motion turns.", show_default="largest angle"
        ),
    ] = None,
    phases: Annotated[
        Literal["movement", "whole"] | None,
        typer.Option(
            rich_help_panel=_MODEL, help="Between the movement's rests, or the whole take.", show_default="movement"
        ),
    ] = None,
    tolerance: Annotated[
        str | None,
        typer.Option(
            metavar="LENGTH",
            rich_help_panel=_MODEL,
            help="Fewest keyframes that keep the RMS displacement below: 2mm.",
        ),
    ] = None,
    method: Annotated[
        Literal["dlb", "sclerp", "sdlb", "dib", "catmull-rom"] | None,
        typer.Option(
            rich_help_panel=_MODEL, help="Interpolation of poses.", show_default="dlb, with a tolerance sclerp"
        ),
    ] = None,
    blend: Annotated[
        Literal["piecewise", "global"] | None,
        typer.Option(rich_help_panel=_MODEL, help="Phase by phase, or all poses at once.", show_default="piecewise"),
    ] = None,
    law: Annotated[
        Literal[
            "cycloidal",
            "linear",
            "harmonic",
            "polynomial-345",
            "polynomial-4567",
            "modified-trapezoid",
            "modified-sine",
            "empirical",
            "best",
        ]
        | None,
        typer.Option(rich_help_panel=_MODEL, help="Law of motion.", show_default="cycloidal, with a tolerance linear"),
    ] = None,
    law_peak: Annotated[
        float | None,
        typer.Option(
            metavar="SHARE", rich_help_panel=_MODEL, help="Time of the highest velocity in a phase.", show_default="0.5"
        ),
    ] = None,
    knots: Annotated[
        Literal["law", "chord", "uniform", "angle"] | None,
        typer.Option(rich_help_panel=_MODEL, help="Parameter of the keyframes.", show_default="law"),
    ] = None,
    radius: Annotated[
        float | None,
        typer.Option(
            metavar="MM",
            rich_help_panel=_MODEL,
            help="Radius of gyration for the RMS displacement.",
            show_default="the distal body's markers, else 50",
        ),
    ] = None,
    angle_unit: Annotated[
        Literal["deg", "rad"] | None,
        typer.Option(rich_help_panel=OUTPUT, help="Unit of angles in tables and figures.", show_default="deg"),
    ] = None,
    length_unit: Annotated[
        Literal["mm", "m"] | None,
        typer.Option(rich_help_panel=OUTPUT, help="Unit of lengths in tables and figures.", show_default="mm"),
    ] = None,
    figure_format: Annotated[
        list[options.FigureFormat] | None,
        typer.Option(rich_help_panel=OUTPUT, help="May be given more than once.", show_default="png"),
    ] = None,
    export: Annotated[
        list[options.ExportFormat] | None,
        typer.Option(
            rich_help_panel=OUTPUT,
            help="Tables for other programs, too; may be given more than once.",
            show_default="none",
        ),
    ] = None,
) -> dict[str, Any]:
    """Collect what was given on the command line; None where nothing was.

    A new option of the analysis is one parameter here, named as the field of `Settings` without its unit.
    """
    given = dict(locals())
    for name in ("proximal_markers", "distal_markers"):
        given[name] = options.names(given[name])
    given["keyframes"] = options.frame_numbers(keyframes)
    for name in ("figure_format", "export"):
        given[name] = [kind.value for kind in given[name]] if given[name] else None
    return given


def analysis_options(command: Callable[..., None]) -> Callable[..., None]:
    """Put the options of `settings_given` in the place of a command's parameter ``given``, which gets what they say."""
    options_of_settings = inspect.signature(settings_given, eval_str=True).parameters
    parameters: list[inspect.Parameter] = []
    for parameter in inspect.signature(command, eval_str=True).parameters.values():
        parameters += options_of_settings.values() if parameter.name == "given" else [parameter]

    @wraps(command)
    def with_options(**values: Any) -> None:
        given = settings_given(**{name: values.pop(name) for name in options_of_settings})
        command(given=given, **values)

    with_options.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    with_options.__annotations__ = {}
    return with_options
