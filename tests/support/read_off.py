"""Movements, tops and valleys read off a Motive recording by plain rules, with nothing of the package.

The rules: the twist of one body in another's frame about the leading direction, smoothed by a Gaussian of 0.04 s. It
moves where its speed is over 5 % of the recording's highest (99.5th percentile); stretches less than 0.25 s apart are
one, and one of less than 2 deg is none. How clear its ends are is told by the times at which the speed passes 10 and
2 % there. Tops and valleys are local extremes with a prominence of a tenth of the range,
each lasting as long as the joint is within a tenth of the way to the extremes beside it.
"""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d
from scipy.signal import find_peaks
from scipy.spatial.transform import Rotation

Array = NDArray[Any]


class ReadOff(NamedTuple):
    """Seconds from the first frame.

    Attributes
    ----------
    onsets, offsets : ndarray, shape (M, 2)
        Of every movement, the earliest and the latest time.
    tops, valleys : ndarray, shape (K, 2), (L, 2)
        Begin and end of every one.
    """

    onsets: Array
    offsets: Array
    tops: Array
    valleys: Array


def read_off(path: Path, proximal: str, distal: str) -> ReadOff:
    """Read the rotation of one body in the other's frame off its columns of Euler angles or quaternions."""
    with path.open(newline="", encoding="utf-8-sig") as lines:
        rows = [row for row in csv.reader(lines) if row]
    head = next(
        k for k, row in enumerate(rows) if row[:2] == ["Frame", "Time"] or row[:2] == ["Frame", "Time (Seconds)"]
    )
    names = next(row for row in rows[:head] if proximal in row)
    kinds, axes = rows[head - 1], rows[head]
    table = rows[head + 1 :]
    time = np.array([float(row[1]) for row in table])

    def rotations(body: str) -> Rotation:
        columns = {
            axes[j]: j
            for j, (name, kind) in enumerate(zip(names, kinds, strict=False))
            if (name, kind) == (body, "Rotation")
        }
        values = np.array([[float(row[columns[axis]]) for axis in sorted(columns)] for row in table])
        if "W" in columns:  # sorted as W, X, Y, Z
            return Rotation.from_quat(values[:, [1, 2, 3, 0]])
        return Rotation.from_euler("XYZ", values, degrees=True)

    joint = rotations(proximal).inv() * rotations(distal)
    quat = (joint[0].inv() * joint).as_quat()
    quat = np.where(quat[:, 3:] < 0.0, -quat, quat)
    leading = np.linalg.eigh(quat[:, :3].T @ quat[:, :3])[1][:, 2]
    twist = np.degrees(2.0 * np.arctan2(quat[:, :3] @ leading, quat[:, 3]))
    twist = twist if twist.max() > -twist.min() else -twist
    time = time - time[0]
    step = float(np.median(np.diff(time)))
    smooth = gaussian_filter1d(twist, 0.04 / step)
    tops, valleys = _extremes(time, smooth)
    onsets, offsets = _movements(time, smooth)
    return ReadOff(onsets, offsets, tops, valleys)


def _movements(time: Array, smooth: Array) -> tuple[Array, Array]:
    speed = np.abs(np.gradient(smooth, time))
    share = speed / np.percentile(speed, 99.5)
    onsets, offsets = [], []
    runs = _runs(time, share > 0.05)
    for k, (first, last) in enumerate(runs):
        fast = first + np.flatnonzero(share[first : last + 1] > 0.10)
        if fast.size and np.ptp(smooth[first : last + 1]) > 2.0:
            begin, end = next(run for run in _runs(time, share > 0.02) if run[0] <= first and run[1] >= last)
            begin = max(begin, runs[k - 1][1]) if k else begin
            end = min(end, runs[k + 1][0]) if k + 1 < len(runs) else end
            onsets.append((time[begin], time[fast[0]]))
            offsets.append((time[fast[-1]], time[end]))
    return np.array(onsets), np.array(offsets)


def _runs(time: Array, mask: Array) -> list[list[int]]:
    """First and last row of every run, those less than 0.25 s apart as one."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(int), [0]])))
    found: list[list[int]] = []
    for first, last in zip(edges[::2].tolist(), (edges[1::2] - 1).tolist(), strict=True):
        if found and time[first] - time[found[-1][1]] < 0.25:
            found[-1][1] = last
        else:
            found.append([first, last])
    return found


def _extremes(time: Array, smooth: Array) -> tuple[Array, Array]:
    least = 0.1 * np.ptp(smooth)
    tops, valleys = (find_peaks(sense * smooth, prominence=least)[0] for sense in (1.0, -1.0))
    at = np.sort(np.concatenate([[0], tops, valleys, [smooth.size - 1]]))

    def spans(extremes: Array) -> Array:
        found = []
        for peak in extremes:
            k = int(np.searchsorted(at, peak))
            # On each side, within a tenth of the way to the next extreme there.
            depth = 0.1 * np.abs(smooth[peak] - smooth[[at[k - 1], at[k + 1]]])
            away = np.abs(smooth - smooth[peak])
            before = np.flatnonzero(away[:peak] > depth[0])
            after = peak + np.flatnonzero(away[peak:] > depth[1])
            found.append((time[before[-1] + 1 if before.size else 0], time[after[0] - 1 if after.size else -1]))
        return np.array(found).reshape(-1, 2)

    return spans(tops), spans(valleys)
