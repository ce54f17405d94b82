"""What a result folder may hold, and how it is told from a folder of somebody else's."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Final, NamedTuple

from elbowscrew.choices import DRAWN_FORMATS
from elbowscrew.disk.temporary import is_temporary
from elbowscrew.opening import read_text
from elbowscrew.results.exporting import EXPORTS
from elbowscrew.results.plugged import FOLDER, is_placed
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
"""All that a result folder may hold, but for what exporters of plug-ins have put into ``exports``."""


class ResultKind(NamedTuple):
    """What a result folder may hold, and the JSON file in it that tells whose it is."""

    files: tuple[str, ...]
    summary: str


ANALYSIS: Final = ResultKind(RESULT_FILES, "summary.json")
COMPARISON: Final = ResultKind(
    ("compare.csv", "compare.json", *(f"figures/{file}" for file in _figure_files("compare")), SUMS), "compare.json"
)

_SUMS_LINE: Final = re.compile(r"([0-9a-f]{64}) [ *](\S+)")


def sums_in(text: str) -> dict[str, str] | None:
    """Read SHA-256 by name from lines as ``sha256sum`` writes them; None if a line is none."""
    lines = [_SUMS_LINE.fullmatch(line) for line in text.splitlines()]
    sums = {line[2]: line[1] for line in lines if line is not None}
    return sums if len(sums) == len(lines) and text.endswith("\n") else None


def is_of_result(name: str, files: Collection[str] = RESULT_FILES) -> bool:
    """Whether a file of a result may have this name."""
    return name in files or (files is RESULT_FILES and is_placed(name))


def placed_by_exporters(folder: Path) -> frozenset[str]:
    """Files of exporters that the digests in a result folder name, so that they are ours; none without digests."""
    try:
        sums = sums_in(read_text(folder / SUMS))
    except (OSError, ValueError):
        return frozenset()
    return frozenset(filter(is_placed, sums or ()))


_STRAYS: Final = frozenset({".ds_store", "thumbs.db", "desktop.ini"})
_BEGINS: Final = '{\n  "elbowscrew": "'


def is_stray(name: str) -> bool:
    """Whether a file is one that a desktop leaves in every folder it shows."""
    return name.casefold() in _STRAYS


def files_in(folder: Path) -> Iterator[str]:
    """Yield what is in a result folder, its ``figures`` and ``exports``, but strays and what a killed run has left.

    The name of any other folder ends with a slash: it is none of ours, whatever it is called, and may hold anything.
    Names are asked for as they are taken: of a folder with a million files, which is none of ours, a few.
    """
    with os.scandir(folder) as entries:
        for one in entries:
            if is_stray(one.name) or is_temporary(one.name):
                continue
            if one.name == "figures" and one.is_dir(follow_symlinks=False):
                yield from _inside(one, one.name)
            elif one.name == FOLDER and one.is_dir(follow_symlinks=False):
                with os.scandir(one.path) as exporters:
                    for exporter in exporters:
                        inside = f"{FOLDER}/{exporter.name}"
                        yield from _inside(exporter, inside) if exporter.is_dir(follow_symlinks=False) else (inside,)
            else:
                yield _told(one)


def _told(entry: os.DirEntry[str]) -> str:
    return f"{entry.name}/" if entry.is_dir(follow_symlinks=False) else entry.name


def _inside(folder: os.DirEntry[str], name: str) -> Iterator[str]:
    with os.scandir(folder.path) as entries:
        yield from (f"{name}/{_told(one)}" for one in entries if not is_stray(one.name))


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
