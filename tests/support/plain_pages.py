"""Pages as they were before they were set for print, to be held against plain words."""

from __future__ import annotations

_PLAIN = str.maketrans({"\N{NO-BREAK SPACE}": " ", "\N{LEFT SINGLE QUOTATION MARK}": "'", "’": "'"})


def plain(page: str) -> str:
    """Undo what holds words together and makes quotes round."""
    return page.translate(_PLAIN)
