"""C3D files that the library does not take, rewritten so that it does.

Numbers of SGI machines, offsets of floats, and an analog rate whose last digit makes a sample fewer.
"""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew.opening import open_bytes
from elbowscrew.reading.c3d_checks import samples_a_frame
from elbowscrew.reading.c3d_parameters import BIG_ENDIAN, Parameter, Statements

_INTEL: Final = 84
_LONGEST_DESCRIPTION: Final = 255
_MOST_SAMPLES: Final = 1 << 16
_HEADER_WORDS: Final = (2, 4, 6, 8, 10, 16, 18)
_HEADER_FLOATS: Final = (12, 20)


def mended(path: Path, stated: Statements) -> bytes | None:
    """Bytes of the file as the library takes it; None where it takes the file as it is.

    Raises
    ------
    OSError
        If the file cannot be read.
    """
    entries = list(stated.entries())
    offsets = [one for one, _ in entries if one is not None and _is_float_offset(one)]
    rate = _rate_beside_a_whole_multiple(stated)
    if stated.processor != BIG_ENDIAN and not offsets and rate is None:
        return None
    with open_bytes(path) as stream:
        data = np.frombuffer(stream.read(), dtype=np.uint8).copy()
    if stated.processor == BIG_ENDIAN:
        at = stated.parameters_at
        for place in (*_HEADER_WORDS, *(at + link_at for _, link_at in entries)):
            _swap(data, place, 2, 1)
        for place in _HEADER_FLOATS:
            _swap(data, place, 4, 1)
        for one, _ in entries:
            if one is not None and one.kind in (2, 4):
                _swap(data, at + one.values_at, one.kind, one.count)
        _swap(data, stated.data_at, stated.word_bytes, (len(data) - stated.data_at) // stated.word_bytes)
        data[at + 3] = _INTEL
    for one in offsets:
        _make_whole(data, stated, one)
    if rate is not None:
        at = stated.parameters_at + rate.values_at
        data[at : at + 4].view("<f4")[:] = _rates(stated)[0] * samples_a_frame(stated) * (1.0 + 1e-6)
    return data.tobytes()


def _is_float_offset(one: Parameter) -> bool:
    return (one.group, one.name, one.kind) == ("ANALOG", "OFFSET", 4)


def _rate_beside_a_whole_multiple(stated: Statements) -> Parameter | None:
    """ANALOG:RATE, where the library would find one sample fewer in a frame than there are; None where it does not."""
    points, analog = _rates(stated)
    less = analog > 0.0 < points and int(analog / points) < samples_a_frame(stated) < _MOST_SAMPLES
    return stated.find("ANALOG", "RATE") if less else None


def _rates(stated: Statements) -> tuple[float, float]:
    return stated.number("POINT", "RATE") or stated.rate_hz, stated.number("ANALOG", "RATE") or 0.0


def _swap(data: NDArray[np.uint8], at: int, width: int, count: int) -> None:
    """Reverse the bytes of so many numbers."""
    if 0 <= at <= len(data) - width * count:
        numbers = data[at : at + width * count].reshape(count, width)
        numbers[:] = numbers[:, ::-1].copy()


def _make_whole(data: NDArray[np.uint8], stated: Statements, one: Parameter) -> None:
    """Write whole numbers in place of floats; the description behind them, longer by blanks, takes what is left over.

    Analog values are not read, so that their offsets do not matter.
    """
    at, room = stated.parameters_at + one.values_at, 2 * one.count
    behind = at + 2 * room
    if behind >= len(data) or data[behind] + room > _LONGEST_DESCRIPTION:
        return
    length = int(data[behind])
    description = data[behind + 1 : behind + 1 + length].copy()
    data[at : at + room] = 0
    data[at + room] = length + room
    data[at + room + 1 : behind + 1] = ord(" ")
    data[behind + 1 : behind + 1 + len(description)] = description
    data[stated.parameters_at + one.link_at + 2] = 2
