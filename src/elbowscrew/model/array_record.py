"""How results show themselves: a line in the console, a table in a notebook; arrays by their shape."""

from __future__ import annotations

import html
from dataclasses import fields
from typing import Any

import numpy as np


class ArrayRecord:
    """A dataclass that holds arrays: shown in brief, and equal only to itself."""

    __slots__ = ()

    def __repr__(self) -> str:
        parts = [f"{name}={text}" for name, text in self._shown_fields()]
        return f"{type(self).__name__}({', '.join(parts)})"

    def _repr_html_(self) -> str:
        return html_table(type(self).__name__, self._shown_fields())

    def _shown_fields(self) -> list[tuple[str, str]]:
        return [(field.name, _shown(getattr(self, field.name))) for field in fields(self)]  # type: ignore[arg-type]


def html_table(title: str, rows: list[tuple[str, str]]) -> str:
    """Write names and what they are as a table for a notebook; everything is escaped."""
    left = 'style="text-align: left; vertical-align: top"'
    body = "".join(
        f"<tr><th {left}>{html.escape(name)}</th><td {left}>{html.escape(text)}</td></tr>" for name, text in rows
    )
    return f"<table><caption {left}><b>{html.escape(title)}</b></caption><tbody>{body}</tbody></table>"


def _shown(value: Any) -> str:
    if isinstance(value, np.ndarray) and value.size > 8:
        return f"<array {'x'.join(map(str, value.shape))}>"
    if isinstance(value, ArrayRecord):
        return f"<{type(value).__name__}>"
    if isinstance(value, tuple) and value and isinstance(value[0], ArrayRecord):
        return f"<{len(value)} {type(value[0]).__name__}>"
    return repr(value)
