"""The look of the figures: readable in print, in grey and by the color-blind."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from contextvars import ContextVar
from difflib import get_close_matches
from typing import Any, Final, cast

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties, fontManager
from matplotlib.offsetbox import OffsetBox

from elbowscrew.errors import UsageError, shown
from elbowscrew.plots.canvas import Renderer, Sheet

# One color means one thing in all figures. From the palettes of Okabe and Ito and of Tol; line styles, markers and
# lightness tell the lines apart in grey as well. No transparency, which EPS does not have.
BLACK: Final = "#000000"  # what was measured
BLUE: Final = "#0072B2"  # the model and the poses it goes through
ORANGE: Final = "#F2B134"  # what holds 95 % of the errors
GREEN: Final = "#009E73"  # the distal body's path
GREY: Final = "#CCCCCC"  # spread: of the frames' axes, of cycles, of trials

MEASURED: Final[dict[str, Any]] = {"color": BLACK, "linewidth": 1.2, "linestyle": "-"}
MODELED: Final[dict[str, Any]] = {"color": BLUE, "linewidth": 1.3, "linestyle": (0, (5, 2))}
KEYFRAME: Final[dict[str, Any]] = {
    "color": BLUE, "marker": "o", "markersize": 5.0, "linestyle": "none", "markerfacecolor": "white",
    "markeredgewidth": 1.2, "zorder": 5, "clip_on": False,
}  # fmt: skip
AXES: Final[tuple[dict[str, Any], ...]] = (
    {"color": "#882255", "linestyle": "-"},
    {"color": "#CC6677", "linestyle": (0, (5, 2))},
    {"color": "#44AA99", "linestyle": (0, (1, 1.2))},
)
"""The joint's axes, and the angles about them."""
GROUPS: Final[tuple[dict[str, Any], ...]] = (
    {"color": "#332288", "linestyle": "-"},
    {"color": "#8A5A00", "linestyle": (0, (6, 2))},
    {"color": "#AA4499", "linestyle": (0, (1, 1.2))},
    {"color": "#117733", "linestyle": (0, (6, 1.5, 1, 1.5))},
    {"color": "#555555", "linestyle": (0, (3, 1))},
    {"color": "#0088AA", "linestyle": (0, (8, 1, 1, 1, 1, 1))},
)
"""Conditions of a study."""
PATH: Final[dict[str, Any]] = {"color": GREEN, "linewidth": 1.2}
PROXIMAL: Final[dict[str, Any]] = {
    "color": "#333333", "marker": "s", "linestyle": "none", "markersize": 3.2, "markeredgewidth": 0.7,
}  # fmt: skip
DISTAL: Final[dict[str, Any]] = {**PROXIMAL, "marker": "o", "markerfacecolor": "white", "markersize": 3.6}
"""Markers of the two bodies; the origin of each has the same look, larger."""
START: Final[dict[str, Any]] = {"color": BLACK, "marker": "D", "markersize": 4.0, "linestyle": "none"}
MOVING: Final[dict[str, Any]] = {"color": "#E6F0FA", "linewidth": 0.0, "zorder": -1}
LOST: Final[dict[str, Any]] = {"color": "#F3D3CB", "linewidth": 0.0, "zorder": 0}
FILLED: Final[dict[str, Any]] = {
    "facecolor": "none", "edgecolor": "#888888", "hatch": "//////", "linewidth": 0.0, "zorder": 0,
}  # fmt: skip
LEVEL: Final[dict[str, Any]] = {"color": "#666666", "linewidth": 0.8, "linestyle": (0, (1, 2))}
BAND: Final[dict[str, Any]] = {"facecolor": ORANGE, "edgecolor": "#A86F00", "linewidth": 0.4, "zorder": 1}
SPREAD: Final[dict[str, Any]] = {"facecolor": GREY, "edgecolor": "#999999", "linewidth": 0.4, "zorder": 1}
# Viridis without its light end, which vanishes on white paper.
COLORMAP: Final = ListedColormap(mpl.colormaps["viridis"](np.linspace(0.0, 0.88, 256)), name="angle")


def tint(color: str) -> str:
    """Give a color as it would be at a fifth over white."""
    return "#" + "".join(f"{round(255 - 0.2 * (255 - int(color[k : k + 2], 16))):02X}" for k in (1, 3, 5))


MM_PER_INCH: Final = 25.4
POINTS_PER_MM: Final = 72.0 / MM_PER_INCH
DOTS_PER_INCH: Final = 300
TEXT: Final = 7.5
_RC: Final[dict[Any, Any]] = {
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
    "axes.formatter.limits": (-3, 6),  # 0.00025 at a tick takes the room of three
    "xtick.labelsize": TEXT,
    "ytick.labelsize": TEXT,
    "xtick.major.width": 0.7,
    "ytick.major.width": 0.7,
    "hatch.linewidth": 0.5,
    "legend.fontsize": TEXT,
    "legend.frameon": False,
    "legend.framealpha": 1.0,
    "axes3d.xaxis.panecolor": "#F6F6F6",
    "axes3d.yaxis.panecolor": "#F0F0F0",
    "axes3d.zaxis.panecolor": "#F3F3F3",
    "legend.handlelength": 2.2,
    "legend.columnspacing": 1.4,
    "savefig.dpi": "figure",
    "pdf.fonttype": 42,
    "ps.fonttype": 42,
    "svg.fonttype": "path",
    "svg.hashsalt": "elbowscrew",
}
# Without the backend: to set it is to load it.
_DEFAULTS: Final[dict[Any, Any]] = {key: value for key, value in mpl.rcParamsDefault.items() if key != "backend"}


def publication_style(font: str | None = None) -> AbstractContextManager[None]:
    """Matplotlib settings of the figures, all of them and none of the user's, for a ``with`` block.

    Raises
    ------
    UsageError
        If no family of that name is installed.
    """
    families = [] if font is None else [known_font(font)]
    return mpl.rc_context({**_DEFAULTS, **_RC, "font.family": [*families, "DejaVu Sans"]})


def known_font(name: str) -> str:
    """Give a family by the name it has, whatever the case; what it lacks is taken from DejaVu Sans.

    Raises
    ------
    UsageError
        If none of that name is installed.
    """
    known = sorted({entry.name for entry in fontManager.ttflist})
    found = next((one for one in known if one.casefold() == name.strip().casefold()), None)
    if found is None:
        near = get_close_matches(name, known, 3, 0.5) or known[:5]
        msg = f"--font {shown(name)}: no such font is installed; there are, for example, {', '.join(near)}"
        raise UsageError(msg)
    return found


def new_figure(width_mm: float, height_mm: float) -> Figure:
    """Return an empty figure of that size on paper, without pyplot's global state; `layout.settle` lays it out."""
    size = width_mm / MM_PER_INCH, height_mm / MM_PER_INCH
    if _SHOWN.get():
        import matplotlib.pyplot as plt

        return plt.figure(figsize=size)
    return Sheet(size, DOTS_PER_INCH)


_SHOWN: Final[ContextVar[bool]] = ContextVar("_SHOWN", default=False)


@contextmanager
def on_screen() -> Iterator[None]:
    """Let figures be pyplot's, which shows them: in a notebook or a window, with the user's dots per inch."""
    token = _SHOWN.set(True)
    try:
        yield
    finally:
        _SHOWN.reset(token)


def letter(*panels: Axes) -> None:
    """Name the panels of a figure a, b, ...; one alone needs no name."""
    for ax, name in zip(panels if len(panels) > 1 else (), "abcdefgh", strict=False):
        ax.set_title(name, loc="left")


def legend(figure: Figure, *panels: Axes, below: bool = False) -> None:
    """Explain all that the panels have labels for, above them or below, in as many columns as fit.

    The figure grows by the rows of it, so that the panels keep their size.
    """
    keys: dict[str, Any] = {}
    for ax in panels:
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True):
            keys.setdefault(label, handle)
    if not keys:
        return
    width, height = figure.get_size_inches()
    columns = _columns(figure, list(keys), 72.0 * width)
    rows = -(-len(keys) // columns)
    figure.set_size_inches(width, height + (1.5 * rows + 1.0) * TEXT / 72.0)
    place: Any = "outside lower center" if below else "outside upper center"
    made: Any = figure.legend(keys.values(), keys.keys(), loc=place, ncols=columns)
    _measured_once(made._legend_box)


def _measured_once(box: Any) -> None:
    """Let a box of a legend, and those within it, keep their size in pixels, which matplotlib finds several times."""
    measure = box.get_bbox
    found: dict[float, Any] = {}

    def get_bbox(renderer: Any) -> Any:
        if not isinstance(renderer, RendererAgg):
            return measure(renderer)
        if renderer.dpi not in found:
            found.clear()
            found[renderer.dpi] = measure(renderer)
        return found[renderer.dpi]

    box.get_bbox = get_bbox
    for part in box.get_children():
        if isinstance(part, OffsetBox):
            _measured_once(part)


def _columns(figure: Figure, labels: list[str], width: float) -> int:
    """How many columns of a legend fit into a width, points."""
    renderer = cast(Any, Renderer)(1, 1, figure.dpi)  # for words alone: the figure has not its size yet
    font = FontProperties(size=TEXT)
    points = 72.0 / figure.dpi
    widths = [points * renderer.get_text_width_height_descent(label, font, "$" in label)[0] for label in labels]
    beside = (mpl.rcParams["legend.handlelength"] + mpl.rcParams["legend.handletextpad"]) * TEXT
    between = mpl.rcParams["legend.columnspacing"] * TEXT
    for columns in range(len(labels), 1, -1):
        parts = [max(part.tolist()) for part in np.array_split(np.array(widths), columns)]
        if sum(parts) + columns * beside + (columns - 1) * between + 2.0 * TEXT <= width:
            return columns
    return 1
