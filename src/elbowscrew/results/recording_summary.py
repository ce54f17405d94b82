"""What a recording is, for every summary: its source, clock, bodies with their tracking, and warnings."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from elbowscrew._version import __version__
from elbowscrew.errors import SettingError
from elbowscrew.model import BodyQuality, QualityWarning, Recording, Spread
from elbowscrew.model.summary_types import (
    ClockSummary,
    FileSummary,
    QualitySummary,
    RecordingSummary,
    RolesSummary,
    SourceSummary,
    SpreadSummary,
    WarningSummary,
)
from elbowscrew.motion.tracking.quality import check_bodies, clock_quality
from elbowscrew.motion.tracking.selection import choose_bodies
from elbowscrew.reading.options import ASK_FOR_MARKERS
from elbowscrew.settings import Settings


def summary_from_recording(recording: Recording, settings: Settings | None = None) -> FileSummary:
    """What a file holds, ready for JSON: source, clock, bodies with their tracking, and which is which segment."""
    checked = check_bodies(recording, recording.bodies, settings or Settings())
    return {
        "elbowscrew": __version__,
        "source": source_summary(recording),
        "trial": {**recording_summary(recording), "bodies": [quality_summary(body) for body in checked.quality]},
        "markers": [
            {"name": marker.name, "seen_share": float(np.isfinite(marker.position).all(axis=1).mean())}
            for marker in recording.markers
        ],
        "roles": _roles(recording),
        "warnings": warnings_summary((*recording.warnings, *checked.warnings)),
    }


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


def _roles(recording: Recording) -> RolesSummary:
    if not recording.bodies:
        return {
            "proximal": None,
            "distal": None,
            "joint": None,
            "text": f"no rigid bodies; {ASK_FOR_MARKERS} to analyze",
        }
    try:
        chosen = choose_bodies(recording, None, None)
    except SettingError as error:
        return {"proximal": None, "distal": None, "joint": None, "text": str(error)}
    joint, distal = chosen.joint, chosen.distal.name
    name = chosen.proximal.name if chosen.proximal is not None else None
    first = f"{joint.proximal.name} {name!r}" if name is not None else f"{joint.proximal.name} that stands still"
    text = f"{first}, {joint.distal.name} {distal!r}"
    return {"proximal": name, "distal": distal, "joint": joint.name, "text": text}


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
