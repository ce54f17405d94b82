"""``elbowscrew simulate``: a synthetic trial with its truth beside it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from elbowscrew.choices import FileUnit, JointName, SimulatedJointType, SimulatedLaw
from elbowscrew.cli import options

_MOTION, _RECORDING, _OUTPUT = "Motion", "Recording", "Output"


def simulate(
    output: Annotated[Path, typer.Argument(metavar="OUT.csv", help="File to write.", show_default=False)],
    joint: Annotated[
        JointName,
        typer.Option(rich_help_panel=_MOTION, help="Names the bodies, and sets their lengths."),
    ] = "elbow",
    side: Annotated[
        Literal["left", "right"] | None,
        typer.Option(rich_help_panel=_MOTION, help="Part of the bodies' names; a left joint mirrors a right one."),
    ] = None,
    frames: Annotated[int, typer.Option(rich_help_panel=_MOTION, help="Frames of one repetition.")] = 450,
    rate: Annotated[float, typer.Option(metavar="HZ", rich_help_panel=_RECORDING, help="Frames per second.")] = 100.0,
    top: Annotated[float, typer.Option(metavar="DEG", rich_help_panel=_MOTION, help="Largest angle.")] = 130.0,
    inversion: Annotated[
        int, typer.Option(metavar="FRAME", rich_help_panel=_MOTION, help="Frame of the largest angle.")
    ] = 211,
    joint_type: Annotated[
        SimulatedJointType, typer.Option(rich_help_panel=_MOTION, help="How the segments move relative to each other.")
    ] = "screw-hinge",
    slide: Annotated[
        float | None,
        typer.Option(
            metavar="MM",
            rich_help_panel=_MOTION,
            help="Slide of a screw-hinge at the top; 3 by default.",
            show_default=False,
        ),
    ] = None,
    pronation: Annotated[
        float | None,
        typer.Option(
            metavar="DEG",
            rich_help_panel=_MOTION,
            help="Range about the second of two axes; 60 by default.",
            show_default=False,
        ),
    ] = None,
    law: Annotated[SimulatedLaw, typer.Option(rich_help_panel=_MOTION, help="Law of motion.")] = "minimum-jerk",
    proximal: Annotated[
        Literal["moving", "still"],
        typer.Option("--proximal", "--arm", rich_help_panel=_MOTION, help="Proximal body."),
    ] = "still",
    repetitions: Annotated[int, typer.Option(rich_help_panel=_MOTION, help="Movements out and back.")] = 1,
    rest_before: Annotated[
        float, typer.Option(metavar="SECONDS", rich_help_panel=_MOTION, help="Rest before the movement.")
    ] = 0.0,
    hold: Annotated[float, typer.Option(metavar="SECONDS", rich_help_panel=_MOTION, help="Rest at every top.")] = 0.0,
    rest_after: Annotated[
        float, typer.Option(metavar="SECONDS", rich_help_panel=_MOTION, help="Rest after the movement.")
    ] = 0.0,
    wander: Annotated[
        float,
        typer.Option(
            "--wander",
            "--axis-drift",
            metavar="DEG",
            rich_help_panel=_MOTION,
            help="Tilt of the (first) axis at the top.",
        ),
    ] = 0.0,
    tremor: Annotated[
        float, typer.Option(metavar="DEG", rich_help_panel=_MOTION, help="Amplitude of a tremor of the angle.")
    ] = 0.0,
    tremor_hz: Annotated[
        float, typer.Option(metavar="HZ", rich_help_panel=_MOTION, help="Frequency of the tremor.")
    ] = 6.0,
    skin: Annotated[
        float, typer.Option(metavar="MM", rich_help_panel=_RECORDING, help="How far markers move with flexion.")
    ] = 0.0,
    marker_noise: Annotated[
        float, typer.Option(metavar="MM", rich_help_panel=_RECORDING, help="SD of each marker coordinate.")
    ] = 0.2,
    gaps: Annotated[int, typer.Option(rich_help_panel=_RECORDING, help="How often the distal body is lost.")] = 0,
    gap_frames: Annotated[int, typer.Option(rich_help_panel=_RECORDING, help="Frames of each gap.")] = 5,
    sign_flips: Annotated[
        bool, typer.Option("--sign-flips", rich_help_panel=_RECORDING, help="Flip quaternion signs at random.")
    ] = False,
    seed: Annotated[int, typer.Option(rich_help_panel=_RECORDING, help="Seed of noise, gaps and flips.")] = 0,
    layout: Annotated[
        Literal["motive", "row-tagged"], typer.Option("--format", rich_help_panel=_OUTPUT, help="File layout.")
    ] = "motive",
    length_unit: Annotated[
        FileUnit, typer.Option(rich_help_panel=_OUTPUT, help="Unit of length in the file (row-tagged: m).")
    ] = "m",
    landmarks: Annotated[
        bool,
        typer.Option(
            "--landmarks", rich_help_panel=_OUTPUT, help="Write landmarks of an elbow or a knee: <OUT>.landmarks.toml."
        ),
    ] = False,
    force: Annotated[
        bool, typer.Option("--force", rich_help_panel=_OUTPUT, help="Replace an earlier simulation.")
    ] = False,
    quiet: options.QuietPaths = False,
) -> None:
    """Write a synthetic trial of a joint.

    The truth about it goes to <OUT>.truth.json.
    """
    from elbowscrew.cli.progress import shown_stages
    from elbowscrew.cli.text import emit, printable
    from elbowscrew.saving import save_simulation
    from elbowscrew.simulate import Simulation, simulate_trial

    simulation = Simulation(
        joint=joint,
        side=side,
        frames=frames,
        rate_hz=rate,
        top_deg=top,
        inversion=inversion,
        joint_type=joint_type,
        slide_mm=slide,
        pronation_deg=pronation,
        law=law,
        marker_noise_mm=marker_noise,
        gaps=gaps,
        gap_frames=gap_frames,
        sign_flips=sign_flips,
        proximal=proximal,
        repetitions=repetitions,
        rest_before_s=rest_before,
        hold_s=hold,
        rest_after_s=rest_after,
        skin_mm=skin,
        wander_deg=wander,
        tremor_deg=tremor,
        tremor_hz=tremor_hz,
        seed=seed,
    )
    with shown_stages(quiet=quiet) as begin:
        begin(f"Simulating {output}")
        made = simulate_trial(simulation)
        begin(f"Writing {output}")
        written = save_simulation(
            made, output, layout=layout, length_unit=length_unit, landmarks=landmarks, overwrite=force
        )
    for path in () if quiet else written:
        emit(f"{printable(str(path))}\n")
