"""Results that are tables: they know their columns."""

from __future__ import annotations

import html
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew.choices import AngleUnit, LengthUnit
from elbowscrew.model.array_record import ArrayRecord
from elbowscrew.quantities import in_units, unit_suffixes
from elbowscrew.tables import Column

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

_ROWS_SHOWN: Final = 10
_COLUMNS_TOLD: Final = 5


class TableRecord(ArrayRecord, ABC):
    """A result that is written as a table; `table` has its columns."""

    __slots__ = ()

    @property
    @abstractmethod
    def table(self) -> tuple[Column, ...]:
        """Columns of this result, in order."""

    def __len__(self) -> int:
        return len(self.table[0].values(self))

    def __repr__(self) -> str:
        names = [*self.columns(rows=slice(0))]
        more = ", …" if len(names) > _COLUMNS_TOLD else ""
        told = f"{len(self)} rows of {len(names)} columns"
        return f"{type(self).__name__}({told}: {', '.join(names[:_COLUMNS_TOLD])}{more})"

    def _repr_html_(self) -> str:
        shown = self.to_frame().to_html(max_rows=_ROWS_SHOWN, float_format="{:.6g}".format, na_rep="")
        return f"<div><b>{html.escape(type(self).__name__)}</b>{shown}</div>"

    def columns(
        self, angle_unit: AngleUnit = "deg", length_unit: LengthUnit = "mm", rows: slice = slice(None)
    ) -> dict[str, NDArray[Any]]:
        """Return the columns by name, in order and in these units; NaN, or a masked integer, where nothing is known."""
        suffixes = unit_suffixes(angle_unit, length_unit)
        return {
            column.name + suffixes.get(column.quantity, ""): in_units(
                column.values(self)[rows], column.quantity, angle_unit, length_unit
            )
            for column in self.table
        }

    def to_frame(self, angle_unit: AngleUnit = "deg", length_unit: LengthUnit = "mm") -> pd.DataFrame:
        """Return the table as a pandas data frame, with the same names and values as in its CSV."""
        import pandas as pd

        return pd.DataFrame(
            {
                name: pd.Series(values.filled(0), dtype="Int64").mask(np.ma.getmaskarray(values))
                if isinstance(values, np.ma.MaskedArray)
                else values
                for name, values in self.columns(angle_unit, length_unit).items()
            }
        )

    def to_xarray(self, angle_unit: AngleUnit = "deg", length_unit: LengthUnit = "mm") -> xr.Dataset:
        """Return the table as an xarray Dataset: along its first column, units as attributes, vectors whole.

        Names are those of the CSV without unit and component. Over frames there is ``time`` beside ``frame``.

        Raises
        ------
        UsageError
            If xarray is not installed.
        """
        from elbowscrew.model.labeled import dataset_from_table

        return dataset_from_table(self, angle_unit, length_unit)
