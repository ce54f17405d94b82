"""The cuts of a measured motion: from the poses as they were tracked, whatever filter comes after."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from elbowscrew.model import QualityWarning
from elbowscrew.model.joint_type import JointType
from elbowscrew.motion.movements.boundaries import REASONS, Cuts, Reasons, no_cycles
from elbowscrew.motion.movements.course import measured_course, mixes_two_axes, two_axes_of
from elbowscrew.motion.movements.cuts import cut
from elbowscrew.motion.movements.given import given_cycles
from elbowscrew.motion.movements.swings import FEWEST_FOR_NOISE
from elbowscrew.motion.screws.measurement import Measurement, rotation_noise_of
from elbowscrew.quantities import in_digits
from elbowscrew.settings import Settings

# The law of a foot is in doubt in most recordings, and the cut's standard deviation tells by how much: a smaller one
# (share of the cycle or movement) needs no more words.
_LARGE_SD: Final = 0.05


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
        return replace(cuts, cycles=given_cycles(np.array(settings.cycles), first, course, elapsed, rate_hz))
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


def cut_warnings(cuts: Cuts, settings: Settings) -> tuple[QualityWarning, ...]:
    """Say which boundaries are uncertain and why, and where a stated swing leaves no cycle; nothing if nothing is."""
    hidden = () if settings.cycles is not None else _hidden(cuts)
    return _doubts(cuts) + hidden + _small_strokes(cuts, settings) + _no_such_swing(cuts, settings)


def _hidden(cuts: Cuts) -> tuple[QualityWarning, ...]:
    if not len(cuts.hidden_s):
        return ()
    told = _listed([f"{begin:.2f} to {end:.2f} s" for begin, end in cuts.hidden_s.tolist()])
    message = (
        f"the joint may turn back where there is no pose ({told} after the first frame): such cycles are not counted, "
        "and those beside them may be parts of two; --cycles gives the times"
    )
    return (QualityWarning(code="turns-in-gaps", message=message, count=len(cuts.hidden_s)),)


def _small_strokes(cuts: Cuts, settings: Settings) -> tuple[QualityWarning, ...]:
    """Tell of strokes that are no cycles only because those beside them are much larger."""
    if not cuts.small.size or settings.cycles is not None or settings.no_cycles:
        return ()
    degrees = np.degrees(cuts.small)
    several = "1 stroke" if degrees.size == 1 else f"{degrees.size} strokes"
    message = (
        f"{several} out and back of {in_digits(degrees.min())} to {in_digits(degrees.max())} deg count as hesitations "
        f"beside the larger ones, and not as cycles; --cycle-swing {in_digits(0.7 * degrees.min())} counts them"
    )
    return (QualityWarning(code="small-strokes", message=message, count=int(degrees.size)),)


def _no_such_swing(cuts: Cuts, settings: Settings) -> tuple[QualityWarning, ...]:
    if settings.cycle_swing_deg is None or settings.cycles is not None or settings.no_cycles:
        return ()
    if cuts.cycles.start_s.size or not np.isfinite(cuts.excursion):
        return ()
    message = (
        f"the motion does not swing out and back by the {settings.cycle_swing_deg:g} deg of --cycle-swing: there is "
        f"no cycle; all of it spans {in_digits(np.degrees(cuts.excursion), 3)} deg"
    )
    return (QualityWarning(code="no-such-swing", message=message),)


def _doubts(cuts: Cuts) -> tuple[QualityWarning, ...]:
    cycles, movements = cuts.cycles, cuts.movements
    lengths = cycles.end_s - cycles.start_s, movements.offset_s - movements.onset_s
    found: dict[str, list[str]] = {}
    for kind, reasons, sd, length in (
        ("start of cycle", cycles.start_reasons, cycles.start_sd_s, lengths[0]),
        ("inversion of cycle", cycles.inversion_reasons, cycles.inversion_sd_s, lengths[0]),
        ("end of cycle", cycles.end_reasons, cycles.end_sd_s, lengths[0]),
        ("onset of movement", movements.onset_reasons, movements.onset_sd_s, lengths[1]),
        ("offset of movement", movements.offset_reasons, movements.offset_sd_s, lengths[1]),
    ):
        for k, codes in enumerate(reasons):
            told_by_sd = not sd[k] > _LARGE_SD * length[k]
            for code in codes:
                if code != "law" or not told_by_sd:
                    found.setdefault(code, []).append(f"{kind} {k + 1}")
    if not found:
        return ()
    parts = [f"{_listed(boundaries)}: {REASONS[code]}" for code, boundaries in found.items()]
    message = (
        f"the cuts of the motion are uncertain. {'; '.join(parts)} (--cycle-swing sets the smallest swing, --cycles "
        "gives the times)"
    )
    return (QualityWarning(code="uncertain-cuts", message=message),)


def _listed(boundaries: list[str]) -> str:
    shown = ", ".join(boundaries[:6])
    return shown if len(boundaries) <= 6 else f"{shown} and {len(boundaries) - 6} more"
