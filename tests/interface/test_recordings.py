"""Recordings as tables and in a notebook: what was read, and nothing else."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import elbowscrew
from elbowscrew import Recording, RigidBody
from elbowscrew.errors import UsageError
from elbowscrew.model import Marker

HALF = np.sqrt(0.5)


def recording(*, located: bool = True) -> Recording:
    """Two bodies: one turned by 90 deg about x and lost in the second of three frames, one as the laboratory."""
    place = np.array([[1, 2, 3], [np.nan] * 3, [1, 2, 4]])
    turned = RigidBody.from_quaternions(
        "Thigh", [[HALF, HALF, 0, 0], [np.nan] * 4, [HALF, HALF, 0, 0]], place if located else None
    )
    return Recording.from_bodies(
        [turned, RigidBody.from_quaternions("<Shank>", [[1, 0, 0, 0]] * 3, np.zeros((3, 3)))], rate_hz=50
    )


def test_a_frame_has_euler_parameters_and_places_in_the_unit_asked_for() -> None:
    found = recording().to_frame()
    assert found["time_s"].tolist() == [0, 0.02, 0.04]
    np.testing.assert_allclose(found["Thigh_e1"], [HALF, np.nan, HALF])
    np.testing.assert_allclose(found["Thigh_z_mm"], [3000, np.nan, 4000])
    np.testing.assert_allclose(recording().bodies[0].to_frame("m")["z_m"], [3, np.nan, 4])
    assert recording().bodies[0].to_frame()["lost"].tolist() == ["", "blank", ""]
    assert [name for name in recording(located=False).to_frame().columns if name.startswith("Thigh")] == [
        "Thigh_e0", "Thigh_e1", "Thigh_e2", "Thigh_e3",
    ]  # fmt: skip


def test_what_a_frame_writes_is_read_as_the_same_recording(samples: Path, tmp_path: Path) -> None:
    known = elbowscrew.read_recording(samples / "elbow_paper.csv")
    known.to_frame("m").to_csv(tmp_path / "again.csv", index=False)
    again = elbowscrew.read_recording(tmp_path / "again.csv")
    for one, other in zip(known.bodies, again.bodies, strict=True):
        assert one.name == other.name
        np.testing.assert_allclose(other.dual_quat_lab_body, one.dual_quat_lab_body, atol=1e-12)
    np.testing.assert_array_equal(known.time_s, again.time_s)


def test_labeled_arrays_go_by_body_and_component(tmp_path: Path) -> None:
    found = recording(located=False).to_xarray("m")
    assert found["orientation"].sel(body="Thigh", quaternion="e1", frame=2).item() == pytest.approx(HALF)
    assert np.isnan(found["position"].sel(body="Thigh")).all()
    assert found["position"].sel(body="<Shank>", component="x", frame=1).item() == 0
    assert found["lost"].sel(body="Thigh", frame=1).item() == "blank"
    assert found["position"].attrs["units"] == "m"
    assert found["time"].values.tolist() == [0, 0.02, 0.04]
    found.to_netcdf(tmp_path / "recording.nc")


def test_bodies_of_one_name_are_kept_apart() -> None:
    one, other = recording().bodies
    twice = Recording.from_bodies([one, replace(other, name="Thigh", identifier="7")], rate_hz=50)
    assert twice.to_xarray()["body"].values.tolist() == ["Thigh (1)", "Thigh (7)"]
    assert twice.to_frame().columns.is_unique


def test_markers_are_part_of_the_tables() -> None:
    marker = Marker(name="EL", position=np.arange(9.0).reshape(3, 3))
    found = replace(recording(), markers=(marker,))
    assert found.to_frame()["EL_y_mm"].tolist() == [1000, 4000, 7000]
    assert found.to_xarray()["marker_position"].sel(marker="EL", component="y").values.tolist() == [1000, 4000, 7000]


def test_a_notebook_shows_what_was_tracked_and_what_was_not(samples: Path) -> None:
    shown = recording()._repr_html_()
    assert "tracked: 2 of 3 frames; lost: 1 blank" in shown
    assert "body &lt;Shank&gt;" in shown
    assert "in memory" in shown
    assert "not measured: orientations alone" in recording(located=False).bodies[0]._repr_html_()
    read = elbowscrew.read_recording(samples / "elbow_natural.csv")._repr_html_()
    assert "elbow_natural.csv (Motive columns 1.23)" in read
    assert "300 at 100 Hz, numbered 0 to 299" in read


def test_bodies_and_markers_by_name(samples: Path) -> None:
    read = elbowscrew.read_recording(samples / "elbow_moving_arm_mm.csv", markers=("*",))
    assert all(read[body.name] is body for body in read.bodies)
    assert all(read[marker.name] is marker for marker in read.markers)
    assert list(read) == [*(body.name for body in read.bodies), *(marker.name for marker in read.markers)]
    assert len(list(read)) > len(read.bodies)
    assert "Forearm" in read
    assert "Fore arm" not in read
    with pytest.raises(KeyError, match="no body or marker 'Fore arm'; did you mean 'Forearm'"):
        read["Fore arm"]
    with pytest.raises(KeyError, match="no body or marker 'q'; there are 'Upper Arm', 'Forearm'"):
        read["q"]
    twice = Recording.from_bodies([read.bodies[0], read.bodies[0]], rate_hz=100.0)
    with pytest.raises(KeyError, match="2 are called 'Upper Arm'"):
        twice["Upper Arm"]
    assert read.duration_s == read.time_s[-1] - read.time_s[0] > 0.0
    assert recording().duration_s == 0.04


def test_what_is_no_body_makes_no_recording() -> None:
    with pytest.raises(UsageError, match=r"expected bodies, from RigidBody.* found 3"):
        Recording.from_bodies([3], rate_hz=100.0)  # type: ignore[list-item]
