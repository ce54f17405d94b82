"""Which way round a blend goes: `Q` and `-Q` are one pose, but two ways to it."""

from __future__ import annotations

from typing import Literal, get_args

WayRound = Literal["shortest", "longest", "as given"]


def check_way(way: str) -> None:
    """Raise ValueError if that is no way round."""
    if way not in get_args(WayRound):
        msg = f"way must be 'shortest', 'longest' or 'as given', found {way!r}"
        raise ValueError(msg)
