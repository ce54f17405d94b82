"""Make `docs/images/cycles.svg`, what a motion is cut into: ``python docs/make_cycles_figure.py``."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from elbowscrew.geometry.arrays import Float
from elbowscrew.motion.movements.boundaries import Cuts
from elbowscrew.motion.movements.cuts import cut

RATE_HZ: Final = 100.0
NOISE_DEG: Final = 0.6
# Begin and duration (s), level before and after (deg): the recording begins and ends on the way.
STROKES: Final = (
    (-0.5, 0.9, 0.0, 85.0),
    (0.5, 0.8, 85.0, 0.0),
    (1.4, 0.8, 0.0, 90.0),
    (2.2, 0.8, 90.0, 4.0),
    (3.0, 0.8, 4.0, 88.0),
    (3.8, 0.9, 88.0, 0.0),
    (6.0, 0.7, 0.0, 60.0),
    (6.7, 0.3, 60.0, 48.0),
    (7.0, 0.6, 48.0, 92.0),
    (8.2, 0.9, 92.0, 0.0),
)
SPAN_S: Final = 10.2


def twist() -> tuple[Float, Float]:
    """Time (s) and noisy rotation (deg) of the drawing, shape (N,) each."""
    time = np.arange(round(SPAN_S * RATE_HZ) + 1) / RATE_HZ
    angle = np.zeros(time.size)
    for begin, duration, low, high in STROKES:
        x = np.clip((time - begin) / duration, 0.0, 1.0)
        angle += (high - low) * (10.0 * x**3 - 15.0 * x**4 + 6.0 * x**5)
    return time, angle + np.random.default_rng(3).normal(0.0, NOISE_DEG, time.size)


def figure() -> Figure:
    """Draw the motion with its cycles, movements and rests, and two feet in detail."""
    time, angle = twist()
    cuts = cut(np.radians(angle), time, RATE_HZ)
    drawn = Figure(figsize=(9.0, 6.4), layout="constrained")
    whole, near = drawn.subplots(2, 1, height_ratios=(3, 2))
    _whole(whole, time, angle, cuts)
    _feet(near, time, angle, cuts)
    return drawn


def _whole(axes: Axes, time: Float, angle: Float, cuts: Cuts) -> None:
    cycles, movements = cuts.cycles, cuts.movements
    axes.plot(time, angle, color="0.35", linewidth=1.0, label="twist")
    for k, (onset, offset) in enumerate(zip(movements.onset_s, movements.offset_s, strict=True)):
        axes.axvspan(onset, offset, color="tab:blue", alpha=0.10, linewidth=0.0, label="movement" if k == 0 else None)
    for begin, end in zip(movements.offset_s[:-1], movements.onset_s[1:], strict=True):
        axes.text(0.5 * (begin + end), 30.0, "rest", ha="center", color="tab:blue")
    tops = np.interp(cycles.inversion_s, time, angle)
    axes.plot(cycles.inversion_s, tops + 5.0, "v", color="tab:red", label="inversion, in the middle of the top")
    feet = np.concatenate([cycles.start_s, cycles.end_s])
    axes.plot(feet, np.interp(feet, time, angle), "o", color="tab:green", label="start or end of a cycle")
    for k, (start, end, part) in enumerate(zip(cycles.start_s, cycles.end_s, cycles.incomplete, strict=True), start=1):
        axes.annotate("", (start, -14.0), (end, -14.0), arrowprops={"arrowstyle": "<->", "color": "tab:green"})
        name = f"cycle {k}, incomplete" if part else f"cycle {k}"
        axes.text(max(0.5 * (start + end), 0.85), -27.0, name, ha="center", color="tab:green")
    axes.annotate("hesitation,\nno inversion", (6.95, 47.0), (5.6, 70.0), arrowprops={"arrowstyle": "->"})
    axes.set(xlabel="time, s", ylabel="twist, deg", ylim=(-34.0, 138.0), xlim=(-0.1, SPAN_S + 0.1))
    axes.legend(loc="upper center", ncols=2, frameon=False)


def _feet(axes: Axes, time: Float, angle: Float, cuts: Cuts) -> None:
    """The end of the first cycle and the start of the second."""
    cycles = cuts.cycles
    shown = (time > 0.85) & (time < 1.95)
    axes.plot(time[shown], angle[shown], ".", color="0.35", markersize=3.0)
    sides = ((cycles.end_s[0], cycles.end_sd_s[0], 85.0, -1), (cycles.start_s[1], cycles.start_sd_s[1], 90.0, 1))
    for k, (foot, sd, rise, side) in enumerate(sides):
        name, limits = ("foot", "95 % of its uncertainty") if k == 0 else (None, None)
        axes.axvspan(foot - 1.96 * sd, foot + 1.96 * sd, color="tab:green", alpha=0.25, linewidth=0.0, label=limits)
        axes.axvline(foot, color="tab:green", label=name)
        flank = shown & (side * (time - foot) > 0.0) & (angle > 0.02 * rise)
        for share, words in ((0.5, "half"), (0.25, "a quarter"), (0.02, "a fiftieth")):
            at = float(time[flank][int(np.argmin(np.abs(angle[flank] - share * rise)))])
            axes.plot(at, share * rise, "s", color="tab:purple", markersize=4.0)
            text = f"{words} of the rise" if side > 0 else ""
            axes.text(at + 0.015, share * rise - (9.0 if share < 0.1 else 2.0), text, color="tab:purple")
            if share == 0.5:
                line = {"arrowstyle": "->", "color": "tab:purple"}
                axes.annotate("", (foot, share * rise), (at, share * rise), arrowprops=line)
    axes.set(xlabel="time, s", ylabel="twist, deg", ylim=(-12.0, 100.0))
    axes.legend(loc="upper center", frameon=False)


def main() -> None:
    """Write the drawing."""
    with mpl.rc_context({"svg.hashsalt": "elbowscrew", "svg.fonttype": "none", "font.family": "sans-serif"}):
        figure().savefig(Path(__file__).parent / "images" / "cycles.svg", metadata={"Date": None})


if __name__ == "__main__":
    main()
