"""C3D files, through ezc3d (the extra ``[c3d]``): markers, and the poses of the ROTATION block where there is one."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowscrew.errors import RecordingError, SettingError
from elbowscrew.io.clock import is_rate
from elbowscrew.io.options import ReadOptions
from elbowscrew.model import Marker, Recording, RigidBody, Source
from elbowscrew.tables import METERS

Float = NDArray[np.float64]


def recognizes(head: bytes) -> bool:
    """Tell by the second byte, which is 0x50 in every C3D file, and a first that is no printable character."""
    return len(head) >= 2 and head[1] == 0x50 and head[0] < 0x20


def read(path: Path, options: ReadOptions) -> Recording:
    """Read a C3D file; see `elbowscrew.io.reading.read_recording`."""
    try:
        import ezc3d
    except ImportError as error:
        msg = f"{path}: a C3D file needs ezc3d; install it with: pip install 'elbowscrew[c3d]'"
        raise RecordingError(msg) from error
    try:
        content: Any = ezc3d.c3d(str(path))
        with path.open("rb") as stream:
            digest = hashlib.file_digest(stream, "sha256").hexdigest()
    except (OSError, RuntimeError, ValueError, IndexError, KeyError) as error:
        msg = f"{path}: not a C3D file that can be read: {error}"
        raise RecordingError(msg) from error
    point = content["parameters"]["POINT"]
    unit = _unit(path, str((_value(point, "UNITS") or [""])[0]), options)
    rate = float((_value(point, "RATE") or [0.0])[0])
    if not is_rate(rate):
        msg = f"{path}: POINT:RATE is {rate:g}, no possible frame rate"
        raise RecordingError(msg)
    bodies = _bodies(content, METERS[unit])
    markers = _markers(content, METERS[unit], options)
    if not bodies and not markers:
        names = ", ".join(_labels(point)[:8]) or "none"
        msg = f"{path}: no rotations in the file (markers: {names}): give --arm-markers and --forearm-markers"
        raise SettingError(msg)
    first = int(content["header"]["points"]["first_frame"])
    count = bodies[0].loss.size if bodies else len(markers[0].position)
    frame = np.arange(first, first + count, dtype=np.int64)
    return Recording(
        bodies=tuple(bodies),
        frame=frame,
        time_s=(frame - first) / rate,
        rate_hz=rate,
        markers=tuple(markers),
        source=Source(
            path=str(path),
            sha256=digest,
            layout="C3D",
            length_unit=unit,
            rotation_type="matrix" if bodies else "",
        ),
    )


def _value(group: Any, name: str) -> list[Any]:
    return list(group[name]["value"]) if name in group else []


def _labels(group: Any) -> list[str]:
    """LABELS, LABELS2, ...: a parameter holds 255 of them at the most."""
    labels = [str(label).strip() for label in _value(group, "LABELS")]
    more = 2
    while f"LABELS{more}" in group:
        labels += [str(label).strip() for label in _value(group, f"LABELS{more}")]
        more += 1
    return labels


def _unit(path: Path, stated: str, options: ReadOptions) -> str:
    unit = stated.strip().casefold()
    if unit and unit not in METERS:
        msg = f"{path}: POINT:UNITS: expected {', '.join(METERS)}, found {stated!r}"
        raise RecordingError(msg)
    if unit and options.units not in (None, unit):
        msg = f"--units {options.units}: the file states {unit} itself; leave --units out"
        raise SettingError(msg)
    if not unit and options.units is None:
        msg = f"{path}: the file does not state its unit of length; give --units m, cm or mm"
        raise SettingError(msg)
    return unit or str(options.units)


def _markers(content: Any, scale: float, options: ReadOptions) -> list[Marker]:
    points = np.asarray(content["data"]["points"], dtype=np.float64)
    residual = np.asarray(content["data"]["meta_points"]["residuals"], dtype=np.float64)
    found = []
    for k, name in enumerate(_labels(content["parameters"]["POINT"])[: points.shape[1]]):
        if options.wants(name):
            position = scale * points[:3, k].T
            # A negative residual says: not seen.
            seen = (residual[0, k] >= 0.0)[:, None] if residual.size else np.ones((len(position), 1), dtype=np.bool_)
            found.append(Marker(name=name, position=np.where(seen, position, np.nan)))
    return found


def _bodies(content: Any, scale: float) -> list[RigidBody]:
    rotations = np.asarray(content["data"].get("rotations", np.empty((4, 4, 0, 0))), dtype=np.float64)
    if not rotations.size:
        return []
    labels = _labels(content["parameters"]["ROTATION"])
    ratio = max(1, int((_value(content["parameters"]["ROTATION"], "RATIO") or [1])[0]))
    rotations = rotations[..., ::ratio]  # rotations may be written more often than points; the points give the clock
    bodies = []
    for k in range(rotations.shape[2]):
        matrix = np.moveaxis(rotations[:, :, k], -1, 0)
        name = labels[k] if k < len(labels) else f"rotation {k + 1}"
        solved = np.isfinite(matrix).all(axis=(1, 2)) & (np.abs(matrix[:, :3, :3]).max(axis=(1, 2)) > 0.0)
        matrix = np.where(solved[:, None, None], matrix, np.nan)
        bodies.append(RigidBody.from_matrices(name, matrix[:, :3, :3], scale * matrix[:, :3, 3]))
    return bodies
