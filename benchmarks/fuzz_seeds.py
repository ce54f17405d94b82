"""Small good files of every format that is read, for `fuzz_readers.py`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from elbowscrew.saving import save_simulation
from elbowscrew.simulate import simulate_trial

FRAMES = 12
TABLE = b"# the table\n"
"""What separates a file of ``--columns`` from its table."""
POSES = b"# poses\n"
"""What a file begins with that is one of six numbers a body, and has a name that says so."""
OLD = ("motive", "tagged", "v11", "semicolon", "v125", "euler")
"""Names of Motive's own formats."""


def seeds(folder: Path) -> None:
    """Small good files of every text format."""
    trial = simulate_trial(frames=FRAMES, inversion=6, top_deg=40, gaps=1, gap_frames=1)
    save_simulation(trial, folder / "motive.csv", length_unit="mm")
    save_simulation(trial, folder / "tagged.csv", layout="row-tagged")
    motive = (folder / "motive.csv").read_text()
    (folder / "v11.csv").write_text(motive.replace("Format Version,1.23", "Format Version,1.1"))
    (folder / "semicolon.csv").write_text(motive.replace(",", ";").replace(".", ","))
    (folder / "v125.csv").write_text(motive.replace("Format Version,1.23", "Format Version,1.25"))
    (folder / "euler.csv").write_text(
        motive.replace("Quaternion", "XYZ").replace(
            "Rotation,Rotation,Rotation,Rotation", "Rotation,Rotation,Rotation,"
        )
    )
    names = [f"{name}_e{k}" for name in ("arm", "forearm") for k in range(4)]
    names += [f"{name}_{axis}_m" for name in ("arm", "forearm") for axis in "xyz"]
    rows = [",".join(["frame,time_s", *names])]
    for k in range(FRAMES):
        half = 0.03 * k
        rows.append(
            f"{k},{k / 100},1,0,0,0,{np.cos(half)},{np.sin(half)},0,0,0.1,0.2,{0.3 + k * 1e-4},0.4,{k * 1e-3},0.6"
        )
    (folder / "table.csv").write_text("\n".join(rows) + "\n")
    trc = [
        "PathFileType\t4\t(X/Y/Z)\tt.trc",
        "DataRate\tUnits",
        "100\tmm",
        "Frame#\tTime\ta1\t\t\ta2\t\t\ta3\t\t\tf1\t\t\tf2\t\t\tf3\t\t",
        "\t\t" + "\t".join(f"{axis}{k}" for k in range(1, 7) for axis in "XYZ"),
    ]
    trc += [
        f"{k + 1}\t{k / 100}\t0\t0\t1\t90\t0\t0\t0\t60\t0\t"  # a marker at 0, 0, 0 was not seen
        f"0\t0\t{300 + k}\t{100 * np.cos(0.05 * k)}\t0\t{300 + k + 100 * np.sin(0.05 * k)}\t0\t80\t{300 + k}"
        for k in range(FRAMES)
    ]
    (folder / "markers.trc").write_text("\n".join(trc) + "\n")
    (folder / "commas.trc").write_text("\n".join(trc).replace("\t", ",") + "\n")
    (folder / "names.trc").write_text("\n".join([*trc[:3], trc[3] + "\tV\t\t\ta1", *trc[4:]]) + "\n")
    (folder / "times.csv").write_text("\n".join(row.partition(",")[2] for row in rows) + "\n")
    qualisys = ["NO_OF_FRAMES\t12", "FREQUENCY\t100", "BODY_NAMES\tarm\tforearm"]
    cells = ["Y", "Z", "Roll", "Pitch", "Yaw", "Residual", *(f"Rot[{k}]" for k in range(9))]
    qualisys.append("\t".join(["Frame", "Time", "arm X", *cells, "forearm X", *cells]))
    for k in range(FRAMES):
        c, s = np.cos(0.05 * k), np.sin(0.05 * k)
        qualisys.append(
            f"{k + 1}\t{k / 100}\t1\t2\t3\t0\t0\t0\t0.4\t1\t0\t0\t0\t1\t0\t0\t0\t1\t"
            f"4\t{k}\t6\t0\t0\t0\t0.4\t{c}\t{s}\t0\t{-s}\t{c}\t0\t0\t0\t1"
        )
    (folder / "qualisys.tsv").write_text("\n".join(qualisys) + "\n")
    three = ["NO_OF_FRAMES\t12", "FREQUENCY\t100", "MARKER_NAMES\ta1\ta2\ta3\tf1\tf2\tf3"]
    three += ["Frame\tTime\t" + "\t".join(f"{name} {axis}" for name in three[2].split("\t")[1:] for axis in "XYZ")]
    (folder / "qualisys3d.tsv").write_text("\n".join([*three, *trc[5:]]) + "\n")
    without = [row.split("\t", 2)[2] for row in trc[5:]]
    (folder / "qualisysrows.tsv").write_text("\n".join([*three[:3], *without]) + "\n")
    still, turning = "1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1", []
    for k in range(FRAMES):
        c, s = np.cos(0.05 * k), np.sin(0.05 * k)
        turning.append(f"{c} {-s} 0 {k} {s} {c} 0 2 0 0 1 3 0 0 0 1")
    (folder / "bodies.tra").write_text("\n".join(f"{still} {one}" for one in turning) + "\n")
    parts = ["R11", "R12", "R13", "01", "R21", "R22", "R23", "02", "R31", "R32", "R33", "03", "TX", "TY", "TY", "1"]
    xmalab = [" , ".join(["Frame", *(f"{name}_{part}" for name in ("arm", "forearm") for part in parts)])]
    for k in range(FRAMES):
        c, s = np.cos(0.05 * k), np.sin(0.05 * k)
        arm, forearm = "1 0 0 0 0 1 0 0 0 0 1 0 5 6 7 1", f"{c} {s} 0 0 {-s} {c} 0 0 0 0 1 0 {k} 2 3 1"
        xmalab.append(f"{k + 1} {arm} {forearm if k != 5 else 'NaN ' * 15 + 'NaN'}".replace(" ", " , "))
    (folder / "xmalab.csv").write_text("\n".join(xmalab) + "\n")
    angles = [f"1 2 3 0 10 0 {k} 5 6 {3 * k} -20 7" for k in range(FRAMES)]
    (folder / "angles.tra").write_text(POSES.decode() + "\n".join(angles) + "\n")
    # The last cells of some rows are blank: what is shifted there must not be taken for whole.
    ends = [row.rsplit(",", 3)[0] + ",,," if k % 3 == 2 else row for k, row in enumerate(rows)]
    (folder / "ends.csv").write_text("\n".join(ends) + "\n")
    ends = [row.rsplit("\t", 3)[0] + "\t\t\t" if k > 5 and k % 3 == 2 else row for k, row in enumerate(trc)]
    (folder / "ends.trc").write_text("\n".join(ends) + "\n")
    storage = ["DataRate=100", "DataType=Quaternion", "version=3", "endheader", "time\tarm\tforearm"]
    storage += [f"{k / 100}\t1,0,0,0\t{np.cos(0.03 * k)},{np.sin(0.03 * k)},0,0" for k in range(FRAMES)]
    (folder / "sensors.sto").write_text("\n".join(storage) + "\n")
    matrix = [f"m{k}" for k in range(16)]
    said = [
        '[clock]\ntime = "t"\nunit = "ms"\n[table]\nfirst_row = 3',
        '[bodies.arm]\neuler = ["a", "b", "c"]\nsequence = "zyx"\ndegrees = true',
        'position = ["#5", "#6", "#7"]\nunit = "mm"',
        f'[bodies.forearm]\nmatrix = {matrix}\nunit = "cm"\n',
    ]
    rows = [";".join(["t", "a", "b", "c", "x", "y", "z", *matrix]), "ms;deg"]
    rows += [f"{10 * k};1;2;3;4;5;6;{one.replace(' ', ';')}" for k, one in enumerate(turning)]
    (folder / "columns.txt").write_text("\n".join(said) + TABLE.decode() + "\n".join(rows) + "\n")
    markers = [one.split("\t") for one in trc[5:]]
    said = [
        f"[markers.{name}]\nposition = ['#{k}', '#{k + 1}', '#{k + 2}']\n"
        for name, k in zip(("a1", "a2", "a3", "f1", "f2", "f3"), range(3, 21, 3), strict=True)
    ]
    table = "\n".join(",".join(one) for one in markers)
    (folder / "markers.txt").write_text(f"[clock]\nframe = '#1'\n{''.join(said)}{TABLE.decode()}{table}\n")
    positions = np.array(markers, dtype=np.float64)[:, 2:]
    for name, rotations in (("points.c3d", False), ("rotations.c3d", True)):
        c3d_seed(folder / name, positions, rotations=rotations)
    for path in folder.glob("*.truth.json"):
        path.unlink()


def c3d_seed(path: Path, positions: Any, *, rotations: bool) -> None:
    """Write markers (N, 18) as a C3D file, with poses beside them or not."""
    import ezc3d

    content = ezc3d.c3d()
    content["parameters"]["POINT"]["RATE"]["value"] = [100.0]
    content["parameters"]["POINT"]["UNITS"]["value"] = ["mm"]
    content["parameters"]["POINT"]["LABELS"]["value"] = ("a1", "a2", "a3", "f1", "f2", "f3")
    points = np.ones((4, 6, FRAMES))
    points[:3] = positions.reshape(FRAMES, 6, 3).transpose(2, 1, 0)
    content["data"]["points"] = points
    if rotations:
        matrices = np.tile(np.eye(4)[:, :, None, None], (1, 1, 2, FRAMES))
        angle = 0.05 * np.arange(FRAMES)
        matrices[0, 0, 1], matrices[1, 1, 1] = np.cos(angle), np.cos(angle)
        matrices[:3, 3, 0] = 1.0  # no rotation at the very origin is no pose
        matrices[1, 0, 1], matrices[0, 1, 1] = np.sin(angle), -np.sin(angle)
        content["data"]["rotations"] = matrices
        content.add_parameter("ROTATION", "RATE", [100.0])
        content.add_parameter("ROTATION", "LABELS", ("arm", "forearm"))
    content.write(str(path))
