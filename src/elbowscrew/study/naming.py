"""Names of the trials' result folders, made from hostile text: never outside the output folder, never the same twice.

A name depends on its own trial's path alone, so that it stays when trials are added, but for the rare case that two
names would meet on some file system.
"""

from __future__ import annotations

import hashlib
import unicodedata
from collections import Counter
from collections.abc import Sequence
from pathlib import PurePosixPath
from typing import Final

_LONGEST: Final = 80
_MOST_BYTES: Final = 160
_DIGITS: Final = 8
_BY_FILE: Final = -1
_KEPT: Final = frozenset("._- ")
_DEVICES: Final = frozenset(
    {"con", "prn", "aux", "nul", "conin$", "conout$"}
    | {f"{kind}{k}" for kind in ("com", "lpt") for k in "0123456789¹²³"}
)
# What stands beside the results in the output folder, or may one day.
_TAKEN: Final = frozenset(
    {"summary.csv", "failures.csv", "cycles.csv", "repetitions.csv", "index.html", "report.html", "figures", "assets"}
)


def result_names(paths: Sequence[str], by_file: Sequence[bool] | None = None) -> list[str]:
    """Name the result folder of each trial.

    Parameters
    ----------
    paths : sequence of str
        Of the trials, relative to the folder they were looked for in, with slashes; no two are the same.
    by_file : sequence of bool, optional
        Which may go by the file's name alone, as long as no other is called so; none by default.

    Returns
    -------
    list of str
        No two are the same, even where case or the composition of characters does not count.

    Examples
    --------
    >>> result_names(["P01/flexion 1.csv", "P01/flexion 1.trc", "../x.csv"])
    ['P01__flexion 1', 'P01__flexion 1.trc', '_.__x-c6a35c28']
    """
    lengths = [_BY_FILE if alone else 0 for alone in by_file or [False] * len(paths)]
    while True:
        names = [_name(path, length) for path, length in zip(paths, lengths, strict=True)]
        met = Counter(map(folded, names))
        again = [k for k, name in enumerate(names) if met[folded(name)] > 1]
        if not again:
            return names
        # The file's name is not enough: the path, then with a digest, then with a longer one.
        least = min(lengths[k] for k in again)
        for k in again:
            if lengths[k] == least:
                lengths[k] = 0 if least == _BY_FILE else least + _DIGITS


def folded(name: str) -> str:
    """Fold what some file system does not tell apart: case, and how characters are composed."""
    return unicodedata.normalize("NFKC", unicodedata.normalize("NFKC", name).casefold())


def _name(path: str, length: int) -> str:
    shown = path.rsplit("/", 1)[-1] if length == _BY_FILE else path
    plain = _plain(shown)
    digits = max(length, 0 if _is_faithful(shown) else _DIGITS)
    if not digits:
        return plain
    digest = hashlib.sha256(shown.encode("utf-8", "surrogatepass")).hexdigest()[:digits]
    short = _shortened(plain).strip(" .-") or "trial"
    return f"{'_' if _is_device(short) else ''}{short}-{digest}"


def _is_faithful(path: str) -> bool:
    """Whether the plain name says all of the path, and every file system takes it."""
    plain = _plain(path)
    return (
        plain == "__".join(_parts(path))
        and plain == _shortened(plain)
        and plain == plain.strip(" .-")
        and bool(plain)
        and not _is_device(plain)
        and folded(plain) not in _TAKEN
    )


def _is_device(name: str) -> bool:
    """Whether Windows takes a name for a device, whatever it ends with."""
    return name.split(".")[0].strip().casefold() in _DEVICES


def _plain(path: str) -> str:
    text = "__".join("".join(mark if _keeps(mark) else "_" for mark in part) for part in _parts(path))
    return text.replace("..", "_.")


def _parts(path: str) -> list[str]:
    pure = PurePosixPath(unicodedata.normalize("NFC", path))
    *folders, last = pure.parts or ("",)
    return [*folders, last[:-4] if last.casefold().endswith(".csv") else last]


def _keeps(mark: str) -> bool:
    return mark in _KEPT or unicodedata.category(mark)[0] in "LNM"


def _shortened(text: str) -> str:
    return text[:_LONGEST].encode("utf-8", "replace")[:_MOST_BYTES].decode("utf-8", "ignore")
