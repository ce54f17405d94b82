"""Results that are tables: they know their columns."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from elbowscrew.choices import AngleUnit, LengthUnit
from elbowscrew.model.array_record import ArrayRecord
from elbowscrew.quantities import in_units, unit_suffixes
from elbowscrew.tables import Column

if TYPE_CHECKING:
    import pandas as pd


class TableRecord(ArrayRecord, ABC):
    """A result that is written as a table; `table` has its columns."""

    __slots__ = ()

    @property
    @abstractmethod
    def table(self) -> tuple[Column, ...]:
        """Columns of this result, in order."""

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
