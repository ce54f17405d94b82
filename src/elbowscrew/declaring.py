"""How a setting is declared, and what options, files and documents are made from."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from types import NoneType
from typing import Annotated, Any, Final, Literal, get_args, get_origin

from pydantic import BeforeValidator, Field
from pydantic.fields import FieldInfo

from elbowscrew.errors import shown

_UNIT_SUFFIXES: Final = ("_deg_s", "_rad_s", "_m_s", "_deg", "_mm", "_hz", "_s", "_percent")

FORMER_NAMES: Final = {
    "arm": "proximal",
    "forearm": "distal",
    "arm-markers": "proximal-markers",
    "forearm-markers": "distal-markers",
}
"""Names that settings had for an elbow alone, still understood."""

BODIES, MOTION, MODEL, OUTPUT = "Bodies and file", "Motion", "Model", "Output"
"""What settings are about, and so the panels of the help."""


def option_name(field: str) -> str:
    """Give a field's name on the command line and in TOML: ``min_angle_deg`` is ``min-angle``."""
    suffix = next((suffix for suffix in _UNIT_SUFFIXES if field.endswith(suffix)), "")
    name = field.removesuffix(suffix).replace("_", "-")
    return FORMER_NAMES.get(name, name)


def setting(default: Any, text: str, about: str, *, metavar: str = "", shown: str = "", **bounds: Any) -> Any:
    """Declare a setting.

    Parameters
    ----------
    default : object
    text : str
        One sentence, for help and documents.
    about : str
        The panel it stands in.
    metavar : str, optional
        What stands for its value, where that is no choice.
    shown : str, optional
        What the help says of the default, where that is not the value itself.
    **bounds
        Of `pydantic.Field`.
    """
    return Field(
        default, description=text, json_schema_extra={"about": about, "metavar": metavar, "shown": shown}, **bounds
    )


def _degrees(value: object) -> object:
    """Take ``2deg`` and ``0.03rad`` for angles, too."""
    if not isinstance(value, str):
        return value
    number, unit = value.strip().removesuffix("deg").removesuffix("rad"), value.strip()[-3:]
    try:
        return math.degrees(float(number)) if unit == "rad" else float(number)
    except ValueError as error:
        msg = f"expected degrees or an angle with its unit, as in 2deg, found {shown(value)}"
        raise ValueError(msg) from error


def _millimeters(value: object) -> object:
    """Take ``2mm`` and ``0.002m`` for lengths, too."""
    if not isinstance(value, str):
        return value
    text = value.strip()
    unit = "mm" if text.endswith("mm") else "m" if text.endswith("m") else ""
    try:
        return float(text.removesuffix(unit)) * (1000.0 if unit == "m" else 1.0)
    except ValueError as error:
        msg = f"expected millimeters or a length with its unit, as in 2mm, found {shown(value)}"
        raise ValueError(msg) from error


def _tolerance(value: object) -> object:
    """Take a length for a number of millimeters, and an angle for text that says its degrees."""
    is_angle = isinstance(value, str) and value.strip()[-3:] in ("deg", "rad")
    number = _degrees(value) if is_angle else _millimeters(value)
    low, high = TOLERANCES
    if isinstance(number, bool) or not isinstance(number, int | float) or not low <= number <= high:
        msg = f"should be greater than or equal to {low:g} and less than or equal to {high:g}, found {shown(value)}"
        raise ValueError(msg)
    return f"{float(number)!r}deg" if is_angle else float(number)


TOLERANCES: Final = (1e-3, 1e5)
"""Least and largest tolerance, in millimeters or degrees."""

Angle = Annotated[float, BeforeValidator(_degrees)]
"""Degrees; as text also with its unit."""
Length = Annotated[float, BeforeValidator(_millimeters)]
"""Millimeters; as text also with its unit."""
Tolerance = Annotated[float | str, BeforeValidator(_tolerance)]
"""A number, or an angle as text with its unit."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Setting:
    """What is declared of a setting, as options and documents want it.

    Attributes
    ----------
    field, option : str
        Its name in `Settings`, and on the command line and in files.
    former : tuple of str
        Names the option had before.
    kind : type
        A `Literal`, `bool`, `int` or `float`, or `str` where it takes more than that; of a list, that of its parts.
    several : bool
        It is a list.
    optional : bool
        It may be None.
    choices : tuple of str
        What it may be, where that is a choice.
    bounds : tuple of str
        As ``>= 0``.
    default : str
        As the help shows it; empty where there is none.
    text, about, metavar : str
    """

    field: str
    option: str
    former: tuple[str, ...]
    kind: Any
    several: bool
    optional: bool
    choices: tuple[str, ...]
    bounds: tuple[str, ...]
    default: str
    text: str
    about: str
    metavar: str


def declared(field: str, info: FieldInfo) -> Setting:
    """Read a declaration back from the field that `setting` made."""
    extra: Any = info.json_schema_extra
    kinds = [kind for kind in get_args(info.annotation) or (info.annotation,) if kind is not NoneType]
    kind = info.annotation if get_origin(info.annotation) in (Literal, tuple) else kinds[0] if len(kinds) == 1 else str
    several = get_origin(kind) is tuple and get_origin(get_args(kind)[0]) is not tuple  # the latter come from a file
    kind = get_args(kind)[0] if several else kind
    choices = get_args(kind) if get_origin(kind) is Literal else ()
    bounds = {"ge": ">=", "gt": ">", "le": "<=", "lt": "<"}
    value = info.default
    return Setting(
        field=field,
        option=option_name(field),
        former=tuple(name for name, now in FORMER_NAMES.items() if now == option_name(field)),
        kind=kind if choices or kind in (bool, int, float) else str,
        several=several,
        optional=value is None,
        choices=choices,
        bounds=tuple(
            f"{sign} {getattr(one, name):g}"
            for one in info.metadata
            for name, sign in bounds.items()
            if hasattr(one, name)
        ),
        default=extra["shown"]
        or ("" if value is None else ",".join(value) if several else f"{value:g}" if kind is float else str(value)),
        text=str(info.description),
        about=extra["about"],
        metavar=extra["metavar"] or f"<{'|'.join(choices)}>",
    )


def attributes(settings: Iterable[Setting]) -> str:
    """Attributes section of the docstring of the class that declares settings."""
    lines = "\n".join(map(_attribute, settings)).replace("\n", "\n    ")
    return f"\n\n    Attributes\n    ----------\n    {lines}\n    "


def _attribute(setting: Setting) -> str:
    kind = "{" + ", ".join(map(repr, setting.choices)) + "}" if setting.choices else setting.kind.__name__
    optional = " or None" if setting.optional else ""
    named = f"{setting.field} : {'tuple of ' if setting.several else ''}{kind}{optional}"
    return f"{named}\n    {setting.text}" + (f" Default: {setting.default}." if setting.default else "")
