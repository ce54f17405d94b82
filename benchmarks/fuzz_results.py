"""Edit and cut what the program reads back: ``python benchmarks/fuzz_results.py COUNT [SEED]``.

Result folders (all JSON files and tables), tables of a batch, manifests, settings, landmarks, cycles and keyframes. The
only error that any of it may cause is ElbowscrewError with one short line; everything must be done with in a second of
the processor's time. Outcomes are counted by kind of file; a failure names its seed, which makes it again.
"""

from __future__ import annotations

import json
import random
import shutil
import subprocess
import sys
import tempfile
import time
import warnings
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

from elbowscrew import interpolate, read_keyframes, read_landmarks, save_motion, save_simulation, simulate_trial
from elbowscrew.configuring import settings_from
from elbowscrew.cycle_times import read_cycle_times
from elbowscrew.errors import ElbowscrewError, UsageError
from elbowscrew.report import remake_pages
from elbowscrew.results.result_files import is_summary
from elbowscrew.results.staging import check_result_folder
from elbowscrew.study.trials import find_trials

LONGEST_S = 1.0
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
CYCLES = "start_time_s,end_time_s\n0.1,0.9\n1.0,1.9\n2,3\n"


def seeds(folder: Path) -> None:
    """A study of two results with all tables, and good files of the other kinds."""
    trial = simulate_trial(frames=120, inversion=60, repetitions=3)
    for name in ("one", "two"):
        (folder / "in").mkdir(exist_ok=True)
        save_simulation(trial, folder / "in" / f"{name}.csv")
    batch = ["batch", "in", "-o", "study", "--figure-format", "none", "--workers", "1", "-q"]
    subprocess.run([sys.executable, "-m", "elbowscrew", *batch], cwd=folder, check=True)
    others = {"a.toml": TOML, "landmarks.toml": LANDMARKS, "manifest.csv": MANIFEST, "cycles.csv": CYCLES}
    for name, text in others.items():
        (folder / name).write_text(text)


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


def read_study(folder: Path, _changed: Path) -> None:
    """Make all pages anew, and ask whether a result may be replaced."""
    for result in (folder / "study").iterdir():
        if result.is_dir():
            is_summary(result / "summary.json")
    try:
        check_result_folder(folder / "study" / "one", force=True)
    except ElbowscrewError as error:
        check_message(error)
    for fault in remake_pages([folder / "study"]).errors:
        check_message(fault)


def read_settings(_folder: Path, changed: Path) -> None:
    settings_from(changed)


def read_marks(_folder: Path, changed: Path) -> None:
    read_landmarks(changed)


def read_manifest(_folder: Path, changed: Path) -> None:
    find_trials([str(changed)])


def read_cycles(_folder: Path, changed: Path) -> None:
    try:
        read_cycle_times(changed)
    except ValueError as error:  # of a setting: its error is the settings'
        raise UsageError(str(error)) from error


def read_poses(folder: Path, changed: Path) -> None:
    save_motion(interpolate(read_keyframes(changed), 20), folder / "motion.csv", overwrite=True)


READERS: dict[str, Callable[[Path, Path], None]] = {
    "study/one/summary.json": read_study,
    "study/one/joint.json": read_study,
    "study/one/screw.csv": read_study,
    "study/one/interpolation.csv": read_study,
    "study/one/repetitions.csv": read_study,
    "study/one/repetition_curve.csv": read_study,
    "study/one/joint_angles.csv": read_study,
    "study/one/axis_path.csv": read_study,
    "study/summary.csv": read_study,
    "study/failures.csv": read_study,
    "study/one/keyframes.csv": read_poses,
    "a.toml": read_settings,
    "landmarks.toml": read_marks,
    "manifest.csv": read_manifest,
    "cycles.csv": read_cycles,
}


def check_message(error: Exception) -> None:
    """An error is one line with an end."""
    assert "\n" not in str(error)
    assert len(str(error)) < LONGEST_MESSAGE, len(str(error))


def one(folder: Path, seed: int, outcomes: Counter[str], longest_s: float = LONGEST_S) -> None:
    """Change one file, read it, and put it back."""
    rng = random.Random(seed)  # noqa: S311 - no secret
    name = rng.choice([name for name in READERS if (folder / name).exists()])
    path = folder / name
    good = path.read_bytes()
    path.write_bytes(edited(path, rng))
    before = time.process_time()
    try:
        READERS[name](folder, path)
        outcomes[f"{name}: read"] += 1
    except ElbowscrewError as error:
        check_message(error)
        outcomes[f"{name}: refused"] += 1
    finally:
        path.write_bytes(good)
    assert time.process_time() - before < longest_s, f"took {time.process_time() - before:.1f} s"


def run(count: int, first: int, longest_s: float = LONGEST_S) -> Counter[str]:
    """Run so many seeds; the first that fails raises, and is named."""
    outcomes: Counter[str] = Counter()
    folder = Path(tempfile.mkdtemp(prefix="elbowscrew-fuzz-"))
    try:
        seeds(folder)
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # a warning of NumPy is a number that nobody looked at
            for seed in range(first, first + count):
                try:
                    one(folder, seed, outcomes, longest_s)
                except BaseException as error:
                    error.add_note(f"seed {seed}")
                    raise
    finally:
        shutil.rmtree(folder)
    return outcomes


if __name__ == "__main__":
    given = [int(text) for text in sys.argv[1:3]]
    for outcome, times in sorted(run(*given, *(20_000, 0)[len(given) :]).items()):
        print(f"{outcome}: {times}")
