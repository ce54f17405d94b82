"""Plots of a trial by attribute: each figure drawn new, or on Axes of one's own."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final, cast

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from mpl_toolkits.mplot3d.axes3d import Axes3D

from elbowscrew.choices import FigureName
from elbowscrew.errors import UsageError, did_you_mean
from elbowscrew.plots import layout, style
from elbowscrew.plots.panels import Panel, panels_of
from elbowscrew.plots.registry import FIGURES
from elbowscrew.view.figure_names import FIGURE_ENTRIES, has_figure
from elbowscrew.view.trial_view import TrialView

_OVERVIEW: Final[tuple[FigureName, ...]] = ("theta", "slide", "error")
_OVERVIEW_MM: Final = (170.0, 130.0)


class OnePanel:
    """A plot of one panel.

    Attributes
    ----------
    name : str
        Of the figure, as the command line has it.
    """

    def __init__(self, name: FigureName, view: TrialView) -> None:
        self.name = name
        self._view = view

    def __call__(self, ax: Axes | None = None, **style_of_curve: Any) -> Axes:
        """Draw it.

        Parameters
        ----------
        ax : Axes, optional
            Where to; a new figure by default, at the size and in the look that it has on paper.
        **style_of_curve
            Properties of the first curve, the measured one: ``color``, ``linewidth``, ``label``, ...

        Returns
        -------
        Axes
            With its legend.

        Raises
        ------
        UsageError
            If this trial has nothing that the figure shows.
        """
        return drawn(self.name, self._view, None if ax is None else [ax], style_of_curve)[-1]

    def __repr__(self) -> str:
        return f"<plot {self.name!r}: call it, with ax=None and the style of the curve>"


class SeveralPanels(OnePanel):
    """A plot of several panels."""

    def __call__(  # type: ignore[override]
        self, ax: Sequence[Axes] | np.ndarray[Any, Any] | None = None, **style_of_curve: Any
    ) -> tuple[Axes, ...]:
        """Draw it.

        Parameters
        ----------
        ax : sequence of Axes, optional
            Where to, one a panel; those in space come first and need ``projection="3d"``. A new figure by default.
        **style_of_curve
            Properties of the first curve of each panel.

        Returns
        -------
        tuple of Axes
            One a panel, with its legend.

        Raises
        ------
        UsageError
            If this trial has nothing that the figure shows, or the Axes are not as many as the panels.
        """
        return drawn(self.name, self._view, None if ax is None else list(np.ravel(np.asarray(ax))), style_of_curve)


class Plots:
    """The plots of a trial; called, an overview."""

    def __init__(self, view: TrialView) -> None:
        self._view = view
        self.theta = OnePanel("theta", view)
        self.euler_parameters = SeveralPanels("euler_parameters", view)
        self.joint = SeveralPanels("joint", view)
        self.slide = OnePanel("slide", view)
        self.error = SeveralPanels("error", view)
        self.anatomy = SeveralPanels("anatomy", view)
        self.velocity = SeveralPanels("velocity", view)
        self.instantaneous_axes = SeveralPanels("instantaneous_axes", view)
        self.cycles = OnePanel("cycles", view)
        self.quality = SeveralPanels("quality", view)
        self.axis = SeveralPanels("axis", view)
        self.joint_axis = SeveralPanels("joint_axis", view)
        self.joint_angles = SeveralPanels("joint_angles", view)
        self.axis_path = SeveralPanels("axis_path", view)
        self.fig7 = OnePanel("fig7", view)
        self.fig8 = OnePanel("fig8", view)
        self.fig9 = OnePanel("fig9", view)
        self.fig10 = OnePanel("fig10", view)

    @property
    def available(self) -> tuple[FigureName, ...]:
        """Names of the figures that this trial has what they show for."""
        return tuple(name for name in cast(dict[FigureName, Any], FIGURE_ENTRIES) if has_figure(name, self._view))

    def __call__(self) -> tuple[Axes, ...]:
        """Draw an overview: the angle, the slide against it, and the model's error.

        Returns
        -------
        tuple of Axes
        """
        names = [name for name in _OVERVIEW if has_figure(name, self._view)]
        panels = [panel for name in names for panel in panels_of(name, self._view)]
        with style.publication_style(self._view.settings.font), style.on_screen():
            figure = style.new_figure(*_OVERVIEW_MM)
            lower = len(panels) - 1
            grid = figure.add_gridspec(2, lower, height_ratios=[1.3, 1.0])
            axes = [figure.add_subplot(grid[0, :]), *(figure.add_subplot(grid[1, k]) for k in range(lower))]
            for ax, panel in zip(axes, panels, strict=True):
                panel.draw(ax, self._view)
            style.letter(*axes)
            style.legend(figure, *axes)
            layout.settle(figure)
        return tuple(axes)

    if not TYPE_CHECKING:  # a type checker would take any attribute for one of these

        def __getattr__(self, name: str) -> Any:
            """Ask back."""
            names = tuple(FIGURE_ENTRIES)
            hint = "" if name.startswith("_") else did_you_mean(name, names) or f"; there are {', '.join(names)}"
            msg = f"no plot is called {name!r}{hint}"
            raise AttributeError(msg)

    def __repr__(self) -> str:
        return f"<plots: call it for an overview, or one of {', '.join(self.available)}>"


def drawn(
    name: FigureName, view: TrialView, axes: list[Axes] | None, style_of_curve: dict[str, Any]
) -> tuple[Axes, ...]:
    """Draw a figure of a trial, new or on the Axes given; see `OnePanel` and `SeveralPanels`."""
    if not has_figure(name, view):
        msg = f"this trial has nothing that the figure {name!r} shows; plot.available names those that it has"
        raise UsageError(msg)
    if axes is None:
        with style.publication_style(view.settings.font), style.on_screen():
            figure = FIGURES[name](view)
            own = [ax for ax in figure.axes if ax.get_label() != "<colorbar>"]
            for ax in own:
                _style(list(ax.lines), style_of_curve, figure)
            layout.settle(figure)
        return tuple(own)
    panels = panels_of(name, view)
    _check_axes(name, panels, axes)
    for ax, panel in zip(axes, panels, strict=True):
        there = set(ax.lines)
        panel.draw(ax, view)
        _style([line for line in ax.lines if line not in there], style_of_curve)
        if ax.get_legend_handles_labels()[1]:
            ax.legend()
    return tuple(axes)


def _check_axes(name: str, panels: Sequence[Panel], axes: Sequence[Axes]) -> None:
    if len(axes) != len(panels):
        msg = f"plot.{name} has {len(panels)} panels: expected ax with as many Axes, found {len(axes)}"
        raise UsageError(msg)
    for number, (ax, panel) in enumerate(zip(axes, panels, strict=True), start=1):
        if isinstance(ax, Axes3D) != panel.in_space:
            needed = 'Axes in space (projection="3d")' if panel.in_space else "plain Axes"
            msg = f"plot.{name}: panel {number} is drawn on {needed}, found {type(ax).__name__}"
            raise UsageError(msg)


def _style(lines: Sequence[Line2D], properties: dict[str, Any], figure: Figure | None = None) -> None:
    """Set properties of the first curve, all its pieces, and of its key where the legend is drawn already."""
    if not lines or not properties:
        return
    first = lines[0]
    look, label = _look(first), first.get_label()
    pieces = [line for line in lines if _look(line) == look]
    without = {key: value for key, value in properties.items() if key != "label"}
    for legend in figure.legends if figure is not None else ():
        for handle, text in zip(legend.legend_handles, legend.get_texts(), strict=True):
            if text.get_text() == label and isinstance(handle, Artist):
                handle.set(**without)
                text.set_text(str(properties.get("label", label)))
    first.set(**properties)
    for line in pieces[1:]:
        line.set(**without)


def _look(line: Line2D) -> tuple[object, ...]:
    return line.get_color(), line.get_linestyle(), line.get_linewidth(), line.get_marker()
