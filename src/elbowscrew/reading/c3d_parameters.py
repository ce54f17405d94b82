"""What a C3D file says of itself in its header and its parameters."""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

from elbowscrew.opening import open_bytes

BLOCK: Final = 512
BIG_ENDIAN: Final = 86
"""Processor of the file in the fourth byte of its parameters: Intel is 84, DEC 85, MIPS (SGI) 86."""
DEC: Final = 85


@dataclass(frozen=True, slots=True)
class Parameter:
    """One entry of the parameters, whose positions count from its blocks' beginning.

    Attributes
    ----------
    group : str
        Name of its group, "" where the file names none (yet).
    name : str
    link_at : int
        Where the two bytes to the next entry stand.
    kind : int
        -1 for text, else bytes of a value: 1, 2 or 4 (floats).
    values_at, count : int
        Where its values stand, and how many there are.
    """

    group: str
    name: str
    link_at: int
    kind: int
    values_at: int
    count: int


@dataclass(frozen=True, slots=True)
class Statements:
    """Header and parameters of a file, as bytes, with the size of the file in bytes."""

    header: bytes
    parameters_at: int
    blocks: bytes
    size: int

    @property
    def processor(self) -> int:
        """84 for Intel, 85 for DEC, 86 for MIPS."""
        return self.blocks[3]

    @property
    def order(self) -> Literal["big", "little"]:
        """Order of the bytes of whole numbers."""
        return "big" if self.processor == BIG_ENDIAN else "little"

    @property
    def data_at(self) -> int:
        """First byte of the points."""
        return BLOCK * (self.word(8) - 1)

    @property
    def word_bytes(self) -> int:
        """Bytes of a coordinate: 4 where the scale factor is negative, which says that they are floats."""
        return 4 if self._float(self.header[12:16]) < 0.0 else 2

    @property
    def rate_hz(self) -> float:
        """Frames a second, by the header."""
        return self._float(self.header[20:24])

    def word(self, number: int) -> int:
        """Whole number of the header, counted from 0."""
        return int.from_bytes(self.header[2 * number : 2 * number + 2], self.order)

    def entries(self) -> Iterator[tuple[Parameter | None, int]]:
        """Go from one entry to the next, and give what it is, None for a group, with where its link stands.

        An entry is: length of the name, number of the group, the name, two bytes to the next entry counted from where
        they stand, and of a parameter its type, how many dimensions it has, these, and its values.
        """
        at, groups = 4, dict[int, str]()
        while at + 2 <= len(self.blocks):
            length, group = abs(_signed(self.blocks[at])), _signed(self.blocks[at + 1])
            link_at = at + 2 + length
            if not length or link_at + 4 > len(self.blocks):
                return
            name = self.blocks[at + 2 : link_at].decode("ascii", "replace").upper()
            if group > 0:
                values_at = link_at + 4 + self.blocks[link_at + 3]
                count = math.prod(self.blocks[link_at + 4 : values_at])
                yield (
                    Parameter(
                        groups.get(group, ""), name, link_at, _signed(self.blocks[link_at + 2]), values_at, count
                    ),
                    link_at,
                )
            else:
                groups[-group] = name
                yield None, link_at
            step = int.from_bytes(self.blocks[link_at : link_at + 2], self.order)
            if not step:
                return
            at = link_at + step

    @property
    def are_cut(self) -> bool:
        """Whether the file ends among the parameters, before the entry without a name that is their last."""
        if len(self.blocks) >= BLOCK * max(self.blocks[2], 1):
            return False
        at = 4
        for _, link_at in self.entries():
            step = int.from_bytes(self.blocks[link_at : link_at + 2], self.order)
            if not step:
                return False
            at = link_at + step
        return at >= len(self.blocks) or self.blocks[at] != 0

    def find(self, group: str, name: str) -> Parameter | None:
        """Give the first parameter of that name that has numbers of two or four bytes, if there is one."""
        wanted = ((group, name, 2), (group, name, 4))
        found = (one for one, _ in self.entries() if one is not None and (one.group, one.name, one.kind) in wanted)
        return next((one for one in found if one.count), None)

    def number(self, group: str, name: str) -> float | None:
        """First value of a parameter, whole numbers without a sign; None if there is none."""
        one = self.find(group, name)
        if one is None:
            return None
        data = self.blocks[one.values_at : one.values_at + one.kind]
        return float(int.from_bytes(data, self.order)) if one.kind == 2 else self._float(data)

    def whole_number(self, group: str, name: str) -> int:
        """First value of a parameter of whole numbers; 0 if there is none."""
        one = self.find(group, name)
        return int(self.number(group, name) or 0) if one is not None and one.kind == 2 else 0

    def _float(self, data: bytes) -> float:
        data = data.ljust(4, b"\0")
        if self.processor == DEC:  # the words of a VAX float stand in the other order, and its exponent is 2 more
            return float(struct.unpack("<f", data[2:] + data[:2])[0]) / 4.0
        return float(struct.unpack(">f" if self.processor == BIG_ENDIAN else "<f", data)[0])


def read_statements(path: Path) -> Statements | None:
    """Read header and parameters; None of a file that is too short for them.

    Raises
    ------
    OSError
        If the file cannot be read.
    """
    with open_bytes(path) as stream:
        header = stream.read(BLOCK)
        at = BLOCK * (max(header[0], 1) - 1) if header else 0
        stream.seek(at)
        head = stream.read(4)
        if len(header) < 24 or len(head) < 4:
            return None
        blocks = head + stream.read(BLOCK * max(head[2], 1))
    return Statements(header, at, blocks, path.stat().st_size)


def _signed(byte: int) -> int:
    return byte - 256 if byte > 127 else byte
