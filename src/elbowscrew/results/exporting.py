"""The tables for other programs: Parquet, MATLAB's ``.mat``, and OpenSim's ``.sto`` of the joint's angle.

The library behind a format is loaded when the format is asked for; both are in the extra ``[export]``.
"""

from __future__ import annotations

import io
import json
from collections.abc import Callable, Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowscrew.errors import UsageError
from elbowscrew.model import Analysis
from elbowscrew.model.summary_types import Summary
from elbowscrew.opening import create, write_new
from elbowscrew.quantities import angle_in
from elbowscrew.results.plugged import exporter
from elbowscrew.results.writing import results_by_table

_Table = Mapping[str, NDArray[Any]]

_MAT_HEADER_BYTES: Final = 116


def check_exports(formats: Sequence[str]) -> None:
    """Raise `UsageError` if a format is not known, or its library is not installed, or a plug-in cannot be loaded."""
    for name in formats:
        if name not in EXPORTS:
            exporter(name)
            continue
        library = EXPORTS[name].library
        if library is not None and find_spec(library) is None:
            msg = f"--export {name} needs {library}; install it with: pip install {library}"
            raise UsageError(msg)


def write_exports(folder: Path, analysis: Analysis, summary: Summary, formats: Sequence[str]) -> None:
    """Write the tables in the formats asked for; the summary goes along where a format has a place for it."""
    for name in dict.fromkeys(formats):
        if name in EXPORTS:
            EXPORTS[name].write(folder, analysis, summary)


def _write_parquet(folder: Path, analysis: Analysis, summary: Summary) -> None:
    """Write each table as one file; what is not known is null, and the summary stands in the file's metadata."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    metadata = {b"elbowscrew": json.dumps(summary, ensure_ascii=True, allow_nan=False).encode()}
    units = analysis.settings.angle_unit, analysis.settings.length_unit
    for name, result in results_by_table(analysis).items():
        columns = {column: _arrow_array(pa, values) for column, values in result.columns(*units).items()}
        with create(folder / f"{name}.parquet") as stream:
            pq.write_table(pa.table(columns).replace_schema_metadata(metadata), stream)


def _arrow_array(pa: Any, values: NDArray[Any]) -> Any:
    if isinstance(values, np.ma.MaskedArray):
        return pa.array(values.filled(0), mask=np.ma.getmaskarray(values))
    if values.dtype.kind == "f":
        return pa.array(values + 0.0, from_pandas=True)  # NaN is null, as it is an empty cell in the CSV
    return pa.array(values.tolist() if values.dtype.kind == "U" else values)


def _write_mat(folder: Path, analysis: Analysis, summary: Summary) -> None:
    """Write one file with a structure for each table, and the summary as JSON; not known is NaN."""
    from scipy.io import savemat

    units = analysis.settings.angle_unit, analysis.settings.length_unit
    content: dict[str, Any] = {
        name: {column: _matlab_array(values) for column, values in result.columns(*units).items()}
        for name, result in results_by_table(analysis).items()
    }
    content["summary_json"] = json.dumps(summary, ensure_ascii=True, allow_nan=False)
    stream = io.BytesIO()
    savemat(stream, content, long_field_names=True, oned_as="column", do_compression=True)
    written = stream.getvalue()
    # The header tells platform and time; the same analysis is to give the same bytes.
    header = b"MATLAB 5.0 MAT-file, by elbowscrew".ljust(_MAT_HEADER_BYTES)
    write_new(folder / "trial.mat", header + written[_MAT_HEADER_BYTES:])


def _matlab_array(values: NDArray[Any]) -> NDArray[Any]:
    if isinstance(values, np.ma.MaskedArray):
        return np.where(np.ma.getmaskarray(values), np.nan, values.data.astype(np.float64))
    if values.dtype.kind == "U":
        return values.astype(object)  # a cell array of text
    return values + 0.0 if values.dtype.kind == "f" else values


def _write_sto(folder: Path, analysis: Analysis, _summary: Summary) -> None:
    """Write the angle over time as OpenSim's storage: a few header lines, then a table with tabs.

    Frames without an angle say NaN: left out, OpenSim would draw its splines across the gap.
    """
    screw, unit = analysis.screw, analysis.settings.angle_unit
    series = {"theta": screw.angle}
    if analysis.anatomy is not None:
        bones = analysis.anatomy
        series |= {column.name: column.values(bones) for column in bones.table if column.attribute in bones.names}
    if analysis.joint_angles is not None:
        own = analysis.joint_angles
        series |= {column.name: column.values(own) for column in own.table if column.attribute == "angle"}
    columns = [screw.time_s, *(angle_in(angle, unit) for angle in series.values())]
    header = (
        "elbowscrew",
        "version=1",
        f"nRows={screw.frame.size}",
        f"nColumns={len(columns)}",
        f"inDegrees={'yes' if unit == 'deg' else 'no'}",
        "endheader",
        "\t".join(("time", *series)),
    )
    rows = zip(*((column + 0.0).tolist() for column in columns), strict=True)
    with create(folder / "joint_angle.sto") as stream:
        stream.writelines(f"{line}\n".encode() for line in header)
        stream.writelines(("\t".join("NaN" if x != x else repr(x) for x in row) + "\n").encode() for row in rows)


class Export(NamedTuple):
    """One format of another program.

    Attributes
    ----------
    write : callable
        Told the folder, the analysis and its summary.
    library : str or None
        What it needs beyond the program's own dependencies.
    file : str
        The file it writes; one that begins with a point is the ending of one file for each table.
    """

    write: Callable[[Path, Analysis, Summary], None]
    library: str | None
    file: str


EXPORTS: Final = {
    "parquet": Export(_write_parquet, "pyarrow", ".parquet"),
    "mat": Export(_write_mat, "scipy", "trial.mat"),
    "sto": Export(_write_sto, None, "joint_angle.sto"),
}
"""A new format is one function and one entry here, and its name in `elbowscrew.choices.ExportName`."""
