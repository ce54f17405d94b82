"""The look of the figures: readable in print, in grey and by the color-blind."""

from __future__ import annotations

from contextlib import AbstractContextManager
from typing import Any, Final

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

# From the palette of Okabe and Ito, and apart in grey as well: line styles differ on top of it.
MEASURED: Final[dict[str, Any]] = {"color": "#000000", "linewidth": 1.3, "linestyle": "-"}
MODELED: Final[dict[str, Any]] = {"color": "#D55E00", "linewidth": 1.3, "linestyle": (0, (5, 2))}
KEYFRAME: Final[dict[str, Any]] = {
    "color": "#0072B2", "marker": "o", "markersize": 5.5, "linestyle": "none", "markerfacecolor": "white",
    "markeredgewidth": 1.3, "zorder": 5, "clip_on": False,
}  # fmt: skip
MOVING: Final[dict[str, Any]] = {"color": "#E6EFF8", "linewidth": 0.0, "zorder": -1}
LOST: Final[dict[str, Any]] = {"color": "#DDDDDD", "linewidth": 0.0, "zorder": 0}
FILLED: Final[dict[str, Any]] = {
    "facecolor": "none", "edgecolor": "#888888", "hatch": "//////", "linewidth": 0.0, "zorder": 0,
}  # fmt: skip
LEVEL: Final[dict[str, Any]] = {"color": "#666666", "linewidth": 0.8, "linestyle": (0, (1, 2))}
SPREAD: Final[dict[str, Any]] = {
    "color": "#CCCCCC", "alpha": 0.6, "linewidth": 0.0, "zorder": 1, "label": "95 % of the frames' axes",
}  # fmt: skip
CONFIDENCE: Final[dict[str, Any]] = {
    "facecolor": "#EE7733", "edgecolor": "#AA3300", "alpha": 0.8, "linewidth": 0.8, "zorder": 1.5,
    "label": "95 % confidence of the joint axis",
}  # fmt: skip
BAND: Final[dict[str, Any]] = {"color": "#888888", "alpha": 0.5, "linewidth": 0.0, "zorder": 1}
# Viridis without its light end, which vanishes on white paper.
COLORMAP: Final = ListedColormap(mpl.colormaps["viridis"](np.linspace(0.0, 0.88, 256)), name="angle")

_MM_PER_INCH: Final = 25.4
_DOTS_PER_INCH: Final = 300
_RC: Final[dict[Any, Any]] = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "font.size": 8.0,
    "axes.labelsize": 8.0,
    "axes.titlesize": 8.0,
    "axes.titlelocation": "left",
    "axes.titleweight": "bold",
    "axes.titley": 1.0,  # where it would come to lie, without a search for ticks above the axes
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.formatter.useoffset": False,
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
    "xtick.major.width": 0.7,
    "ytick.major.width": 0.7,
    "hatch.linewidth": 0.5,
    "legend.fontsize": 7.5,
    "legend.frameon": False,
    "legend.handlelength": 2.6,
    "savefig.dpi": "figure",
    "pdf.fonttype": 42,
    "svg.fonttype": "path",
    "svg.hashsalt": "elbowscrew",
}
# Without the backend: to set it is to load it.
_DEFAULTS: Final[dict[Any, Any]] = {key: value for key, value in mpl.rcParamsDefault.items() if key != "backend"}


def publication_style() -> AbstractContextManager[None]:
    """Matplotlib settings of the figures, all of them and none of the user's, for a ``with`` block."""
    return mpl.rc_context({**_DEFAULTS, **_RC})


def new_figure(width_mm: float, height_mm: float) -> Figure:
    """Return an empty figure of that size on paper, without pyplot's global state; `settle` lays it out."""
    figure = Figure(figsize=(width_mm / _MM_PER_INCH, height_mm / _MM_PER_INCH), dpi=_DOTS_PER_INCH)
    FigureCanvasAgg(figure)  # so that laying out and drawing share a renderer
    return figure


def settle(figure: Figure) -> None:
    """Lay a figure out once and for all, the places of its axes rounded.

    The layout's solver leaves last digits that differ from run to run, and with them the bytes of a file. It works
    here once: as the figure's own engine it would do so, and draw all for it, each time the figure is saved.
    """
    ConstrainedLayoutEngine().execute(figure)
    for ax in figure.axes:
        left, bottom, width, height = (round(float(value), 6) for value in ax.get_position(original=True).bounds)
        ax.set_position((left, bottom, width, height), which="both")
