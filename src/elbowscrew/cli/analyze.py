"""``elbowscrew analyze``: one trial into one folder."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from elbowscrew.cli import options

_BODIES, _MOTION, _MODEL, _OUTPUT = "Bodies and file", "Motion", "Model", "Output"


def analyze(
    trial: Annotated[
        Path, typer.Argument(metavar="TRIAL", help="An OptiTrack export, plain table, TRC or C3D.", show_default=False)
    ],
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="DIR",
            rich_help_panel=_OUTPUT,
            help="Result folder.",
            show_default="<trial>_elbowscrew in the current folder",
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an earlier result.", rich_help_panel=_OUTPUT)] = False,
    arm: Annotated[
        str | None,
        typer.Option(metavar="NAME", rich_help_panel=_BODIES, help="Upper arm: name or id; none if it stands still."),
    ] = None,
    forearm: Annotated[
        str | None, typer.Option(metavar="NAME", rich_help_panel=_BODIES, help="Forearm: name or id.")
    ] = None,
    arm_markers: Annotated[
        list[str] | None,
        typer.Option(metavar="NAMES", rich_help_panel=_BODIES, help="Markers of the arm, or patterns; with commas."),
    ] = None,
    forearm_markers: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAMES", rich_help_panel=_BODIES, help="Markers of the forearm, or patterns; with commas."
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
        Literal["forearm", "arm", "lab"] | None,
        typer.Option(rich_help_panel=_MOTION, help="Frame the screw is written in.", show_default="forearm"),
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
    robust: Annotated[
        bool | None,
        typer.Option("--robust/--no-robust", rich_help_panel=_MOTION, help="Weigh outliers down in the joint's axis."),
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
            show_default="the forearm's markers, else 50",
        ),
    ] = None,
    angle_unit: Annotated[
        Literal["deg", "rad"] | None,
        typer.Option(rich_help_panel=_OUTPUT, help="Unit of angles in tables and figures.", show_default="deg"),
    ] = None,
    length_unit: Annotated[
        Literal["mm", "m"] | None,
        typer.Option(rich_help_panel=_OUTPUT, help="Unit of lengths in tables and figures.", show_default="mm"),
    ] = None,
    figure_format: Annotated[
        list[options.FigureFormat] | None,
        typer.Option(rich_help_panel=_OUTPUT, help="May be given more than once.", show_default="png"),
    ] = None,
    page: Annotated[
        bool, typer.Option("--report/--no-report", rich_help_panel=_OUTPUT, help="Write the page report.html.")
    ] = True,
    config: Annotated[
        Path | None, typer.Option(metavar="FILE.toml", rich_help_panel=_OUTPUT, help="Settings; options are stronger.")
    ] = None,
    json_output: Annotated[
        bool, typer.Option("--json", help="Print summary.json instead of the table.", rich_help_panel=_OUTPUT)
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print no table.", rich_help_panel=_OUTPUT)] = False,
    verbose: Annotated[
        bool, typer.Option("--verbose", "-v", help="Name every file written.", rich_help_panel=_OUTPUT)
    ] = False,
) -> None:
    """Analyze one trial into a result folder.

    Screw axis, angle and slide of every frame, a model through a few poses, tables, a summary and figures.
    """
    from elbowscrew.cli import render
    from elbowscrew.errors import ElbowscrewError
    from elbowscrew.io.landmarks import read_landmarks
    from elbowscrew.io.reading import read_recording
    from elbowscrew.io.staging import check_result_folder
    from elbowscrew.io.summary import summary_from_analysis
    from elbowscrew.motion.analysis import analyze as analyze_recording
    from elbowscrew.results import save_analysis
    from elbowscrew.settings import settings_from

    settings = settings_from(
        config,
        {
            "arm": arm,
            "forearm": forearm,
            "arm_markers": options.names(arm_markers),
            "forearm_markers": options.names(forearm_markers),
            "pose_method": pose_method,
            "units": units,
            "rotation": rotation,
            "frozen": frozen,
            "max_turn": max_turn,
            "max_speed": max_speed,
            "min_tracked": min_tracked,
            "reference": reference,
            "reference_window": reference_window,
            "express_in": express_in,
            "max_gap": max_gap,
            "min_angle": min_angle,
            "lowpass": lowpass,
            "resample": resample,
            "min_rate": min_rate,
            "axis_sd": axis_sd,
            "step": step,
            "marker_noise": marker_noise,
            "noise": noise,
            "robust": robust,
            "keyframes": options.frame_numbers(keyframes),
            "inversion": inversion,
            "phases": phases,
            "tolerance": tolerance,
            "method": method,
            "blend": blend,
            "law": law,
            "law_peak": law_peak,
            "knots": knots,
            "radius": radius,
            "angle_unit": angle_unit,
            "length_unit": length_unit,
            "figure_format": [kind.value for kind in figure_format] if figure_format else None,
        },
    )
    target = output if output is not None else Path(f"{trial.stem}_elbowscrew")
    check_result_folder(target, force=force)  # before the work, not after it
    places = None if landmarks is None else read_landmarks(landmarks)
    markers = (*settings.markers, *(() if places is None else places.markers))
    recording = read_recording(trial, units=settings.units, rotation=settings.rotation, markers=markers)
    try:
        analysis = analyze_recording(recording, settings, landmarks=places)
    except ElbowscrewError as error:
        msg = f"{trial}: {error}"
        raise type(error)(msg) from error
    save_analysis(analysis, target, force=force, report=page)
    summary = summary_from_analysis(analysis)
    render.warnings(summary["warnings"])
    if json_output:
        render.json_object(summary)
    elif not quiet:
        render.analysis_table(summary, target)
    if verbose:
        render.files(target)
