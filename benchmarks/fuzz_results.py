"""Edit and cut what the program reads back: ``python benchmarks/fuzz_results.py COUNT [SEED]``.

Result folders (every file), tables of a batch, manifests, settings, landmarks, cycles, columns and keyframes; files are
also lost, or something else has their name: a link, a folder, a pipe. The only error that any of it may cause is
ElbowscrewError with one short line; everything must be done with in a second. Of a result that is not as it
was written, figures, page and overlay must be what they were, or refused; where the digest was written anew, too, it
may be read. Outcomes are counted by kind of file; a failure names its seed, which makes it again.
"""

from __future__ import annotations

import hashlib
import json
import os
import pickle
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

from elbowscrew import (
    ComparisonPlan,
    compare,
    interpolate,
    read_keyframes,
    read_landmarks,
    read_result,
    save_comparison,
    save_motion,
    save_simulation,
    simulate_trial,
)
from elbowscrew.column_file import read_column_file
from elbowscrew.configuring import settings_from
from elbowscrew.cycle_times import read_cycle_times
from elbowscrew.errors import ElbowscrewError, ResultError, UsageError
from elbowscrew.report import remake_pages
from elbowscrew.report.study import trials_of
from elbowscrew.report.trial_page import write_trial_page
from elbowscrew.results.proof import proof_of
from elbowscrew.results.result_files import COMPARISON, SUMS, is_summary
from elbowscrew.results.staging import check_result_folder
from elbowscrew.results.trial_views import view_of_result
from elbowscrew.study.trials import find_trials

LONGEST_S = 1.0
HANGS_S = 20
DRAWN = ("report.html", "methods.txt")
"""What may be retouched: it goes into nothing else."""
LONGEST_MESSAGE = 20_000  # a line on the terminal is cut anyway

VALUES: tuple[Any, ...] = (
    None, True, 0, -1, 1e308, -1e-320, 10**400, "", "x", "\ud800", "\0", "a" * 5000, "1" * 5000, [], [1, 2, 3], [[1]],
    {}, {"x": 1}, "NaN", "../../etc", "<script>", 2**63, 0.5,
)  # fmt: skip
TOKENS = (
    "", "nan", "inf", "-1e400", "1e308", "-0", "1" * 5000, "x", '"', "\0", "\ud800", "a,b", "1;2", "=1+1",
    "0x" + "F" * 5000, "[" * 2000, "{", "\r", "\ufeff", "-1", "1e-320", "é" * 300,
)  # fmt: skip

TOML = 'proximal = "Arm"\nmin-angle = 5\nlowpass = 6.0\nkeyframes = [1, 2, 3]\nmethod = "dlb"\nsigned = "auto"\n'
LANDMARKS = """side = "right"
[landmarks]
EL = "a"
EM = ["b", "c"]
US = { body = "arm", mm = [1, 2, 3] }
RS = "d"
GH = "e"
"""
MANIFEST = "path,name,subject,min-angle,keyframes\na.csv,one,s1,5,1 2 3\nb.csv,two,s2,,\nc.csv,,s3,7,\n"
COLUMNS = """[clock]
time = "t"
unit = "ms"
[[body]]
name = "arm"
position = ["x", "y", "z"]
unit = "mm"
[body.rotation]
type = "ZXY"
columns = ["#5", "#6", "#7"]
"""
CYCLES = "start_time_s,end_time_s\n0.1,0.9\n1.0,1.9\n2,3\n"


def seeds(folder: Path) -> None:
    """A study of two results with all tables, and good files of the other kinds."""
    trial = simulate_trial(frames=60, inversion=30, repetitions=3)
    for name in ("one", "two"):
        (folder / "in").mkdir(exist_ok=True)
        save_simulation(trial, folder / "in" / f"{name}.csv")
    batch = ["batch", "in", "-o", "study", "--figure-format", "none", "--workers", "1", "-q"]
    subprocess.run([sys.executable, "-m", "elbowscrew", *batch], cwd=folder, check=True)
    plan = ComparisonPlan(laws=("linear",), counts=(2,), data=("raw",))
    save_comparison(compare(trial.recording, plan=plan), folder / "compared", figure_formats=())
    others = {
        "a.toml": TOML,
        "columns.toml": COLUMNS,
        "landmarks.toml": LANDMARKS,
        "manifest.csv": MANIFEST,
        "cycles.csv": CYCLES,
    }
    for name, text in others.items():
        (folder / name).write_text(text)
    shutil.copy(folder / "study" / "one" / "keyframes.csv", folder)


def edited(path: Path, rng: random.Random) -> bytes:
    """Change a file as somebody, or a disk, might: some values, some cells, some bytes, or cut it."""
    content = path.read_bytes()
    kind = rng.random()
    if kind < 0.1:
        return content[: rng.randrange(len(content) + 1)]
    if kind < 0.2:
        changed = bytearray(content)
        for _ in range(rng.randint(1, 5)):
            changed[rng.randrange(len(changed))] = rng.randrange(256)
        return bytes(changed)
    if path.suffix == ".json" and kind < 0.9:
        tree = json.loads(content)
        for _ in range(rng.randint(1, 2)):
            _edit(tree, rng)
        return json.dumps(tree).encode()
    lines = content.decode().split("\n")
    for _ in range(rng.randint(1, 3)):
        row = rng.randrange(len(lines))
        mark = "," if path.suffix == ".csv" else " "
        cells = lines[row].split(mark)
        column = rng.randrange(len(cells))
        action = rng.randrange(6)
        if action <= 2:
            cells[column] = rng.choice(TOKENS)
        elif action == 3:
            del cells[column]
        elif action == 4:
            cells.insert(column, rng.choice(TOKENS))
        else:
            cells = [*cells, *lines[rng.randrange(len(lines))].split(mark)]
        lines[row] = mark.join(cells)
    return "\n".join(lines).encode("utf-8", "surrogatepass")


def _edit(tree: Any, rng: random.Random) -> None:
    """Change, remove or add one value somewhere in a tree."""
    at = tree
    while True:
        keys = list(at) if isinstance(at, dict) else list(range(len(at)))
        if not keys:
            return
        key = rng.choice(keys)
        if isinstance(at[key], dict | list) and at[key] and rng.random() < 0.8:
            at = at[key]
            continue
        if rng.random() < 0.15:
            del at[key]
        else:
            at[key] = rng.choice(VALUES)
        return


def read_result_of(folder: Path, changed: Path, rng: random.Random) -> None:
    """Read one result in two of the ways there are: what it was before, or what is wrong."""
    result = folder / "study" / "one"
    is_summary(result / "summary.json")
    try:
        different = set(proof_of(result).changed()) - set(DRAWN)
        resealed = SUMS in GOOD and (result / SUMS).read_bytes() != GOOD[SUMS]
    except ResultError as error:
        check_message(error)
        different, resealed = {SUMS}, False
    refused = None
    for name in rng.sample(list(WAYS), 2):
        try:
            made = WAYS[name](result)
        except ElbowscrewError as error:
            check_message(error)
            refused = error
        else:
            told = resealed or changed.name in DRAWN  # whether it is there is told, too
            assert told or made == GOOD.setdefault(name, made), f"{name}: numbers of an edited file"
            assert name != "result" or not different, f"{sorted(different)} not named"
    try:
        check_result_folder(result, force=True)
    except ElbowscrewError as error:
        check_message(error)
    if refused is not None:
        raise refused  # counted


def _page(result: Path) -> bytes:
    return write_trial_page(result).read_bytes()


def _whole(result: Path) -> bytes:
    read_result(result)
    return b""


WAYS: dict[str, Callable[[Path], bytes]] = {
    "figures": lambda result: repr(view_of_result(result).summary).encode(),
    "overlay": lambda result: pickle.dumps(trials_of([result])),
    "page": _page,
    "result": _whole,
}
GOOD: dict[str, bytes] = {}
"""What is made of the result as it was written."""


def read_study(folder: Path, _changed: Path, _rng: random.Random) -> None:
    """Make all pages anew."""
    for fault in remake_pages([folder / "study"]).errors:
        check_message(fault)


def read_comparison(folder: Path, _changed: Path, _rng: random.Random) -> None:
    check_result_folder(folder / "compared", force=True, kind=COMPARISON)


def read_columns(_folder: Path, changed: Path, _rng: random.Random) -> None:
    try:
        read_column_file(changed)
    except ValueError as error:  # as of cycles
        raise UsageError(str(error)) from error


def read_settings(_folder: Path, changed: Path, _rng: random.Random) -> None:
    settings_from(changed)


def read_marks(_folder: Path, changed: Path, _rng: random.Random) -> None:
    read_landmarks(changed)


def read_manifest(_folder: Path, changed: Path, _rng: random.Random) -> None:
    find_trials([str(changed)])


def read_cycles(_folder: Path, changed: Path, _rng: random.Random) -> None:
    try:
        read_cycle_times(changed)
    except ValueError as error:  # of a setting: its error is the settings'
        raise UsageError(str(error)) from error


def read_poses(folder: Path, changed: Path, _rng: random.Random) -> None:
    save_motion(interpolate(read_keyframes(changed), 20), folder / "motion.csv", overwrite=True)


RESULT = (
    "summary.json", "joint.json", "screw.csv", "interpolation.csv", "repetitions.csv", "cycles.csv", "axis_path.csv",
    "repetition_curve.csv", "joint_angles.csv", "instantaneous.csv", "keyframes.csv", "report.html", "methods.txt",
    SUMS,
)  # fmt: skip

READERS: dict[str, tuple[Callable[[Path, Path, random.Random], None], int]] = {
    **{f"study/one/{name}": (read_result_of, 6 if name.endswith(".json") else 2) for name in RESULT},
    "study/two/summary.json": (read_study, 1),
    "study/two/screw.csv": (read_study, 1),
    "study/summary.csv": (read_study, 1),
    "study/failures.csv": (read_study, 1),
    "compared/compare.json": (read_comparison, 1),
    "keyframes.csv": (read_poses, 4),
    "a.toml": (read_settings, 4),
    "columns.toml": (read_columns, 4),
    "landmarks.toml": (read_marks, 4),
    "manifest.csv": (read_manifest, 4),
    "cycles.csv": (read_cycles, 4),
}
"""What reads each file, and how often it is tried beside others."""


def check_message(error: Exception) -> None:
    """An error is one line with an end."""
    assert "\n" not in str(error)
    assert len(str(error)) < LONGEST_MESSAGE, len(str(error))


def one(folder: Path, seed: int, outcomes: Counter[str], longest_s: float = LONGEST_S) -> None:
    """Change one file, read it, and put everything back."""
    rng = random.Random(seed)  # noqa: S311 - no secret
    names = [name for name in READERS if (folder / name).exists()]
    name = rng.choices(names, [READERS[name][1] for name in names])[0]
    path = folder / name
    kept = {one: one.read_bytes() for one in {path, *path.parent.glob("*")} if one.is_file()}
    change(path, rng)
    before = time.process_time()
    signal.alarm(HANGS_S)
    try:
        READERS[name][0](folder, path, rng)
        outcomes[f"{name}: read"] += 1
    except ElbowscrewError as error:
        check_message(error)
        outcomes[f"{name}: refused"] += 1
    finally:
        signal.alarm(0)
        for file, content in kept.items():
            if file.is_symlink() or not file.is_file() or file.read_bytes() != content:
                _remove(file)
                file.write_bytes(content)
    assert time.process_time() - before < longest_s, f"took {time.process_time() - before:.1f} s"


def change(path: Path, rng: random.Random) -> None:
    """Change a file, and of a result at times its digest, too; or put something else in its place."""
    kind = rng.random()
    if kind < 0.9:
        path.write_bytes(edited(path, rng))
        if (path.parent / SUMS).exists() and path.name != SUMS and kind < 0.5:
            _reseal(path)
        return
    content = path.read_bytes()
    _remove(path)
    match rng.randrange(5):
        case 0:
            path.mkdir()
        case 1:
            os.mkfifo(path)
        case 2:
            path.symlink_to("nowhere")
        case 3:
            path.write_bytes(bytes(len(content)))


def _reseal(path: Path) -> None:
    sums = path.parent / SUMS
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    sums.write_text(re.sub(rf"^[0-9a-f]{{64}}(?=  {re.escape(path.name)}$)", digest, sums.read_text(), flags=re.M))


def _remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def run(count: int, first: int, longest_s: float = LONGEST_S, failures: list[str] | None = None) -> Counter[str]:
    """Run so many seeds; the first that fails raises, and is named, or all that fail are gathered."""
    outcomes: Counter[str] = Counter()
    folder = Path(tempfile.mkdtemp(prefix="elbowscrew-fuzz-"))
    signal.signal(signal.SIGALRM, _hangs)
    try:
        seeds(folder)
        GOOD.clear()
        GOOD[SUMS] = (folder / "study" / "one" / SUMS).read_bytes()
        GOOD.update({name: read(folder / "study" / "one") for name, read in WAYS.items()})
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # a warning of NumPy is a number that nobody looked at
            for seed in range(first, first + count):
                try:
                    one(folder, seed, outcomes, longest_s)
                except Exception as error:
                    error.add_note(f"seed {seed}")
                    if failures is None:
                        raise
                    failures.append("".join(traceback.format_exception(error)))
                    print(failures[-1], flush=True)
    finally:
        shutil.rmtree(folder)
    return outcomes


def _hangs(*_given: object) -> None:
    msg = f"not done in {HANGS_S} s"
    raise AssertionError(msg)


if __name__ == "__main__":
    asked, failed = [int(text) for text in sys.argv[1:3]], list[str]()
    count, first = (*asked, *(20_000, 0)[len(asked) :])
    found = run(count, first, failures=failed)
    for outcome, times in sorted(found.items()):
        print(f"{outcome}: {times}")
    print(f"{sum(found.values())} read or refused, {len(failed)} wrong")
    sys.exit(1 if failed else 0)
