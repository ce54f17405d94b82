"""A result as its reader finds it: files, page and terminal, read by the standard library and pandas alone."""

from __future__ import annotations

import csv
import json
import re
from functools import cached_property
from html.parser import HTMLParser
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from plain_pages import plain
from scipy.spatial.transform import Rotation

Float = NDArray[np.float64]

_SCALES = {"m": 1000.0, "cm": 10.0, "mm": 1.0}
_OTHER_UNITS = re.compile(r"_(rad|m)(_s)?$")


class Told:
    """What one analysis wrote: the tables in degrees and millimeters, whatever units they are in."""

    def __init__(self, folder: Path, source: Path, options: tuple[str, ...], terminal: str) -> None:
        self.folder, self.source, self.options, self.terminal = folder, source, options, terminal

    @cached_property
    def summary(self) -> Any:
        return json.loads((self.folder / "summary.json").read_text(encoding="utf-8"))

    @cached_property
    def joint(self) -> Any:
        return json.loads((self.folder / "joint.json").read_text(encoding="utf-8"))

    @cached_property
    def page(self) -> Page:
        return Page((self.folder / "report.html").read_text(encoding="utf-8"))

    @cached_property
    def screw(self) -> pd.DataFrame:
        return self.table("screw")

    @cached_property
    def model(self) -> pd.DataFrame:
        return self.table("interpolation")

    @cached_property
    def keyframes(self) -> pd.DataFrame:
        return self.table("keyframes")

    @cached_property
    def repetitions(self) -> pd.DataFrame:
        return self.table("repetitions")

    @cached_property
    def recording(self) -> MotiveFile:
        return MotiveFile(self.source)

    def table(self, name: str) -> pd.DataFrame:
        found = pd.read_csv(self.folder / f"{name}.csv", keep_default_na=False, na_values=[""])
        renamed = {}
        for column in found.columns:
            match = _OTHER_UNITS.search(column)
            if match:
                unit, scale = ("deg", 180.0 / np.pi) if match[1] == "rad" else ("mm", 1000.0)
                found[column] *= scale
                renamed[column] = f"{column[: match.start()]}_{unit}{match[2] or ''}"
        return found.rename(columns=renamed)

    def option(self, name: str) -> str | None:
        """The value that an option was given, None if it was not."""
        return self.options[self.options.index(name) + 1] if name in self.options else None

    @property
    def frame_of_screws(self) -> str:
        return self.option("--express-in") or "distal"


class Body(NamedTuple):
    """One rigid body of a file: rotation matrices (N, 3, 3), places (N, 3) and markers (N, M, 3) in millimeters.

    The solved markers are where the body's pose puts them, the seen ones where the cameras saw them.
    """

    name: str
    identifier: str
    quat: Float
    R: Float
    p: Float
    error: Float
    solved: Float
    seen: Float

    @property
    def tracked(self) -> NDArray[np.bool_]:
        return np.asarray(np.isfinite(self.p).all(axis=1))

    @property
    def offsets(self) -> Float:
        """Mean places of the markers (M, 3) in the body's own frame."""
        return np.asarray(np.nanmean(np.einsum("nji,nmj->nmi", self.R, self.solved - self.p[:, None]), axis=0))

    @property
    def residual(self) -> Float:
        """RMS over the markers of their distance from where the body's pose puts them, each frame."""
        put = np.einsum("nij,mj->nmi", self.R, self.offsets) + self.p[:, None]
        return np.asarray(np.sqrt(np.mean(np.sum((self.seen - put) ** 2, axis=2), axis=1)))


class MotiveFile:
    """A Motive export of columns, version 1.23, with quaternions."""

    def __init__(self, path: Path) -> None:
        with path.open(encoding="utf-8", newline="") as stream:
            rows = list(csv.reader(stream))
        self.header = dict(zip(rows[0][::2], rows[0][1::2], strict=True))
        labels = list(zip(*rows[2:7], strict=True))[2:]
        cells = np.array([[float(cell or "nan") for cell in row] for row in rows[7:]])
        self.frame, self.time_s, data = cells[:, 0].astype(int), cells[:, 1], cells[:, 2:]
        scale = _SCALES[{"Meters": "m", "Centimeters": "cm", "Millimeters": "mm"}[self.header["Length Units"]]]

        def of(kind: str, name: str, quantity: str) -> Float:
            found = [k for k, label in enumerate(labels) if label[:2] == (kind, name) and label[3] == quantity]
            return data[:, found]

        def markers_of(kind: str, body: str) -> Float:
            names = dict.fromkeys(label[1] for label in labels if label[0] == kind and label[1].startswith(f"{body}:"))
            found = [scale * of(kind, name, "Position") for name in names]
            return np.stack(found, axis=1) if found else np.empty((len(data), 0, 3))

        self.bodies = []
        for name, identifier in dict.fromkeys(label[1:3] for label in labels if label[0] == "Rigid Body"):
            quat, p = of("Rigid Body", name, "Rotation"), scale * of("Rigid Body", name, "Position")
            R = np.full((len(p), 3, 3), np.nan)
            known = np.isfinite(quat).all(axis=1)
            R[known] = Rotation.from_quat(quat[known]).as_matrix()
            solved, seen = (markers_of(kind, name) for kind in ("Rigid Body Marker", "Marker"))
            error = scale * of("Rigid Body", name, "Mean Marker Error")[:, 0]
            self.bodies.append(Body(name, identifier, quat, R, p, error, solved, seen))


class Page(HTMLParser):
    """What a page says: rows of its tables, terms with what stands beside them, and every other text in one piece.

    Of a chart its description and its keys, not its ticks.
    """

    _EMPTY = ("meta", "link", "input", "br", "img")
    _BLOCKS = ("th", "td", "dt", "dd", "p", "li", "figcaption", "desc")

    def __init__(self, text: str) -> None:
        super().__init__()
        self.rows: list[list[str]] = []
        self.terms: dict[str, list[str]] = {}
        self.texts: list[str] = []
        self._open: list[str] = []
        self._cell: list[str] = []
        self._term = ""
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag in self._EMPTY:
            return
        self._open.append(tag)
        if tag == "tr":
            self.rows.append([])
        elif tag in self._BLOCKS or (tag == "span" and not set(self._BLOCKS) & set(self._open)):
            self._cell = []

    def handle_endtag(self, tag: str) -> None:
        while self._open and self._open[-1] != tag:
            self._open.pop()
        if self._open:
            self._open.pop()
        text = " ".join("".join(self._cell).split())
        if tag in ("th", "td"):
            self.rows[-1].append(text)
        elif tag == "dt":
            self._term = text
            self.terms[text] = []
        elif tag == "dd":
            self.terms[self._term].append(text)
        elif tag in self._BLOCKS or (tag == "span" and not set(self._BLOCKS) & set(self._open)):
            self.texts.append(text)
        else:
            return
        self._cell = []

    def handle_data(self, data: str) -> None:
        if {"script", "style"} & set(self._open) or ("svg" in self._open and "desc" not in self._open):
            return
        self._cell.append(plain(data))

    @property
    def text(self) -> str:
        """All of it."""
        rows = [cell for row in self.rows for cell in row]
        return " ".join([*self.texts, *rows, *(text for texts in self.terms.values() for text in texts)])


def leaves(value: Any, path: tuple[str, ...] = ()) -> dict[tuple[str, ...], Any]:
    """Every value of nested objects by its keys; a list of numbers or words is one value."""
    if isinstance(value, dict) and value:
        return {key: leaf for name, part in value.items() for key, leaf in leaves(part, (*path, name)).items()}
    if isinstance(value, list) and any(isinstance(part, dict | list) for part in value):
        return {key: leaf for k, part in enumerate(value) for key, leaf in leaves(part, (*path, str(k))).items()}
    return {path: value}


def pattern(path: tuple[str, ...]) -> str:
    """Write a path with a star for each place in a list."""
    return ".".join("*" if part.isdigit() else part for part in path)
