"""What a C3D file says of its own size, looked at before a library believes it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Final, Literal

from elbowscrew.errors import RecordingError
from elbowscrew.opening import open_bytes

_BLOCK: Final = 512
_BIG_ENDIAN: Final = 86
"""Processor of the file in the fourth byte of its parameters: Intel is 84, DEC 85, MIPS 86."""


def check_sizes(path: Path) -> None:
    """Refuse a file whose parameters have more values than it has bytes.

    Nothing else is judged here: what cannot be followed is left to the reader.

    Raises
    ------
    RecordingError
        If they have.
    OSError
        If the file cannot be read.
    """
    size = path.stat().st_size
    with open_bytes(path) as stream:
        first = stream.read(1)
        stream.seek(_BLOCK * (max(first[0], 1) - 1) if first else 0)
        head = stream.read(4)
        if len(head) < 4:
            return
        blocks = stream.read(_BLOCK * max(head[2], 1))
    stated = 0
    for name, values in _parameters(blocks, "big" if head[3] == _BIG_ENDIAN else "little"):
        stated += values
        if stated > size:
            msg = (
                f"{path}: not a C3D file that can be read: its parameters up to {name} state {stated} values, where "
                f"the whole file has {size} bytes; export the take again"
            )
            raise RecordingError(msg)


def _parameters(blocks: bytes, order: Literal["big", "little"]) -> Iterator[tuple[str, int]]:
    """Go from one parameter to the next, and give its name and how many values it states.

    An entry is: length of the name, number of the group, the name, two bytes to the next entry counted from where
    they stand, and of a parameter its type, how many dimensions it has, and these.
    """
    at = 0
    while at + 2 <= len(blocks):
        length, group = abs(_signed(blocks[at])), _signed(blocks[at + 1])
        behind_name = at + 2 + length
        if not length or behind_name + 4 > len(blocks):
            return
        if group > 0:
            dimensions = blocks[behind_name + 4 : behind_name + 4 + blocks[behind_name + 3]]
            name = blocks[at + 2 : behind_name].decode("ascii", "replace")
            yield name, math.prod(dimensions)
        step = int.from_bytes(blocks[behind_name : behind_name + 2], order)
        if not step:
            return
        at = behind_name + step


def _signed(byte: int) -> int:
    return byte - 256 if byte > 127 else byte
