"""Models beside each other: error over the number of keyframes, by method, law and data."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter, StrMethodFormatter
from numpy.typing import NDArray

from elbowscrew.choices import METHOD_LABELS
from elbowscrew.geometry.arrays import Float
from elbowscrew.model import ComparedModels, ComparedOverTrials, Comparison, Selection, TrialsComparison
from elbowscrew.plots import style
from elbowscrew.quantities import angle_in, length_in, rounded
from elbowscrew.settings import Settings
from elbowscrew.view.comparisons import has_displacements

_WIDTH_MM: Final = 170.0
_BETWEEN_TWO: Final = {
    "dlb": "blend",
    "sclerp": "screw",
    "sdlb": "blend",
    "dib": "screw",
    "catmull-rom": "screw",
    "joint": "joint",
}
# Room for the legend, as a share of the logarithmic axis.
_LEGEND_ROOM: Final = 0.45
_MARKERS: Final = ("o", "s", "^", "D", "v", "P", "X", "*", "h")
_DASHES: Final = ("-", (0, (5, 2)), (0, (1, 1.5)), (0, (5, 1.5, 1, 1.5)), (0, (2, 2)))
# A method has its color in every panel, the joint's own angles that of the joint's axis; what is no method is grey.
_COLORS: Final = (style.BLUE, "#56B4E9", "#6A3D9A", "#A6611A", "#8F8F00", style.AXES[0]["color"])
_GREYS: Final = (style.BLACK, "#555555", "#808080", "#A6A6A6")


class _Errors(NamedTuple):
    """What is drawn of a comparison: a value for each model, and its spread over trials (NaN for one)."""

    data: NDArray[np.str_]
    method: NDArray[np.str_]
    blend: NDArray[np.str_]
    law: NDArray[np.str_]
    keyframes: NDArray[np.int64]
    value: Float
    spread: Float
    label: str

    @classmethod
    def of(cls, models: ComparedModels | ComparedOverTrials, settings: Settings) -> _Errors:
        """RMS displacements, or of orientations alone, which have none, the angles."""
        mean = "" if isinstance(models, ComparedModels) else "_mean"
        of_length = has_displacements(models)
        kind = "rms_displacement" if of_length else "rms_angle_error"
        value: Float = getattr(models, f"{kind}{mean}")
        spread = getattr(models, f"{kind}_sd") if mean else np.full(models.rank.size, np.nan)
        known = np.isfinite(value)
        if of_length:
            value, spread = (length_in(values[known], settings.length_unit) for values in (value, spread))
        else:
            value, spread = (angle_in(values[known], settings.angle_unit) for values in (value, spread))
        return cls(
            models.data[known],
            models.method[known],
            models.blend[known],
            models.law[known],
            models.keyframes_per_phase[known],
            value,
            spread,
            f"RMS displacement ({settings.length_unit})" if of_length else f"RMS angle ({settings.angle_unit})",
        )

    def where(self, mask: NDArray[np.bool_]) -> _Errors:
        return _Errors(
            self.data[mask],
            self.method[mask],
            self.blend[mask],
            self.law[mask],
            self.keyframes[mask],
            self.value[mask],
            self.spread[mask],
            self.label,
        )

    def best_by_count(self) -> tuple[NDArray[np.int64], Float, Float]:
        """Least value of each number of keyframes, and its spread."""
        counts = np.unique(self.keyframes)
        chosen = [np.flatnonzero(self.keyframes == count) for count in counts]
        rows = np.array([rows[np.argmin(self.value[rows])] for rows in chosen], dtype=np.int64)
        return counts, self.value[rows], self.spread[rows]


def comparison_figure(found: Comparison | TrialsComparison) -> Figure:
    """Make the figure of a comparison, of one trial or of several."""
    errors = _Errors.of(found.models, found.settings)
    figure = style.new_figure(_WIDTH_MM, 150.0)
    panels = figure.subplots(2, 2).ravel()
    plot_methods(panels[0], errors)
    plot_laws(panels[1], errors)
    plot_keyframe_sources(panels[2], errors)
    trials = [found.selections] if isinstance(found, Comparison) else [one.selections for one in found.trials]
    plot_selections(panels[3], trials, found.settings)
    style.letter(*panels)
    return figure


def plot_methods(ax: Axes, errors: _Errors) -> Axes:
    """Draw the error over the number of keyframes in each phase, for each method under its best law, piecewise."""
    raw = _as_recorded(errors)
    piecewise = raw.where(raw.blend == "piecewise")
    for k, name in enumerate(METHOD_LABELS):
        # What is the same model between two poses stands in the comparison once.
        same = [other for other, kind in _BETWEEN_TWO.items() if kind == _BETWEEN_TWO[name]]
        mine = (piecewise.method == name) | ((piecewise.keyframes == 2) & np.isin(piecewise.method, same))
        if name in piecewise.method:
            _curve(ax, piecewise.where(mine), k, METHOD_LABELS[name])
    ax.set_title("each method, best law", loc="center", fontweight="normal")
    return _over_count(ax, errors)


def _as_recorded(errors: _Errors) -> _Errors:
    """Models whose keyframes are from the recording as it is, or else from the first that was compared."""
    return errors.where(errors.data == ("raw" if "raw" in errors.data else errors.data[0]))


def plot_laws(ax: Axes, errors: _Errors) -> Axes:
    """Draw the error of each law, for each number of keyframes in a phase, under its best method."""
    raw = _as_recorded(errors)
    counts = np.unique(raw.keyframes)
    fewest = raw.where(raw.keyframes == counts[0])
    laws = sorted(set(raw.law.tolist()), key=lambda law: float(np.min(fewest.value[fewest.law == law], initial=np.inf)))
    for k, count in enumerate(counts[:4]):
        of_count = raw.where(raw.keyframes == count)
        for row, law in enumerate(laws):
            mine = of_count.where(of_count.law == law)
            if mine.value.size:
                best = int(np.argmin(mine.value))
                label = f"{count} keyframes" if row == 0 else None
                spread = None if np.isnan(mine.spread[best]) else mine.spread[best]
                ax.errorbar(
                    mine.value[best],
                    row,
                    xerr=spread,
                    label=label,
                    capsize=2.0,
                    **series_look(k, line=False, grey=True),
                )
    ax.set_yticks(range(len(laws)), laws)
    ax.invert_yaxis()
    ax.set_xscale("log")
    plain_ticks(ax.xaxis)
    values = raw.value[np.isin(raw.keyframes, counts[:4])]
    ax.set_xlim(left=max(ax.get_xlim()[0], 0.4 * float(values.min())))
    ax.set_xlabel(errors.label)
    ax.set_title("each law, best method", loc="center", fontweight="normal")
    ax.grid(axis="y", linewidth=0.4, color="#DDDDDD")
    ax.legend(loc="best", title="in each phase", title_fontsize=7.5, frameon=True, edgecolor="none")
    return ax


def plot_keyframe_sources(ax: Axes, errors: _Errors) -> Axes:
    """Draw the error over the number of keyframes, taken from the recording as it is, filtered, and thinned."""
    for k, name in enumerate(dict.fromkeys(sorted(errors.data.tolist(), key=_source_order))):
        label = f"{name} frame" if name.startswith("every") else name
        _curve(ax, errors.where(errors.data == name), k, label, grey=True)
    ax.set_title("keyframes from, best model", loc="center", fontweight="normal")
    return _over_count(ax, errors)


def plot_selections(ax: Axes, trials: Sequence[dict[str, Selection]], settings: Settings) -> Axes:
    """Draw the largest error over the number of keyframes, where these are chosen best.

    Of trials with positions and others without, those without are left out.
    """
    chosen = [found for selections in trials for found in selections.values()]
    of_angles = bool(chosen) and all(found.as_angle for found in chosen)
    alike = [{name: one for name, one in found.items() if one.as_angle == of_angles} for found in trials]
    trials = [found for found in alike if found]
    unit = settings.angle_unit if of_angles else settings.length_unit

    def told(values: Float) -> Float:
        return angle_in(values, settings.angle_unit) if of_angles else length_in(values, settings.length_unit)

    drawn: set[str] = set()
    for selections in trials:
        for method, selection in selections.items():
            label = None if method in drawn else f"{METHOD_LABELS[method]}, constant speed between"
            drawn.add(method)
            look = {
                **series_look(list(METHOD_LABELS).index(method), line=True),
                "linewidth": 1.0 if len(trials) > 1 else 1.3,
                "markersize": 3.0,
            }
            ax.plot(selection.count, told(selection.largest), label=label, **look)
    if trials:
        tolerance = float(told(np.array(next(iter(trials[0].values())).tolerance)))
        ax.axhline(tolerance, **style.LEVEL)
        ax.annotate(
            f"tolerance {rounded(tolerance, 3)} {unit}",
            (0.0, tolerance),
            xycoords=ax.get_yaxis_transform(),
            xytext=(3.0, 2.0),
            textcoords="offset points",
        )
        ax.legend(loc="upper right", handlelength=1.7, handletextpad=0.5)
    ax.set_yscale("log")
    plain_ticks(ax.yaxis)
    _leave_room(ax, *ax.get_ylim())
    ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    ax.set_xlabel("Keyframes in all, chosen best (–)")
    ax.set_ylabel(f"Largest angle ({unit})" if of_angles else f"Largest RMS displacement ({unit})")
    ax.set_title("fewest keyframes", loc="center", fontweight="normal")
    return ax


def _source_order(name: str) -> tuple[int, int]:
    if name.startswith("every"):
        return 2, int("".join(character for character in name if character.isdigit()))
    return (0 if name == "raw" else 1), 0


def _curve(ax: Axes, errors: _Errors, k: int, label: str, *, grey: bool = False) -> None:
    if errors.value.size:
        counts, value, spread = errors.best_by_count()
        yerr = None if np.isnan(spread).all() else np.nan_to_num(spread)
        ax.errorbar(counts, value, yerr=yerr, label=label, capsize=2.0, **series_look(k, line=True, grey=grey))


def series_look(k: int, *, line: bool, grey: bool = False) -> dict[str, Any]:
    """Look of the k-th of several series: color, marker and dashes, each of which alone tells them apart."""
    colors = _GREYS if grey else _COLORS
    return {
        "color": colors[k % len(colors)],
        "marker": _MARKERS[k % len(_MARKERS)],
        "markersize": 4.5,
        "markerfacecolor": "white",
        "linewidth": 1.2,
        "linestyle": _DASHES[k % len(_DASHES)] if line else "none",
    }


def _over_count(ax: Axes, errors: _Errors) -> Axes:
    ax.set_yscale("log")
    plain_ticks(ax.yaxis)
    ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    ax.set_xlabel("Keyframes in each phase (–)")
    ax.set_ylabel(errors.label)
    _leave_room(ax, *ax.get_ylim())
    ax.legend(loc="upper right", ncols=2, columnspacing=0.8, handlelength=1.7, handletextpad=0.5)
    return ax


def _leave_room(ax: Axes, low: float, high: float) -> None:
    """Set the limits so that the legend stands above the curves; bars that reach 0 or less end at the lower one."""
    values = np.concatenate([line.get_ydata() for line in ax.lines if line.get_marker() in _MARKERS] or [[low, high]])
    low, high = max(low, 0.4 * float(np.min(values))), max(high, float(np.max(values)))
    ax.set_ylim(low, high * (high / low) ** _LEGEND_ROOM)


def plain_ticks(axis: Any) -> None:
    """Write numbers of a logarithmic axis as they are."""
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axis.set_minor_formatter(NullFormatter())
