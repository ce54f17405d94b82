"""Keyframes from a CSV file: those of an analysis, or anybody's."""

from __future__ import annotations

import csv
import os
from pathlib import Path
from typing import Any, Final, Literal, NoReturn, cast

import numpy as np
from numpy.typing import NDArray

from elbowscrew.choices import LAW_PEAKS, METHOD_NAMES
from elbowscrew.errors import RecordingError, SettingError, shown, why_unreadable
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import continuous_signs, dual_quat_from_pose, normalize
from elbowscrew.geometry.quaternion import norm
from elbowscrew.model import KeyframeSet, PhaseLaw
from elbowscrew.model.joint_coordinates import MOVING_JOINTS, JointCoordinates
from elbowscrew.motion.interpolation.keyframes import phase_time_share
from elbowscrew.motion.interpolation.laws import LAWS, is_closed, named_law
from elbowscrew.opening import read_text
from elbowscrew.quantities import METERS, Quantity
from elbowscrew.tables import KEYFRAME_JOINT_COLUMNS

_POSE: Final = ("e0", "e1", "e2", "e3", "d_x", "d_y", "d_z")
_UNIT_TOLERANCE: Final = 5e-3


def read_keyframes(
    path: str | os.PathLike[str], *, method: str | None = None, law: str | None = None, law_peak: float | None = None
) -> KeyframeSet:
    """Read keyframes to rebuild a motion from.

    Parameters
    ----------
    path : path-like
        A CSV file whose first line names the columns. It must have ``time_s``, ``e0`` to ``e3`` and ``d_x_mm``,
        ``d_y_mm``, ``d_z_mm`` (or ``_cm``, ``_m``). What else stands in ``keyframes.csv`` of a result is taken from it;
        without it there is one phase, blended by DLB under the cycloidal law, from pose to pose the shorter way.
    method, law : str, optional
        To use instead of the file's.
    law_peak : float, optional
        Time of the law's highest velocity, as a share of the phase; only with a law.

    Returns
    -------
    KeyframeSet

    Raises
    ------
    RecordingError
        If the file cannot be read; the message says where and why.
    SettingError
        If the file's law is not one in closed form, so that another must be given.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> lines = ["time_s,e0,e1,e2,e3,d_x_mm,d_y_mm,d_z_mm", "0,1,0,0,0,0,0,0", "1,0,0,0,1,0,0,10"]
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = pathlib.Path(folder, "poses.csv")
    ...     _ = file.write_text(chr(10).join(lines))
    ...     read_keyframes(file).knot
    array([0., 1.])
    """
    table = _Table.read(Path(path))
    time_s = table.numbers("time_s")
    table.check((np.diff(time_s) > 0.0, "time_s must increase from line to line"))
    unit = next((unit for unit in METERS if f"d_x_{unit}" in table.columns), "mm")
    e = np.column_stack([table.numbers(name) for name in _POSE[:4]])
    places = [f"{name}_{unit}" for name in _POSE[4:]]
    located = not all(table.is_blank(name) for name in places)
    d = np.zeros((time_s.size, 3))
    if located:
        d = METERS[unit] * np.column_stack([table.numbers(name) for name in places])
    table.check((np.abs(norm(e) - 1.0) <= _UNIT_TOLERANCE, "e0 to e3 must be a unit quaternion"))
    count = time_s.size
    if count < 2:
        table.refuse(1, f"expected two keyframes or more, found {count}")
    numbered = table.numbers("phase") if "phase" in table.columns else np.ones(count)
    steps = np.diff(numbered)
    table.check(((steps == 0) | (steps == 1), "phases must be numbered 1, 2, ... in their order"))
    phase = numbered.astype(np.int64)
    if numbered[0] != 1:
        table.refuse(table.lines[0], f"the first phase must be 1, found {numbered[0]:g}")
    first = np.flatnonzero(np.diff(phase, prepend=0))
    if first[-1] == count - 1 and first.size > 1:
        table.refuse(table.lines[-1], "the last phase has no keyframe but its first")
    bounds = np.concatenate([first, [count - 1]])
    laws = _laws(table, first, law, law_peak)
    starts, ends = time_s[bounds[:-1]], time_s[bounds[1:]]
    if "law_start_s" in table.columns and "law_end_s" in table.columns:
        starts, ends = table.numbers("law_start_s")[first], table.numbers("law_end_s")[first]
    fits = (starts < ends) & (starts >= time_s[bounds[:-1]]) & (ends <= time_s[bounds[1:]])
    if not fits.all():
        table.refuse(
            table.lines[first[np.argmin(fits)]], "law_start_s and law_end_s must lie in order between the keyframes"
        )
    pose = normalize(dual_quat_from_pose(e / norm(e)[:, None], d))
    if "knot" not in table.columns:
        pose = continuous_signs(pose)
    blend = table.word("blend", ("piecewise", "global"), "piecewise")
    wanted = method or table.word("method", METHOD_NAMES, "dlb")
    joint, joint_angle = _joint(table, located=located) if wanted == "joint" else (None, None)
    return KeyframeSet(
        frame=table.numbers("frame").astype(np.int64) if "frame" in table.columns else np.arange(count, dtype=np.int64),
        time_s=time_s,
        phase=phase,
        knot=_knots(table, time_s, bounds, laws, (starts, ends), blend=blend, given=law is not None),
        angle=np.full(count, np.nan),
        dual_quat=pose,
        method=wanted,
        blend=cast(Literal["piecewise", "global"], blend),
        law=laws,
        law_start_s=starts,
        law_end_s=ends,
        joint=joint,
        joint_angle=joint_angle,
        located=located,
    )


def _joint(table: _Table, *, located: bool) -> tuple[JointCoordinates, Float]:
    """Read the joint whose angles are interpolated, and its angles (K, k); without positions its places are 0."""
    if "joint_type" not in table.columns:
        msg = f"{table.path}: --method joint: the file does not tell of a joint; give another, such as --method sclerp"
        raise SettingError(msg)
    kind = next(name for name in MOVING_JOINTS if name == table.word("joint_type", MOVING_JOINTS, ""))
    columns = [column for column in KEYFRAME_JOINT_COLUMNS[kind] if column.quantity is not Quantity.LABEL]
    nowhere = np.zeros(len(table.lines))
    read = {
        column: nowhere
        if not located and column.quantity is Quantity.LENGTH
        else table.in_si(column.name, column.quantity)
        for column in columns
    }
    angle = np.stack([values for column, values in read.items() if column.attribute == "joint_angle"], axis=1)
    shared = np.full(max(column.component or 0 for column in columns) + 1, np.nan)
    for column, values in read.items():
        if column.attribute != "joint_angle" and column.component is not None:
            table.check((values == values[0], f"{column.name} must be the same in all lines"))
            shared[column.component] = values[0]
    axes, end = shared[[0, 1, 2, 6, 7, 8]].reshape(2, 3), shared[13:17]
    units = np.array([norm(end), *norm(axes)])
    if (np.abs(units[np.isfinite(units)] - 1.0) > _UNIT_TOLERANCE).any():
        table.refuse(table.lines[0], "axes must be unit vectors, and end_e0 to end_e3 a unit quaternion")
    count = {"ball": 0, "two_axes": 2}.get(kind, 1)
    joint = JointCoordinates(
        type=kind,
        axis=axes[:count] / norm(axes[:count])[:, None],
        point=shared[[3, 4, 5, 9, 10, 11]].reshape(2, 3)[: max(count, 1)],
        pitch=float(shared[12]) if kind == "screw_hinge" else 0.0,
        end=dual_quat_from_pose(end / norm(end), shared[17:20]),
    )
    return joint, angle


def _laws(table: _Table, first: NDArray[np.intp], law: str | None, law_peak: float | None) -> tuple[PhaseLaw, ...]:
    if law is not None:
        named_law(law, law_peak)
        return tuple(PhaseLaw(law, law_peak, np.nan) for _ in first)
    names = table.columns.get("law", ["cycloidal"] * len(table.lines))
    peaks = table.columns.get("law_peak", [""] * len(table.lines))
    found = []
    for k in first.tolist():
        if names[k] == "empirical":
            place = f"{table.path}:{table.lines[k]}"
            msg = f"{place}: the law is the recording's own, which the file does not hold; give --law {', '.join(LAWS)}"
            raise SettingError(msg)
        peak = table.number(peaks[k], table.lines[k], "law_peak") if peaks[k] else None
        if not is_closed(names[k]):
            table.refuse(table.lines[k], f"expected a law of {', '.join(LAWS)}, found {names[k]!r}")
        if peak is not None and not LAW_PEAKS[0] <= peak <= LAW_PEAKS[1]:
            table.refuse(
                table.lines[k], f"law_peak: expected {LAW_PEAKS[0]:g} to {LAW_PEAKS[1]:g}, found {shown(peaks[k])}"
            )
        found.append(PhaseLaw(names[k], peak, np.nan))
    return tuple(found)


def _knots(
    table: _Table,
    time_s: Float,
    bounds: NDArray[np.intp],
    laws: tuple[PhaseLaw, ...],
    spans: tuple[Float, Float],
    *,
    blend: str,
    given: bool,
) -> Float:
    if "knot" in table.columns and not given:
        knot = table.numbers("knot")
    else:
        knot = np.empty(time_s.size)
        for p, law in enumerate(laws):
            part = slice(bounds[p], bounds[p + 1] + 1)
            knot[part] = p + named_law(law.name, law.peak)(phase_time_share(time_s[part], spans[0][p], spans[1][p]))
    table.check((np.diff(knot) > 0.0, "the knots must increase: between two keyframes the law does not advance"))
    ends = bounds if blend == "piecewise" else bounds[[0, -1]]
    expected = np.linspace(0.0, len(laws), ends.size)
    if not np.array_equal(knot[ends], expected):
        table.refuse(table.lines[0], f"the knots at the phases' ends must be {', '.join(f'{k:g}' for k in expected)}")
    return knot


class _Table:
    """Cells of a CSV file by column, with the line each row stands in."""

    def __init__(self, path: Path, columns: dict[str, list[str]], lines: list[int]) -> None:
        self.path, self.columns, self.lines = path, columns, lines

    @classmethod
    def read(cls, path: Path) -> _Table:
        """Read the file, faults of its form named with their line."""
        try:
            text = read_text(path, encoding="utf-8-sig")
            rows = [
                row for row in enumerate(csv.reader(text.splitlines()), start=1) if any(cell.strip() for cell in row[1])
            ]
        except (OSError, ValueError, csv.Error) as error:
            why = why_unreadable(path, error) if isinstance(error, OSError) else "not a CSV file in UTF-8"
            msg = f"{path}: cannot be read as keyframes: {why}"
            raise RecordingError(msg) from error
        names = [cell.strip() for cell in rows[0][1]] if rows else []
        missing = [name for name in ("time_s", *_POSE[:4]) if name not in names]
        missing += [] if any(f"d_x_{unit}" in names for unit in METERS) else ["d_x_mm, d_y_mm, d_z_mm"]
        if missing or len(set(names)) < len(names):
            fault = f"missing columns {', '.join(missing)}" if missing else "a column stands twice"
            msg = f"{path}:1: expected the columns of keyframes.csv, found {fault}; see docs/reference/compare.md"
            raise RecordingError(msg)
        for line, row in rows[1:]:
            if len(row) != len(names):
                msg = f"{path}:{line}: expected {len(names)} cells, found {len(row)}"
                raise RecordingError(msg)
        columns = {name: [row[k].strip() for _, row in rows[1:]] for k, name in enumerate(names)}
        return cls(path, columns, [line for line, _ in rows[1:]])

    def is_blank(self, name: str) -> bool:
        """Whether a column has no numbers at all: positions that were not measured."""
        return not any(self.columns.get(name, ["0"]))

    def numbers(self, name: str) -> Float:
        """Numbers of a column, shape (K,)."""
        if name not in self.columns:
            self.refuse(1, f"the column {name} is missing")
        cells = zip(self.columns[name], self.lines, strict=True)
        return np.array([self.number(cell, line, name) for cell, line in cells], dtype=np.float64)

    def in_si(self, name: str, quantity: Quantity) -> Float:
        """Numbers of a column with a unit, shape (K,), in SI units and radians."""
        if quantity is Quantity.ANGLE:
            if f"{name}_rad" in self.columns:
                return self.numbers(f"{name}_rad")
            return np.radians(self.numbers(f"{name}_deg"))
        if quantity is Quantity.LENGTH:
            unit = next((unit for unit in METERS if f"{name}_{unit}" in self.columns), "mm")
            return METERS[unit] * self.numbers(f"{name}_{unit}")
        return self.numbers(name)

    def number(self, cell: str, line: int, name: str) -> float:
        """Turn a cell into a number."""
        try:
            value = float(cell)
        except ValueError:
            value = np.nan
        if not abs(value) <= 1e12:
            self.refuse(line, f"{name}: expected a number, found {cell[:40]!r}")
        return value

    def word(self, name: str, choices: tuple[str, ...], default: str) -> str:
        """Give the one word of a column."""
        found = set(self.columns.get(name, [default]))
        if len(found) != 1 or not found <= set(choices):
            self.refuse(self.lines[0], f"{name}: expected one of {', '.join(choices)} throughout")
        return found.pop()

    def check(self, *rules: tuple[Any, str]) -> None:
        """Refuse the file at the first row that breaks a rule; a rule of steps tells of the later row."""
        for good, sentence in rules:
            if not good.all():
                row = int(np.argmin(good)) + len(self.lines) - good.size
                self.refuse(self.lines[row], sentence)

    def refuse(self, line: int, sentence: str) -> NoReturn:
        """Raise the error of a line."""
        msg = f"{self.path}:{line}: {sentence}"
        raise RecordingError(msg)
