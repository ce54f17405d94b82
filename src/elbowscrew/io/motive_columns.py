"""Motive's column layout: a header (`motive_header`), then one line a frame."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew.errors import RecordingError, SettingError, UsageError
from elbowscrew.geometry import quaternion
from elbowscrew.geometry.dual_quaternion import conjugate, transform_points
from elbowscrew.io.cells import read_columns
from elbowscrew.io.motive_header import BodyColumns, Header, body_columns, parse_header
from elbowscrew.io.source import TextSource
from elbowscrew.model import QualityWarning, Recording, RigidBody, Source
from elbowscrew.tables import METERS

Float = NDArray[np.float64]

_UNIT_NAMES: Final = {"meters": "m", "centimeters": "cm", "millimeters": "mm"}
_KNOWN_VERSIONS: Final = ("1.2", "1.21", "1.22", "1.23", "1.24", "1.25")
_MIRRORED_VERSION: Final = "1.1"
_OFFSET_ROWS: Final = 1024
_OFFSET_TOLERANCE_M: Final = 1e-3


def read(source: TextSource, units: str | None, rotation: str | None) -> Recording:
    """Read a file of the column layout; see `elbowscrew.io.reading.read_recording`."""
    header = parse_header(source)
    if header.version == _MIRRORED_VERSION:
        msg = (
            f"{source.path}:1: format version 1.1 writes rigid bodies mirrored in z, which is not read yet; "
            "export the take again with a newer Motive"
        )
        raise RecordingError(msg)
    bodies = body_columns(source, header)
    unit = _length_unit(source, header, units)
    order = _rotation_type(source, header, bodies, rotation)
    columns = sorted({k for body in bodies for k in (*body.rotation.values(), *body.position.values())})
    width = len(header.columns)
    data = read_columns(source, header.lines, [0, 1, *columns], width)
    if data.shape[0] == 0:
        msg = f"{source.path}:{header.lines + 1}: no frame follows the header; export the take again"
        raise RecordingError(msg)
    frame, time_s = _frames(source, header, data)
    place = {column: k + 2 for k, column in enumerate(columns)}
    scale = METERS[unit]
    warnings: list[QualityWarning] = []
    rigid_bodies = []
    for body in bodies:
        cells = {label: data[:, place[k]] for label, k in body.rotation.items()}
        position = scale * np.stack([data[:, place[body.position[axis]]] for axis in "XYZ"], axis=1)
        rigid = RigidBody.from_quaternions(body.name, _quaternions(cells, order), position, identifier=body.identifier)
        warnings += _partly_blank(body, data[:, [place[k] for k in (*body.rotation.values(), *body.position.values())]])
        offsets = _marker_offsets(source, header, body, rigid, scale)
        rigid_bodies.append(replace(rigid, marker_offsets=offsets))
    rate, rate_warnings = _rate(source, header, frame, time_s)
    warnings += rate_warnings + _file_warnings(source, header)
    return Recording(
        bodies=tuple(rigid_bodies),
        frame=frame,
        time_s=time_s,
        rate_hz=rate,
        source=Source(
            path=str(source.path),
            sha256=source.sha256,
            layout=f"Motive columns {header.version}",
            take_name=header.pairs.get("Take Name", ""),
            length_unit=unit,
            rotation_type=order,
            metadata=header.pairs,
        ),
        warnings=tuple(warnings),
    )


def _length_unit(source: TextSource, header: Header, units: str | None) -> str:
    stated = header.pairs.get("Length Units", "")
    if not stated:
        if units is None:
            msg = f"{source.path}:1: the file does not state its unit of length; give --units m, cm or mm"
            raise SettingError(msg)
        return units
    unit = _UNIT_NAMES.get(stated.casefold())
    if unit is None:
        msg = f"{source.path}:1: Length Units: expected {', '.join(_UNIT_NAMES)}, found {stated!r}"
        raise RecordingError(msg)
    if units is not None and units != unit:
        msg = f"units: the file states {stated} itself, which {units!r} contradicts; leave --units out"
        raise UsageError(msg)
    return unit


def _rotation_type(source: TextSource, header: Header, bodies: tuple[BodyColumns, ...], rotation: str | None) -> str:
    """Return "quaternion" or an Euler order; the labels have the last word on which of the two it is."""
    if all("W" in body.rotation for body in bodies):
        return "quaternion"
    stated = header.pairs.get("Rotation Type", "").upper()
    given = (rotation or "").upper()
    order = stated or given
    if not order:
        msg = (
            f"{source.path}:1: the file does not state the order of its Euler angles; give --rotation "
            f"{', '.join(quaternion.EULER_ORDERS)}"
        )
        raise SettingError(msg)
    if given and given != order:
        msg = f"rotation: the file states {stated} itself, which {rotation!r} contradicts; leave --rotation out"
        raise UsageError(msg)
    if order not in quaternion.EULER_ORDERS or any("W" in body.rotation for body in bodies):
        if not stated:
            msg = f"rotation: expected one of {', '.join(quaternion.EULER_ORDERS)} for this file, found {rotation!r}"
            raise UsageError(msg)
        msg = f"{source.path}:1: Rotation Type {stated!r} does not fit the rotation columns X, Y, Z"
        raise RecordingError(msg)
    return order


def _quaternions(cells: dict[str, Float], order: str) -> Float:
    """Scalar first, from columns taken by their label: Motive writes X, Y, Z, W, or angles in degrees."""
    if order == "quaternion":
        return np.stack([cells[label] for label in "WXYZ"], axis=1)
    return quaternion.quat_from_euler_angles(np.radians(np.stack([cells[label] for label in order], axis=1)), order)


def _frames(source: TextSource, header: Header, data: Float) -> tuple[NDArray[np.int64], Float]:
    frame, time_s = data[:, 0], data[:, 1]
    bad = ~(np.isfinite(frame) & np.isfinite(time_s)) | (np.nan_to_num(frame) % 1.0 != 0.0)
    if bad.any():
        row = int(np.flatnonzero(bad)[0])
        msg = (
            f"{source.path}: row {row + 1} after the header: expected a whole frame number and a time, found "
            f"{frame[row]:g} and {time_s[row]:g} (nan is a blank cell)"
        )
        raise RecordingError(msg)
    return frame.astype(np.int64), time_s


def _partly_blank(body: BodyColumns, cells: Float) -> list[QualityWarning]:
    known = np.isfinite(cells)
    count = int((known.any(axis=1) & ~known.all(axis=1)).sum())
    if not count:
        return []
    message = f"body {body.name!r} has some but not all cells of its pose in {count} frames: taken as lost tracking"
    return [QualityWarning(code="partly-blank", message=message)]


def _marker_offsets(
    source: TextSource, header: Header, body: BodyColumns, rigid: RigidBody, scale: float
) -> Float | None:
    """Return the body's markers in its own frame, from the first frames; None if they are not at rest in it.

    In Coordinate Space `Local` the Rigid Body Marker columns are these offsets themselves.
    """
    if not body.markers:
        return None
    columns = [k for triple in body.markers for k in triple]
    cells = scale * read_columns(source, header.lines, columns, len(header.columns), max_rows=_OFFSET_ROWS)
    seen = cells.reshape(len(cells), -1, 3)
    if header.pairs.get("Coordinate Space", "").casefold() != "local":
        seen = transform_points(conjugate(rigid.dual_quat_lab_body[: len(seen), None, :]), seen)
    whole = np.isfinite(seen).all(axis=(1, 2))
    if not whole.any():
        return None
    offsets: Float = np.median(seen[whole], axis=0)
    spread = np.median(np.abs(seen[whole] - offsets), axis=0)
    return offsets if (spread < _OFFSET_TOLERANCE_M).all() else None


def _rate(
    source: TextSource, header: Header, frame: NDArray[np.int64], time_s: Float
) -> tuple[float, list[QualityWarning]]:
    stated = header.pairs.get("Export Frame Rate") or header.pairs.get("Capture Frame Rate") or ""
    try:
        rate = float(stated)
    except ValueError:
        rate = float("nan")
    span = time_s[-1] - time_s[0]
    counted = (frame[-1] - frame[0]) / span if span > 0.0 else float("nan")
    if not (np.isfinite(rate) and rate > 0.0):
        if not (np.isfinite(counted) and counted > 0.0):
            msg = f"{source.path}: neither the header nor the times give a frame rate; export the take again"
            raise RecordingError(msg)
        return float(counted), []
    # A time rounded to milliseconds at either end is no disagreement.
    if np.isfinite(counted) and abs(counted - rate) > rate * (0.01 + 2e-3 / span):
        message = f"the header states {rate:g} frames a second, the time column gives {counted:.4g}"
        return rate, [QualityWarning(code="frame-rate", message=message)]
    return rate, []


def _file_warnings(source: TextSource, header: Header) -> list[QualityWarning]:
    warnings = []
    if header.version not in _KNOWN_VERSIONS:
        message = f"format version {header.version!r} is not known; read as {_KNOWN_VERSIONS[-1]}"
        warnings.append(QualityWarning(code="unknown-version", message=message))
    if not source.ends_with_newline:
        message = "the last line has no line end: the file may have been cut, and with it the last number"
        warnings.append(QualityWarning(code="no-final-newline", message=message))
    return warnings
