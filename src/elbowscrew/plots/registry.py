"""The functions of the figures, by their names in `elbowscrew.view.figure_names`."""

from __future__ import annotations

from importlib import import_module
from typing import Final

from elbowscrew.plots.figures import MakeFigure
from elbowscrew.view.figure_names import FIGURE_ENTRIES


def figure_function(name: str) -> MakeFigure:
    """Give the function that makes a figure of a trial."""
    module, _, function = FIGURE_ENTRIES[name].home.rpartition(".")
    found: MakeFigure = getattr(import_module(f"elbowscrew.plots.{module}"), function)
    return found


FIGURES: Final[dict[str, MakeFigure]] = {name: figure_function(name) for name in FIGURE_ENTRIES}
"""All figures of a trial."""
