"""Motive exports as the tests need them, written by hand from the format's description."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from oracles import KnownTrial, quaternion_xyzw
from scipy.spatial.transform import Rotation

from elbowscrew.geometry.arrays import Float

SCALES = {"Meters": 1.0, "Centimeters": 100.0, "Millimeters": 1000.0}


@dataclass
class BodyData:
    name: str
    identifier: str
    R: Float
    p: Float
    lost: NDArray[np.bool_] | None = None
    flips: NDArray[np.bool_] | None = None


def bodies_of(
    trial: KnownTrial, names: tuple[str, str] = ("Upper Arm", "Forearm"), *, seed: int | None = None
) -> list[BodyData]:
    """Arm and forearm of a known trial, with random signs if a seed is given."""
    rng = np.random.default_rng(seed)
    flips = None if seed is None else rng.random((2, len(trial.angle))) < 0.5
    return [
        BodyData(names[0], "A" * 32, trial.proximal_R, trial.proximal_p, flips=None if flips is None else flips[0]),
        BodyData(names[1], "B" * 32, trial.distal_R, trial.distal_p, flips=None if flips is None else flips[1]),
    ]


def write_columns(
    path: Path,
    bodies: list[BodyData],
    *,
    version: str = "1.23",
    rotation: str = "Quaternion",
    unit: str = "Meters",
    decimals: int | None = None,
    end: str = "\n",
    bom: bool = False,
    padding: int = 0,
    first_frame: int = 0,
    quoted_ids: bool = True,
    timecode: bool = False,
    w_label: str = "W",
    header: dict[str, str | None] | None = None,
) -> Path:
    """Write the column layout in one of its variants."""
    frames = len(bodies[0].p)
    pairs: dict[str, str | None] = {
        "Format Version": version,
        "Take Name": "Take 1",
        **({"Take Notes": ""} if version >= "1.23" else {}),
        "Capture Frame Rate": "100.000000",
        "Export Frame Rate": "100.000000",
        "Capture Start Time": "2023-03-29 06.23.40.520 下午",
        "Total Frames in Take": str(frames),
        "Total Exported Frames": str(frames),
        "Rotation Type": rotation,
        "Length Units": unit,
        "Coordinate Space": "Global",
        **(header or {}),
    }
    tagged = version >= "1.23"
    labels: list[tuple[str, str, str, str, str]] = []
    if timecode:
        labels.append(("", "", "", "", "TimeCode"))
    values: list[Float] = []
    for body in bodies:
        identifier = f'"{body.identifier}"' if quoted_ids else body.identifier
        head = ("Rigid Body", body.name, identifier)
        if rotation == "Quaternion":
            cells = quaternion_xyzw(body.R)
            if body.flips is not None:
                cells = np.where(body.flips[:, None], -cells, cells)
            axes = ["X", "Y", "Z", w_label]
        else:
            cells = Rotation.from_matrix(body.R).as_euler(rotation, degrees=True)
            axes = list(rotation)
        block = np.concatenate([cells, SCALES[unit] * body.p, np.zeros((frames, 1))], axis=1)
        if body.lost is not None:
            block[body.lost] = np.nan
        values.append(block)
        labels += [(*head, "Rotation", axis) for axis in axes] + [(*head, "Position", axis) for axis in "XYZ"]
        labels.append((*head, "Mean Marker Error" if tagged else "Error Per Marker", ""))
    pad = "," * padding
    lines = [",".join(cell for key, value in pairs.items() if value is not None for cell in (key, value)) + pad, pad]
    titles = ["Type", "Name", "ID"] if tagged else ["", "", ""]
    for row, title in enumerate(titles):
        lines.append(",".join(["", title, *(label[row] for label in labels)]) + pad)
    if version == "1.25":
        lines.append(",".join(["", "Parent", *("" for _ in labels)]) + pad)
    lines.append(",".join(["", "", *(label[3] for label in labels)]) + pad)
    time_label = "Time (Seconds)" if version >= "1.22" else "Time"
    lines.append(",".join(["Frame", time_label, *(label[4] for label in labels)]) + pad)
    data = np.concatenate(values, axis=1)

    def text(value: float) -> str:
        if np.isnan(value):
            return ""
        return repr(float(value)) if decimals is None else f"{value:.{decimals}f}"

    for k in range(frames):
        code = ["15:26:46:12.02"] if timecode else []
        lines.append(",".join([str(first_frame + k), f"{k / 100:.6f}", *code, *(text(v) for v in data[k])]) + pad)
    content = end.join(lines) + end
    path.write_bytes((b"\xef\xbb\xbf" if bom else b"") + content.encode())
    return path


def write_row_tagged(
    path: Path, bodies: list[BodyData], *, version: str = "1.1", quoted: bool = True, decimals: int | None = None
) -> Path:
    """Write the row-tagged layout 1.0 or 1.1; lost bodies are absent, the others stand in reverse order."""
    tag = "rigidbody" if version == "1.1" else "trackable"
    quote = '"' if quoted else ""
    lines = ['comment,"NaturalPoint export"', "righthanded"]
    if version == "1.1":
        lines.append("info,version,1.1")
    lines += [f"info,framecount,{len(bodies[0].p)}", f"info,{tag}count,{len(bodies)}"]
    for number, body in enumerate(bodies, start=1):
        lines.append(f"{tag},{quote}{body.name}{quote},{number},3,0.04,0,0,-0.02,0.03,0,-0.02,-0.03,0")
    quats = [quaternion_xyzw(body.R) for body in bodies]

    def text(value: float) -> str:
        return repr(float(value)) if decimals is None else f"{value:.{decimals}f}"

    for k in range(len(bodies[0].p)):
        cells: list[str] = []
        count = 0
        for number in range(len(bodies), 0, -1):
            body = bodies[number - 1]
            if body.lost is not None and body.lost[k]:
                continue
            count += 1
            cells += [str(number), *(text(v) for v in (*body.p[k], *quats[number - 1][k])), "0", "0", "0"]
        lines.append(",".join(["frame", str(k), f"{k / 100:.8f}", str(count), *cells, "0"]))
        for number, body in enumerate(bodies, start=1):
            lost = body.lost is not None and body.lost[k]
            seen = "NAN,NAN,NAN" if lost else "0.1,0.2,0.3"
            lines.append(
                f"{tag},{k},{k / 100:.8f},{quote}{body.name}{quote},{number},{int(lost)},1,"
                f"0.1,0.2,0.3,{seen},1,1.0,0.001"
            )
    path.write_text("\n".join(lines) + "\n")
    return path
