"""Feed mutated files of every text format to readers and analysis: run ``python benchmarks/fuzz_readers.py COUNT``.

Coverage-guided by atheris (``pip install atheris``). The only error a file may cause is ElbowscrewError, every file
must be done with in seconds, and what comes back must be whole: finite poses of unit length where a frame counts as
tracked, NaN where not, numbers in the analysis where it says so.
"""

from __future__ import annotations

import random
import sys
import tempfile
import warnings
from pathlib import Path
from typing import Any

import atheris
import numpy as np

with atheris.instrument_imports(include=["elbowscrew"]):
    from elbowscrew import analyze, read_recording
    from elbowscrew.errors import ElbowscrewError, NoBodiesError
    from elbowscrew.saving import save_simulation
    from elbowscrew.settings import Settings
    from elbowscrew.simulate import simulate_trial

FRAMES = 12
SCRATCH = Path(tempfile.mkdtemp(prefix="elbowscrew-fuzz-"))
TARGET = SCRATCH / "mutant.csv"
outcomes: dict[str, int] = {}


def seeds(folder: Path) -> None:
    """Small good files of every text format."""
    trial = simulate_trial(frames=FRAMES, inversion=6, top_deg=40, gaps=1, gap_frames=1)
    save_simulation(trial, folder / "motive.csv", length_unit="mm")
    save_simulation(trial, folder / "tagged.csv", layout="row-tagged")
    motive = (folder / "motive.csv").read_text()
    (folder / "v11.csv").write_text(motive.replace("Format Version,1.23", "Format Version,1.1"))
    (folder / "semicolon.csv").write_text(motive.replace(",", ";").replace(".", ","))
    (folder / "euler.csv").write_text(
        motive.replace("Quaternion", "YXZ").replace(
            "Rotation,Rotation,Rotation,Rotation", "Rotation,Rotation,Rotation,"
        )
    )
    names = [f"{name}_e{k}" for name in ("arm", "forearm") for k in range(4)]
    names += [f"{name}_{axis}_m" for name in ("arm", "forearm") for axis in "xyz"]
    rows = [",".join(["frame,time_s", *names])]
    for k in range(FRAMES):
        half = 0.03 * k
        rows.append(f"{k},{k / 100},1,0,0,0,{np.cos(half)!r},{np.sin(half)!r},0,0,0.1,0.2,{0.3 + k * 1e-4},0.4,{k},0.6")
    (folder / "table.csv").write_text("\n".join(rows) + "\n")
    trc = [
        "PathFileType\t4\t(X/Y/Z)\tt.trc",
        "DataRate\tUnits",
        "100\tmm",
        "Frame#\tTime\ta1\t\t\ta2\t\t\ta3\t\t\tf1\t\t\tf2\t\t\tf3\t\t",
        "\t\t" + "\t".join(f"{axis}{k}" for k in range(1, 7) for axis in "XYZ"),
    ]
    trc += [
        f"{k + 1}\t{k / 100}\t0\t0\t0\t90\t0\t0\t0\t60\t0\t"
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
    for path in folder.glob("*.truth.json"):
        path.unlink()


ARM, FOREARM = ("a*",), ("f*",)


def one(data: bytes) -> None:
    """Read and analyze one file."""
    total = sum(outcomes.values())
    if total and total % 10_000 == 0:
        print(total, outcomes, flush=True)  # libFuzzer ends the process itself: there is no later moment
    TARGET.write_bytes(data)
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # a warning of NumPy is a number that nobody looked at
        try:
            try:
                recording = read_recording(TARGET)
            except NoBodiesError:
                recording = read_recording(TARGET, markers=(*ARM, *FOREARM))
        except ElbowscrewError as error:
            outcomes[type(error).__name__] = outcomes.get(type(error).__name__, 0) + 1
            check_message(str(error))
            return
        for body in recording.bodies:
            size = np.linalg.norm(body.dual_quat_lab_body[:, :4], axis=1)
            assert np.allclose(size[body.tracked], 1.0)
            assert np.isnan(body.dual_quat_lab_body[~body.tracked]).all()
        try:
            chosen: dict[str, Any] = {} if recording.bodies else {"arm_markers": ARM, "forearm_markers": FOREARM}
            analysis = analyze(recording, Settings(min_tracked_percent=0, min_angle_deg=1, **chosen))
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
    lines = data.split(b"\n")
    for _ in range(rng.randint(1, 3)):
        row = rng.randrange(len(lines)) if rng.random() < 0.2 else rng.randrange(len(lines) // 2, len(lines))
        delimiter = max(b",;\t", key=lines[row].count).to_bytes()
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
    arguments = [
        sys.argv[0],
        f"-runs={count}",
        "-max_len=32768",
        "-timeout=10",
        "-mutate_depth=2",
        "-print_final_stats=1",
        str(corpus),
    ]
    atheris.Setup([*arguments, *sys.argv[2:]], one, custom_mutator=mutate)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
