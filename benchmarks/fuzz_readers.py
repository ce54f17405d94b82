"""Feed mutated files of every format to readers and analysis: run ``python benchmarks/fuzz_readers.py COUNT``.

Coverage-guided by atheris (``pip install atheris``). The only error that a file may cause is ElbowscrewError, every
file must be done with in a second of the processor's time, and what comes back must be whole: finite poses of unit
length where a frame counts as tracked, NaN where not, numbers in the analysis where it says so.

No number may be wrong in silence either. Whatever is read is changed once more in one place that is known: a cell among
the numbers may change one row of one body or marker at the most, a row that is taken out takes only itself, cells that
are shifted shift no others, and what a changed header moves or scales must be told.

COUNT is of files in all, ``--seconds`` is the longest time. ``--seed`` makes other ones, ``--new`` leaves Motive's own
formats out, ``--only PATTERN`` takes the seeds with such names alone (`fuzz_seeds.py`), so that each format has its
share, and ``--finds FOLDER`` is where each find is kept, with the file that it came from. The counts are printed as
JSON, by format.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time
import traceback
import warnings
import zlib
from collections import Counter, defaultdict
from pathlib import Path
from typing import Any

import atheris
import numpy as np
from fuzz_seeds import OLD, POSES, TABLE, seeds

with atheris.instrument_imports(include=["elbowscrew"]):
    from elbowscrew import analyze, read_recording
    from elbowscrew.errors import ElbowscrewError, MissingStatementError, NoBodiesError
    from elbowscrew.model import Recording
    from elbowscrew.reading import c3d, c3d_worker
    from elbowscrew.reading.c3d_checks import check_sizes
    from elbowscrew.reading.c3d_mending import mended
    from elbowscrew.reading.c3d_parameters import read_statements
    from elbowscrew.settings import Settings

SCRATCH = Path(tempfile.mkdtemp(prefix="elbowscrew-fuzz-"))
TARGET = SCRATCH / "mutant.csv"
POSES_TARGET = SCRATCH / "mutant.tra"
COLUMNS = SCRATCH / "columns.toml"
LONGEST_S = 1.0
# An analysis takes as long as hundreds of readings, a library in a process of its own as long as ten; the choice by the
# file itself can be repeated.
ANALYZED_OF = 500
OPENED_OF = 4
CHANGED_AGAIN = 2
FROM_A_SEED = 0.5
# What a file may lack.
STATED = {"units": "mm", "rotation": "YXZ", "rate_hz": 100.0}
KINDS = {
    b"pathfiletype": "TRC", b"no_of": "Qualisys", b"frame": "plain table", b"time": "plain table",
    b"data": "storage", b"version": "storage", b"format": "Motive columns", b"comment": "row-tagged",
}  # fmt: skip
ARM, FOREARM = ("a*",), ("f*",)
outcomes: defaultdict[str, Counter[str]] = defaultdict(Counter)
slowest: dict[str, float] = {}
seen: set[str] = set()
finds = SCRATCH / "finds"
wanted_count = 0
last_moment = 0.0
good: list[bytes] = []


def kind_of(data: bytes) -> str:
    """The format that a file is, or once was."""
    if data[1:2] == b"P" and data[:1] < b" ":
        return "C3D"
    if TABLE in data:
        return "named columns"
    if data.startswith(POSES):
        return "six numbers"
    begin = data.lstrip(b"\xef\xbb\xbf \r\n\t")[:12].lower()
    found = next((kind for word, kind in KINDS.items() if begin.startswith(word)), None)
    return found or ("matrices" if begin[:1].isdigit() or begin[:1] in b"-.n" else "other")


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


def stated_reading(path: Path, **options: Any) -> Recording:
    """Read a file, with what it lacks."""
    for _ in STATED:
        try:
            return read_recording(path, **options)
        except MissingStatementError as error:
            options |= {one.setting: STATED[one.setting] for one in error.missing}
    return read_recording(path, **options)


def read(data: bytes) -> Recording | None:
    """Read one file and check what comes back; None if it is refused."""
    kind = kind_of(data)
    columns, named, table = data.partition(TABLE)
    COLUMNS.write_bytes(columns)
    path = POSES_TARGET if kind == "six numbers" else TARGET
    path.write_bytes(table if named else data.removeprefix(POSES))
    options: dict[str, Any] = {"columns": COLUMNS} if named else {}
    begin = spent()
    outcomes[kind]["files"] += 1
    try:
        if kind == "C3D" and zlib.crc32(data) % OPENED_OF:
            stated = read_statements(TARGET)
            if stated is not None:
                check_sizes(TARGET, stated)
                mended(TARGET, stated)
            outcomes[kind]["looked at"] += 1
            return None
        try:
            recording = stated_reading(path, **options)
        except NoBodiesError:
            recording = stated_reading(path, markers=(*ARM, *FOREARM), **options)
    except ElbowscrewError as error:
        outcomes[kind][type(error).__name__] += 1
        if "\n" in str(error):
            keep("message of several lines", data, str(error))
        return None
    finally:
        took = spent() - begin
        slowest[kind] = max(took, slowest.get(kind, 0.0))
        if took > LONGEST_S:
            keep("slow", data, f"{took:.2f} s")
    for body in recording.bodies:
        size = np.linalg.norm(body.dual_quat_lab_body[:, :4], axis=1)
        if not np.allclose(size[body.tracked], 1.0) or not np.isnan(body.dual_quat_lab_body[~body.tracked]).all():
            keep("no pose", data, body.name)
    outcomes[kind]["read"] += 1
    return recording


def spent() -> float:
    """Seconds of the processor, those of forks included."""
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + children.ru_utime + children.ru_stime


def one(data: bytes) -> None:
    """Read one file, change it again in some places, and analyze some."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # a warning of NumPy is a number that nobody looked at
        try:
            recording = read(data)
            if recording is not None:
                rng = random.Random(zlib.crc32(data))  # noqa: S311 - no secret
                for _ in range(CHANGED_AGAIN):
                    change_once(data, recording, rng)
                if zlib.crc32(data) % ANALYZED_OF == 0:
                    analyzed(kind_of(data), recording)
        except Exception:  # any other one is a find
            lines = traceback.format_exc().splitlines()
            where = [line.strip() for line in lines if "elbowscrew" in line]
            keep(f"{lines[-1][:80]} {where[-1] if where else ''}", data, "\n".join(lines))
    total = sum(count["files"] for count in outcomes.values())
    if total >= wanted_count or time.monotonic() > last_moment:
        finish()


def analyzed(kind: str, recording: Recording) -> None:
    """Analyze what was read."""
    chosen: dict[str, Any] = {} if recording.bodies else {"arm_markers": ARM, "forearm_markers": FOREARM}
    if len(recording.bodies) > 1 and not recording.bodies[0].name.startswith("arm"):
        chosen = {"proximal": "#1", "distal": "#2"}
    try:
        analysis = analyze(recording, Settings(min_tracked_percent=0, min_angle_deg=0.1, **chosen))
    except ElbowscrewError:
        outcomes[kind]["analysis refused"] += 1
        return
    assert np.isfinite(analysis.screw.angle[analysis.screw.valid]).all()
    outcomes[kind]["analyzed"] += 1


def change_once(data: bytes, before: Recording, rng: random.Random) -> None:
    """Change a file in one place, read it again, and hold it against the file before."""
    kind = kind_of(data)
    changed, what = (change_bytes if kind == "C3D" else change_text)(data, rng)
    after = read(changed)
    if after is None:
        return
    moved = differences(before, after)
    told = {one.code for one in after.warnings} - {one.code for one in before.warnings}
    if what == "header":  # what moves in one place alone was a number
        silent = len(moved) > 1 and not told and not stated_otherwise(before, after)
    elif what == "row":
        silent = bool(moved) or not is_without_a_row(before, after)
    else:
        silent = len(moved) > 1 or before.frame.size != after.frame.size
    outcomes[kind][f"held against: {what}"] += 1
    if silent:
        keep(f"silent {kind} {what}", changed, f"{sorted(moved)[:9]} {before.source} {after.source}", data)


def entities(recording: Recording) -> dict[str, Any]:
    """Poses of bodies and positions of markers, by name."""
    found: dict[str, Any] = {f"marker {one.name}": one.position for one in recording.markers}
    for body in recording.bodies:
        pose = body.dual_quat_lab_body
        first = np.take_along_axis(pose[:, :4], np.abs(np.nan_to_num(pose[:, :4])).argmax(axis=1)[:, None], axis=1)
        found[f"body {body.name}"] = pose * np.where(first < 0.0, -1.0, 1.0)
    return found


def differences(before: Recording, after: Recording) -> set[tuple[str, int]]:
    """What of the same name is not the same, row by row."""
    old, new = entities(before), entities(after)
    return {
        (name, int(row))
        for name in old.keys() & new.keys()
        if old[name].shape == new[name].shape
        for row in np.flatnonzero(~((old[name] == new[name]) | (np.isnan(old[name]) & np.isnan(new[name]))).all(axis=1))
    }


def stated_otherwise(before: Recording, after: Recording) -> bool:
    """Whether the file states another unit or another order of angles, which may have done it."""
    assert before.source is not None
    assert after.source is not None
    said, says = before.source, after.source
    return (said.length_unit, said.rotation_type) != (says.length_unit, says.rotation_type)


def is_without_a_row(before: Recording, after: Recording) -> bool:
    """Whether all is as it was but for a row that is no more, and blank ones that end the file without it."""
    old, new = entities(before), entities(after)
    rows, count = before.frame.size, after.frame.size
    if rows == count:  # the line was none
        return True
    if old.keys() != new.keys() or count > rows:
        return False
    if count < rows - 1 and not all(np.isnan(one[count : rows - 1]).all() for one in old.values()):
        return False
    return any(
        all(np.array_equal(np.delete(old[name], row, axis=0)[:count], new[name], equal_nan=True) for name in old)
        for row in range(rows)
    )


def change_bytes(data: bytes, rng: random.Random) -> tuple[bytes, str]:
    """Change a byte of the last third of a C3D file, which is coordinates, or one before them."""
    changed = bytearray(data)
    for _ in range(64):  # until it is one that the library is asked about
        changed = bytearray(data)
        number = rng.random() < 0.5
        at = rng.randrange(len(data) * 2 // 3, len(data)) if number else rng.randrange(2, 1536)
        changed[at % len(data)] = rng.choice((0, 1, 2, 127, 128, 255, rng.randrange(256)))
        if zlib.crc32(changed) % OPENED_OF == 0:
            break
    return bytes(changed), "cell" if number else "header"


def change_text(data: bytes, rng: random.Random) -> tuple[bytes, str]:
    """Change one cell among the numbers, take a row out, shift the cells of one, or change the header."""
    lines = data.split(b"\n")
    what = rng.choice(("cell", "cell", "row", "shift", "header"))
    row = rng.randrange(len(lines) * 2 // 3, len(lines))
    if what == "header":
        row = rng.randrange(max(1, len(lines) // 3))
    if what == "row":
        return b"\n".join(lines[:row] + lines[row + 1 :]), what
    delimiter = max(b",;\t ", key=lines[row].count).to_bytes()
    cells = lines[row].split(delimiter)
    column = rng.randrange(len(cells))
    if what == "cell" or (what == "header" and rng.random() < 0.5):
        cells[column] = rng.choice((*NUMBERS, *TOKENS) if what == "header" else NUMBERS)
    elif rng.random() < 0.5:
        del cells[column]
    else:
        cells.insert(column, rng.choice(NUMBERS))
    lines[row] = delimiter.join(cells)
    return b"\n".join(lines), what


def keep(what: str, data: bytes, told: str, before: bytes = b"") -> None:
    """Keep a find, and count others of its kind."""
    outcomes[kind_of(data)][f"FIND: {what}"] += 1
    name = f"{zlib.crc32(what.encode()):08x}"
    if sum(one.startswith(name) for one in seen) >= 12:
        return
    name += f"-{zlib.crc32(data):08x}"
    seen.add(name)
    (finds / f"{name}.txt").write_text(f"{what}\n{told}\n", encoding="utf-8", errors="replace")
    (finds / f"{name}.mutant").write_bytes(data)
    if before:
        (finds / f"{name}.before").write_bytes(before)


TOKENS = tuple(
    """|nan|inf|-1e400|1e308|-0|0|1|1e-320|99999999999999999999|-5|0.5|x|"|"1,2"|1,5| 1 |1e5|frame|Rigid Body|Rotation|W
    Frame|6.5|\x00|\xff""".encode("latin-1").split(b"|")
)
NUMBERS = b"|0|1|-1|0.5|-0.5|7|-7|1e-9|1e308|1e150|-1e5|3e4|0.0|-0|1e-320|180|-180|90".split(b"|")


def mutate(data: bytes, max_size: int, seed: int) -> bytes:
    """Mostly change whole cells and lines, so that many mutants get past the header; else let atheris."""
    rng = random.Random(seed)  # noqa: S311 - no secret
    if rng.random() < FROM_A_SEED:  # else files of the format with the most branches would be most of all
        data = rng.choice(good)
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


def finish() -> None:
    """Print the counts and end; libFuzzer would end the process itself, without a word of ours."""
    slow = {kind: round(took, 3) for kind, took in slowest.items()}
    print(json.dumps({"counts": outcomes, "slowest_s": slow, "finds": str(finds)}, indent=1), flush=True)
    os._exit(any("FIND" in what for count in outcomes.values() for what in count))


def main() -> None:
    """Run atheris from the seeds."""
    global wanted_count, last_moment, finds
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("count", nargs="?", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--new", action="store_true")
    parser.add_argument("--seconds", type=float, default=float("inf"))
    parser.add_argument("--only", default="*")
    parser.add_argument("--finds", type=Path, default=finds)
    given = parser.parse_args()
    wanted_count, finds, last_moment = given.count, given.finds, time.monotonic() + given.seconds
    finds.mkdir(parents=True, exist_ok=True)
    corpus = SCRATCH / "corpus"
    corpus.mkdir()
    seeds(corpus)
    for path in sorted(corpus.iterdir()):
        if not path.match(given.only) or (given.new and path.stem in OLD):
            path.unlink()
        else:
            good.append(path.read_bytes())
    c3d._worker_output = opened_in_a_fork
    atheris.Setup(
        [
            sys.argv[0],
            f"-seed={given.seed}",
            "-max_len=16384",
            "-timeout=60",
            "-mutate_depth=2",
            "-verbosity=0",
            str(corpus),
        ],
        one,
        custom_mutator=mutate,
    )
    atheris.Fuzz()


if __name__ == "__main__":
    main()
