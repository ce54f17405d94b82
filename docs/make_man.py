"""Make the man page, `packaging/elbowscrew.1`, from the program's commands: ``python docs/make_man.py``."""

from __future__ import annotations

import re
import runpy
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

from elbowscrew._version import __version__

DOCS: Final = Path(__file__).parent
PAGE: Final = DOCS.parent / "packaging" / "elbowscrew.1"
_DECLARED: Final = runpy.run_path(str(DOCS / "_extensions" / "declared.py"))


def page() -> str:
    """Text of the man page, as `man` reads it (man(7))."""
    return "\n".join(_lines()) + "\n"


def _lines() -> Iterator[str]:
    yield '.\\" Made by docs/make_man.py from the commands themselves; do not edit.'
    yield f'.TH ELBOWSCREW 1 "" "elbowscrew {__version__}" "User Commands"'
    yield from (".SH NAME", _text("elbowscrew - screw motion of a joint from recordings of two rigid bodies"))
    yield from (".SH SYNOPSIS", ".B elbowscrew", r"\fICOMMAND\fR [\fIOPTIONS\fR]")
    yield from (
        ".SH DESCRIPTION",
        _text("By dual quaternions: angle, screw axis and slide of every frame, the joint's"),
    )
    yield _text(
        "type and axis with what holds 95 % of their errors, a model through a few poses, figures, pages, studies."
    )
    yield _text("A command ends with --help for its options, as here. Settings stand in a TOML file (--config), too.")
    found: dict[str, Any] = _DECLARED["commands"]()
    for name, command in found.items():
        yield from _command(name, command)
    yield from (".SH EXIT STATUS", *_exit_codes())
    yield from (
        ".SH FILES",
        _text("A result folder has summary.json, joint.json, tables (.csv), figures/, report.html,"),
    )
    yield _text("methods.txt, and SHA256SUMS, which sha256sum --check reads.")


def _command(name: str, command: Any) -> Iterator[str]:
    yield f".SH {name.upper()}"
    yield _text(_DECLARED["usage"](name, command))
    for paragraph in _DECLARED["paragraphs"](command):
        yield from (".PP", _text(paragraph))
    for title, parameters in _DECLARED["panels"](command).items():
        yield f".SS {_text(title)}"
        for one in parameters:
            takes = "" if title == "Arguments" or not one.takes else f" \\fI{_text('|'.join(one.takes))}\\fR"
            yield from (".TP", ", ".join(f"\\fB{_text(word)}\\fR" for word in one.names) + takes)
            yield _text(one.text + (f" Default: {one.default}." if one.default else "")) or "."
    examples = _DECLARED["examples"](command)
    if examples:
        yield from (".SS Examples", ".nf", *map(_text, examples), ".fi")


def _exit_codes() -> Iterator[str]:
    """Give those of the reference, so that they are written once."""
    text = (DOCS / "reference" / "outputs.md").read_text(encoding="utf-8").partition("## Exit codes\n")[2]
    told = " ".join(text.strip().partition("\n\n")[0].split()).rstrip(".")
    for code, meaning in re.findall(r"(\d+) ([^;.]+?)(?:; |\. |$)", re.sub(r", (?=\d+ )", "; ", told)):
        yield from (".TP", f".B {code}", _text(meaning))


def _text(text: str) -> str:
    """Escape what roff would take for its own."""
    plain = text.replace("\\", "\\e").replace("-", "\\-")
    return f"\\&{plain}" if plain[:1] in (".", "'") else plain


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
