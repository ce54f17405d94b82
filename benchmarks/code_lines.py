"""Lines of code of a tree, without blank lines, comments and docstrings: ``python benchmarks/code_lines.py [TREE]``."""

from __future__ import annotations

import argparse
import ast
import io
import tokenize
from collections import Counter
from pathlib import Path

LIMIT = 300
LAYOUT = {tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER}


def code_lines(source: str) -> int:
    """Count the lines that hold code; text that stands alone as a statement is documentation."""
    documentation = {
        line
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
        for line in range(node.lineno, (node.end_lineno or node.lineno) + 1)
    }
    found: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        lines = range(token.start[0], token.end[0] + 1)
        if token.type in LAYOUT or (token.type == tokenize.STRING and documentation.issuperset(lines)):
            continue
        found.update(lines)
    text = source.splitlines()
    return sum(bool(text[line - 1].strip()) for line in found)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("tree", nargs="?", type=Path, default=Path("src"))
    tree: Path = parser.parse_args().tree
    modules = {path.relative_to(tree): code_lines(path.read_text("utf-8")) for path in sorted(tree.rglob("*.py"))}
    if not modules:
        parser.error(f"no Python modules in {tree}")
    packages: Counter[str] = Counter()
    for path, count in modules.items():
        packages[path.parent.as_posix()] += count
    for name, count in packages.items():
        print(f"{count:7,}  {name}")
    print(f"{packages.total():7,}  total, {len(modules)} modules")
    long = {path: count for path, count in modules.items() if count > LIMIT}
    print(f"modules over {LIMIT} lines: {len(long)}")
    for path, count in long.items():
        print(f"{count:7,}  {path.as_posix()}")


if __name__ == "__main__":
    main()
