"""The cuts of a measured motion: from the poses as they were tracked, whatever filter comes after."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from elbowscrew.errors import SettingError
from elbowscrew.geometry.arrays import Float
from elbowscrew.model import QualityWarning
from elbowscrew.model.joint_type import JointType
from elbowscrew.motion.movements.boundaries import REASONS, Cuts, Cycles, Reasons, no_cycles
from elbowscrew.motion.movements.course import measured_course, mixes_two_axes, two_axes_of
from elbowscrew.motion.movements.cuts import cut
from elbowscrew.motion.movements.swings import FEWEST_FOR_NOISE, swings_of
from elbowscrew.motion.screws.measurement import Measurement, rotation_noise_of
from elbowscrew.settings import Settings

# Times that differ by less are the same: they may have been written with six decimals.
_SAME_S: Final = 1e-6


def measured_cuts(measured: Measurement, settings: Settings, joint_type: JointType | None = None) -> Cuts:
    """Cut a measured motion on its unfiltered course (`measured_course`), or take the cycles that were given.

    The noise of a twist is the one that is stated (`Settings.marker_noise_mm`), else that of its third differences, and
    of recordings too short for these the one that is known otherwise; the noise of an angle 1 is always its own.

    Raises
    ------
    SettingError
        If a given cycle does not lie in the recording.
    """
    course = measured_course(measured, settings, joint_type)
    first_angle = two_axes_of(joint_type) is not None
    elapsed, rate_hz = measured.unfiltered.elapsed, measured.unfiltered.rate_hz
    least = None if settings.cycle_swing_deg is None else float(np.radians(settings.cycle_swing_deg))
    # The residuals of the markers are no measure of white noise: most of them may be constant, as that of a cluster
    # which is not quite what it was calibrated as.
    known = settings.marker_noise_mm is not None or np.isfinite(course).sum() <= FEWEST_FOR_NOISE
    noise = rotation_noise_of(measured.joint, measured.noise) if known and not first_angle else None
    cuts = cut(course, elapsed, rate_hz, noise, least_swing=least)
    if mixes_two_axes(joint_type) and not first_angle:
        cuts = _all_doubted(cuts, "two-axes")
    elif not measured.sense.signed and not first_angle:
        cuts = _all_doubted(cuts, "unsigned" if settings.signed == "no" else "no-dominant-axis")
    if settings.no_cycles:
        return replace(cuts, cycles=no_cycles())
    if settings.cycles is not None:
        first = float(measured.recording.time_s[0])
        return replace(cuts, cycles=_given(np.array(settings.cycles) - first, first, course, elapsed))
    return cuts


def _all_doubted(cuts: Cuts, code: str) -> Cuts:
    """Give every boundary one more reason to be uncertain."""

    def more(reasons: tuple[Reasons, ...]) -> tuple[Reasons, ...]:
        return tuple((*codes, code) for codes in reasons)

    cycles, movements = cuts.cycles, cuts.movements
    return replace(
        cuts,
        cycles=replace(
            cycles,
            start_reasons=more(cycles.start_reasons),
            inversion_reasons=more(cycles.inversion_reasons),
            end_reasons=more(cycles.end_reasons),
        ),
        movements=replace(
            movements,
            onset_reasons=more(movements.onset_reasons),
            offset_reasons=more(movements.offset_reasons),
        ),
    )


def cut_warnings(cuts: Cuts) -> tuple[QualityWarning, ...]:
    """One warning that says which boundaries are uncertain and why; none if none is."""
    cycles, movements = cuts.cycles, cuts.movements
    found: dict[str, list[str]] = {}
    for kind, reasons in (
        ("start", cycles.start_reasons),
        ("inversion", cycles.inversion_reasons),
        ("end", cycles.end_reasons),
    ):
        for k, codes in enumerate(reasons, start=1):
            for code in codes:
                found.setdefault(code, []).append(f"{kind} of cycle {k}")
    for kind, reasons in (("onset", movements.onset_reasons), ("offset", movements.offset_reasons)):
        for k, codes in enumerate(reasons, start=1):
            for code in codes:
                found.setdefault(code, []).append(f"{kind} of movement {k}")
    if not found:
        return ()
    parts = [f"{_listed(boundaries)}: {REASONS[code]}" for code, boundaries in found.items()]
    message = (
        f"where the motion is cut is uncertain. {'; '.join(parts)} (--cycle-swing sets the least swing, --cycles gives "
        "the times)"
    )
    return (QualityWarning(code="uncertain-cuts", message=message),)


def _listed(boundaries: list[str]) -> str:
    shown = ", ".join(boundaries[:6])
    return shown if len(boundaries) <= 6 else f"{shown} and {len(boundaries) - 6} more"


def _given(times: Float, first: float, twist: Float, elapsed: Float) -> Cycles:
    """Cycles between times that were given, each with the largest rotation of the smoothed twist as its inversion."""
    span = float(elapsed[-1] - elapsed[0])
    before = 0.0
    for start, end in times.tolist():
        if not before - _SAME_S <= start < end <= span + _SAME_S:
            msg = (
                f"--cycles: a cycle from {start + first:g} to {end + first:g} s; expected one after the other, within "
                f"the recording's {first:g} to {span + first:g} s"
            )
            raise SettingError(msg)
        before = end
    known = np.flatnonzero(np.isfinite(twist))
    time = elapsed - elapsed[0]
    rate_hz = 1.0 / float(np.median(np.diff(time)))
    even = np.arange(round(span * rate_hz) + 1) / rate_hz
    smooth = swings_of(np.interp(even, time[known], twist[known]), rate_hz).smooth
    tops = []
    for start, end in times.tolist():
        inside = slice(int(np.searchsorted(even, start)), max(int(np.searchsorted(even, end, side="right")), 1))
        tops.append(float(even[inside][int(np.argmax(smooth[inside]))]) if smooth[inside].size else 0.5 * (start + end))
    none, unknown = ((),) * len(times), np.full(len(times), np.nan)
    return Cycles(
        start_s=times[:, 0],
        inversion_s=np.array(tops),
        end_s=times[:, 1],
        start_sd_s=unknown,
        inversion_sd_s=unknown,
        end_sd_s=unknown,
        incomplete=np.zeros(len(times), dtype=np.bool_),
        start_reasons=none,
        inversion_reasons=none,
        end_reasons=none,
    )
