"""Command lines, files and Python that pages show, run at build, with what they print below them.

Each page has a folder of its own with the sample recordings in it; what a command writes is there for the next one.
``run`` takes command lines, ``file`` the text of a file by the name in its argument, ``python`` a program, and
``picture`` a file that they have made.
A command that ends otherwise than its ``exit`` says (0 by default) fails the build.
"""

from __future__ import annotations

import ast
import contextlib
import io
import os
import re
import shlex
import shutil
import tempfile
import traceback
from collections.abc import Iterator
from pathlib import Path
from typing import Any, ClassVar

from docutils import nodes
from docutils.parsers.rst import Directive, directives
from sphinx.application import Sphinx
from sphinx.errors import ExtensionError
from sphinx.util import logging

MADE = Path(__file__).resolve().parents[1] / "_made"
"""Pictures that the build makes."""
SAMPLES = Path(__file__).resolve().parents[2] / "sample_data"
_LOG = logging.getLogger(__name__)
_ESCAPES = re.compile(r"\x1b\[[0-9;?]*[A-Za-z]")


class Page:
    """What a page has run so far.

    Attributes
    ----------
    folder : Path
        Where it runs.
    names : dict
        Of its Python.
    """

    def __init__(self) -> None:
        self.folder = Path(tempfile.mkdtemp(prefix="elbowscrew-docs-"))
        self.names: dict[str, Any] = {"__name__": "__main__"}
        shutil.copytree(SAMPLES, self.folder, dirs_exist_ok=True)

    @contextlib.contextmanager
    def entered(self) -> Iterator[io.StringIO]:
        """Work in the page's folder, and give what is printed meanwhile."""
        former, printed = Path.cwd(), io.StringIO()
        os.chdir(self.folder)
        try:
            with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
                yield printed
        finally:
            os.chdir(former)

    def command(self, line: str) -> tuple[str, int]:
        """Run a command line, and give what it printed and its exit code."""
        from elbowscrew.cli import main

        words = shlex.split(line, comments=True)
        if words[0] != "elbowscrew":
            msg = f"only elbowscrew is run here, found {line!r}"
            raise ExtensionError(msg)
        arguments = [found for word in words[1:] for found in self._found(word)]
        with self.entered() as printed:
            code = main(arguments)
        return printed.getvalue(), code

    def _found(self, word: str) -> list[str]:
        """Give the files that a pattern means, as a shell does."""
        if not set("*?") & set(word) or '"' in word:
            return [word]
        return sorted(path.relative_to(self.folder).as_posix() for path in self.folder.glob(word)) or [word]

    def python(self, text: str) -> str:
        """Run a program, and give what it printed and what its last line is."""
        tree = ast.parse(text)
        last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
        with self.entered() as printed:
            exec(compile(tree, "<page>", "exec"), self.names)  # noqa: S102
            if isinstance(last, ast.Expr):
                value = eval(compile(ast.Expression(last.value), "<page>", "eval"), self.names)  # noqa: S307
                if value is not None:
                    print(repr(value))  # noqa: T201
        return printed.getvalue()


_PAGES: dict[str, Page] = {}


class _Shown(Directive):
    has_content = True
    option_spec: ClassVar[dict[str, Any]] = {
        "exit": directives.nonnegative_int,
        "lines": directives.nonnegative_int,
        "quiet": directives.flag,
    }
    language = "console"

    @property
    def environment(self) -> Any:
        return self.state.document.settings.env

    @property
    def page(self) -> Page:
        return _PAGES.setdefault(self.environment.docname, Page())

    @property
    def text(self) -> str:
        return "\n".join(self.content)

    def block(self, text: str, language: str, *classes: str) -> nodes.literal_block:
        return nodes.literal_block(text, text, language=language, classes=list(classes))

    def failed(self, why: str) -> None:
        """Warn, which ends a build that takes warnings for errors after all pages have been read."""
        _LOG.warning(why, location=(self.environment.docname, self.lineno))

    def result(self, printed: str) -> list[nodes.Node]:
        if "quiet" in self.options or not printed.strip():
            return []
        lines = [line.rstrip() for line in _ESCAPES.sub("", printed).strip("\n").splitlines()]
        most = self.options.get("lines", 40)
        if len(lines) > most:
            lines = [*lines[:most], "…"]
        return [self.block("\n".join(lines), "text", "printed")]


class Run(_Shown):
    """Command lines."""

    def run(self) -> list[nodes.Node]:
        """Show them, with what they print."""
        shown: list[nodes.Node] = [self.block(self.text, "sh")]
        if not self.environment.config.run_commands:
            return shown
        printed = ""
        for line in self.content:
            if not line.strip() or line.startswith("#"):
                continue
            told, code = self.page.command(line)
            printed += told
            if code != self.options.get("exit", 0):
                self.failed(f"{line!r} ended with {code}\n{told}")
        return [*shown, *self.result(printed)]


class File(_Shown):
    """A file that commands below it read."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """Show it under its name, and write it."""
        name = self.arguments[0]
        (self.page.folder / name).write_text(self.text + "\n", encoding="utf-8")
        block = self.block(self.text, {".toml": "toml"}.get(Path(name).suffix, "text"))
        return [nodes.container("", nodes.caption(name, "", nodes.literal(name, name)), block,
                                literal_block=True, classes=["literal-block-wrapper"])]  # fmt: skip


class Python(_Shown):
    """A program."""

    def run(self) -> list[nodes.Node]:
        """Show it, with what it prints."""
        shown: list[nodes.Node] = [self.block(self.text, "python")]
        if not self.environment.config.run_commands:
            return shown
        try:
            return [*shown, *self.result(self.page.python(self.text))]
        except Exception:  # whatever it is, the page must be told
            self.failed(traceback.format_exc())
            return shown


class Picture(_Shown):
    """A picture that a command above has made; the text below it tells those who cannot see it what it shows."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """Keep it beside the pages, and show it."""
        if not self.environment.config.run_commands:
            return []
        source = self.page.folder / self.arguments[0]
        if not source.exists():
            self.failed(f"no picture {self.arguments[0]}")
            return []
        name = "-".join([*self.environment.docname.split("/"), *source.relative_to(self.page.folder).parts])
        MADE.mkdir(exist_ok=True)
        shutil.copy(source, MADE / name)
        return [nodes.image("", uri=f"/{MADE.name}/{name}", alt=" ".join(self.text.split()))]


def _forget(_app: Sphinx, _error: Exception | None) -> None:
    for page in _PAGES.values():
        shutil.rmtree(page.folder, ignore_errors=True)
    _PAGES.clear()


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directives."""
    os.environ["COLUMNS"] = "88"  # how wide tables are
    app.add_config_value("run_commands", True, "env")
    app.add_directive("run", Run)
    app.add_directive("file", File)
    app.add_directive("python", Python)
    app.add_directive("picture", Picture)
    app.connect("build-finished", _forget)
    return {"parallel_read_safe": False, "parallel_write_safe": True}
