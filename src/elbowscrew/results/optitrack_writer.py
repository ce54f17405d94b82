"""Recordings written in OptiTrack's own layouts, for synthetic trials."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import pose_from_dual_quat, transform_points
from elbowscrew.model import Recording, RigidBody
from elbowscrew.quantities import METERS

_UNIT_TITLES = {"m": "Meters", "cm": "Centimeters", "mm": "Millimeters"}


def motive_columns_lines(recording: Recording, markers: Mapping[str, Float], unit: str, take: str) -> Iterator[str]:
    """Lines of Motive's column layout 1.23: bodies, their fitted markers, then the markers as seen.

    Parameters
    ----------
    recording : Recording
        Its bodies must have marker offsets.
    markers : mapping of str to ndarray, shape (N, M, 3)
        Markers as seen, by body name, meters.
    unit : {"m", "cm", "mm"}
    take : str
        Name of the take.
    """
    rate = f"{recording.rate_hz:.6f}"
    count = str(recording.frame.size)
    pairs = {
        "Format Version": "1.23",
        "Take Name": take,
        "Take Notes": "synthetic",
        "Capture Frame Rate": rate,
        "Export Frame Rate": rate,
        "Capture Start Time": "2026-01-01 12.00.00.000 PM",
        "Total Frames in Take": count,
        "Total Exported Frames": count,
        "Rotation Type": "Quaternion",
        "Length Units": _UNIT_TITLES[unit],
        "Coordinate Space": "Global",
    }
    yield ",".join(_cell(text) for pair in pairs.items() for text in pair)
    yield ""
    labels, blocks = _motive_blocks(recording, markers, 1.0 / METERS[unit])
    for row, title in enumerate(("Type", "Name", "ID", "")):
        yield ",".join(["", title, *(label[row] for label in labels)])
    yield ",".join(["Frame", "Time (Seconds)", *(label[4] for label in labels)])
    values = np.concatenate(blocks, axis=1)
    for frame, time_s, row in zip(recording.frame.tolist(), recording.time_s.tolist(), values.tolist(), strict=True):
        yield ",".join([str(frame), f"{time_s:.6f}", *(_fixed(value, 6) for value in row)])


def _motive_blocks(
    recording: Recording, markers: Mapping[str, Float], scale: float
) -> tuple[list[tuple[str, ...]], list[Float]]:
    """Labels (type, name, id, field, axis) and values of every column."""
    labels: list[tuple[str, ...]] = []
    bodies, fitted, seen = [], [], []
    for body in recording.bodies:
        quat, position = pose_from_dual_quat(body.dual_quat_lab_body)
        error = np.linalg.norm(markers[body.name] - _fitted(body), axis=2).mean(axis=1, keepdims=True)
        bodies.append(np.concatenate([quat[:, [1, 2, 3, 0]], scale * position, scale * error], axis=1))
        head = ("Rigid Body", _cell(body.name), f'"{body.identifier}"')
        labels += [(*head, "Rotation", axis) for axis in "XYZW"] + [(*head, "Position", axis) for axis in "XYZ"]
        labels.append((*head, "Mean Marker Error", ""))
    for body in recording.bodies:
        quality = np.where(body.tracked, 1.0, np.nan)[:, None]
        for k in range(len(_offsets(body))):
            fitted.append(np.concatenate([scale * _fitted(body)[:, k], quality], axis=1))
            head = ("Rigid Body Marker", f'"{body.name}:Marker{k + 1}"', f'"{body.identifier}"')
            labels += [(*head, "Position", axis) for axis in "XYZ"] + [(*head, "Marker Quality", "")]
    for body in recording.bodies:
        for k in range(len(_offsets(body))):
            seen.append(scale * markers[body.name][:, k])
            head = ("Marker", f'"{body.name}:Marker{k + 1}"', f'"{body.identifier[:-2]}{k + 1:02X}"')
            labels += [(*head, "Position", axis) for axis in "XYZ"]
    return labels, [*bodies, *fitted, *seen]


def row_tagged_lines(recording: Recording, markers: Mapping[str, Float]) -> Iterator[str]:
    """Lines of the row-tagged layout 1.1: definitions, then for each frame its row and the bodies' extended rows.

    Parameters as in `motive_columns_lines`; lengths are meters.
    """
    yield from (f'comment,"{text}"' for text in ("OptiTrack Export Data", "== synthetic trial"))
    yield "righthanded"
    yield "info,version,1.1"
    yield f"info,framecount,{recording.frame.size}"
    yield f"info,rigidbodycount,{len(recording.bodies)}"
    for number, body in enumerate(recording.bodies, start=1):
        offsets = _offsets(body)
        yield _row("rigidbody", f'"{body.name}"', number, len(offsets), offsets)
    poses = [pose_from_dual_quat(body.dual_quat_lab_body) for body in recording.bodies]
    fitted = [_fitted(body) for body in recording.bodies]
    ids = _marker_numbers(recording)
    since = [0] * len(recording.bodies)
    for index, (frame, time_s) in enumerate(zip(recording.frame.tolist(), recording.time_s.tolist(), strict=True)):
        yield _frame_row(recording, markers, poses, ids, index, frame, time_s)
        for number, body in enumerate(recording.bodies, start=1):
            k = number - 1
            since[k] = 0 if body.tracked[index] else since[k] + 1
            last = index - since[k]
            seen = markers[body.name][index]
            error = float(np.linalg.norm(seen - fitted[k][index], axis=1).mean()) if not since[k] else 0.0
            head = ("rigidbody", frame, time_s, f'"{body.name}"', number, since[k], len(seen))
            points = [cell for m, point in enumerate(fitted[k][last]) for cell in (*point.tolist(), ids[k][m])]
            flags = [int(not since[k])] * len(seen)
            yield _row(*head, points, seen, flags, [float(flag) for flag in flags], error)


def _marker_numbers(recording: Recording) -> list[list[int]]:
    numbers, following = [], 1
    for body in recording.bodies:
        count = len(_offsets(body))
        numbers.append(list(range(following, following + count)))
        following += count
    return numbers


def _frame_row(
    recording: Recording,
    markers: Mapping[str, Float],
    poses: list[tuple[Float, Float]],
    ids: list[list[int]],
    index: int,
    frame: int,
    time_s: float,
) -> str:
    tracked = [k for k, body in enumerate(recording.bodies) if body.tracked[index]]
    cells: list[Any] = []
    for k in tracked:
        quat, position = poses[k][0][index], poses[k][1][index]
        cells += [k + 1, position, quat[[1, 2, 3, 0]], _yaw_pitch_roll(quat)]
    seen: list[Any] = []
    for k in tracked:
        body = recording.bodies[k]
        for m, point in enumerate(markers[body.name][index]):
            seen += [point, ids[k][m], f"{body.name}-Marker {m + 1}"]
    count = sum(len(_offsets(recording.bodies[k])) for k in tracked)
    return _row("frame", frame, time_s, len(tracked), *cells, count, *seen)


def _yaw_pitch_roll(quat: Float) -> Float:
    """Angles of ``R = Rx(roll) Rz(pitch) Ry(yaw)`` in degrees, as layout 1.1 has them."""
    w, x, y, z = quat.tolist()
    pitch = np.arcsin(np.clip(2.0 * (w * z - x * y), -1.0, 1.0))
    yaw = np.arctan2(2.0 * (x * z + w * y), w * w + x * x - y * y - z * z)
    roll = np.arctan2(2.0 * (y * z + w * x), w * w - x * x + y * y - z * z)
    return np.array(np.degrees([yaw, pitch, roll]))


def _offsets(body: RigidBody) -> Float:
    if body.marker_offsets is None:
        msg = f"body {body.name!r} has no markers to write"
        raise ValueError(msg)
    return body.marker_offsets


def _fitted(body: RigidBody) -> Float:
    return transform_points(body.dual_quat_lab_body[:, None, :], _offsets(body))


def _row(*parts: Any) -> str:
    cells: list[str] = []
    for part in parts:
        for value in np.ravel(part).tolist() if isinstance(part, (np.ndarray, list)) else [part]:
            cells.append((_fixed(value, 8) or "NAN") if isinstance(value, float) else str(value))
    return ",".join(cells)


def _fixed(value: float, decimals: int) -> str:
    return "" if value != value else f"{value:.{decimals}f}"


def _cell(text: str) -> str:
    return '"' + text.replace('"', '""') + '"' if set(text) & set(',"\r\n') else text
