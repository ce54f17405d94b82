"""The commands."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any

import typer
import typer.core

from elbowscrew._version import __version__
from elbowscrew.cli.analyze import analyze
from elbowscrew.cli.batch import batch
from elbowscrew.cli.compare import compare
from elbowscrew.cli.examples import epilog
from elbowscrew.cli.info import info
from elbowscrew.cli.interpolate import interpolate
from elbowscrew.cli.paper import paper
from elbowscrew.cli.report import report
from elbowscrew.cli.samples import samples
from elbowscrew.cli.simulate import simulate


class _Commands(typer.core.TyperGroup):
    """The commands; options that are made from the settings are made for the command that is asked for alone."""

    def resolve_command(self, ctx: Any, args: list[str]) -> tuple[Any, Any, list[str]]:
        name, command, rest = super().resolve_command(ctx, args)
        with_settings = getattr(getattr(command, "callback", None), "with_settings", None)
        if with_settings is not None:
            alone = typer.Typer(add_completion=False, pretty_exceptions_enable=False)
            alone.command(name, epilog=epilog(str(name)))(with_settings())
            command = typer.main.get_command(alone)
        return name, command, rest


app = typer.Typer(
    cls=_Commands,
    name="elbowscrew",
    help="Screw motion of a joint from OptiTrack recordings, by dual quaternions.",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
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


_COMMANDS: dict[str, Callable[..., Any]] = {
    "analyze": analyze,
    "batch": batch,
    "report": report,
    "compare": compare,
    "interpolate": interpolate,
    "info": info,
    "simulate": simulate,
    "paper": paper,
    "samples": samples,
}
for _name, _command in _COMMANDS.items():
    app.command(_name, epilog=epilog(_name))(_command)


def run(arguments: list[str]) -> object:
    """Parse and run; an error is raised, a wish to exit becomes the code returned."""
    command = typer.main.get_command(app)
    # The list of commands is short and needs no panels: without rich the help is there in half the time.
    command.rich_markup_mode = None  # type: ignore[attr-defined]
    return command.main(arguments, standalone_mode=False, prog_name="elbowscrew")
