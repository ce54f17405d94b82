"""Feed mutated files of every format to readers and analysis: run ``python benchmarks/fuzz_readers.py COUNT``.

Coverage-guided by atheris (``pip install atheris``). The only error a file may cause is ElbowscrewError, every file
must be done with in a minute, and what comes back must be whole: finite poses of unit length where a frame counts as
tracked, NaN where not, numbers in the analysis where it says so. A seed may be a file of ``--columns`` and its table
below it.
"""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import tempfile
import warnings
import zlib
from pathlib import Path
from typing import Any

import atheris
import numpy as np

with atheris.instrument_imports(include=["elbowscrew"]):
    from elbowscrew import analyze, read_recording
    from elbowscrew.errors import ElbowscrewError, MissingStatementError, NoBodiesError
    from elbowscrew.reading import c3d, c3d_worker
    from elbowscrew.saving import save_simulation
    from elbowscrew.settings import Settings
    from elbowscrew.simulate import simulate_trial

FRAMES = 12
SCRATCH = Path(tempfile.mkdtemp(prefix="elbowscrew-fuzz-"))
TARGET = SCRATCH / "mutant.csv"
COLUMNS = SCRATCH / "columns.toml"
TABLE = b"# the table\n"
# An analysis takes as long as hundreds of readings; the choice by the file itself can be repeated.
ANALYZED_OF = 20
# What a file may lack.
STATED = {"units": "mm", "rotation": "YXZ", "rate_hz": 100.0}
outcomes: dict[str, int] = {}


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
    still, turning = "1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1", []
    for k in range(FRAMES):
        c, s = np.cos(0.05 * k), np.sin(0.05 * k)
        turning.append(f"{c} {-s} 0 {k} {s} {c} 0 2 0 0 1 3 0 0 0 1")
    (folder / "bodies.tra").write_text("\n".join(f"{still} {one}" for one in turning) + "\n")
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


def opened_in_a_fork(file: Path) -> bytes:
    """Open a C3D file as its worker does, but in a fork, which costs a hundredth of a new interpreter."""
    source, sink = os.pipe()
    child = os.fork()
    if child == 0:
        for number in (signal.SIGABRT, signal.SIGSEGV, signal.SIGBUS, signal.SIGFPE, signal.SIGXCPU):
            signal.signal(number, signal.SIG_DFL)
        os.dup2(sink, 1)
        os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
        try:
            c3d_worker.main(str(file))
            sys.stdout.flush()
        except BaseException:
            os._exit(1)
        os._exit(0)
    os.close(sink)
    with os.fdopen(source, "rb") as stream:
        output = stream.read()
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    if code:
        raise subprocess.CalledProcessError(code, "c3d_worker", stderr=b"a damaged file")
    return output


def stated_reading(**options: Any) -> Any:
    """Read the target, with what it lacks."""
    for _ in STATED:
        try:
            return read_recording(TARGET, **options)
        except MissingStatementError as error:
            check_message(str(error))
            options |= {one.setting: STATED[one.setting] for one in error.missing}
    return read_recording(TARGET, **options)


ARM, FOREARM = ("a*",), ("f*",)


def one(data: bytes) -> None:
    """Read one file, and analyze some."""
    total = sum(outcomes.values())
    if total and total % 1000 == 0:
        print(total, outcomes, flush=True)  # libFuzzer ends the process itself: there is no later moment
    columns, named, table = data.partition(TABLE)
    COLUMNS.write_bytes(columns)
    TARGET.write_bytes(table if named else data)
    options: dict[str, Any] = {"columns": COLUMNS} if named else {}
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # a warning of NumPy is a number that nobody looked at
        try:
            try:
                recording = stated_reading(**options)
            except NoBodiesError:
                recording = stated_reading(markers=(*ARM, *FOREARM), **options)
        except ElbowscrewError as error:
            outcomes[type(error).__name__] = outcomes.get(type(error).__name__, 0) + 1
            check_message(str(error))
            return
        for body in recording.bodies:
            size = np.linalg.norm(body.dual_quat_lab_body[:, :4], axis=1)
            assert np.allclose(size[body.tracked], 1.0)
            assert np.isnan(body.dual_quat_lab_body[~body.tracked]).all()
        if zlib.crc32(data) % ANALYZED_OF:
            outcomes["read"] = outcomes.get("read", 0) + 1
            return
        try:
            chosen: dict[str, Any] = {} if recording.bodies else {"arm_markers": ARM, "forearm_markers": FOREARM}
            if len(recording.bodies) > 1 and not recording.bodies[0].name.startswith("arm"):
                chosen = {"proximal": "#1", "distal": "#2"}
            analysis = analyze(recording, Settings(min_tracked_percent=0, min_angle_deg=0.1, **chosen))
        except ElbowscrewError as error:
            kind = f"analysis: {type(error).__name__}"
            outcomes[kind] = outcomes.get(kind, 0) + 1
            return
        assert np.isfinite(analysis.screw.angle[analysis.screw.valid]).all()
        outcomes["analyzed"] = outcomes.get("analyzed", 0) + 1


def check_message(message: str) -> None:
    """An error is one line, but for what the file's own name has."""
    assert "\n" not in message


TOKENS = tuple(
    """|nan|inf|-1e400|1e308|-0|0|1|1e-320|99999999999999999999|-5|0.5|x|"|"1,2"|1,5| 1 |1e5|frame|Rigid Body|Rotation|W
    Frame|6.5|\x00|\xff""".encode("latin-1").split(b"|")
)
NUMBERS = b"|0|1|-1|0.5|-0.5|7|-7|1e-9|1e308|1e150|-1e5|3e4|0.0|-0|1e-320|180|-180|90".split(b"|")


def mutate(data: bytes, max_size: int, seed: int) -> bytes:
    """Mostly change whole cells and lines, so that many mutants get past the header; else let atheris."""
    rng = random.Random(seed)  # noqa: S311 - no secret
    if rng.random() < 0.1:
        return bytes(atheris.Mutate(data, max_size))
    if data[1:2] == b"P":  # C3D: bytes, those of header and parameters above all
        changed = bytearray(data)
        for _ in range(rng.randint(1, 4)):
            end = len(changed) if rng.random() < 0.3 else min(len(changed), 2048)
            changed[rng.randrange(2, end)] = rng.choice((0, 1, 2, 127, 128, 255, rng.randrange(256)))
        return bytes(changed if rng.random() < 0.9 else changed[: rng.randrange(2, len(changed))])
    lines = data.split(b"\n")
    for _ in range(rng.randint(1, 3)):
        row = rng.randrange(len(lines)) if rng.random() < 0.2 else rng.randrange(len(lines) // 2, len(lines))
        delimiter = max(b",;\t ", key=lines[row].count).to_bytes()
        cells = lines[row].split(delimiter)
        column = rng.randrange(len(cells))
        action = rng.randrange(8)
        if action <= 3:
            cells[column] = rng.choice(TOKENS if action == 0 else NUMBERS)
        elif action == 4:
            del cells[column]
        elif action == 5:
            cells.insert(column, rng.choice(TOKENS))
        elif action == 6:
            lines[row] = lines[rng.randrange(len(lines) // 2, len(lines))]
            continue
        else:
            lines.insert(row, lines[rng.randrange(len(lines))])
            continue
        lines[row] = delimiter.join(cells)
    return b"\n".join(lines)[:max_size]


def main() -> None:
    """Run atheris from the seeds."""
    count = sys.argv[1] if len(sys.argv) > 1 else "10000"
    corpus = SCRATCH / "corpus"
    corpus.mkdir()
    seeds(corpus)
    c3d._worker_output = opened_in_a_fork
    arguments = [
        sys.argv[0],
        f"-runs={count}",
        "-max_len=65536",
        "-timeout=60",
        "-mutate_depth=2",
        "-print_final_stats=1",
        str(corpus),
    ]
    atheris.Setup([*arguments, *sys.argv[2:]], one, custom_mutator=mutate)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
