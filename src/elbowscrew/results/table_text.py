"""Text from files and folders as cells of a CSV: one line, and nothing a spreadsheet would run."""

from __future__ import annotations

import re
import unicodedata
from typing import Final

_NUMBER: Final = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d+)?", re.ASCII)
_FORMULA: Final = frozenset("=+-@")


def safe_cell(text: str) -> str:
    r"""Make text harmless: line ends and tabs become blanks, and what would begin a formula gets an apostrophe.

    A number stays as it is. Characters that do not print become question marks.

    Examples
    --------
    >>> safe_cell("=1+1\nx"), safe_cell("-5.2"), safe_cell("-5.2 deg")
    ("'=1+1 x", '-5.2', "'-5.2 deg")
    """
    line = "".join(" " if mark.isspace() else mark if mark.isprintable() else "?" for mark in text)
    inner = line.strip()
    if not inner or _NUMBER.fullmatch(inner):
        return inner
    # The wide forms of these signs begin formulas in some spreadsheets, too.
    return f"'{line}" if unicodedata.normalize("NFKC", inner[0])[0] in _FORMULA else line
