"""The charts of a trial's page about the joint by its type, in degrees and millimeters."""

from __future__ import annotations

from typing import Final

import numpy as np
from markupsafe import Markup

from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.sensitivity import NORMAL_95
from elbowscrew.quantities import rounded
from elbowscrew.report.charts import WIDTH, Chart, picture, range_of
from elbowscrew.report.trial_charts import mark_tracking, over_time
from elbowscrew.view.bands import is_seen, span_of
from elbowscrew.view.joint_space import ANGLE_NAMES
from elbowscrew.view.long_trials import shown_part
from elbowscrew.view.trial_view import TrialView
from elbowscrew.view.wander import off_mean

_TALL: Final = 300.0
_SHARE: Final = 0.62  # of the width, for what is drawn over time


def angles_chart(trial: TrialView) -> Markup | None:
    """Draw the joint's own angles over time, and the second of two against the first; None where theta is the one."""
    shown, stretch = shown_part(trial)
    found = shown.joint_angles
    if found is None or found.angle.shape[1] == 1:
        return None
    names = ANGLE_NAMES[found.angle.shape[1]]
    angles, reach = np.degrees(found.angle), NORMAL_95 * np.degrees(found.angle_sd)
    both = len(names) == 2
    chart = over_time(
        shown, "own", "", "", range_of(angles), "Angles (deg)", width=WIDTH * (_SHARE if both else 1.0), height=_TALL
    )
    mark_tracking(chart, shown)
    for k, name in enumerate(names):
        own = found.time_s, angles[:, k], reach[:, k]
        chart.reach(*own, "band-known", f"95 % interval of {name}", "deg", span_of(angles))
        chart.line(found.time_s, angles[:, k], f"axis{k + 1}", name)
    panels = [chart.panel()]
    text = f"{', '.join(names)} over time{'' if stretch is None else f', of {stretch.told}'}"
    if both:
        panels.append(_together(angles, names).panel(_SHARE * WIDTH))
        text += f"; on the right {names[1]} against {names[0]}"
    return chart.keys() + picture("own", "The joint's own angles", f"{text}.", WIDTH, _TALL, panels)


def _together(angles: Float, names: tuple[str, ...]) -> Chart:
    first, second = angles.T
    chart = Chart(
        "together",
        "",
        "",
        x_range=range_of(first),
        y_range=range_of(second),
        x_label=f"{names[0]} (deg)",
        y_label=f"{names[1]} (deg)",
        size=((1.0 - _SHARE) * WIDTH, _TALL),
    )
    chart.loop(first, second, "measured")
    start = np.flatnonzero(np.isfinite(first) & np.isfinite(second))[:1]
    chart.points(first[start], second[start], "center")
    return chart


def wander_chart(trial: TrialView) -> Markup | None:
    """Draw how far an axis that wanders is off its mean, against the angle; None of an axis that stays."""
    path = trial.axis_path
    if path is None:
        return None
    found, angle = off_mean(trial, path), np.degrees(path.angle)
    kinds = [("Tilt", "deg", np.degrees(found.tilt), np.degrees(found.tilt_reach))]
    if trial.located:
        kinds.append(("Shift", "mm", 1000.0 * found.shift, 1000.0 * found.shift_reach))
    charts = []
    for n, (what, unit, parts, reach) in enumerate(kinds):
        chart = Chart(
            f"wander{n}",
            "",
            "",
            x_range=range_of(angle, air=0.03),
            y_range=range_of(parts - np.nan_to_num(reach), parts + np.nan_to_num(reach)),
            x_label="Angle (deg)",
            y_label=f"{what} from the mean axis ({unit})",
            size=(0.5 * WIDTH, _TALL),
        )
        seen = is_seen(parts[0], reach, span_of(parts))
        for values in parts if seen else ():
            chart.band(angle, values - reach, values + reach, "band-known", "95 % of each")
        if np.isfinite(reach).any() and not seen:
            half = f"±{rounded(float(np.nanmedian(reach)))} {unit}"
            chart.remark(f"95 % of each {what.lower()}: {half}, too narrow to be drawn")
        for k, values in enumerate(parts):
            chart.line(angle, values, f"axis{k + 1}", f"toward {found.toward[k]}")
        charts.append(chart)
    panels = [chart.panel(0.5 * WIDTH * n) for n, chart in enumerate(charts)]
    text = f"{' and '.join(kind[0].lower() for kind in kinds).capitalize()} of the joint's axis from its mean."
    return charts[0].keys(*charts[1:]) + picture("wander", "The axis against the angle", text, WIDTH, _TALL, panels)
