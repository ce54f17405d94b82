"""One recording of a study: where it is, what it is called, and what a manifest says of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """One recording of a study.

    Attributes
    ----------
    path : Path
        Absolute.
    label : str
        What it is called in tables and messages: its path in the folder given, or as it was given; with slashes.
    columns : mapping
        What a manifest says of it, for ``summary.csv``.
    settings : mapping
        What a manifest sets for it.
    distal_path : Path, optional
        The distal body's file, where it has one of its own; absolute.
    landmarks : Path, optional
        The manifest's.
    name : str
        Name of the result folder, if the manifest gives one.
    by_file : bool
        Whether its result folder may go by the file's name alone.
    location : str
        Line of the manifest, for messages.
    """

    path: Path
    label: str
    columns: Mapping[str, str] = field(default_factory=dict)
    settings: Mapping[str, Any] = field(default_factory=dict)
    distal_path: Path | None = None
    landmarks: Path | None = None
    name: str = ""
    by_file: bool = False
    location: str = ""
