"""The functions of the figures, by their names in `elbowscrew.view.figure_names`."""

from __future__ import annotations

from importlib import import_module
from typing import Final

from elbowscrew.plots.figures import MakeFigure
from elbowscrew.view.figure_names import FIGURE_ENTRIES, SAVED_FIGURES
from elbowscrew.view.trial_view import TrialView


def figure_function(name: str) -> MakeFigure:
    """Give the function that makes a figure of a trial.

    Raises
    ------
    KeyError
        If there is no such figure.
    """
    module, _, function = FIGURE_ENTRIES[name].home.rpartition(".")
    found: MakeFigure = getattr(import_module(f"elbowscrew.plots.{module}"), function)
    return found


def has_figure(name: str, view: TrialView) -> bool:
    """Tell whether a trial has what a figure shows."""
    needs = FIGURE_ENTRIES[name].needs
    return not needs or getattr(view, needs) is not None


FIGURES: Final[dict[str, MakeFigure]] = {name: figure_function(name) for name in SAVED_FIGURES}
"""Those that are part of every result."""
