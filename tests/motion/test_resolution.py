"""Stillness in coarse numbers, poses of no rotation in line with the motion, and one body under two names."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from elbowscrew import Recording, RigidBody, Settings, analyze, read_recording
from elbowscrew.errors import AnalysisError
from elbowscrew.geometry.arrays import Float
from elbowscrew.model import Marker
from elbowscrew.motion.tracking.quality import check_bodies

CLUSTER = np.array([[0.06, 0.0, 0.01], [-0.05, 0.03, 0.0], [0.0, -0.04, 0.02]])
RATE = 100.0


def held_flexion() -> tuple[Float, Float]:
    """Rotation matrices and positions of a body that rests, turns by 60 deg, and rests."""
    time = np.clip((np.arange(120) - 30) / 60.0, 0.0, 1.0)
    fraction = time**3 * (10.0 - 15.0 * time + 6.0 * time**2)
    R = Rotation.from_rotvec(np.radians(60.0) * fraction[:, None] * [0.96, 0.28, 0.0]).as_matrix()
    return R, 0.2 * R[:, :, 1] + [0.3, 1.0, 0.2]


def recording_of(step_m: float | None, noise_m: float, frozen: slice | None) -> Recording:
    R, p = held_flexion()
    seen = np.einsum("nij,mj->nmi", R, CLUSTER) + p[:, None]
    seen += np.random.default_rng(3).normal(0.0, noise_m, seen.shape)
    if frozen is not None:
        seen[frozen] = seen[frozen.start]
    if step_m is not None:
        seen = step_m * np.round(seen / step_m)
    markers = tuple(Marker(name=f"F{k}", position=seen[:, k]) for k in range(3))
    frame = np.arange(120)
    return Recording(bodies=(), frame=frame, time_s=frame / RATE, rate_hz=RATE, markers=markers)


SETTINGS = Settings(proximal="none", distal_markers=("F*",), min_tracked_percent=0)


@pytest.mark.parametrize("step_m", [0.001, 0.0005, 0.002])
def test_rest_in_coarse_numbers_is_measured(step_m: float) -> None:
    found = analyze(recording_of(step_m, 0.0, None), SETTINGS)
    assert found.screw.valid.all()
    assert np.degrees(found.screw.angle[-1]) == pytest.approx(60.0, abs=3.0)
    assert "coarse-numbers" in {warning.code for warning in found.warnings}


@pytest.mark.parametrize(("step_m", "noise_m"), [(1e-6, 1e-4), (1e-5, 1e-4), (1e-4, 2e-4), (None, 1e-4)])
def test_frozen_poses_in_fine_numbers_are_lost(step_m: float | None, noise_m: float) -> None:
    found = analyze(recording_of(step_m, noise_m, slice(50, 60)), SETTINGS)
    assert np.flatnonzero(found.screw.distal_loss == "frozen").tolist() == list(range(51, 60))


def test_a_body_with_coarse_positions_and_fine_rotations_is_lost_where_it_repeats() -> None:
    R, p = held_flexion()
    rng = np.random.default_rng(8)
    R = Rotation.from_rotvec(rng.normal(0.0, 1e-4, (120, 3))).as_matrix() @ R
    R[50:60] = R[50]
    p = np.round(p, 3)
    p[50:60] = p[50]
    body = RigidBody.from_matrices("forearm", R, p)
    found = analyze(Recording.from_bodies([body], rate_hz=RATE), Settings(min_tracked_percent=0))
    assert np.flatnonzero(found.screw.distal_loss == "frozen").tolist() == list(range(51, 60))


@pytest.mark.parametrize("first_step_deg", [0.0, 4.0, 20.0])
def test_a_pose_of_no_rotation_in_line_with_its_neighbors_is_measured(first_step_deg: float) -> None:
    """The body speeds up: 0, 4, 12, 24, ... deg; or the first frame is one of a body that was not solved."""
    angle = np.radians(first_step_deg + np.r_[0.0, 2.0 * np.arange(1, 6) * np.arange(1, 6) + 2.0 * np.arange(1, 6)])
    if first_step_deg in (0.0, 4.0):
        angle -= angle[0]
    else:
        angle[0] = 0.0
    quat = np.stack([np.cos(angle / 2), np.sin(angle / 2), 0 * angle, 0 * angle], axis=1)
    body = RigidBody.from_quaternions("forearm", quat, np.tile([0.0, 0.2, 0.0], (6, 1)))
    recording = Recording.from_bodies([body], rate_hz=20.0)
    checked = check_bodies(recording, recording.bodies, Settings())
    assert bool(checked.bodies[0].body.tracked[0]) == (first_step_deg < 20.0)


def test_one_body_under_two_names_is_said_so() -> None:
    R, p = held_flexion()
    bodies = [RigidBody.from_matrices(name, R, p) for name in ("upper arm", "forearm")]
    with pytest.raises(AnalysisError, match="'upper arm' and 'forearm' have one and the same pose in every frame"):
        analyze(Recording.from_bodies(bodies, rate_hz=RATE))


def test_bodies_that_turn_on_the_spot_to_the_last_digit_have_no_measured_positions() -> None:
    R, _ = held_flexion()
    arm = Rotation.from_rotvec(np.linspace(0.0, 0.3, 120)[:, None] * [0.0, 1.0, 0.0]).as_matrix()
    still = np.tile([0.1, 0.2, 0.3], (120, 1))
    bodies = [RigidBody.from_matrices("upper arm", arm, still), RigidBody.from_matrices("forearm", arm @ R, 0 * still)]
    found = analyze(Recording.from_bodies(bodies, rate_hz=RATE))
    codes = [warning.code for warning in found.warnings]
    assert {"constant-positions", "no-positions"} <= set(codes)
    assert np.isnan(found.screw.slide).all()
    moving = RigidBody.from_matrices("forearm", arm @ R, 1e-6 * np.random.default_rng(2).normal(size=(120, 3)))
    assert analyze(Recording.from_bodies([bodies[0], moving], rate_hz=RATE)).screw.valid.all()
    fixed = RigidBody.from_matrices("upper arm", 0 * arm + np.eye(3), still)
    alone = analyze(Recording.from_bodies([fixed, bodies[1]], rate_hz=RATE))
    assert np.isfinite(alone.screw.slide).any()
    assert "on-the-spot" in [warning.code for warning in alone.warnings]


def test_cases(real_data: Path) -> None:
    cases = real_data / "cases"
    markers = Settings(proximal_markers=("A?",), distal_markers=("F?",))
    found = analyze(read_recording(cases / "trc_frozen_quantized_1mm.trc", markers="*"), markers)
    assert np.degrees(np.nanmax(found.screw.angle)) == pytest.approx(60.0, abs=1.5)
    first = analyze(read_recording(cases / "identity_fast_start.csv"))
    assert first.screw.valid[0]
    with pytest.raises(AnalysisError, match="one and the same pose"):
        analyze(read_recording(cases / "same_pose.csv"))
    assert np.isnan(analyze(read_recording(cases / "imu_zero_pos.csv")).screw.slide).all()
