"""Motive's column layout: a header (`motive_header`), then one line a frame."""

from __future__ import annotations

from typing import Final

import numpy as np

from elbowscrew.errors import Missing, MissingStatementError, RecordingError, SettingError
from elbowscrew.geometry import quaternion
from elbowscrew.model import QualityWarning, Recording, Source
from elbowscrew.quantities import METERS
from elbowscrew.reading.builders import ArrayBuilder, MarkerBuilder
from elbowscrew.reading.cells import read_blocks
from elbowscrew.reading.clock import check_frames, cut_warnings, rate_and_times
from elbowscrew.reading.cluster_shapes import swap_warnings
from elbowscrew.reading.motive_bodies import MotiveBody, sample_bodies
from elbowscrew.reading.motive_header import (
    BodyColumns,
    Header,
    body_columns,
    bone_names,
    marker_columns,
    no_bodies,
    parse_header,
)
from elbowscrew.reading.options import ReadOptions, stated_unit
from elbowscrew.reading.source import TextSource

_KNOWN_VERSIONS: Final = ("1.1", "1.2", "1.21", "1.22", "1.23", "1.24", "1.25")


def recognizes(cells: list[str]) -> bool:
    """Tell by the first cell."""
    return cells[0] == "format version"


def read(source: TextSource, options: ReadOptions) -> Recording:
    """Read a file of the column layout; see `elbowscrew.reading.registry.read_recording`."""
    header = parse_header(source)
    all_markers, wanted = marker_columns(header), marker_columns(header, options)
    bodies = body_columns(source, header, options)
    if not bodies and not wanted:
        raise no_bodies(source, header, options, list(all_markers))
    unit, order = _stated(source, header, bodies, options)
    samples = sample_bodies(source, header, bodies, METERS[unit], order)
    builders = [MotiveBody(body, METERS[unit], order, sample) for body, sample in zip(bodies, samples, strict=True)]
    columns = sorted({0, 1}.union(*(builder.columns for builder in builders), *wanted.values()))
    index = {column: k for k, column in enumerate(columns)}
    frames, times = ArrayBuilder(dtype=np.int64), ArrayBuilder()
    markers = {name: MarkerBuilder(name) for name in wanted}
    line = header.lines
    for block in read_blocks(source, header.lines, columns, header.width, exact=header.whole):
        check_frames(source, line, block)
        frames.append(block[:, 0].astype(np.int64))
        times.append(block[:, 1])
        for name, triple in wanted.items():
            markers[name].append(METERS[unit] * block[:, [index[k] for k in triple]])
        for builder in builders:
            builder.append(block, columns)
        line += len(block)
    frame, time_s = frames.finish(), times.finish()
    if frame.size == 0:
        msg = f"{source.path}:{header.lines + 1}: no frame follows the header; export the take again"
        raise RecordingError(msg)
    stated_rate = header.pairs.get("Export Frame Rate") or header.pairs.get("Capture Frame Rate") or ""
    rate, time_s, warnings = rate_and_times(source.path, stated_rate, frame, time_s)
    for builder in builders:
        warnings += builder.warnings(header.version)
    for marker in markers.values():
        warnings += marker.warnings()
    warnings += swap_warnings([one for builder in builders if (one := builder.cluster_mismatch) is not None], frame)
    return Recording(
        bodies=tuple(builder.finish() for builder in builders),
        frame=frame,
        time_s=time_s,
        rate_hz=rate,
        markers=tuple(marker.finish() for marker in markers.values()),
        source=Source(
            path=str(source.path),
            sha256=source.sha256,
            layout=f"Motive columns {header.version}",
            take_name=header.pairs.get("Take Name", ""),
            length_unit=unit,
            rotation_type=order,
            metadata=header.pairs,
            markers=tuple(all_markers),
            bones=bone_names(header),
        ),
        warnings=(*warnings, *_file_warnings(source, header, frame.size)),
    )


def _stated(
    source: TextSource, header: Header, bodies: tuple[BodyColumns, ...], options: ReadOptions
) -> tuple[str, str]:
    """Give the unit of length and the rotation type; where both are missing, ask for both at once."""
    text = header.pairs.get("Length Units", "")
    try:
        unit = stated_unit(source.path, text, options)
    except MissingStatementError as no_unit:
        try:
            _rotation_type(source, header, bodies, options.rotation)
        except MissingStatementError as no_order:
            raise MissingStatementError.of(source.path, *no_unit.missing, *no_order.missing) from no_order
        raise
    return unit, _rotation_type(source, header, bodies, options.rotation)


def _rotation_type(source: TextSource, header: Header, bodies: tuple[BodyColumns, ...], rotation: str | None) -> str:
    """Return "quaternion" or an Euler order, empty without bodies; the labels tell which of the two it is."""
    if not bodies:
        return ""
    if all("W" in body.rotation for body in bodies):
        if rotation not in (None, "quaternion"):
            msg = f"--rotation {rotation}: the file has quaternions (its columns are labeled X, Y, Z, W)"
            raise SettingError(msg)
        return "quaternion"
    stated = header.pairs.get("Rotation Type", "").upper()
    given = (rotation or "").upper()
    order = stated or given
    written = {"".join(sorted(body.rotation, key=lambda axis: body.rotation[axis])) for body in bodies}
    if order in quaternion.EULER_ORDERS and written != {order}:
        msg = (
            f"{source.path}: the rotation columns stand in the order {', '.join(sorted(written))}, which {order} "
            "contradicts: Motive writes them in the order of the rotation type; export the take again"
        )
        raise RecordingError(msg) if stated else SettingError(msg)
    if not order:
        give = f"--rotation {', '.join(quaternion.EULER_ORDERS)}"
        missing = Missing("rotation", "does not state the order of its Euler angles", give)
        raise MissingStatementError.of(source.path, missing)
    if given and given != order:
        msg = f"rotation: the file states {stated} itself, which {rotation!r} contradicts; leave --rotation out"
        raise SettingError(msg)
    if order not in quaternion.EULER_ORDERS or any("W" in body.rotation for body in bodies):
        if not stated:
            msg = f"rotation: expected one of {', '.join(quaternion.EULER_ORDERS)} for this file, found {rotation!r}"
            raise SettingError(msg)
        msg = f"{source.path}:1: Rotation Type {stated!r} does not fit the rotation columns X, Y, Z"
        raise RecordingError(msg)
    return order


def _file_warnings(source: TextSource, header: Header, rows: int) -> list[QualityWarning]:
    stated = header.pairs.get("Total Exported Frames") or header.pairs.get("Total Frames") or ""
    warnings = cut_warnings(source, stated, rows)
    if header.version not in _KNOWN_VERSIONS:
        message = f"format version {header.version!r} is not known; read as {_KNOWN_VERSIONS[-1]}"
        warnings.append(QualityWarning(code="unknown-version", message=message))
    return warnings
