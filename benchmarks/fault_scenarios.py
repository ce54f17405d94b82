"""What is disturbed: every command that writes, from a state before it to the state after it."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from fault_process import CLOSED_ABOVE, MOUNTED, NO_EXCHANGE

from elbowscrew import (
    analyze,
    compare,
    keyframes_of,
    save_analysis,
    save_comparison,
    save_motion,
    save_simulation,
    simulate_trial,
)
from elbowscrew import interpolate as rebuild
from elbowscrew.cli import main
from elbowscrew.disk.temporary import UNSETTLED
from elbowscrew.motion.interpolation.keyframe_sources import ComparisonPlan
from elbowscrew.report import write_study_page
from elbowscrew.report.study_tables import STUDY_TABLES
from elbowscrew.results.proof import seal
from elbowscrew.samples import path
from elbowscrew.saving import analyze_file
from elbowscrew.settings import Settings

FAST = ("--figure-format", "none", "-q")
PLAN = ("--laws", "linear", "--counts", "2", "--data", "raw", "-q")
__all__ = ["SCENARIOS", "UNSETTLED", "Scenario", "Tree", "part_of", "state_of", "temporaries_of", "tree_of"]

SILENT = frozenset({"info"})
"""Commands that write nothing."""

Tree = dict[str, str]
"""SHA-256 of files by their paths."""


@dataclass(frozen=True)
class Scenario:
    """A command, what is there before it, and the parts of what it writes that are each the old one or the new one.

    A part is one folder, one file, or several files that belong together. A part that is `passing` may be missing after
    a disturbance: the tables of a batch that is not finished.
    """

    name: str
    arguments: tuple[str, ...]
    prepare: Callable[[Path], None]
    parts: tuple[tuple[str, ...], ...]
    passing: tuple[str, ...] = ()
    quick: bool = True
    disks: frozenset[int] = frozenset()
    """Other disks on which it is disturbed, too, by what they cannot: where folders are replaced."""

    @property
    def command(self) -> str:
        return self.arguments[0]


def tree_of(folder: Path) -> Tree:
    """Files below a folder, but locks and temporary ones."""
    return {
        path.relative_to(folder).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and ".elbowscrew-" not in path.as_posix()
    }


def state_of(folder: Path) -> frozenset[tuple[str, str]]:
    """All that is below a folder, to the last byte."""
    return frozenset(
        (path.relative_to(folder).as_posix(), hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else "")
        for path in folder.rglob("*")
    )


def temporaries_of(folder: Path) -> list[str]:
    return [str(path) for path in folder.rglob(".elbowscrew-*") if not path.name.endswith(".lock")]


def part_of(tree: Tree, part: tuple[str, ...]) -> Tree:
    return {path: digest for path, digest in tree.items() if any(_is_below(path, place) for place in part)}


def _is_below(path: str, place: str) -> bool:
    return path == place or path.startswith(f"{place}/")


def _trial(folder: Path, name: str = "t.csv", seed: int = 1) -> Path:
    export, truth = save_simulation(simulate_trial(frames=60, inversion=30, seed=seed), folder / name)
    truth.unlink()
    return export


def _result(folder: Path) -> None:
    _trial(folder)
    analysis = analyze_file(folder / "t.csv", Settings(min_angle_deg=12.0))
    save_analysis(analysis, folder / "t_elbowscrew", figure_formats=())


def _result_with_old_page(folder: Path) -> None:
    _result(folder)
    result = folder / "t_elbowscrew"
    page = (result / "report.html").read_text(encoding="utf-8")
    (result / "report.html").write_text(re.sub("<title>", "<title>Old ", page), encoding="utf-8")
    (result / "SHA256SUMS").unlink()
    seal(result)


def _result_and_bone(folder: Path) -> None:
    _result_with_old_page(folder)
    (folder / "bone.obj").write_text("v 0 0 0\nv 9 0 0\nv 0 9 0\nf 1 2 3\n", encoding="utf-8")


def _result_and_clip(folder: Path) -> None:
    _result(folder)
    (folder / "view.png").write_text("old", encoding="utf-8")


def _study(folder: Path) -> None:
    for k in range(2):
        _trial(folder, f"in/t{k}.csv", seed=k)


def _study_done(folder: Path) -> None:
    """One recording has changed since, of another result a number was doubled, and of a third the summary is cut."""
    _study(folder)
    _trial(folder, "in/t2.csv", seed=2)
    for k in range(3):
        analysis = analyze_file(folder / "in" / f"t{k}.csv", Settings(figure_format=("none",)))
        save_analysis(analysis, folder / "batch_elbowscrew" / f"t{k}", figure_formats=())
    out = folder / "batch_elbowscrew"
    (out / ".elbowscrew-batch.lock").touch()
    (out / "summary.csv").write_text("old table\n", encoding="utf-8")
    (out / "index.html").write_bytes(b"")
    (folder / "in" / "t0.csv").unlink()
    _trial(folder, "in/t0.csv", seed=9)
    text = (out / "t1" / "summary.json").read_text(encoding="utf-8")
    summary = json.loads(text)
    summary["motion"]["theta_max_deg"] = 999.5
    (out / "t1" / "summary.json").write_text(json.dumps(summary), encoding="utf-8")
    (out / "t2" / "summary.json").write_text(text[:100], encoding="utf-8")


def _simulated(folder: Path) -> None:
    save_simulation(simulate_trial(frames=40, inversion=20, seed=8), folder / "s.csv")


def _motion(folder: Path) -> None:
    analysis = analyze(simulate_trial(frames=60, inversion=30).recording)
    result = save_analysis(analysis, folder / "r", figure_formats=(), report=False)
    save_motion(rebuild(keyframes_of(analysis), 10), folder / "keyframes_motion.csv")
    assert (result / "keyframes.csv").exists()


def _compared(folder: Path) -> None:
    _trial(folder)
    plan = ComparisonPlan(laws=("cycloidal",), counts=(2,), data=("raw",))
    recording = simulate_trial(frames=60, inversion=30).recording
    save_comparison(compare(recording, plan=plan), folder / "t_compare", figure_formats=())


def _figures(folder: Path) -> None:
    _result(folder)
    (folder / "figs").mkdir()
    for name in ("theta.png", "error.png"):
        (folder / "figs" / name).write_text("old", encoding="utf-8")


def _study_with_old_pages(folder: Path) -> None:
    for k in range(2):
        _trial(folder, f"in/t{k}.csv", seed=k)
        analysis = analyze_file(folder / "in" / f"t{k}.csv", Settings(figure_format=("none",)))
        save_analysis(analysis, folder / "study" / f"t{k}", figure_formats=())
    page, tables = write_study_page(folder / "study"), [folder / "study" / name for name in STUDY_TABLES]
    page.write_text(page.read_text(encoding="utf-8").replace("<title>", "<title>Old "), encoding="utf-8")
    for table in tables:
        table.write_text(table.read_text(encoding="utf-8") + "old\n", encoding="utf-8")


def _samples_cut(folder: Path) -> None:
    """A copy that was cut off between two of its files."""
    (folder / _SAMPLES[0]).write_bytes((path() / _SAMPLES[0]).read_bytes())


def _nothing(_folder: Path) -> None:
    """Make nothing."""


_R, _OUT = "t_elbowscrew", "batch_elbowscrew"
_OVER = ("index.html", *STUDY_TABLES)
"""The page over a study, and the tables that are written with it."""
_TABLES = ((f"{_OUT}/summary.csv",), (f"{_OUT}/failures.csv",), tuple(f"{_OUT}/{name}" for name in _OVER))
_PASSING = tuple(table[0] for table in _TABLES)
_SIMULATE = ("simulate", "s.csv", "--frames", "40", "--inversion", "20", "--seed", "3")
_FIGURES = ("report", _R, "--figures", "theta,error", "--figure-format", "png", "-o", "figs", "-q")
_DRAWN = tuple(f"figs/{name}.{kind}" for name in ("theta", "error") for kind in ("png", "caption.txt"))
_PARTS = (*((f"{_OUT}/t{k}",) for k in range(3)), *_TABLES)

_SAMPLES, _SAMPLE_STUDY = (
    tuple(sorted(file.relative_to(path()).as_posix() for file in folder.iterdir() if file.is_file()))
    for folder in (path(), path("study"))
)

SCENARIOS = (
    Scenario("analyze", ("analyze", "t.csv", *FAST), _trial, ((_R,),), quick=False),  # type: ignore[arg-type]
    Scenario("analyze --force", ("analyze", "t.csv", *FAST, "--force"), _result, ((_R,),),
             disks=frozenset({NO_EXCHANGE, CLOSED_ABOVE, MOUNTED})),
    Scenario("analyze with figures", ("analyze", "t.csv", "-q", "--force"), _result, ((_R,),), quick=False),
    Scenario("analyze with exports into new folders",
             ("analyze", "t.csv", *FAST, "--export", "mat,sto", "-o", "new/folders/result"), _trial,  # type: ignore[arg-type]
             (("new",),), quick=False),
    Scenario("batch", ("batch", "in", *FAST), _study, _PARTS, passing=_PASSING, quick=False),
    Scenario("batch again", ("batch", "in", *FAST), _study_done, _PARTS, passing=_PASSING,
             disks=frozenset({NO_EXCHANGE, CLOSED_ABOVE, MOUNTED})),
    Scenario("report", ("report", _R, "-q"), _result_with_old_page, ((f"{_R}/report.html", f"{_R}/SHA256SUMS"),)),
    Scenario("report --mesh", ("report", _R, "--mesh", "arm=bone.obj", "-q"), _result_and_bone,
             ((f"{_R}/meshes.json", f"{_R}/report.html", f"{_R}/SHA256SUMS"),), quick=False),
    Scenario("report --clip --force", ("report", _R, "--clip", "view.png", "--force", "-q"), _result_and_clip,
             (("view.png",),), quick=False),
    Scenario("report of all", ("report", ".", "-q"), _result_with_old_page,
             ((f"{_R}/report.html", f"{_R}/SHA256SUMS"), _OVER), quick=False),
    Scenario("report of a study", ("report", "study", "-q"), _study_with_old_pages,
             (*((f"study/t{k}/report.html", f"study/t{k}/SHA256SUMS") for k in range(2)),
              tuple(f"study/{name}" for name in _OVER)),
             quick=False),
    Scenario("report --figures", _FIGURES, _result, (_DRAWN,), quick=False),
    Scenario("report --figures --force", (*_FIGURES, "--force"), _figures, (_DRAWN,)),
    Scenario("compare", ("compare", "t.csv", *PLAN), _trial, (("t_compare",),), quick=False),  # type: ignore[arg-type]
    Scenario("compare --force", ("compare", "t.csv", *PLAN, "--force"), _compared, (("t_compare",),),
             disks=frozenset({NO_EXCHANGE, CLOSED_ABOVE, MOUNTED})),
    Scenario("compare of a folder", ("compare", "in", *PLAN, "--force"), _study, (("in_compare",),), quick=False),
    Scenario("interpolate", ("interpolate", "r/keyframes.csv", "--frames", "30", "-o", "m.csv"), _motion,
             (("m.csv",),), quick=False),
    Scenario("interpolate --force", ("interpolate", "r/keyframes.csv", "--frames", "30", "--force"), _motion,
             (("keyframes_motion.csv",),)),
    Scenario("simulate", _SIMULATE, _nothing, (("s.csv", "s.truth.json"),), quick=False),
    Scenario("simulate --force", (*_SIMULATE, "--force"), _simulated, (("s.csv", "s.truth.json"),),
             disks=frozenset({NO_EXCHANGE})),
    Scenario("simulate --landmarks", (*_SIMULATE, "--landmarks"), _nothing,
             (("s.csv", "s.truth.json", "s.landmarks.toml"),), quick=False),
    Scenario("samples --copy", ("samples", "--copy", "."), _nothing, (_SAMPLES, _SAMPLE_STUDY), quick=False),
    Scenario("samples --copy again", ("samples", "--copy", "."), _samples_cut, (_SAMPLES, _SAMPLE_STUDY), quick=False),
    Scenario("paper --figures", ("paper", "--figures", "figs"), _nothing,
             (("figs/figures_7_and_8.png", "figs/figures_9_and_10.png"),), quick=False),
)  # fmt: skip


def check_complete() -> None:
    """Fail if the program has a command that nobody disturbs."""
    from elbowscrew.cli.app import app

    commands = {one.callback.__name__ for one in app.registered_commands if one.callback is not None}
    missing = commands - {scenario.command for scenario in SCENARIOS} - SILENT
    assert not missing, f"no scenario for {', '.join(sorted(missing))}"
    assert main is not None
