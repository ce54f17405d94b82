"""``elbowscrew samples``: the recordings that come with the program."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from elbowscrew.cli import options


def samples(
    copy: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Copy all of them into this folder.", show_default=False)
    ] = None,
    quiet: options.QuietPaths = False,
) -> None:
    """List the samples that come with the program, or copy them.

    Synthetic recordings to try everything on; the truth stands beside each.
    """
    from elbowscrew.cli.text import emit, printable
    from elbowscrew.samples import SAMPLES, copy_to

    if copy is None:
        width = max(map(len, SAMPLES))
        for name, text in SAMPLES.items():
            emit(f"{name:<{width}}  {text}\n")
        return
    copied = copy_to(copy)
    for file in () if quiet else copied:
        emit(f"{printable(str(file))}\n")
