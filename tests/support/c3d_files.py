"""C3D files of other processors, and with faults, made of sound ones by the format's description alone."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from typing import Final, Literal, NamedTuple

BLOCK: Final = 512
_INTEL: Final = 84
PROCESSORS: Final = {"DEC": 85, "SGI": 86}


class Parameter(NamedTuple):
    """Where a parameter stands: its name, type (-1 text, 1, 2, 4 bytes), the first byte of its values, their count."""

    group: int
    name: str
    kind: int
    kind_at: int
    values_at: int
    values: int


def parameters(data: bytes) -> Iterator[Parameter]:
    """Walk over the parameters of an Intel file."""
    at = (data[0] - 1) * BLOCK + 4
    while True:
        length, group = abs(struct.unpack_from("b", data, at)[0]), struct.unpack_from("b", data, at + 1)[0]
        if length == 0 or group == 0:
            return
        name = data[at + 2 : at + 2 + length].decode()
        link_at = at + 2 + length
        (link,) = struct.unpack_from("<H", data, link_at)
        if group > 0:
            kind, sizes = struct.unpack_from("b", data, link_at + 2)[0], data[link_at + 3]
            count = 1
            for size in data[link_at + 4 : link_at + 4 + sizes]:
                count *= size
            yield Parameter(group, name, kind, link_at + 2, link_at + 4 + sizes, count)
        if link == 0:
            return
        at = link_at + link


def links(data: bytes) -> Iterator[int]:
    """Where the links from record to record stand."""
    at = (data[0] - 1) * BLOCK + 4
    while True:
        length, group = abs(struct.unpack_from("b", data, at)[0]), struct.unpack_from("b", data, at + 1)[0]
        if length == 0 or group == 0:
            return
        yield at + 2 + length
        (link,) = struct.unpack_from("<H", data, at + 2 + length)
        if link == 0:
            return
        at += 2 + length + link


def of_processor(data: bytes, processor: Literal["DEC", "SGI"]) -> bytes:
    """Rewrite a file of floats: SGI has big-endian numbers; DEC's floats have their halves exchanged, times four."""
    found = bytearray(data)

    def whole(at: int) -> None:
        if processor == "SGI":
            found[at : at + 2] = data[at : at + 2][::-1]

    def real(at: int) -> None:
        if processor == "SGI":
            found[at : at + 4] = data[at : at + 4][::-1]
            return
        (value,) = struct.unpack_from("<f", data, at)
        halves = struct.pack("<f", 4.0 * value)
        found[at : at + 4] = halves[2:] + halves[:2]

    for at in (*range(2, 12, 2), 16, 18):
        whole(at)
    real(12)
    real(20)
    for one in parameters(data):
        for k in range(one.values):
            if one.kind in (2, 4):
                {2: whole, 4: real}[one.kind](one.values_at + one.kind * k)
    for at in links(data):
        whole(at)
    start = (struct.unpack_from("<H", data, 16)[0] - 1) * BLOCK
    for at in range(start, len(data) - 3, 4):
        real(at)
    found[(data[0] - 1) * BLOCK + 3] = PROCESSORS[processor]
    return bytes(found)
