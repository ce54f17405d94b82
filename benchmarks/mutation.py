"""Which small faults in the code the tests see: some at random, one at a time, in a copy of the sources.

    python benchmarks/mutation.py results --tests tests/results tests/last_mile --count 60 --seed 1

A fault is a comparison turned round, an operator, a number, a word or a function for its neighbor, a condition negated,
or a keyword argument left out. Those that no test sees are printed as line and change; some change nothing that can be
seen, and only reading them tells.
"""

from __future__ import annotations

import argparse
import ast
import os
import random
import resource
import shutil
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = Path("elbowscrew")
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
    """The module, the node of its tree, and what is changed there; the tree is parsed again for each."""

    file: Path
    node: int
    change: int

    def made(self, text: str) -> tuple[str, str, str]:
        """What stands there, what is put there, and the whole source with it."""
        tree = ast.parse(text)
        place = list(ast.walk(tree))[self.node]
        before = _text(place)
        for name, value in list(_changes(place))[self.change].items():
            setattr(place, name, value)
        return before, _text(place), ast.unparse(ast.fix_missing_locations(tree))


def faults_of(file: Path, text: str) -> Iterator[Fault]:
    """Every fault that can be made in a module; what stands in an annotation does nothing."""
    nodes = list(ast.walk(ast.parse(text)))
    idle = {id(part) for node in nodes if isinstance(node, ast.AnnAssign) for part in ast.walk(node.annotation)}
    for number, node in enumerate(nodes):
        if id(node) not in idle:
            for change, _ in enumerate(_changes(node)):
                yield Fault(file, number, change)


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


def _bare(text: str) -> str:
    """The source without docstrings and annotations: a fault in them is none."""
    tree = ast.parse(text)
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef):
            node.returns = None
            for argument in (*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs):
                argument.annotation = None
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
            node.body = [
                part
                for k, part in enumerate(node.body)
                if not (
                    isinstance(part, ast.Expr)
                    and isinstance(part.value, ast.Constant)
                    and isinstance(part.value.value, str)
                )
            ] or [ast.Pass()]
    return ast.unparse(ast.fix_missing_locations(tree))


def seen(tests: list[str], sources: Path, limit_s: int) -> bool:
    """Whether a test fails; in a process of its own, which has all libraries from this one."""
    child = os.fork()
    if child == 0:
        silent = os.open(os.devnull, os.O_WRONLY)
        os.dup2(silent, 1)
        os.dup2(silent, 2)
        resource.setrlimit(resource.RLIMIT_CPU, (limit_s, limit_s))  # a fault may make a loop endless
        os.environ["PYTHONPATH"] = str(sources)
        sys.path.insert(0, str(sources))
        sys.path_importer_cache.clear()
        import pytest

        os._exit(int(pytest.main(["-q", "-x", "-p", "no:cacheprovider", *tests])))
    return os.waitpid(child, 0)[1] != 0


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rooms", nargs="+", help="folders or modules of the package")
    parser.add_argument("--tests", nargs="+", required=True)
    parser.add_argument("--count", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--limit", type=int, default=300, help="seconds of the processor for the tests of one fault")
    parser.add_argument("--only", default="", help="tests whose names this expression of pytest's -k fits")
    chosen = parser.parse_args()
    os.chdir(ROOT)
    os.environ["OPENBLAS_NUM_THREADS"] = "1"  # threads do not live through a fork
    tests = [*chosen.tests, "-k", chosen.only]
    sys.path[:] = [path for path in sys.path if not (Path(path) / PACKAGE).is_dir()]
    for library in ( "jinja2", "matplotlib.pyplot", "pandas", "pydantic", "rich.table", "scipy.linalg",
                    "scipy.optimize", "scipy.signal", "scipy.spatial.transform", "scipy.stats", "typer"):  # fmt: skip
        __import__(library)
    with tempfile.TemporaryDirectory() as folder:
        sources = Path(folder) / "src"
        shutil.copytree(ROOT / "src", sources, ignore=shutil.ignore_patterns("__pycache__"))
        sys.dont_write_bytecode = True
        files = [path for room in chosen.rooms for path in _modules(sources / PACKAGE / room)]
        bare = {file: _bare(file.read_text(encoding="utf-8")) for file in files}
        found = [fault for file, text in bare.items() for fault in faults_of(file, text)]
        random.Random(chosen.seed).shuffle(found)  # noqa: S311
        assert not seen(tests, sources, chosen.limit), "the tests fail without any fault"
        killed, start = 0, time.perf_counter()
        for fault in found[: chosen.count]:
            kept = fault.file.read_text(encoding="utf-8")
            before, after, source = fault.made(bare[fault.file])
            fault.file.write_text(source, encoding="utf-8")
            if seen(tests, sources, chosen.limit):
                killed += 1
                print(".", end="", flush=True)
            else:
                place = fault.file.relative_to(sources / PACKAGE)
                print(f"\nnot seen: {place}: {before}  ->  {after}", flush=True)
            fault.file.write_text(kept, encoding="utf-8")
        count = min(chosen.count, len(found))
        print(
            f"\n{' '.join(chosen.rooms)}: {killed} of {count} faults seen ({100.0 * killed / count:.0f} %), of "
            f"{len(found)} possible, seed {chosen.seed}, {time.perf_counter() - start:.0f} s"
        )


def _modules(place: Path) -> list[Path]:
    return sorted(place.rglob("*.py")) if place.is_dir() else [place.with_suffix(".py")]


if __name__ == "__main__":
    main()
