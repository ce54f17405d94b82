"""The figures by name, and where the function of each is; light, as the command line's help tells of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final, NamedTuple

if TYPE_CHECKING:
    from elbowscrew.view.trial_view import TrialView


class FigureEntry(NamedTuple):
    """One figure.

    Attributes
    ----------
    home : str
        Module and name of the function that makes it, inside `elbowscrew.plots`.
    usual : bool
        Whether it is drawn of every result that has what it shows; else it is made on request.
    needs : str
        What a result must have for it, as a field of `elbowscrew.view.trial_view.TrialView`; empty if it needs nothing.
    places : bool
        Whether it shows places, which orientations alone do not tell.
    table : str
        Which table it needs beside those that every view has, by its name in `TrialView.extra`.
    """

    home: str
    usual: bool
    needs: str = ""
    places: bool = False
    table: str = ""


FIGURE_ENTRIES: Final[dict[str, FigureEntry]] = {
    "theta": FigureEntry("figures.theta_figure", usual=True),
    "euler_parameters": FigureEntry("figures.euler_parameters_figure", usual=True),
    "joint": FigureEntry("joint_type.joint_figure", usual=True, places=True),
    "slide": FigureEntry("kinematics.slide_figure", usual=True, places=True),
    "error": FigureEntry("figures.error_figure", usual=True),
    "anatomy": FigureEntry("anatomy.anatomy_figure", usual=True, needs="has_landmarks", table="anatomy"),
    "velocity": FigureEntry("kinematics.velocity_figure", usual=False, needs="has_velocity", table="instantaneous"),
    "instantaneous_axes": FigureEntry(
        "figures.instantaneous_axes_figure", usual=False, needs="has_velocity", places=True, table="instantaneous"
    ),
    "cycles": FigureEntry("cycles.cycles_figure", usual=False, needs="has_cycles", table="cycles"),
    "quality": FigureEntry("quality.quality_figure", usual=False, table="losses"),
    "axis": FigureEntry("figures.axis_figure", usual=False, places=True),
    "joint_axis": FigureEntry("figures.joint_axis_figure", usual=False, places=True),
    "joint_angles": FigureEntry("joint_angles.joint_angles_figure", usual=False, needs="joint_angles"),
    "axis_path": FigureEntry("joint_angles.axis_path_figure", usual=False, needs="axis_path", places=True),
    "fig7": FigureEntry("paper_figures.figure_7", usual=False),
    "fig8": FigureEntry("paper_figures.figure_8", usual=False),
    "fig9": FigureEntry("paper_figures.figure_9", usual=False),
    "fig10": FigureEntry("paper_figures.figure_10", usual=False),
}
"""A new figure of a trial is one function in `elbowscrew.plots`, its caption, its name and one entry here."""

USUAL_FIGURES: Final = tuple(name for name, entry in FIGURE_ENTRIES.items() if entry.usual)
OVERLAY: Final = "overlay"
"""The one figure of several trials."""
ALL: Final = "all"
"""All figures of a trial that has what they show."""

FIGURE_CHOICES: Final = (*FIGURE_ENTRIES, OVERLAY)


def chosen_figures(names: Sequence[str] | None) -> tuple[str, ...]:
    """Give the figures of a trial that are asked for: the usual ones if none are, and every one for ``all``."""
    if names is None:
        return USUAL_FIGURES
    return tuple(name for name in FIGURE_ENTRIES if name in names or ALL in names)


def has_figure(name: str, view: TrialView) -> bool:
    """Tell whether a trial has what a figure shows."""
    needs, places = FIGURE_ENTRIES[name].needs, FIGURE_ENTRIES[name].places
    found = getattr(view, needs) if needs else True
    return found is not None and found is not False and (view.located or not places)


def caption_file(name: str) -> str:
    """Give the name of the file that a figure's caption is in."""
    return f"{name}.caption.txt"
