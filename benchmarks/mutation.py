"""Which small faults in the code the tests see: some at random, one at a time, in a copy of the sources.

    python benchmarks/mutation.py results --tests tests/results tests/last_mile --count 60 --seed 1

A fault is a comparison turned round, an operator, a number, a word or a function for its neighbor, a condition negated,
or a keyword argument left out. Each meets the tests that run its statement, quick ones first, until one fails; which
they are, coverage.py tells beforehand, once for each of the folders of tests. Where a statement runs when its module is
imported or in a child process, they are all tests of the folders that come by it. Faults that no test sees are printed
as line and change; some change nothing that can be seen, and only reading them tells.
"""

from __future__ import annotations

import argparse
import ast
import os
import random
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import coverage
import pytest

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = Path("elbowscrew")
ENDLESS_S = 180  # a test that takes longer has met an endless loop
SLOW_S = 1.0
OPERATORS: dict[type[ast.AST], type[ast.AST]] = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.Pow: ast.Mult, ast.MatMult: ast.Mult,
    ast.Lt: ast.GtE, ast.LtE: ast.Lt, ast.Gt: ast.LtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot, ast.IsNot: ast.Is, ast.In: ast.NotIn, ast.NotIn: ast.In, ast.And: ast.Or, ast.Or: ast.And,
    ast.BitAnd: ast.BitOr, ast.BitOr: ast.BitAnd,
}  # fmt: skip
NAMES = {
    "nanmax": "nanmin", "nanmin": "nanmax", "max": "min", "min": "max", "nanmedian": "nanmean", "median": "mean",
    "mean": "median", "rms": "abs", "sum": "mean", "degrees": "radians", "radians": "degrees", "sin": "cos",
    "cos": "sin", "arcsin": "arctan", "any": "all", "all": "any", "argmax": "argmin", "argmin": "argmax",
    "nanargmax": "nanargmin", "sqrt": "square", "direction": "point", "point": "direction", "proximal": "distal",
    "distal": "proximal", "start": "end", "end": "start", "valid": "filled", "filled": "valid", "hypot": "add",
}  # fmt: skip


class Fault(NamedTuple):
    """The module, the node of its tree, and what is changed there; the tree is parsed again for each.

    `lines` are those of its statement, without the body of one that has a body.
    """

    file: Path
    node: int
    change: int
    lines: range
    at_import: bool

    def made(self, text: str) -> tuple[str, str, str]:
        """What stands there, what is put there, and the whole source with it."""
        tree = ast.parse(text)
        place = list(ast.walk(tree))[self.node]
        before = _text(place)
        for name, value in list(_changes(place))[self.change].items():
            setattr(place, name, value)
        return before, _text(place), ast.unparse(ast.fix_missing_locations(tree))


def faults_of(file: Path) -> Iterator[Fault]:
    """Every fault that can be made in a module; what stands in an annotation or a docstring does nothing."""
    nodes = list(ast.walk(ast.parse(file.read_text(encoding="utf-8"))))
    idle = {id(part) for node in nodes for idle in _idle(node) for part in ast.walk(idle)}
    late = {id(part) for node in nodes for body in _late(node) for part in ast.walk(body)}
    statement = {id(part): node for node in nodes if isinstance(node, ast.stmt) for part in ast.walk(node)}
    for number, node in enumerate(nodes):
        if id(node) not in idle:
            for change, _ in enumerate(_changes(node)):
                owner = statement[id(node)]
                yield Fault(file, number, change, _own_lines(owner), id(node) not in late)


def _idle(node: ast.AST) -> list[ast.expr]:
    match node:
        case ast.AnnAssign(annotation=annotation):
            return [annotation]
        case ast.arg(annotation=ast.expr() as annotation):
            return [annotation]
        case ast.FunctionDef(returns=ast.expr() as returns):
            return [returns]
        case ast.Expr(value=ast.Constant(value=str()) as docstring):
            return [docstring]
        case _:
            return []


def _late(node: ast.AST) -> list[ast.stmt] | list[ast.expr]:
    """What runs when it is called, for each test anew."""
    match node:
        case ast.FunctionDef(body=body, decorator_list=decorators):
            return [] if any("cache" in ast.unparse(decorator) for decorator in decorators) else body
        case ast.Lambda(body=value):
            return [value]
        case _:
            return []


def _own_lines(statement: ast.stmt) -> range:
    first = min(part.lineno for part in (statement, *getattr(statement, "decorator_list", [])))
    if getattr(statement, "body", None):
        return range(first, max(statement.lineno + 1, statement.body[0].lineno))  # type: ignore[attr-defined]
    return range(first, (statement.end_lineno or first) + 1)


def _text(node: ast.AST) -> str:
    return ast.unparse(node).split("\n")[0][:100]


def _changes(node: ast.AST) -> Iterator[dict[str, object]]:
    match node:
        case ast.BinOp(op=op) | ast.BoolOp(op=op) | ast.AugAssign(op=op) if type(op) in OPERATORS:
            # `|` between types is no arithmetic, and joins mappings otherwise.
            if not isinstance(op, ast.BitOr | ast.BitAnd):
                yield {"op": OPERATORS[type(op)]()}
        case ast.Compare(ops=[op]) if type(op) in OPERATORS:
            yield {"ops": [OPERATORS[type(op)]()]}
        case ast.Constant(value=bool(value)):
            yield {"value": not value}
        case ast.Constant(value=int(value)):
            yield {"value": value + 1}
        case ast.Constant(value=float(value)):
            yield {"value": 2.0 * value if value else 1.0}
        case ast.Constant(value=str(value)) if value.strip():
            yield {"value": f"{value}X"}
        case ast.Attribute(attr=name) if name in NAMES:
            yield {"attr": NAMES[name]}
        case ast.Name(id=name, ctx=ast.Load()) if name in NAMES:
            yield {"id": NAMES[name]}
        case ast.IfExp(test=test) | ast.If(test=test):
            yield {"test": ast.UnaryOp(ast.Not(), test)}
        case ast.UnaryOp(op=ast.USub(), operand=operand) if not isinstance(operand, ast.Constant):
            yield {"op": ast.UAdd()}
        case ast.Call(keywords=[*_, last]) if last.arg is not None:
            yield {"keywords": node.keywords[:-1]}


class Observer:
    """Tells coverage.py which test runs, or which fixture that serves several, and how long each test takes."""

    def __init__(self, cov: coverage.Coverage, log: Path) -> None:
        self.cov, self.log, self.test = cov, log, ""

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        self.test = item.nodeid
        self.cov.switch_context(self.test)
        return (yield)

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: pytest.FixtureDef[Any]) -> Iterator[None]:
        if fixturedef.scope != "function":
            self.cov.switch_context(fixturedef.argname)
        try:
            return (yield)
        finally:
            self.cov.switch_context(self.test)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_call(self, item: pytest.Function) -> Iterator[None]:
        start = time.perf_counter()
        try:
            return (yield)
        finally:
            names = [item.nodeid, *item.fixturenames]
            with self.log.open("a", encoding="utf-8") as log:
                print(time.perf_counter() - start, *names, sep="\t", file=log)


class Run:
    """What a folder of tests runs of the sources, told by a run without a fault."""

    def __init__(self, tests: str, sources: Path, kept: Path) -> None:
        self.tests = tests
        settings, log = kept / "settings", kept / "tests"
        data = f"data_file = {kept / 'data'}\nparallel = true\nsource = {sources / PACKAGE}"
        settings.write_text(f"[run]\n{data}\npatch = subprocess, _exit\ndisable_warnings = no-data-collected\n")
        if _in_child(lambda: self._observed(settings, log, sources)):
            raise SystemExit(f"{tests}: tests fail without any fault")
        rows = [line.split("\t") for line in log.read_text(encoding="utf-8").splitlines()]
        self.seconds = {test: float(seconds) for seconds, test, *_ in rows}
        self.names = {test: {test, *fixtures} for _, test, *fixtures in rows}
        self.contexts: dict[tuple[str, int], set[str]] = {}
        for file in kept.glob("data.*"):
            found = coverage.CoverageData(str(file))
            found.read()
            for module in found.measured_files():
                for line, contexts in found.contexts_by_lineno(module).items():
                    self.contexts.setdefault((module, line), set()).update(contexts)

    def _observed(self, settings: Path, log: Path, sources: Path) -> int:
        cov = coverage.Coverage(config_file=str(settings))
        cov.start()
        status = _pytest([self.tests, "--tb=short"], sources, Observer(cov, log))
        cov.stop()
        return status  # what is measured is saved as the process ends

    def reaching(self, fault: Fault) -> dict[str, tuple[bool, bool]]:
        """The tests that run the fault's statement; first those with False, False: that surely do, and quickly."""
        contexts = set().union(*(self.contexts.get((str(fault.file), line), ()) for line in fault.lines))
        if not contexts:
            return {}
        surely = contexts - {""}
        if fault.at_import:
            surely = set().union(*(names for (module, _), names in self.contexts.items() if module == str(fault.file)))
        return {
            test: (names.isdisjoint(surely), self.seconds[test] > SLOW_S)
            for test, names in self.names.items()
            if fault.at_import or "" in contexts or not names.isdisjoint(surely)
        }


class Chosen:
    """Has pytest run these tests alone, the lowest key first, and ends the process where one takes too long."""

    def __init__(self, keys: dict[str, tuple[bool, bool, float]]) -> None:
        self.keys = keys

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        items[:] = sorted((item for item in items if item.nodeid in self.keys), key=lambda item: self.keys[item.nodeid])

    def pytest_runtest_logstart(self) -> None:
        signal.setitimer(signal.ITIMER_REAL, ENDLESS_S)


def seen(runs: list[Run], fault: Fault, sources: Path) -> bool:
    """Whether a test fails; in a process of its own, which has all libraries from this one."""
    reached = [(run, run.reaching(fault)) for run in runs]
    keys = {
        test: (*key, sum(run.seconds[test] for test in tests)) for run, tests in reached for test, key in tests.items()
    }
    if not keys:
        return False
    folders = [run.tests for run, tests in reached if tests]
    status = _in_child(lambda: _pytest([*folders, "-x", "--tb=no"], sources, Chosen(keys), silent=True))
    if status == pytest.ExitCode.INTERNAL_ERROR:
        raise SystemExit(f"pytest itself fails: {fault}")
    return status != 0


def _pytest(arguments: list[str], sources: Path, plugin: object, *, silent: bool = False) -> int:
    if silent:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, 1)
        os.dup2(nowhere, 2)
        signal.setitimer(signal.ITIMER_REAL, ENDLESS_S)
    os.environ["PYTHONPATH"] = str(sources)
    sys.path.insert(0, str(sources))
    sys.path_importer_cache.clear()
    kept = f"--basetemp={sources.parent / 'written'}"  # the usual folder is shared with other runs
    return int(pytest.main(["-q", "-p", "no:cacheprovider", kept, *arguments], plugins=[plugin]))


def _in_child(work: Callable[[], int]) -> int:
    """What the work in a process of its own ends with; less than 0 where a signal has ended it."""
    child = os.fork()
    if child == 0:
        status = int(pytest.ExitCode.INTERNAL_ERROR)
        try:
            status = work()
        finally:
            os._exit(status)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rooms", nargs="+", help="folders or modules of the package")
    parser.add_argument("--tests", nargs="+", required=True, help="folders or modules of tests")
    parser.add_argument("--count", type=int, default=50, help="faults in each room")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--again", type=Path, help="what an earlier run printed: of its faults only those not seen")
    chosen = parser.parse_args()
    again = chosen.again and chosen.again.read_text(encoding="utf-8").splitlines()
    os.chdir(ROOT)
    os.environ["OPENBLAS_NUM_THREADS"] = "1"  # threads do not live through a fork
    sys.path[:] = [path for path in sys.path if not (Path(path) / PACKAGE / "__init__.py").is_file()]
    for library in ( "jinja2", "matplotlib.pyplot", "pandas", "pydantic", "rich.table", "scipy.linalg",
                    "scipy.optimize", "scipy.signal", "scipy.spatial.transform", "scipy.stats", "typer"):  # fmt: skip
        __import__(library)
    sys.dont_write_bytecode = True
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name).resolve()
        sources = folder / "src"
        shutil.copytree(ROOT / "src", sources, ignore=shutil.ignore_patterns("__pycache__"))
        os.environ["HYPOTHESIS_STORAGE_DIRECTORY"] = str(folder / "hypothesis")
        runs = []
        for number, tests in enumerate(chosen.tests):
            kept = folder / str(number)
            kept.mkdir()
            runs.append(Run(tests, sources, kept))
        for room in chosen.rooms:
            _score(room, runs, sources, chosen.count, chosen.seed, again)


def _score(room: str, runs: list[Run], sources: Path, count: int, seed: int, again: list[str] | None) -> None:
    place = sources / PACKAGE / room
    files = sorted(place.rglob("*.py")) if place.is_dir() else [place.with_suffix(".py")]
    possible = [fault for file in files for fault in faults_of(file)]
    faults = random.Random(seed).sample(possible, min(count, len(possible)))  # noqa: S311
    tried, killed, start = 0, 0, time.perf_counter()
    for fault in faults:
        kept = fault.file.read_text(encoding="utf-8")
        before, after, source = fault.made(kept)
        not_seen = f"not seen: {fault.file.relative_to(sources / PACKAGE)}:{fault.lines.start}: {before}  ->  {after}"
        if again is not None and not_seen not in again:
            continue
        tried += 1
        fault.file.write_text(source, encoding="utf-8")
        if seen(runs, fault, sources):
            killed += 1
            print(".", end="", flush=True)
        else:
            print(f"\n{not_seen}", flush=True)
        fault.file.write_text(kept, encoding="utf-8")
    print(
        f"\n{room}: {killed} of {tried} faults seen ({100.0 * killed / max(tried, 1):.0f} %), of {len(possible)} "
        f"possible, seed {seed}, {time.perf_counter() - start:.0f} s"
    )


if __name__ == "__main__":
    main()
