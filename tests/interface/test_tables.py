"""Results as tables: in brief, in a notebook, labeled, on disk and back."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from elbowscrew import Analysis, ComparisonPlan, compare, simulate_trial
from elbowscrew.errors import UsageError
from elbowscrew.model import labeled
from elbowscrew.model.table_record import TableRecord
from elbowscrew.results.writing import results_by_table


@pytest.fixture(scope="module")
def tables(elbow: Analysis) -> dict[str, TableRecord]:
    plan = ComparisonPlan(methods=("sclerp",), laws=("linear",), counts=(2,), data=("raw",))
    compared = compare(simulate_trial(frames=60, inversion=30).recording, plan=plan)
    return {**results_by_table(elbow), "compare": compared.models}


def test_every_number_of_a_table_is_in_its_dataset(tables: dict[str, TableRecord]) -> None:
    for name, table in tables.items():
        frame, labeled_table = table.to_frame("rad", "m"), table.to_xarray("rad", "m")
        for column in frame:
            stem = str(column).removesuffix("_rad_s").removesuffix("_m_s").removesuffix("_rad").removesuffix("_m")
            values = frame[column].to_numpy(na_value=np.nan) if frame[column].dtype == "Int64" else frame[column]
            if stem in labeled_table or stem in labeled_table.coords:
                found = labeled_table[stem].to_numpy().ravel()
                if name != "cycles" or stem == "theta":
                    np.testing.assert_array_equal(found, values, err_msg=f"{name}: {column}")
            elif stem[-2:] in ("_x", "_y", "_z"):
                np.testing.assert_array_equal(labeled_table[stem[:-2]].sel(component=stem[-1]), values, err_msg=stem)
            elif stem != "time_s" and not stem.startswith("residual"):
                vector, along = stem.rstrip("0123"), stem.replace("_sd", "")
                if stem.endswith("_sd"):
                    vector = f"{along[:-1]}_sd"
                dimension = f"{along.rstrip('0123')}_component"
                np.testing.assert_array_equal(labeled_table[vector].sel({dimension: along}), values, err_msg=stem)


def test_units_are_attributes(tables: dict[str, TableRecord]) -> None:
    screw = tables["screw"].to_xarray()
    assert screw["theta"].attrs["units"] == "deg"
    assert screw["point"].attrs["units"] == "mm"
    assert screw["axis"].dims == ("frame", "component")
    assert screw["time"].attrs["units"] == tables["repetitions"].to_xarray()["duration_s"].attrs["units"] == "s"
    assert tables["instantaneous"].to_xarray("rad", "m")["slide_velocity"].attrs["units"] == "m/s"
    assert tables["compare"].to_xarray()["ns_per_frame"].attrs["units"] == "ns"
    assert tables["cycles"].to_xarray()["theta"].sizes == {"cycle": 1, "percent": 101}


def test_datasets_go_to_netcdf_and_back(tables: dict[str, TableRecord], tmp_path: Path) -> None:
    for name, table in tables.items():
        written = table.to_xarray()
        written.to_netcdf(tmp_path / f"{name}.nc")
        with xr.open_dataset(tmp_path / f"{name}.nc") as back:
            xr.testing.assert_equal(back.load(), written)


def test_without_xarray_its_name_is_told(elbow: Analysis, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(labeled, "find_spec", lambda _name: None)
    with pytest.raises(UsageError, match="pip install xarray"):
        elbow.screw.to_xarray()


def test_results_show_themselves_in_brief(elbow: Analysis) -> None:
    assert repr(elbow.screw) == "ScrewMotion(300 rows of 27 columns: frame, time_s, valid, theta_deg, slide_mm, …)"
    assert repr(elbow.recording) == "Recording(300 frames at 100 Hz; bodies 'Right Upper Arm', 'Right Forearm')"
    assert repr(elbow.distal) == "RigidBody('Right Forearm'; tracked in 300 of 300 frames)"
    assert "theta_deg" in elbow.screw._repr_html_()
    assert elbow.screw._repr_html_().count("<tr>") < 15
    assert "<td" in elbow.joint_axis._repr_html_()
    assert "&lt;LineEstimate&gt;" in elbow.joint_axis._repr_html_()


def test_results_are_pickled(elbow: Analysis) -> None:
    back = pickle.loads(pickle.dumps(elbow))  # noqa: S301 - our own
    np.testing.assert_array_equal(back.screw.angle, elbow.screw.angle)
    assert back.settings == elbow.settings
    assert repr(back.recording) == repr(elbow.recording)
