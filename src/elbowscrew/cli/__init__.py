"""The command line: parse, call one function, render. Only this package knows typer and rich."""

from elbowscrew.cli.main import main

__all__ = ["main"]
