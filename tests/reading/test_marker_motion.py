"""What readers keep of the markers' motion among themselves."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from elbowscrew import Settings, read_recording, save_simulation, simulate_trial
from elbowscrew.model import MarkerMotion, Recording
from elbowscrew.motion.smoothing.resampling import resample_recording
from elbowscrew.motion.tracking.marker_poses import body_from_markers
from elbowscrew.reading import builders
from elbowscrew.reading.builders import ThinnedBuilder


@pytest.mark.parametrize("rows", [1, 7, 8, 9, 40, 1000])
def test_a_thinned_array_has_every_kth_row_and_a_bound(monkeypatch: pytest.MonkeyPatch, rows: int) -> None:
    monkeypatch.setattr(builders, "_MOST_THINNED", 8)
    values = np.random.default_rng(rows).normal(size=(rows, 2))
    thinned = ThinnedBuilder(2)
    for block in np.split(values, np.sort(np.random.default_rng(1).integers(0, rows, 5))):
        thinned.append(block[thinned.wanted(len(block))], len(block))
    row, kept = thinned.finish()
    assert min(rows, 5) <= len(row) <= 8
    assert row.tolist() == list(range(0, rows, int(row[1]) if len(row) > 1 else 1))
    assert (kept == values[row.astype(int)]).all()


def motion_of(recording: Recording, body: int) -> MarkerMotion:
    found = recording.bodies[body].marker_motion
    assert found is not None
    return found


def test_solved_bodies_keep_what_their_poses_do_not_explain_of_the_markers(samples: Path) -> None:
    """The pose that fits them best leaves the misfit of the markers, all of it."""
    recording = read_recording(samples / "elbow_paper.csv")
    for body in recording.bodies:
        motion, residual = body.marker_motion, body.marker_residual
        assert motion is not None
        assert residual is not None
        assert motion.row.tolist() == list(range(len(residual)))
        assert not motion.own_shape
        known = np.isfinite(motion.nonrigid).all(axis=1)
        square = np.sum(motion.nonrigid[known] ** 2, axis=1)
        # Printed to micrometers: poses and places.
        assert np.sqrt(square) == pytest.approx(np.sqrt(len(motion.shape)) * residual[known], abs=1e-5)
        assert 1e3 * np.sqrt(np.mean(square) / motion.nonrigid.shape[1]) == pytest.approx(0.1, rel=0.03)


def test_a_frame_with_a_marker_hidden_tells_nothing_and_its_neighbors_do(samples: Path, tmp_path: Path) -> None:
    lines = (samples / "elbow_paper.csv").read_text().splitlines()
    kinds, names = (lines[k].replace('"', "").split(",") for k in (2, 3))
    hidden = [
        k for k, (kind, name) in enumerate(zip(kinds, names, strict=True)) if (kind, name[-7:]) == ("Marker", "Marker2")
    ]
    cells = lines[7 + 30].split(",")
    lines[7 + 30] = ",".join("" if k in hidden else cell for k, cell in enumerate(cells))
    path = tmp_path / "hidden.csv"
    path.write_text("\n".join(lines) + "\n")
    lost = np.isnan(motion_of(read_recording(path), 1).nonrigid).all(axis=1)
    whole = np.isnan(motion_of(read_recording(samples / "elbow_paper.csv"), 1).nonrigid).all(axis=1)
    assert np.flatnonzero(lost != whole).tolist() == [30]


def test_bodies_built_from_markers_keep_it_too(tmp_path: Path) -> None:
    save_simulation(simulate_trial(marker_noise_mm=0.3, seed=4), tmp_path / "t.csv")
    settings = Settings(distal_markers=("Forearm:Marker?",))
    recording = read_recording(tmp_path / "t.csv", markers=settings.markers)
    body = body_from_markers(recording, "markers", ("Forearm:Marker?",), "svd")
    motion, residual = body.marker_motion, body.marker_residual
    assert motion is not None
    assert residual is not None
    assert motion.own_shape
    seen = np.isfinite(motion.nonrigid).all(axis=1)
    assert np.linalg.norm(motion.nonrigid[seen], axis=1) == pytest.approx(2.0 * residual[seen], rel=1e-3)
    # The same as from the solved body, but for the direction of the coordinates.
    solved = motion_of(recording, 1).nonrigid[seen]
    assert np.std(motion.nonrigid[seen]) == pytest.approx(np.std(solved), rel=0.02)


@pytest.mark.parametrize("rate_hz", [25.0, 50.0, 100.0, 333.0])
def test_another_clock_takes_the_frame_that_is_nearest(samples: Path, rate_hz: float) -> None:
    taken = read_recording(samples / "elbow_paper.csv")
    changed = resample_recording(taken, rate_hz)
    old = taken.time_s - taken.time_s[0]
    rows = np.arange(0, len(changed.time_s), 7)
    nearest = np.argmin(np.abs(old - changed.time_s[rows, None]), axis=1)
    off = np.abs(old - changed.time_s[rows, None])
    clear = np.sort(off, axis=1)[:, 1] - np.sort(off, axis=1)[:, 0] > 1e-6
    found = motion_of(changed, 0).at(rows)
    expected = motion_of(taken, 0).nonrigid[nearest]
    assert np.array_equal(found[clear], expected[clear], equal_nan=True)
