"""The knee by Grood and Suntay's own vectors: their angles, computed from the paper's formulas, are ours."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from elbowscrew import Landmark, Landmarks, Recording, RigidBody, analyze, read_landmarks, simulate_trial
from elbowscrew.errors import UsageError
from elbowscrew.geometry.arrays import Float
from elbowscrew.model.anatomy import AnatomicalMotion, Side

# A right leg that stands: X forward, Y up, Z to the right, meters; the malleoli turned outward as a tibia's are.
STANDING = {
    "HC": np.array([0.01, 0.42, -0.012]),
    "FLE": np.array([0.0, 0.004, 0.041]),
    "FME": np.array([0.003, -0.004, -0.043]),
    "LC": np.array([-0.001, -0.022, 0.036]),
    "MC": np.array([0.002, -0.021, -0.037]),
    "LM": np.array([-0.02, -0.40, 0.036]),
    "MM": np.array([0.008, -0.39, -0.03]),
}
ON_SHANK = ("LC", "MC", "LM", "MM")
MIRROR = np.diag([1.0, 1.0, -1.0])
N = 60
T = np.linspace(0.0, 1.0, N)
# Flexion, adduction, internal rotation of the tibia against where it stands, degrees.
COURSE = np.stack(
    [5.0 + 110.0 * np.sin(np.pi * T), 4.0 * np.sin(2 * np.pi * T) - 2.0, 15.0 * np.sin(np.pi * T)], axis=1
)


def unit(vector: Float) -> Float:
    return np.asarray(vector / np.linalg.norm(vector, axis=-1, keepdims=True))


def grood_and_suntay(at: dict[str, Float], side: Side) -> Float:
    """Angles (N, 3), deg, from landmarks (N, 3) in the laboratory, in the paper's letters: I, J, K and i, j, k.

    The femur has I to the right, J forward, K up its mechanical axis; the tibia i, j, k alike. e1 = I, e3 = k and
    e2 = e3 x e1; flexion is the angle from J to e2, away from K, internal rotation that from e2 to j, and adduction
    how far I and k are from a right angle. `test_signs_are_the_anatomical_ones` has the signs.
    """
    outward = 1.0 if side == "right" else -1.0
    K = unit(at["HC"] - 0.5 * (at["FLE"] + at["FME"]))
    J = unit(np.cross(K, outward * (at["FLE"] - at["FME"])))
    I = np.cross(J, K)  # noqa: E741
    k = unit(0.5 * (at["LC"] + at["MC"] - at["LM"] - at["MM"]))
    j = unit(np.cross(k, outward * (at["LC"] - at["MC"])))
    i = np.cross(j, k)
    e2 = unit(np.cross(k, I))
    flexion = np.arctan2(-np.sum(e2 * K, axis=1), np.sum(e2 * J, axis=1))
    adduction = outward * (0.5 * np.pi - np.arccos(np.sum(I * k, axis=1)))
    internal = np.arctan2(outward * np.sum(e2 * i, axis=1), np.sum(e2 * j, axis=1))
    return np.asarray(np.degrees(np.stack([flexion, adduction, internal], axis=1)))


class Leg:
    """A leg that moves by matrices alone, in a laboratory that lies anyhow: landmarks (N, 3), and two bodies on it."""

    def __init__(self, side: Side, seed: int) -> None:
        rng = np.random.default_rng(seed)
        mirror = MIRROR if side == "left" else np.eye(3)
        inner = Rotation.from_euler("ZXY", COURSE * [-1.0, 1.0, 1.0], degrees=True).as_matrix()
        turn = Rotation.random(rng=rng).as_matrix()
        sway = Rotation.from_rotvec(np.outer(T, rng.normal(scale=0.4, size=3))).as_matrix()
        thigh, shank = turn @ sway, turn @ sway @ (mirror @ inner @ mirror)
        shift = rng.normal(size=3) + np.outer(T, rng.normal(size=3))
        self.at = {
            name: ((shank if name in ON_SHANK else thigh) @ (mirror @ place)) + shift
            for name, place in STANDING.items()
        }
        cluster = [Rotation.random(rng=rng).as_matrix() for _ in range(2)]
        origin = rng.normal(scale=0.1, size=(2, 3))
        self.R = [thigh @ cluster[0], shank @ cluster[1]]
        self.p = [thigh @ origin[0] + shift, shank @ origin[1] + shift]

    def recording(self) -> Recording:
        names = ("Thigh", "Shank")
        bodies = [RigidBody.from_matrices(*one) for one in zip(names, self.R, self.p, strict=True)]
        return Recording.from_bodies(bodies, rate_hz=100)

    def landmarks(self, side: Side) -> Landmarks:
        marks: dict[str, Any] = {}
        for name, place in self.at.items():
            k = int(name in ON_SHANK)
            point = self.R[k][0].T @ (place[0] - self.p[k][0])
            marks[name] = Landmark(point=point, frame="distal" if k else "proximal")
        return Landmarks(side=side, **marks)


@pytest.mark.parametrize(("side", "seed"), [("right", 0), ("left", 1)])
def test_the_angles_are_grood_and_suntays(side: Side, seed: int) -> None:
    leg = Leg(side, seed)
    analysis = analyze(leg.recording(), landmarks=leg.landmarks(side))
    found = analysis.anatomy
    assert isinstance(found, AnatomicalMotion)
    expected = grood_and_suntay(leg.at, side)
    assert np.degrees(found.angles) == pytest.approx(expected, abs=1e-9)
    assert np.degrees(found.flexion).max() == pytest.approx(115.0, abs=3.0)
    assert np.ptp(found.adduction) > np.radians(5.0)
    assert not [one for one in analysis.warnings if one.code.startswith("landmark")]
    table = found.to_frame()
    assert list(table.columns[2:5]) == ["flexion_deg", "adduction_deg", "internal_rotation_deg"]
    with pytest.raises(AttributeError, match="pronation is no angle of the knee; it has flexion, adduction"):
        _ = found.pronation


def test_signs_are_the_anatomical_ones() -> None:
    """Of a right leg that stands: the foot goes back, towards the other leg, and its front inward."""
    for course, direction, landmark in (
        ((5.0, 0.0, 0.0), [-1.0, 0.0, 0.0], "LM"),
        ((0.0, 5.0, 0.0), [0.0, 0.0, -1.0], "LM"),
        ((0.0, 0.0, 5.0), [1.0, 0.0, 0.0], "LC"),
    ):
        moved = Rotation.from_euler("ZXY", np.array(course) * [-1.0, 1.0, 1.0], degrees=True).as_matrix()
        at = {name: np.stack([p, moved @ p]) if name in ON_SHANK else np.stack([p, p]) for name, p in STANDING.items()}
        assert np.dot(at[landmark][1] - at[landmark][0], direction) > 0.001
        change = np.diff(grood_and_suntay(at, "right"), axis=0)[0]
        assert change == pytest.approx(course, abs=0.4)


@pytest.mark.parametrize(
    "given",
    [{"FLE": "FME", "FME": "FLE"}, {"LC": "MC", "MC": "LC"}, {}],
)
def test_landmarks_taken_for_each_other_are_told(given: dict[str, str]) -> None:
    leg = Leg("right", 2)
    right = leg.landmarks("right")
    marks: dict[str, Any] = {name: right.by_name[given.get(name, name)] for name in STANDING}
    analysis = analyze(leg.recording(), landmarks=Landmarks(side="right" if given else "left", **marks))
    told = [one.message for one in analysis.warnings if one.code == "landmarks-doubtful"]
    assert len(told) == 1
    assert "which no knee does" in told[0]


def test_a_simulated_knee_has_the_angles_of_its_landmarks() -> None:
    """By the paper's vectors, from landmarks carried along by the bodies' poses."""
    for side in ("right", "left"):
        trial = simulate_trial(joint="knee", side=side, frames=60, inversion=30, marker_noise_mm=0.0, proximal="moving")
        assert trial.landmarks is not None
        found = analyze(trial.recording, landmarks=trial.landmarks).anatomy
        assert found is not None
        at = {}
        for name, mark in trial.landmarks.by_name.items():
            q = trial.recording.bodies[int(mark.frame == "distal")].dual_quat_lab_body
            R = Rotation.from_quat(q[:, [1, 2, 3, 0]])
            t = 2.0 * quaternion_product(q[:, 4:], q[:, :4] * [1.0, -1.0, -1.0, -1.0])[:, 1:]
            at[name] = R.apply(mark.point) + t
        expected = grood_and_suntay(at, "left" if side == "left" else "right")
        assert np.degrees(found.angles) == pytest.approx(expected, abs=1e-6)
        assert np.ptp(found.flexion) > np.radians(90.0)
        assert 0.0 < np.degrees(found.flexion).min() < 10.0


def quaternion_product(a: Float, b: Float) -> Float:
    scalar = a[:, :1] * b[:, :1] - np.sum(a[:, 1:] * b[:, 1:], axis=1, keepdims=True)
    vector = a[:, :1] * b[:, 1:] + b[:, :1] * a[:, 1:] + np.cross(a[:, 1:], b[:, 1:])
    return np.concatenate([scalar, vector], axis=1)


def test_landmarks_are_all_of_one_joint(tmp_path: Path) -> None:
    at = Landmark(markers=("M",))
    with pytest.raises(ValueError, match="all of one joint: of the elbow EL, EM, US, RS, GH; of the knee FLE, FME"):
        Landmarks(side="left", FLE=at, FME=at, HC=at, LM=at, MM=at)
    path = tmp_path / "leg.toml"
    path.write_text('side = "left"\n[landmarks]\nFLE = "a"\nHC = { body = "arm", mm = [1, 2, 3] }\nEL = "b"\n')
    with pytest.raises(UsageError) as caught:
        read_landmarks(path)
    for said in (
        "unknown landmark 'EL'; possible: FLE, FME, HC",
        "FME (medial femoral epicondyle), LC (lateral tibial condyle)",
        "HC: body: expected 'thigh', 'shank' or 'lab', found 'arm'",
        'give each a marker\'s name, a list of names, or { body = "thigh", mm = [x, y, z] }',
    ):
        assert said in str(caught.value)
