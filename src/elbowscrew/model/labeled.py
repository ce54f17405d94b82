"""Tables as labeled arrays: an xarray Dataset, whose library is loaded when one is asked for."""

from __future__ import annotations

import re
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew.choices import AngleUnit, LengthUnit
from elbowscrew.errors import UsageError
from elbowscrew.model.table_record import TableRecord
from elbowscrew.quantities import Quantity, in_units
from elbowscrew.tables import Column

if TYPE_CHECKING:
    import xarray as xr

_AXES: Final = ("x", "y", "z")


def dataset_from_table(result: TableRecord, angle_unit: AngleUnit, length_unit: LengthUnit) -> xr.Dataset:
    """Label a table; see `TableRecord.to_xarray`."""
    if find_spec("xarray") is None:
        msg = "to_xarray needs xarray; install it with: pip install xarray"
        raise UsageError(msg)
    import xarray as xr

    units = _units(angle_unit, length_unit)
    index, *others = result.table
    row = index.name
    variables: dict[str, Any] = {}
    coords: dict[str, Any] = {row: (row, _values(result, index, angle_unit, length_unit), _attributes(index, units))}
    for name, columns in _vectors(others).items():
        parts = [_values(result, column, angle_unit, length_unit) for column in columns]
        unit = _attributes(columns[0], units)
        if name == "time_s" and row == "frame":
            coords["time"] = (row, parts[0], unit)
        elif columns[0].component is None:
            variables[name] = (row, parts[0], unit)
        else:
            along, labels = _along(name, columns)
            coords[along] = labels
            variables[name] = ((row, along), np.stack(parts, axis=1), unit)
    return xr.Dataset(variables, coords)


def _units(angle_unit: AngleUnit, length_unit: LengthUnit) -> dict[Quantity, str]:
    """Units of the kinds of quantities that have one."""
    return {
        Quantity.ANGLE: angle_unit,
        Quantity.LENGTH: length_unit,
        Quantity.ANGULAR_VELOCITY: f"{angle_unit}/s",
        Quantity.VELOCITY: f"{length_unit}/s",
    }


def _attributes(column: Column, units: dict[Quantity, str]) -> dict[str, str]:
    """Attributes of a variable: its unit; that of a plain number stands in the column's name, if it has one."""
    if column.quantity is not Quantity.NUMBER:
        return {"units": units[column.quantity]} if column.quantity in units else {}
    name = column.name
    named = {"ns": name.startswith("ns_"), "s": name.endswith("_s"), "percent": name == "percent"}
    return {"units": next((unit for unit, fits in named.items() if fits), "1")}


def _values(result: TableRecord, column: Column, angle_unit: AngleUnit, length_unit: LengthUnit) -> NDArray[Any]:
    """Values of a column; integers that are not known all through are floats with NaN, as xarray has no mask."""
    values = column.values(result)
    if column.quantity is Quantity.FLAG:
        return values.astype(bool)
    found = in_units(values, column.quantity, angle_unit, length_unit)
    if isinstance(found, np.ma.MaskedArray):
        return np.where(np.ma.getmaskarray(found), np.nan, found.data.astype(np.float64))
    return found


def _vectors(columns: list[Column]) -> dict[str, list[Column]]:
    """Columns by the name of what they are the components of; of two things of one name, by their attributes."""
    found: dict[tuple[str, str], list[Column]] = {}
    for column in columns:
        stem = column.name if column.component is None else re.sub(r"_[xyz]$|\d(?=_sd$|$)", "", column.name)
        found.setdefault((stem, column.attribute), []).append(column)
    stems = [stem for stem, _ in found]
    return {attribute if stems.count(stem) > 1 else stem: parts for (stem, attribute), parts in found.items()}


def _along(name: str, columns: list[Column]) -> tuple[str, list[str]]:
    """Dimension of a vector and the labels along it: one for all vectors in space."""
    labels = [column.name for column in columns]
    if tuple(label[-1] for label in labels) == _AXES:
        return "component", list(_AXES)
    return f"{name.removesuffix('_sd')}_component", [label.removesuffix("_sd") for label in labels]
