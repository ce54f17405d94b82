"""Synthetic recordings in OptiTrack's layouts, read cell by cell as the layouts are described."""

from __future__ import annotations

import csv
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from elbowscrew import simulate_trial
from elbowscrew.geometry.dual_quaternion import pose_from_dual_quat
from elbowscrew.results.optitrack_writer import motive_columns_lines, row_tagged_lines

TRIAL = simulate_trial(frames=60, inversion=30, gaps=1, gap_frames=4, proximal="moving", marker_noise_mm=0.3, seed=2)
RECORDING = TRIAL.recording
POSES = {body.name: pose_from_dual_quat(body.dual_quat_lab_body) for body in RECORDING.bodies}


def fitted(name: str) -> Any:
    body = next(one for one in RECORDING.bodies if one.name == name)
    quat, place = POSES[name]
    points = np.full((60, 4, 3), np.nan)
    for k in np.flatnonzero(body.tracked):
        points[k] = Rotation.from_quat(quat[k], scalar_first=True).apply(body.marker_offsets) + place[k]
    return points


@pytest.mark.parametrize(("unit", "title", "scale"), [("m", "Meters", 1.0), ("cm", "Centimeters", 100.0),
                                                      ("mm", "Millimeters", 1000.0)])  # fmt: skip
def test_columns_hold_poses_errors_and_markers(unit: str, title: str, scale: float) -> None:
    rows = list(csv.reader(motive_columns_lines(RECORDING, TRIAL.markers, unit, 'a "take", noisy')))
    header = dict(zip(rows[0][::2], rows[0][1::2], strict=True))
    assert header["Format Version"] == "1.23"
    assert header["Take Name"] == 'a "take", noisy'
    assert float(header["Capture Frame Rate"]) == float(header["Export Frame Rate"]) == RECORDING.rate_hz
    assert header["Total Frames in Take"] == header["Total Exported Frames"] == "60"
    assert (header["Rotation Type"], header["Length Units"], header["Coordinate Space"]) == (
        "Quaternion", title, "Global",
    )  # fmt: skip
    assert rows[1] == []
    kinds, names, ids, fields, axes = rows[2:7]
    assert [row[1] for row in rows[2:6]] == ["Type", "Name", "ID", ""]
    assert axes[:2] == ["Frame", "Time (Seconds)"]
    table = np.array([[float(cell or "nan") for cell in row] for row in rows[7:]])
    assert table[:, 0].tolist() == RECORDING.frame.tolist()
    assert table[:, 1] == pytest.approx(RECORDING.time_s, abs=1e-6)
    columns = {key: table[:, k] for k, key in enumerate(zip(kinds, names, fields, axes, strict=True))}
    for body in RECORDING.bodies:
        quat, place = POSES[body.name]
        for k, axis in enumerate("WXYZ"):
            found = columns["Rigid Body", body.name, "Rotation", axis]
            assert found == pytest.approx(quat[:, k], abs=1e-6, nan_ok=True)
        points, seen = fitted(body.name), TRIAL.markers[body.name]
        for k, axis in enumerate("XYZ"):
            found = columns["Rigid Body", body.name, "Position", axis]
            assert found == pytest.approx(scale * place[:, k], abs=1e-6, nan_ok=True)
            for m in range(4):
                one = f"{body.name}:Marker{m + 1}"
                own = columns["Rigid Body Marker", one, "Position", axis]
                assert own == pytest.approx(scale * points[:, m, k], abs=1e-6, nan_ok=True)
                assert columns["Marker", one, "Position", axis] == pytest.approx(
                    scale * seen[:, m, k], abs=1e-6, nan_ok=True
                )
        mean = scale * np.linalg.norm(seen - points, axis=2).mean(axis=1)
        assert columns["Rigid Body", body.name, "Mean Marker Error", ""] == pytest.approx(mean, abs=1e-6, nan_ok=True)
        quality = columns["Rigid Body Marker", f"{body.name}:Marker2", "Marker Quality", ""]
        assert (quality == 1.0).tolist() == body.tracked.tolist()
        assert np.isnan(quality[~body.tracked]).all()
    # Markers as seen have identifiers of their own, a body's columns and its markers' those of the body.
    of_kind = {kind: {(n, i) for t, n, i in zip(kinds, names, ids, strict=True) if t == kind} for kind in set(kinds)}
    assert {i for _, i in of_kind["Rigid Body Marker"]} == {body.identifier for body in RECORDING.bodies}
    assert len({i for _, i in of_kind["Marker"]}) == 8
    assert all(len(i) == 32 for _, i in of_kind["Marker"])


def test_rows_hold_definitions_frames_and_bodies() -> None:
    rows = list(csv.reader(row_tagged_lines(RECORDING, TRIAL.markers)))
    tags = [row[0] for row in rows]
    assert ["info", "version", "1.1"] in rows
    assert ["info", "framecount", "60"] in rows
    assert ["info", "rigidbodycount", "2"] in rows
    assert tags.count("frame") == 60
    assert tags.count("comment") == 2
    assert "righthanded" in tags
    first = tags.index("frame")
    defined = [row for row in rows[:first] if row[0] == "rigidbody"]
    for number, (row, body) in enumerate(zip(defined, RECORDING.bodies, strict=True), start=1):
        assert row[1:4] == [body.name, str(number), "4"]
        assert np.array(row[4:], float).reshape(4, 3) == pytest.approx(body.marker_offsets, abs=1e-8)
    since = dict.fromkeys(POSES, 0)
    for index in range(60):
        frame, *bodies = rows[first + 3 * index : first + 3 * index + 3]
        tracked = [body for body in RECORDING.bodies if body.tracked[index]]
        assert int(frame[1]) == index
        assert float(frame[2]) == pytest.approx(RECORDING.time_s[index], abs=1e-8)
        assert int(frame[3]) == len(tracked)
        cells = frame[4:]
        for body in tracked:
            which, own, cells = cells[0], np.array(cells[1:11], float), cells[11:]
            quat, place = (part[index] for part in POSES[body.name])
            assert RECORDING.bodies[int(which) - 1] is body
            assert own[:3] == pytest.approx(place, abs=1e-8)
            assert own[3:7] == pytest.approx(quat[[1, 2, 3, 0]], abs=1e-8)
            yaw, pitch, roll = own[7:]
            again = Rotation.from_euler("XZY", [roll, pitch, yaw], degrees=True)
            assert (again.inv() * Rotation.from_quat(quat, scalar_first=True)).magnitude() < 1e-7
        count, cells = int(cells[0]), cells[1:]
        assert count == 4 * len(tracked)
        assert len(cells) == 5 * count
        ids = [int(cell) for cell in cells[3::5]]
        assert ids == [4 * RECORDING.bodies.index(body) + m + 1 for body in tracked for m in range(4)]
        assert cells[4::5] == [f"{body.name}-Marker {m + 1}" for body in tracked for m in range(4)]
        for number, (row, body) in enumerate(zip(bodies, RECORDING.bodies, strict=True), start=1):
            lost = not body.tracked[index]
            since[body.name] = since[body.name] + 1 if lost else 0
            assert row[3:7] == [body.name, str(number), str(since[body.name]), "4"]
            own = np.array(row[7:23], float).reshape(4, 4)
            assert own[:, :3] == pytest.approx(fitted(body.name)[index - since[body.name]], abs=1e-8)
            assert own[:, 3].tolist() == [4 * (number - 1) + m + 1 for m in range(4)]
            assert row[35:39] == ["0" if lost else "1"] * 4
            assert [float(cell) for cell in row[39:43]] == [0.0 if lost else 1.0] * 4
            gaps = np.linalg.norm(TRIAL.markers[body.name][index] - fitted(body.name)[index], axis=1)
            assert float(row[43]) == pytest.approx(0.0 if lost else gaps.mean(), abs=1e-8)
    assert any(not body.tracked.all() for body in RECORDING.bodies)  # or nothing of the above were asked
