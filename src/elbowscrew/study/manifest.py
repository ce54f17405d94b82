"""Manifests: a CSV with one row a trial, its path, what is known of it, and settings of its own."""

from __future__ import annotations

import csv
import difflib
import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Final

from elbowscrew.configuring import settings_from
from elbowscrew.declaring import option_name
from elbowscrew.errors import UsageError, unreadable
from elbowscrew.opening import read_text
from elbowscrew.reading.source import first_bytes
from elbowscrew.settings import FILES, LISTS, Settings
from elbowscrew.study.trial import Trial
from elbowscrew.study_columns import STUDY_COLUMNS, study_header

_HEAD_BYTES: Final = 65536
_MOST_FAULTS: Final = 5
_SETTINGS: Final = frozenset(option_name(name) for name in Settings.model_fields)
_OURS: Final = frozenset({"path", "path-distal", "name", "landmarks"})
_BLANKS: Final = re.compile(r"[\s_]+")


def is_manifest(path: Path) -> bool:
    """Tell a manifest by its first line: a table with a column ``path``."""
    if path.suffix.casefold() not in (".csv", ".tsv", ".txt"):
        return False
    head = first_bytes(path, _HEAD_BYTES)
    if b"\0" in head:
        return False
    first = next(iter(head.decode("utf-8-sig", "replace").splitlines()), "")
    return "path" in [cell.casefold() for cell in _split(first, _delimiter(first))]


def read_manifest(path: Path) -> list[Trial]:
    """Read a manifest; ``docs/reference/batch.md`` says how it looks.

    Parameters
    ----------
    path : Path
        A CSV with commas, semicolons or tabs. Paths in it are relative to its own folder.

    Returns
    -------
    list of Trial

    Raises
    ------
    UsageError
        If it cannot be read, or a cell does not fit; it names line and column, and up to five faults together.
    """
    header, rows, delimiter = _read(path)
    keys = _columns(path, header)
    faults: list[str] = []
    found: list[Trial] = []
    seen: dict[tuple[str, str], int] = {}
    for line, cells in rows:
        if len(cells) != len(header):
            faults.append(f"{path}:{line}: expected {len(header)} cells as in the header, found {len(cells)}")
            continue
        values = dict(zip(keys, cells, strict=True))
        given, distal = _slashes(values["path"]), _slashes(values.get("path-distal", ""))
        if not given:
            faults.append(f"{path}:{line}: column 'path': the cell is empty; expected the path of a recording")
            continue
        identity = (given, values.get("name", ""))
        if identity in seen:
            faults.append(
                f"{path}:{line}: column 'path': {given!r} stands in line {seen[identity]}, too; "
                "to analyze it twice, tell the two apart in a column 'name'"
            )
            continue
        seen[identity] = line
        settings = {}
        for column, key in zip(header, keys, strict=True):
            if key in _SETTINGS and values[key]:
                value = str(path.parent / values[key]) if key in FILES else _value(key, values[key], delimiter)
                fault = _fault({key: value})
                if fault:
                    faults.append(f"{path}:{line}: column {column!r}: {fault}")
                else:
                    settings[key] = value
        fault = _fault(settings)
        if fault:
            faults.append(f"{path}:{line}: {fault}")
        marks = values.get("landmarks", "")
        found.append(
            Trial(
                path=_absolute(path, given),
                distal_path=_absolute(path, distal) if distal else None,
                label=Path(given).as_posix(),
                columns={
                    column: text
                    for column, key, text in zip(header, keys, cells, strict=True)
                    if key not in ("path", "name")
                },
                settings=settings,
                landmarks=path.parent / marks if marks else None,
                name=values.get("name", ""),
                by_file=Path(given).is_absolute(),
                location=f"{path}:{line}",
            )
        )
    if faults:
        more = f"; and {len(faults) - _MOST_FAULTS} more" if len(faults) > _MOST_FAULTS else ""
        raise UsageError("; ".join(faults[:_MOST_FAULTS]) + more)
    if not found:
        msg = f"{path}: the manifest has no rows; expected one row a trial"
        raise UsageError(msg)
    return found


def _slashes(text: str) -> str:
    return text.replace("\\", "/") if os.name == "nt" else text


def _absolute(manifest: Path, given: str) -> Path:
    return Path(os.path.abspath(manifest.parent / given))  # noqa: PTH100 - keeps links


def _read(path: Path) -> tuple[list[str], list[tuple[int, list[str]]], str]:
    try:
        text = read_text(path, encoding="utf-8-sig")
    except OSError as error:
        raise unreadable(path, "a manifest", error) from error
    except UnicodeDecodeError as error:
        msg = f"{path}: not UTF-8 text; save the manifest as CSV in UTF-8"
        raise UsageError(msg) from error
    if "\0" in text:
        line = text[: text.index("\0")].count("\n") + 1
        msg = f"{path}:{line}: a NUL character; save the manifest as CSV in UTF-8"
        raise UsageError(msg)
    delimiter = _delimiter(next(iter(text.splitlines()), ""))
    try:
        reader = csv.reader(text.splitlines(keepends=True), delimiter=delimiter, strict=True)
        rows = [(reader.line_num, [cell.strip() for cell in row]) for row in reader if any(map(str.strip, row))]
    except csv.Error as error:
        msg = f"{path}: not a CSV: {error}; check its quotes"
        raise UsageError(msg) from error
    header = rows[0][1]
    while header and not header[-1] and all(len(row) < len(header) or not row[-1] for _, row in rows):
        header = header[:-1]  # a spreadsheet leaves empty columns at the end
        rows = [(line, row[: len(header)]) for line, row in rows]
    return header, rows[1:], delimiter


def _columns(path: Path, header: list[str]) -> list[str]:
    """Give each column's key, and refuse names that are none, come twice, or nearly name a setting."""
    keys = [_key(name) for name in header]
    ours = set(study_header("deg", "mm")) | set(study_header("rad", "m")) | {column.name for column in STUDY_COLUMNS}
    for k, (name, key) in enumerate(zip(header, keys, strict=True), 1):
        if not name:
            msg = f"{path}:1: column {k} has no name; give it one, or remove it"
            raise UsageError(msg)
        if keys.count(key) > 1:
            msg = f"{path}:1: column {name!r} appears twice; keep one"
            raise UsageError(msg)
        if key in _OURS or key in _SETTINGS:
            continue
        close = difflib.get_close_matches(_spelled(name), _SETTINGS | _OURS, n=1, cutoff=0.85)
        if close:
            msg = f"{path}:1: column {name!r}: did you mean the setting {close[0]!r}? If not, give it another name"
            raise UsageError(msg)
        if name in ours:
            msg = f"{path}:1: column {name!r} is one of summary.csv already; give it another name"
            raise UsageError(msg)
    return keys


def _key(name: str) -> str:
    key = _spelled(name)
    return key if key in _SETTINGS | _OURS else name


def _spelled(name: str) -> str:
    """Spell a column as the options are: ``Min_Angle`` and ``min angle`` are ``min-angle``."""
    return option_name(_BLANKS.sub("_", name.strip()).casefold())


def _value(key: str, text: str, delimiter: str) -> object:
    """Turn a cell into what `Settings` takes; lists have blanks, commas or semicolons between their parts."""
    if key in LISTS:
        parts = re.split(r"[,;]", text) if "markers" in key else re.split(r"[,;\s]+", text)
        return [part.strip() for part in parts if part.strip()]
    if delimiter != "," and re.fullmatch(r"[-+]?\d+,\d+", text):
        return text.replace(",", ".")  # where commas do not separate cells, they are decimal points
    return text


def _fault(values: Mapping[str, object]) -> str:
    try:
        settings_from(None, values)
    except UsageError as error:
        told = str(error).removeprefix("settings: ")
        return told.removeprefix(f"{next(iter(values))}: ") if len(values) == 1 else told
    return ""


def _delimiter(line: str) -> str:
    return max(",;\t", key=line.count)


def _split(line: str, delimiter: str) -> list[str]:
    try:
        return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter), [])]
    except csv.Error:
        return []
