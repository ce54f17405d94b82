"""The commands."""

from __future__ import annotations

from typing import Annotated

import typer

from elbowscrew._version import __version__
from elbowscrew.cli.analyze import analyze
from elbowscrew.cli.info import info
from elbowscrew.cli.simulate import simulate

app = typer.Typer(
    name="elbowscrew",
    help="Screw motion of a joint from OptiTrack recordings, by dual quaternions.",
    pretty_exceptions_enable=False,
)


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"elbowscrew {__version__}")
        raise typer.Exit


@app.callback()
def _common(
    version: Annotated[
        bool, typer.Option("--version", help="Show the version and exit.", callback=_print_version, is_eager=True)
    ] = False,
) -> None:
    pass


app.command()(analyze)
app.command()(info)
app.command()(simulate)
