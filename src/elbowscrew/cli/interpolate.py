"""``elbowscrew interpolate``: the motion between keyframes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from elbowscrew.choices import LAW_PEAKS, ClosedLaw, MethodName
from elbowscrew.cli import options


def interpolate(
    keyframes: Annotated[
        Path,
        typer.Argument(
            metavar="KEYFRAMES.csv", help="The keyframes of a result, or any poses with times.", show_default=False
        ),
    ],
    frames: Annotated[
        int,
        typer.Option(
            metavar="N", min=2, max=10_000_000, help="Frames, evenly spaced in time from the first pose to the last."
        ),
    ],
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="OUT.csv",
            help="File to write.",
            show_default="<keyframes>_motion.csv in the current folder",
        ),
    ] = None,
    method: Annotated[
        MethodName | None,
        typer.Option(
            help="Interpolation of poses, or of the file's joint (joint).", show_default="the file's, else dlb"
        ),
    ] = None,
    law: Annotated[
        ClosedLaw | None, typer.Option(help="Law of motion.", show_default="the file's, else cycloidal")
    ] = None,
    law_peak: Annotated[
        float | None,
        typer.Option(
            metavar="SHARE",
            min=LAW_PEAKS[0],
            max=LAW_PEAKS[1],
            help="Time of the law's highest velocity in a phase; with --law.",
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an earlier motion.")] = False,
    quiet: options.QuietPaths = False,
) -> None:
    """Rebuild a motion from its keyframes.

    Times, laws and method are those of the file, unless given.
    """
    from elbowscrew.cli.text import emit, printable
    from elbowscrew.errors import UsageError
    from elbowscrew.motion.interpolation.rebuilding import interpolate as rebuild
    from elbowscrew.results.keyframe_table import read_keyframes
    from elbowscrew.saving import save_motion

    if law_peak is not None and law in (None, "linear"):
        msg = f"--law-peak: {'the linear law has no highest velocity' if law else 'give it with --law'}"
        raise UsageError(msg)
    found = read_keyframes(keyframes, method=method, law=law, law_peak=law_peak)
    target = output if output is not None else Path(f"{keyframes.stem}_motion.csv")
    written = save_motion(rebuild(found, frames), target, overwrite=force)
    if not quiet:
        emit(f"{printable(str(written))}\n")
