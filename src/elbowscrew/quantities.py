"""Kinds of quantities: how each is scaled, named and written in the units asked for."""

from __future__ import annotations

import math
from enum import Enum
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew.choices import AngleUnit, LengthUnit

METERS: Final[dict[str, float]] = {"m": 1.0, "cm": 0.01, "mm": 0.001}
"""Meters in one unit of length."""
_LONG: Final = 6  # digits before the point, from which on a number is written with a power of ten
_RAISED: Final = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


class Quantity(Enum):
    """What a column holds, and so how it is scaled, named and written."""

    INTEGER = "integer"
    MASKED_INTEGER = "integer, masked where not known"
    FLAG = "flag"
    NUMBER = "number"
    ANGLE = "angle"
    LENGTH = "length"
    ANGULAR_VELOCITY = "angular velocity"
    VELOCITY = "velocity"
    LABEL = "label"


def angle_in(radians: NDArray[np.float64], unit: AngleUnit) -> NDArray[np.float64]:
    """Angles in the unit asked for."""
    return np.degrees(radians) if unit == "deg" else radians


def length_in(meters: NDArray[np.float64], unit: LengthUnit) -> NDArray[np.float64]:
    """Lengths in the unit asked for."""
    return meters * 1000.0 if unit == "mm" else meters


def power_of_ten(power: int) -> str:
    """Write a power of ten as a figure or a sentence has it.

    Examples
    --------
    >>> power_of_ten(-5)
    '10⁻⁵'
    """
    return f"10{str(power).translate(_RAISED)}"


def in_digits(value: float | None, digits: int = 2) -> str:
    """Write a number to so many digits that count, in letters that any terminal has; a dash of none.

    Examples
    --------
    >>> in_digits(0.123), in_digits(123.0), in_digits(5.5e-5)
    ('0.12', '120', '5.5e-05')
    """
    if value is None or math.isnan(value):
        return "–"
    text = f"{value:.{digits}g}"
    power = text.partition("e+")[2]
    return f"{float(text):.0f}" if power and int(power) < _LONG else text


def rounded(value: float | None, digits: int = 2) -> str:
    """Write a number to so many digits that count, a very small or large one with a power of ten; a dash of none.

    Examples
    --------
    >>> rounded(0.123), rounded(123.0), rounded(5.5e-5)
    ('0.12', '120', '5.5·10⁻⁵')
    """
    mantissa, _, power = in_digits(value, digits).partition("e")
    return f"{mantissa}·{power_of_ten(int(power))}" if power else mantissa


def unit_suffixes(angle_unit: AngleUnit, length_unit: LengthUnit) -> dict[Quantity, str]:
    """What the names of columns with units end in."""
    return {
        Quantity.ANGLE: f"_{angle_unit}",
        Quantity.LENGTH: f"_{length_unit}",
        Quantity.ANGULAR_VELOCITY: f"_{angle_unit}_s",
        Quantity.VELOCITY: f"_{length_unit}_s",
    }


def in_units(values: NDArray[Any], quantity: Quantity, angle_unit: AngleUnit, length_unit: LengthUnit) -> NDArray[Any]:
    """Values of a kind, from SI units and radians, in the units asked for."""
    match quantity:
        case Quantity.ANGLE | Quantity.ANGULAR_VELOCITY:
            return angle_in(values, angle_unit)
        case Quantity.LENGTH | Quantity.VELOCITY:
            return length_in(values, length_unit)
        case Quantity.INTEGER | Quantity.MASKED_INTEGER | Quantity.FLAG:
            return values.astype(np.int64)
        case Quantity.NUMBER | Quantity.LABEL:
            return values


def in_si(
    values: NDArray[Any],
    quantity: Quantity,
    angle_unit: AngleUnit,
    length_unit: LengthUnit,
    out: NDArray[Any] | None = None,
) -> NDArray[Any]:
    """Values of a kind back in SI units and radians, into another array if one is given for them."""
    found: NDArray[Any] = values
    if quantity in (Quantity.ANGLE, Quantity.ANGULAR_VELOCITY) and angle_unit == "deg":
        found = np.radians(values, out=out)
    elif quantity in (Quantity.LENGTH, Quantity.VELOCITY) and length_unit == "mm":
        found = np.multiply(values, METERS["mm"], out=out)
    return found


def as_read_back(
    values: NDArray[Any], quantity: Quantity, angle_unit: AngleUnit, length_unit: LengthUnit
) -> NDArray[Any]:
    """Values of a kind, SI units and radians, with the last digit that they lose in units and back."""
    there = in_units(values, quantity, angle_unit, length_unit)
    return in_si(there, quantity, angle_unit, length_unit, out=None if there is values else there)
