"""Which way round a blend goes: `Q` and `-Q` are one pose, but two ways to it."""

from __future__ import annotations

from typing import Literal, get_args

from elbowscrew.geometry import _rows

WayRound = Literal["shortest", "longest", "as given"]


def check_way(way: str) -> None:
    """Raise ValueError if there is no such way round."""
    if way not in get_args(WayRound):
        msg = f"way must be 'shortest', 'longest' or 'as given', found {way!r}"
        raise ValueError(msg)


def choose_signs(Q: _rows.Rows, reference: _rows.Rows, way: WayRound) -> _rows.Rows:
    """Quaternions or dual quaternions with the sign that goes that way round from the reference."""
    if way == "as given":
        return Q
    sign = _rows.sign_towards(Q, reference)
    return [sign * row if way == "shortest" else -sign * row for row in Q]
