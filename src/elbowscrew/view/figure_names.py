"""The figures by name, and where the function of each is; light, as the command line's help tells of them."""

from __future__ import annotations

from typing import Final, NamedTuple


class FigureEntry(NamedTuple):
    """One figure.

    Attributes
    ----------
    home : str
        Module and name of the function that makes it, inside `elbowscrew.plots`.
    saved : bool
        Whether it is part of every result, as ``figures/<name>``; else it is made on request.
    needs : str
        What a result must have for it, as a field of `elbowscrew.view.trial_view.TrialView`; empty if it needs nothing.
    """

    home: str
    saved: bool
    needs: str = ""


FIGURE_ENTRIES: Final = {
    "theta": FigureEntry("figures.theta_figure", saved=True),
    "euler_parameters": FigureEntry("figures.euler_parameters_figure", saved=True),
    "axis": FigureEntry("figures.axis_figure", saved=True),
    "joint_axis": FigureEntry("figures.joint_axis_figure", saved=True),
    "joint": FigureEntry("joint_type.joint_figure", saved=True),
    "joint_angles": FigureEntry("joint_angles.joint_angles_figure", saved=True, needs="joint_angles"),
    "axis_path": FigureEntry("joint_angles.axis_path_figure", saved=True, needs="axis_path"),
    "error": FigureEntry("figures.error_figure", saved=True),
    "fig7": FigureEntry("paper_figures.figure_7", saved=False),
    "fig8": FigureEntry("paper_figures.figure_8", saved=False),
    "fig9": FigureEntry("paper_figures.figure_9", saved=False),
    "fig10": FigureEntry("paper_figures.figure_10", saved=False),
}
"""A new figure of a trial is one function in `elbowscrew.plots` and one entry here."""

SAVED_FIGURES: Final = tuple(name for name, entry in FIGURE_ENTRIES.items() if entry.saved)
OVERLAY: Final = "overlay"
"""The one figure of several trials."""

FIGURE_CHOICES: Final = (*FIGURE_ENTRIES, OVERLAY)
