"""What is said of a recording is what it holds: each figure under its own name and in its own unit."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np
import pytest

from elbowscrew import Settings, simulate_trial
from elbowscrew.model import BodyQuality, QualityWarning, Recording, Spread
from elbowscrew.model.recording import Source
from elbowscrew.results.recording_summary import (
    quality_summary,
    recording_summary,
    source_summary,
    summary_from_recording,
    warnings_summary,
)
from elbowscrew.results.statistics import known, rms, statistic

SIMULATED = simulate_trial(frames=120, inversion=60, gaps=2, gap_frames=5, proximal="moving", seed=1)
BODIES = {body.name: body for body in SIMULATED.recording.bodies}
QUALITY = BodyQuality(
    name="Forearm", identifier="ABC", tracked_share=0.75, lost_frames={"missing": 30}, sign_flips=2, leaps=1,
    fastest_turn=np.pi, fastest_speed=1.5, marker_residual=Spread(median=1e-4, percentile_95=3e-4, largest=2e-3),
    reported_error=None, pivot_offset=0.012, shape_deviation=0.03, markers=4,
)  # fmt: skip


def test_figures_of_a_body_are_in_the_units_their_names_say() -> None:
    found = quality_summary(QUALITY)
    plain = ("name", "tracked_share", "lost_frames", "sign_flips", "leaps", "shape_deviation", "markers")
    assert {name: found[name] for name in plain} == {name: getattr(QUALITY, name) for name in plain}  # type: ignore[literal-required]
    assert found["id"] == "ABC"
    assert found["fastest_turn_deg_s"] == pytest.approx(180.0)
    assert found["fastest_speed_m_s"] == 1.5
    assert found["marker_residual_mm"] == pytest.approx({"median": 0.1, "percentile_95": 0.3, "largest": 2.0})
    assert found["reported_error_mm"] is None
    assert found["pivot_offset_mm"] == pytest.approx(12.0)
    other = quality_summary(
        replace(QUALITY, marker_residual=None, reported_error=QUALITY.marker_residual, pivot_offset=None)
    )
    assert (other["marker_residual_mm"], other["pivot_offset_mm"]) == (None, None)
    assert other["reported_error_mm"] == found["marker_residual_mm"]


def test_frames_and_times_are_those_of_the_clock() -> None:
    one = SIMULATED.recording
    frame = np.arange(500, 620)
    found = recording_summary(replace(one, frame=frame, time_s=one.time_s + 7.0))
    assert (found["frames"], found["first_frame"], found["last_frame"]) == (120, 500, 619)
    assert found["rate_hz"] == one.rate_hz
    assert found["duration_s"] == pytest.approx(119.0 / one.rate_hz)
    clock = found["clock"]
    assert (clock["missing_frames"], clock["frame_gaps"], clock["repeated_frames"]) == (0, 0, 0)
    assert clock["largest_offset_s"] == pytest.approx(0.0, abs=1e-6)


def test_a_clock_with_faults_tells_them() -> None:
    """Two numbers left out in one place, three in another."""
    one = SIMULATED.recording
    frame = np.arange(120) + 2 * (np.arange(120) >= 40) + 3 * (np.arange(120) >= 90)
    clock = recording_summary(replace(one, frame=frame, time_s=frame / one.rate_hz))["clock"]
    assert (clock["missing_frames"], clock["frame_gaps"], clock["repeated_frames"]) == (5, 2, 0)


def test_a_file_tells_its_bodies_roles_and_markers() -> None:
    found = summary_from_recording(SIMULATED.recording, Settings())
    told = {body["name"]: body for body in found["trial"]["bodies"]}
    assert list(told) == list(BODIES)
    for name, body in BODIES.items():
        assert told[name]["tracked_share"] == pytest.approx(body.tracked.mean())
        assert told[name]["markers"] == 4
    roles = found["roles"]
    assert (roles["proximal"], roles["distal"], roles["joint"]) == ("Upper Arm", "Forearm", "elbow")
    assert roles["text"] == "upper arm 'Upper Arm', forearm 'Forearm'"
    for marker, own in zip(found["markers"], SIMULATED.recording.markers, strict=True):
        seen = np.isfinite(own.position).all(axis=1)
        assert marker["name"] == own.name
        assert marker["seen_share"] == pytest.approx(seen.sum() / seen.size)


def test_a_body_alone_moves_beside_one_that_stands_still() -> None:
    alone = replace(SIMULATED.recording, bodies=(BODIES["Forearm"],))
    roles = summary_from_recording(alone)["roles"]
    assert (roles["proximal"], roles["distal"]) == (None, "Forearm")
    assert roles["text"] == "upper arm that stands still, forearm 'Forearm'"


def test_bodies_that_are_not_understood_have_no_roles_and_it_is_said_why() -> None:
    strange = tuple(replace(BODIES["Forearm"], name=name, identifier=name) for name in ("Ball", "Table", "Chair"))
    roles = summary_from_recording(replace(SIMULATED.recording, bodies=strange))["roles"]
    assert (roles["proximal"], roles["distal"], roles["joint"]) == (None, None, None)
    for word in ("Ball", "Table", "Chair", "--proximal", "--distal"):
        assert word in roles["text"]
    none = summary_from_recording(replace(SIMULATED.recording, bodies=()))["roles"]
    assert (none["proximal"], none["distal"], none["joint"]) == (None, None, None)
    assert none["text"] == "no rigid bodies; give --proximal-markers and --distal-markers to analyze"


def sourced(path: str) -> Recording:
    source = Source(path=path, sha256="0" * 64, layout="motive columns", take_name="take 1", length_unit="m",
                    rotation_type="Quaternion")  # fmt: skip
    return replace(SIMULATED.recording, source=source)


@pytest.mark.parametrize("path", ["trial.csv", "a/b/trial.csv", "C:\\data\\trial.csv"])
def test_a_source_is_told_without_its_folder(path: str) -> None:
    assert source_summary(sourced(path)) == {
        "name": "trial.csv", "sha256": "0" * 64, "layout": "motive columns", "take": "take 1", "length_unit": "m",
        "rotation": "Quaternion", "distal_file": None, "columns_file": None,
    }  # fmt: skip
    assert source_summary(sourced("bad\udcff.csv"))["name"] == "bad?.csv"  # bytes of a name that are no text


def test_a_recording_without_a_file_has_no_source() -> None:
    assert set(source_summary(replace(SIMULATED.recording, source=None)).values()) == {None}
    assert set(source_summary(replace(SIMULATED.recording, source=None))) == set(source_summary(sourced("a.csv")))


def test_warnings_come_before_notes_in_their_order() -> None:
    order: tuple[tuple[str, Literal["warning", "note"]], ...] = (
        ("a", "note"),
        ("b", "warning"),
        ("c", "note"),
        ("d", "warning"),
    )
    given = [
        QualityWarning(code=code, message=f"about {code}", severity=severity, frames=(1, 2), count=9)
        for code, severity in order
    ]
    found = warnings_summary(given)
    assert [one["code"] for one in found] == ["b", "d", "a", "c"]
    assert found[0] == {"code": "b", "message": "about b", "severity": "warning", "frames": [1, 2], "count": 9}


def test_what_is_not_known_is_none_and_no_statistic_counts_it() -> None:
    nan = float("nan")
    assert [known(value) for value in (1.5, nan, np.inf, -np.inf)] == [1.5, None, None, None]
    assert statistic(np.nanmax, np.array([nan, 2.0])) == 2.0
    assert statistic(np.nanmax, np.array([nan, nan])) is None
    assert rms(np.array([3.0, nan, -4.0])) == pytest.approx(np.sqrt((9.0 + 16.0) / 2.0))
