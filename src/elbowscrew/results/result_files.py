"""What a result folder may hold, and how it is told from a folder of somebody else's."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Final, NamedTuple

from elbowscrew.choices import DRAWN_FORMATS
from elbowscrew.disk.temporary import is_temporary
from elbowscrew.opening import read_text
from elbowscrew.results.exporting import EXPORTS
from elbowscrew.tables import TABLES
from elbowscrew.view.figure_names import FIGURE_ENTRIES, caption_file

SUMS: Final = "SHA256SUMS"
"""The file that has the digests of all others."""

BATCH_MARK: Final = ".elbowscrew-batch.lock"
"""Its presence says that a folder is the output of a batch, and the system's lock on it that one is at work there."""


def _figure_files(name: str) -> tuple[str, ...]:
    """A figure in all formats, and its caption."""
    return (*(f"{name}.{kind}" for kind in DRAWN_FORMATS), caption_file(name))


_TABLE_ENDINGS: Final = (".csv", *(export.file for export in EXPORTS.values() if export.file.startswith(".")))
RESULT_FILES: Final = (
    "summary.json",
    "joint.json",
    "meshes.json",
    *(f"{name}{ending}" for name in TABLES for ending in _TABLE_ENDINGS),
    *(export.file for export in EXPORTS.values() if not export.file.startswith(".")),
    "report.html",
    "methods.txt",
    *(f"figures/{file}" for name in FIGURE_ENTRIES for file in _figure_files(name)),
    SUMS,
)
"""All that a result folder may hold."""


class ResultKind(NamedTuple):
    """What a result folder may hold, and the JSON file in it that tells whose it is."""

    files: tuple[str, ...]
    summary: str


ANALYSIS: Final = ResultKind(RESULT_FILES, "summary.json")
COMPARISON: Final = ResultKind(
    ("compare.csv", "compare.json", *(f"figures/{file}" for file in _figure_files("compare")), SUMS), "compare.json"
)

_STRAYS: Final = frozenset({".ds_store", "thumbs.db", "desktop.ini"})
_BEGINS: Final = '{\n  "elbowscrew": "'


def is_stray(name: str) -> bool:
    """Whether a file is one that a desktop leaves in every folder it shows."""
    return name.casefold() in _STRAYS


def files_in(folder: Path) -> Iterator[str]:
    """Yield what is in a result folder and in its ``figures``, but strays and what a killed run has left.

    The name of any other folder ends with a slash: it is none of ours, whatever it is called, and may hold anything.
    Names are asked for as they are taken: of a folder with a million files, which is none of ours, a few.
    """
    with os.scandir(folder) as entries:
        for one in entries:
            if is_stray(one.name) or is_temporary(one.name):
                continue
            if one.name == "figures" and one.is_dir(follow_symlinks=False):
                with os.scandir(one.path) as inner:
                    yield from (f"figures/{_told(figure)}" for figure in inner if not is_stray(figure.name))
            else:
                yield _told(one)


def _told(entry: os.DirEntry[str]) -> str:
    return f"{entry.name}/" if entry.is_dir(follow_symlinks=False) else entry.name


def is_summary(path: Path) -> bool:
    """Whether a file is the summary of a result."""
    try:
        return _tells_of_us(read_text(path))
    except (OSError, ValueError):
        return False


def is_or_was_summary(path: Path) -> bool:
    """Whether a file is the summary of a result, or what a power failure leaves of one: nothing, zeros, its beginning.

    Raises
    ------
    OSError
        If the file is there and cannot be read.
    """
    if not path.is_file():
        return False
    text = read_text(path, encoding="latin-1")  # it may be cut inside a character
    return _BEGINS.startswith(text.rstrip("\0")[: len(_BEGINS)]) or _tells_of_us(text)


def _tells_of_us(text: str) -> bool:
    try:
        summary = json.loads(text)
    except (ValueError, RecursionError):
        return False
    return isinstance(summary, dict) and "elbowscrew" in summary


def version_told(folder: Path) -> str | None:
    """Version that the summary in a folder says it was written by; None if there is no file of that name."""
    path = folder / ANALYSIS.summary
    if not path.is_file():
        return None
    try:
        told = json.loads(read_text(path))["elbowscrew"]
    except (OSError, ValueError, RecursionError, LookupError, TypeError):
        return "unknown"
    return " ".join(str(told).split())[:40]
