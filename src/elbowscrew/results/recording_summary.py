"""What a recording is, for every summary: its source, clock, bodies with their tracking, and warnings."""

from __future__ import annotations

from collections.abc import Iterable, Sequence, Set
from dataclasses import replace
from typing import Final

import numpy as np

from elbowscrew._version import __version__
from elbowscrew.declaring import option_name
from elbowscrew.errors import Missing, SettingError
from elbowscrew.model import BodyQuality, QualityWarning, Recording, Spread
from elbowscrew.model.summary_types import (
    ClockSummary,
    FileClock,
    FileSummary,
    QualitySummary,
    RecordingSummary,
    RolesSummary,
    SourceSummary,
    SpreadSummary,
    WarningSummary,
)
from elbowscrew.motion.tracking.quality import check_bodies, clock_quality
from elbowscrew.motion.tracking.selection import bones_of, choose_bodies
from elbowscrew.reading.options import ASK_FOR_MARKERS
from elbowscrew.settings import Settings

_NO_LIMIT: Final = 1e300


def summary_from_recording(
    recording: Recording, settings: Settings | None = None, missing: Sequence[Missing] = ()
) -> FileSummary:
    """What a file holds, ready for JSON: source, clock, bodies with their tracking, and which is which segment.

    Parameters
    ----------
    recording : Recording
    settings : Settings, optional
    missing : sequence of Missing
        What the file does not state: all that depends on it is None.
    """
    unknown = {one.setting for one in missing}
    wanted = settings or Settings()
    if unknown:  # what is made up leaps at will
        wanted = wanted.model_copy(update={"max_turn_deg_s": _NO_LIMIT, "max_speed_m_s": _NO_LIMIT})
    checked = check_bodies(recording, recording.bodies, wanted)
    found = {marker.name: float(np.isfinite(marker.position).all(axis=1).mean()) for marker in recording.markers}
    names = () if recording.source is None else recording.source.markers
    roles, unclear = _roles(recording)
    return {
        "elbowscrew": __version__,
        "source": _known_source(source_summary(recording), unknown),
        "trial": {
            **_known_clock(recording, unknown),
            "bodies": [_known_quality(quality_summary(body), unknown) for body in checked.quality],
        },
        "markers": [{"name": name, "seen_share": found.get(name)} for name in dict.fromkeys((*names, *found))],
        "bones": list(bones_of(recording)),
        "roles": roles,
        "missing": [
            {"option": option_name(one.setting), "lacks": one.lacks, "give": one.give} for one in (*missing, *unclear)
        ],
        "warnings": warnings_summary((*recording.warnings, *(() if unknown else checked.warnings))),
    }


def _known_source(source: SourceSummary, unknown: Set[str]) -> SourceSummary:
    length = None if "units" in unknown else source["length_unit"]
    rotation = None if "rotation" in unknown else source["rotation"]
    return {**source, "length_unit": length, "rotation": rotation}


def _known_clock(recording: Recording, unknown: Set[str]) -> FileClock:
    told = recording_summary(recording)
    if "rate_hz" not in unknown:
        return {**told}
    return {**told, "rate_hz": None, "duration_s": None, "clock": None}


def _known_quality(quality: QualitySummary, unknown: Set[str]) -> QualitySummary:
    known = quality.copy()
    if unknown & {"rotation", "rate_hz"}:
        known["fastest_turn_deg_s"] = None
    if unknown & {"units", "rate_hz"}:
        known["fastest_speed_m_s"] = None
    if unknown & {"units", "rotation"}:  # the markers' distances from the body need both
        known["marker_residual_mm"] = known["pivot_offset_mm"] = known["shape_deviation"] = None
        known["reported_error_mm"] = None
    return known


def source_summary(recording: Recording) -> SourceSummary:
    """Where the recording came from."""
    source = recording.source
    if source is None:
        return {
            "name": None,
            "sha256": None,
            "layout": None,
            "take": None,
            "length_unit": None,
            "rotation": None,
            "distal_file": None,
            "columns_file": None,
        }
    return {
        "name": _file_name(source.path),
        "sha256": source.sha256,
        "layout": source.layout,
        "take": source.take_name,
        "length_unit": source.length_unit,
        "rotation": source.rotation_type,
        "distal_file": None
        if source.distal is None
        else {"name": _file_name(source.distal.path), "sha256": source.distal.sha256},
        "columns_file": None
        if source.columns is None
        else {"name": _file_name(source.columns.name), "sha256": source.columns.sha256},
    }


def recording_summary(recording: Recording) -> RecordingSummary:
    """Frames, rate and clock of a recording."""
    return {
        "frames": int(recording.frame.size),
        "first_frame": int(recording.frame[0]),
        "last_frame": int(recording.frame[-1]),
        "rate_hz": recording.rate_hz,
        "duration_s": float(recording.time_s[-1] - recording.time_s[0]),
        "clock": _clock(recording),
    }


def _clock(recording: Recording) -> ClockSummary:
    clock = clock_quality(recording)
    return {
        "missing_frames": clock.missing_frames,
        "frame_gaps": clock.frame_gaps,
        "repeated_frames": clock.repeated_frames,
        "largest_offset_s": clock.largest_offset_s,
    }


def quality_summary(quality: BodyQuality) -> QualitySummary:
    """Figures of one body, units in the names."""
    return {
        "name": quality.name,
        "id": quality.identifier,
        "tracked_share": quality.tracked_share,
        "lost_frames": dict(quality.lost_frames),
        "sign_flips": quality.sign_flips,
        "leaps": quality.leaps,
        "fastest_turn_deg_s": float(np.degrees(quality.fastest_turn)),
        "fastest_speed_m_s": quality.fastest_speed,
        "marker_residual_mm": _spread_mm(quality.marker_residual),
        "reported_error_mm": _spread_mm(quality.reported_error),
        "pivot_offset_mm": None if quality.pivot_offset is None else 1000.0 * quality.pivot_offset,
        "shape_deviation": quality.shape_deviation,
        "markers": quality.markers,
    }


def _spread_mm(spread: Spread | None) -> SpreadSummary | None:
    if spread is None:
        return None
    return {
        "median": 1000.0 * spread.median,
        "percentile_95": 1000.0 * spread.percentile_95,
        "largest": 1000.0 * spread.largest,
    }


def _roles(recording: Recording) -> tuple[RolesSummary, tuple[Missing, ...]]:
    """Which body is which segment, or what must be told of that."""
    if not recording.bodies:
        text = f"no rigid bodies; {ASK_FOR_MARKERS} to analyze"
        unclear = Missing("proximal_markers", "has no rigid bodies", ASK_FOR_MARKERS.removeprefix("give "))
        return {"proximal": None, "distal": None, "joint": None, "text": text}, (unclear,)
    bones = bones_of(recording)
    rigid = tuple(body for body in recording.bodies if body.name not in bones)
    try:
        chosen = choose_bodies(replace(recording, bodies=rigid) if rigid else recording, None, None)
    except SettingError as error:
        unclear = Missing("proximal", "does not say which bodies are the joint's", "--proximal NAME and --distal NAME")
        return {"proximal": None, "distal": None, "joint": None, "text": str(error)}, (unclear,)
    joint, distal = chosen.joint, chosen.distal.name
    name = chosen.proximal.name if chosen.proximal is not None else None
    first = f"{joint.proximal.name} {name!r}" if name is not None else f"{joint.proximal.name} that stands still"
    text = f"{first}, {joint.distal.name} {distal!r}"
    return {"proximal": name, "distal": distal, "joint": joint.name, "text": text}, ()


def warnings_summary(warnings: Iterable[QualityWarning]) -> list[WarningSummary]:
    """Warnings, those that matter first."""
    return [
        {
            "code": warning.code,
            "message": warning.message,
            "severity": warning.severity,
            "frames": list(warning.frames),
            "count": warning.count,
        }
        for warning in sorted(warnings, key=lambda warning: warning.severity != "warning")
    ]


def _file_name(path: str) -> str:
    """File names may hold bytes that are no text; JSON may not."""
    return path.replace("\\", "/").rsplit("/", 1)[-1].encode("utf-8", "replace").decode("utf-8")
