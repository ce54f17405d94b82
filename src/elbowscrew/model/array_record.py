"""How results show themselves: a line a field, arrays by their shape."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np


class ArrayRecord:
    """A dataclass that holds arrays: shown in brief, and equal only to itself."""

    __slots__ = ()

    def __repr__(self) -> str:
        parts = [f"{field.name}={_shown(getattr(self, field.name))}" for field in fields(self)]  # type: ignore[arg-type]
        return f"{type(self).__name__}({', '.join(parts)})"


def _shown(value: Any) -> str:
    if isinstance(value, np.ndarray) and value.size > 8:
        return f"<array {'x'.join(map(str, value.shape))}>"
    if isinstance(value, ArrayRecord):
        return f"<{type(value).__name__}>"
    if isinstance(value, tuple) and value and isinstance(value[0], ArrayRecord):
        return f"<{len(value)} {type(value[0]).__name__}>"
    return repr(value)
