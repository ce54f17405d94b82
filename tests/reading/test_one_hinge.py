"""One hinge, the arm moving, in every format: theta, axis and point are equal within each format's digits."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import ezc3d
import numpy as np
import pytest
from motive_files import bodies_of, write_columns
from oracles import known_trial, quaternion_xyzw

from elbowscrew import Analysis, Settings, analyze, read_recording
from elbowscrew.geometry.arrays import Float

FRAMES = 80
TRIAL = known_trial(110.0, frames=FRAMES, inversion=40, slide=0.0, seed=21)
BODIES = (("Upper Arm", TRIAL.proximal_R, TRIAL.proximal_p), ("Forearm", TRIAL.distal_R, TRIAL.distal_p))
CLUSTER = np.array([[0.04, 0, 0.01], [-0.03, 0.05, 0], [0, -0.04, 0.01], [0.01, 0.02, -0.06]])
MARKERS = {
    f"{letters}{k + 1}": (R @ CLUSTER[k]) + p
    for letters, (_, R, p) in zip(("UA", "FA"), BODIES, strict=True)
    for k in range(4)
}
FROM_MARKERS: dict[str, Any] = {"proximal_markers": ("UA?",), "distal_markers": ("FA?",)}


def lines_of(path: Path, lines: list[str]) -> Path:
    path.write_text("\n".join(lines) + "\n")
    return path


def cells(values: Float, mark: str = ",") -> str:
    return mark.join(f"{x:.9f}" for x in values)


def motive(folder: Path) -> Any:
    return read_recording(write_columns(folder / "t.csv", bodies_of(TRIAL, seed=1), decimals=6))


def trc(folder: Path) -> Any:
    stated = {"DataRate": "100", "CameraRate": "100", "NumFrames": str(FRAMES), "NumMarkers": "8", "Units": "mm"}
    lines = ["PathFileType\t4\t(X/Y/Z)\tt.trc", "\t".join(stated), "\t".join(stated.values())]
    lines.append("\t".join(["Frame#", "Time", *(cell for name in MARKERS for cell in (name, "", ""))]))
    lines += ["\t".join(["", "", *(f"{axis}{k + 1}" for k in range(8) for axis in "XYZ")]), ""]
    positions = 1000.0 * np.concatenate(list(MARKERS.values()), axis=1)
    lines += ["\t".join([str(k + 1), f"{k / 100:.6f}", cells(row, "\t")]) for k, row in enumerate(positions)]
    return read_recording(lines_of(folder / "t.trc", lines), markers="*")


def c3d(folder: Path, *, rotations: bool) -> Any:
    content = ezc3d.c3d()
    content["parameters"]["POINT"]["RATE"]["value"] = [100.0]
    content["parameters"]["POINT"]["UNITS"]["value"] = ["mm"]
    content["parameters"]["POINT"]["LABELS"]["value"] = tuple(MARKERS)
    points = np.ones((4, 8, FRAMES))
    points[:3] = 1000.0 * np.moveaxis(np.stack(list(MARKERS.values())), [0, 1, 2], [1, 2, 0])
    content["data"]["points"] = points
    if rotations:
        matrices = np.tile(np.eye(4)[:, :, None, None], (1, 1, 2, FRAMES))
        for k, (_, R, p) in enumerate(BODIES):
            matrices[:3, :3, k], matrices[:3, 3, k] = np.moveaxis(R, 0, -1), 1000.0 * p.T
        content["data"]["rotations"] = matrices
        content.add_parameter("ROTATION", "RATE", [100.0])
        content.add_parameter("ROTATION", "LABELS", ("r_uarm_4X4", "r_larm_4X4"))
    content.write(str(folder / "t.c3d"))
    return read_recording(folder / "t.c3d", markers=() if rotations else "*")


def qualisys(folder: Path) -> Any:
    columns = ["Y", "Z", "Roll", "Pitch", "Yaw", "Residual", *(f"Rot[{k}]" for k in range(9))]
    lines = [f"NO_OF_FRAMES\t{FRAMES}", "NO_OF_BODIES\t2", "FREQUENCY\t100", "BODY_NAMES\tUpper Arm\tForearm"]
    lines.append("\t".join(["Frame", "Time", "Upper Arm X", *columns, "Forearm X", *columns]))
    for k in range(FRAMES):
        bodies = [cells(np.r_[1000.0 * p[k], 1.0, 2.0, 3.0, 0.4, R[k].T.ravel()], "\t") for _, R, p in BODIES]
        lines.append("\t".join([str(k + 1), f"{k / 100:.5f}", *bodies]))
    return read_recording(lines_of(folder / "t.tsv", lines))


def matrices(folder: Path) -> Any:
    paths = []
    for name, R, p in (("humerus", *BODIES[0][1:]), ("ulna", *BODIES[1][1:])):
        poses = np.tile(np.eye(4), (FRAMES, 1, 1))
        poses[:, :3, :3], poses[:, :3, 3] = R, 1000.0 * p
        paths.append(lines_of(folder / f"{name}.tra", [cells(pose.ravel()) for pose in poses]))
    return read_recording(paths[0], distal_path=paths[1], units="mm", rate_hz=100.0)


def table(folder: Path, *, positions: bool) -> Any:
    names = ["frame", "time_s"]
    columns = [np.arange(float(FRAMES))[:, None], np.arange(FRAMES)[:, None] / 100.0]
    for name, R, p in BODIES:
        names += [f"{name}_e{k}" for k in range(4)]
        columns.append(quaternion_xyzw(R)[:, [3, 0, 1, 2]])
        if positions:
            names += [f"{name}_{axis}_mm" for axis in "xyz"]
            columns.append(1000.0 * p)
    rows = np.concatenate(columns, axis=1)
    return read_recording(
        lines_of(folder / "t.csv", [",".join(names), *(f"{row[0]:.0f}," + cells(row[1:]) for row in rows)])
    )


def storage(folder: Path) -> Any:
    quats = [quaternion_xyzw(R)[:, [3, 0, 1, 2]] for _, R, _ in BODIES]
    lines = ["DataRate=100.0", "DataType=Quaternion", "version=3", "endheader", "time\thumerus_r_imu\tulna_r_imu"]
    lines += ["\t".join([f"{k / 100:.3f}", *(cells(quat[k]) for quat in quats)]) for k in range(FRAMES)]
    return read_recording(lines_of(folder / "t.sto", lines))


class Kind(NamedTuple):
    """A format: how a recording of it is made, what its digits leave of an angle (rad) and a length (m)."""

    make: Callable[[Path], Any]
    angle: float
    length: float
    markers: bool = False


KINDS = {
    "Motive": Kind(motive, 5e-6, 5e-6),
    "TRC": Kind(trc, 1e-9, 1e-9, markers=True),
    "C3D points": Kind(lambda folder: c3d(folder, rotations=False), 2e-5, 2e-5, markers=True),
    "C3D rotations": Kind(lambda folder: c3d(folder, rotations=True), 2e-6, 2e-6),
    "Qualisys": Kind(qualisys, 1e-8, 1e-8),
    "4 x 4": Kind(matrices, 1e-8, 1e-8),
    "plain table": Kind(lambda folder: table(folder, positions=True), 1e-8, 1e-8),
}
ORIENTATIONS = {
    "storage": Kind(storage, 1e-8, 0.0),
    "plain table": Kind(lambda folder: table(folder, positions=False), 1e-8, 0.0),
}


def analyzed(kind: Kind, folder: Path) -> Analysis:
    settings = Settings(express_in="lab", **(FROM_MARKERS if kind.markers else {}))
    return analyze(kind.make(folder), settings)


@pytest.mark.parametrize("name", KINDS)
def test_theta_axis_and_point_are_those_of_the_hinge(name: str, tmp_path: Path) -> None:
    kind = KINDS[name]
    found = analyzed(kind, tmp_path)
    direction, point = TRIAL.line_in("lab")
    assert found.screw.angle == pytest.approx(TRIAL.angle, abs=kind.angle)
    assert np.nanmax(np.abs(found.screw.slide)) <= 5.0 * kind.length
    best = found.joint_axis.best
    assert best is not None
    for line in (found.mean_axis, best.line):
        assert line.direction == pytest.approx(direction, abs=kind.angle)
        assert line.point == pytest.approx(point, abs=10.0 * (kind.angle + kind.length))
    assert found.named_joint.name == ("joint" if kind.markers else "elbow")


@pytest.mark.parametrize("name", ORIENTATIONS)
def test_orientations_give_theta_and_direction(name: str, tmp_path: Path) -> None:
    kind = ORIENTATIONS[name]
    found = analyzed(kind, tmp_path)
    direction, _ = TRIAL.line_in("lab")
    assert found.screw.angle == pytest.approx(TRIAL.angle, abs=kind.angle)
    best = found.joint_axis.best
    assert best is not None
    for line in (found.mean_axis, best.line):
        assert line.direction == pytest.approx(direction, abs=kind.angle)
        assert np.isnan(line.point).all()
    assert found.joint_type is not None
    assert found.joint_type.type == "hinge"
