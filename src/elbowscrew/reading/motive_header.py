"""The header of Motive's column layout: what each column is, found by label and not by counting."""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from elbowscrew.errors import ElbowscrewError, NoBodiesError, RecordingError
from elbowscrew.reading.options import ASK_FOR_MARKERS, ReadOptions, nothing_wanted
from elbowscrew.reading.source import TextSource

_HEADER_LINES: Final = 25
_BONES_TOLD: Final = 24
_LAST_NUMBER: Final = re.compile(r"(?<!\d)\d{1,9}$", re.ASCII)


@dataclass(frozen=True, slots=True, kw_only=True)
class ColumnKey:
    """What the header says of one column."""

    index: int
    kind: str
    name: str
    identifier: str
    field: str
    axis: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Header:
    """The header: the pairs of line 1, a key for every column, its lines, and whether its rows are equally long.

    They are, padding of spreadsheets included, unless somebody cut them; then lines have just as many cells.
    """

    pairs: dict[str, str]
    columns: tuple[ColumnKey, ...]
    lines: int
    whole: bool

    @property
    def width(self) -> int:
        """Cells of a whole line."""
        return len(self.columns)

    @property
    def version(self) -> str:
        """The number of the export format; a spreadsheet may have made its point a comma."""
        return self.pairs.get("Format Version", "").replace(",", ".")


@dataclass(frozen=True, slots=True, kw_only=True)
class BodyColumns:
    """Where one rigid body, or a bone, stands: its columns by label, and the X, Y, Z of its markers by number.

    The fitted ones are the Rigid Body Marker columns, the seen ones the Marker columns that bear the body's name.
    """

    name: str
    identifier: str
    rotation: dict[str, int]
    position: dict[str, int]
    error: int | None
    fitted: dict[int, tuple[int, ...]]
    seen: dict[int, tuple[int, ...]]
    bone: bool = False


def parse_header(source: TextSource) -> Header:
    """Find the header's rows by what they hold, not by counting: exports and spreadsheets insert and pad lines.

    The axis row is the first whose first cell is `Frame`; the field row stands above it; the rows before that hold
    types, names, ids and perhaps parents, in this order or as tagged in their second cell.
    """
    rows = [_cells(source, number, line) for number, line in enumerate(source.head(_HEADER_LINES), start=1)]
    lines = [number for number, row in enumerate(rows, start=1) if any(row)]
    rows = [row for row in rows if any(row)]
    axis_row = next((k for k, row in enumerate(rows) if row[0].casefold() == "frame"), None)
    if axis_row is None or axis_row < 2:
        msg = (
            f"{source.path}: the header is cut: no row begins with 'Frame' in the first {_HEADER_LINES} lines; "
            "export the take again"
        )
        raise RecordingError(msg)
    cells = iter(rows[0])
    pairs: dict[str, str] = {}
    for key in cells:
        if not key:
            break
        pairs[key] = next(cells, "")
    labels = _label_rows(source, rows, axis_row, lines[axis_row])
    axes, fields = rows[axis_row], rows[axis_row - 1]
    width = max(_trimmed_width(axes), _trimmed_width(fields))
    columns = tuple(
        ColumnKey(
            index=k,
            kind=_cell(labels["type"], k),
            name=_cell(labels["name"], k),
            identifier=_cell(labels["id"], k),
            field=_cell(fields, k).casefold(),
            axis=_cell(axes, k).upper(),
        )
        for k in range(width)
    )
    nameless = next((c for c in columns[2:] if c.field == "rotation" and not (c.kind and c.name)), None)
    if nameless is not None:
        msg = (
            f"{source.path}:{lines[axis_row]}: the header is cut: column {nameless.index + 1} ({nameless.field}) is "
            "without type or name; export the take again"
        )
        raise RecordingError(msg)
    whole = len({len(row) for row in (axes, fields, *labels.values()) if row}) == 1
    padded = len(axes) if whole else width
    columns += tuple(_blank_column(k) for k in range(width, padded))
    return Header(pairs=pairs, columns=columns, lines=lines[axis_row], whole=whole)


def _blank_column(index: int) -> ColumnKey:
    return ColumnKey(index=index, kind="", name="", identifier="", field="", axis="")


def _cells(source: TextSource, number: int, line: str) -> list[str]:
    try:
        return source.cells(line)
    except csv.Error as error:
        msg = f"{source.path}:{number}: not a line of a CSV file: {error}"
        raise RecordingError(msg) from error


def _trimmed_width(row: Sequence[str]) -> int:
    """Count the columns up to the last that has a label; spreadsheets pad the rest."""
    return max((k + 1 for k, cell in enumerate(row) if cell.strip()), default=0)


def _cell(row: Sequence[str], k: int) -> str:
    return row[k].strip() if k < len(row) else ""


def _label_rows(source: TextSource, rows: list[list[str]], axis_row: int, line: int) -> dict[str, list[str]]:
    candidates = [row for row in rows[1 : axis_row - 1] if any(cell.strip() for cell in row[1:])]
    tagged = {row[1].strip().casefold(): row for row in candidates if row[1].strip()}
    if "type" in tagged:
        return {key: tagged.get(key, []) for key in ("type", "name", "id")}
    if len(candidates) < 3:
        msg = (
            f"{source.path}:{line}: the header is cut: expected rows of types, names and ids above the axis "
            f"row, found {len(candidates)}; export the take again"
        )
        raise RecordingError(msg)
    return dict(zip(("type", "name", "id"), candidates, strict=False))


def body_columns(source: TextSource, header: Header, options: ReadOptions) -> tuple[BodyColumns, ...]:
    """Group the columns of the rigid bodies by id and name, taking every column by its label; bones asked for follow.

    Raises
    ------
    RecordingError
        If a body is not whole, or bones asked for are told in the frames of others.
    """
    groups = _grouped(header, "rigid body")
    names = {name for _, name in groups}
    bones = {key: one for key, one in _grouped(header, "bone").items() if options.wants_bone(key[1])}
    bones = {key: one for key, one in bones.items() if key[1] not in names}
    if bones and header.pairs.get("Coordinate Space", "").casefold() == "local":
        msg = (
            f"{source.path}: bones in local coordinates are told in the frames of their parents; export the take with "
            "Coordinate Space 'Global'"
        )
        raise RecordingError(msg)
    bodies = []
    for (identifier, name), columns in (groups | bones).items():
        bone = (identifier, name) in bones
        rotation = _labeled(source, columns, "rotation", name)
        position = _labeled(source, columns, "position", name)
        if set(position) != set("XYZ") or set(rotation) not in (set("XYZ"), set("XYZW")):
            msg = (
                f"{source.path}:{header.lines}: body {name!r}: expected rotation X, Y, Z (W) and position X, Y, Z, "
                f"found rotation {', '.join(rotation) or 'none'} and position {', '.join(position) or 'none'}; "
                "export the take again"
            )
            raise RecordingError(msg)
        bodies.append(
            BodyColumns(
                name=name,
                identifier=identifier,
                rotation=rotation,
                position=position,
                error=next((column.index for column in columns if "error" in column.field), None),
                fitted={} if bone else _marker_columns(header.columns, "rigid body marker", identifier=identifier),
                seen={} if bone else _marker_columns(header.columns, "marker", body=name),
                bone=bone,
            )
        )
    return tuple(bodies)


def bone_names(header: Header) -> tuple[str, ...]:
    """Names of all bones of skeletons."""
    return tuple(name for _, name in _grouped(header, "bone"))


def no_bodies(source: TextSource, header: Header, options: ReadOptions, markers: Sequence[str]) -> ElbowscrewError:
    """Say that a file has no rigid bodies, nor what was asked for in their place, and what it has, markers included."""
    if options.markers and markers:
        return nothing_wanted(source.path, "no rigid bodies in the file", markers, options)
    kinds = sorted({column.kind for column in header.columns[2:] if column.kind})
    found = ", ".join(kinds) if kinds else "no data columns at all"
    bones = bone_names(header)
    others = [ASK_FOR_MARKERS] if markers else []
    if bones:
        told = f"{', '.join(map(repr, bones[:_BONES_TOLD]))}{' and others' if len(bones) > _BONES_TOLD else ''}"
        others.append(f"name two bones of the skeleton by --proximal and --distal ({told})")
    return NoBodiesError(
        f"{source.path}: no rigid bodies in the file (found: {found}); in Motive, solve the bodies and tick "
        f"'Rigid Bodies' in the export{''.join(f', or {other}' for other in others)}"
    )


def _grouped(header: Header, kind: str) -> dict[tuple[str, str], list[ColumnKey]]:
    """Columns of one kind by id and name."""
    groups: dict[tuple[str, str], list[ColumnKey]] = {}
    for column in header.columns:
        if column.kind.casefold() == kind:
            groups.setdefault((column.identifier, column.name), []).append(column)
    return groups


def marker_columns(header: Header, options: ReadOptions | None = None) -> dict[str, tuple[int, ...]]:
    """X, Y and Z columns of the markers asked for, else of all; markers of one name have their id behind it."""
    grouped: dict[tuple[str, str], dict[str, int]] = {}
    for column in header.columns:
        if column.kind.casefold() == "marker" and column.field == "position":
            grouped.setdefault((column.name, column.identifier), {})[column.axis] = column.index
    names = Counter(name for name, _ in grouped)
    found = {}
    for (name, identifier), axes in grouped.items():
        shown = name if names[name] == 1 else f"{name} ({identifier})"
        wanted = options is None or options.wants(name) or options.wants(shown)
        if wanted and {"X", "Y", "Z"} <= set(axes):
            found[shown] = tuple(axes[axis] for axis in "XYZ")
    return found


def _marker_columns(
    columns: tuple[ColumnKey, ...], kind: str, *, identifier: str | None = None, body: str | None = None
) -> dict[int, tuple[int, ...]]:
    """X, Y and Z columns of a body's markers, by the number their names end in; none if the numbers are not clear.

    Fitted markers bear the body's identifier, seen ones its name.
    """
    by_name: dict[str, dict[str, int]] = {}
    for column in columns:
        if column.kind.casefold() != kind or column.field != "position":
            continue
        if column.identifier == identifier if body is None else _is_marker_of(body, column.name):
            by_name.setdefault(column.name, {})[column.axis] = column.index
    numbered = {
        int(number[0]): tuple(axes[axis] for axis in "XYZ")
        for name, axes in by_name.items()
        if (number := _LAST_NUMBER.search(name)) and {"X", "Y", "Z"} <= set(axes)
    }
    return numbered if len(numbered) == len(by_name) else {}


def _is_marker_of(body: str, marker: str) -> bool:
    rest = marker.removeprefix(body)
    return rest != marker and re.fullmatch(r"[:_\- ]\s*Marker\s*\d+", rest) is not None


def _labeled(source: TextSource, columns: list[ColumnKey], field: str, body: str) -> dict[str, int]:
    by_name: dict[str, int] = {}
    for column in columns:
        if column.field == field:
            if column.axis in by_name:
                msg = (
                    f"{source.path}: body {body!r} appears twice in the file with the same id (columns "
                    f"{by_name[column.axis] + 1} and {column.index + 1}); export the take again"
                )
                raise RecordingError(msg)
            by_name[column.axis] = column.index
    return by_name
