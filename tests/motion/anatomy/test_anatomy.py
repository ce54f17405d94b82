"""The elbow in the ISB's frames: the angles put in come out, whatever the side, the bodies and the laboratory."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from oracles import rodrigues
from poses import random_poses, vectors
from scipy.spatial.transform import Rotation

from elbowscrew import Recording, RigidBody, Settings, analyze, simulate_trial
from elbowscrew.errors import SettingError
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import line_through
from elbowscrew.geometry import quaternion as qn
from elbowscrew.geometry.arrays import Float
from elbowscrew.model import JointMotion, Marker, QualityWarning
from elbowscrew.model.anatomy import AnatomicalMotion, Landmark, LandmarkFrame, Landmarks, Side
from elbowscrew.model.recording import Source
from elbowscrew.motion.anatomy.anatomy import anatomical_motion, angle_to_epicondyles, distance_from_point
from elbowscrew.motion.anatomy.bone_frames import bone_angles, forearm_frame, proximal_frame
from elbowscrew.motion.screws.relative import joint_from_bodies

SIDES: tuple[Side, ...] = ("right", "left")
NAMES = ("EL", "EM", "US", "RS", "GH")
ON_ARM = ("EL", "EM", "GH")
N = 120
REACH = np.linspace(0.0, np.pi, N)
FLEX = np.radians(145.0) * np.sin(REACH)
NO_AXES: dict[str, Any] = {"axis_lines": np.full((N, 6), np.nan), "functional": None}

# A right arm that hangs down: X forward, Y up, Z to the right, meters. Neither styloid is beneath its epicondyle.
STANDING = {
    "GH": np.array([0.0, 0.0, 0.0]),
    "EL": np.array([0.0, -0.30, 0.034]),
    "EM": np.array([0.0, -0.30, -0.034]),
    "US": np.array([0.0, -0.55, 0.0]),
    "RS": np.array([0.0, -0.557, 0.051]),
}
ELBOW = np.array([0.0, -0.30, 0.0])
MIRROR = np.diag([1.0, 1.0, -1.0])


@dataclass(frozen=True)
class Arm:
    """An arm by matrices alone: its landmarks in the laboratory, shape (N, 3), and the poses of two bodies on it."""

    landmarks: dict[str, Float]
    proximal_R: Float
    proximal_p: Float
    distal_R: Float
    distal_p: Float

    def bodies(self) -> tuple[RigidBody, RigidBody]:
        return (
            RigidBody.from_matrices("proximal", self.proximal_R, self.proximal_p),
            RigidBody.from_matrices("distal", self.distal_R, self.distal_p),
        )

    def moved(self, R: Float, p: Float) -> Arm:
        """The same arm in another laboratory, or, if R is a reflection, the arm of the other side."""
        turn = R * np.linalg.det(R)  # a reflected body is held by a turned one, its frame being any
        return Arm(
            {name: place @ R.T + p for name, place in self.landmarks.items()},
            turn @ self.proximal_R,
            self.proximal_p @ R.T + p,
            turn @ self.distal_R,
            self.distal_p @ R.T + p,
        )

    def in_body(self, name: str, body: Literal["proximal", "distal", "lab"], row: int = 0) -> Float:
        place: Float = self.landmarks[name][row]
        if body == "lab":
            return place
        R, p = (self.proximal_R, self.proximal_p) if body == "proximal" else (self.distal_R, self.distal_p)
        inside: Float = R[row].T @ (place - p[row])
        return inside


def known_proximal(flexion: Float, carrying: Float, pronation: Float, seed: int = 0) -> Arm:
    """Turn the forearm by the ISB's angles about the middle of the epicondyles while the whole arm moves."""
    rng = np.random.default_rng(seed)
    J = Rotation.from_euler("ZXY", np.stack([flexion, carrying, pronation], axis=1)).as_matrix()
    t = np.linspace(0.0, 1.0, len(J))
    R = rodrigues(rng.normal(size=3), 0.5 * np.sin(3 * t) + 0.7) @ rodrigues(rng.normal(size=3), 0.6 * t)
    p = rng.normal(size=3) + 0.1 * np.stack([np.sin(2 * t), np.cos(5 * t), t], axis=1)
    body_R = rodrigues(rng.normal(size=3), np.array([1.9, 2.6]))
    body_p = rng.normal(scale=0.1, size=(2, 3))
    places = {
        name: (R @ place) + p if name in ON_ARM else (R @ J @ (place - ELBOW)) + R @ ELBOW + p
        for name, place in STANDING.items()
    }
    return Arm(places, R @ body_R[0], R @ body_p[0] + p, R @ J @ body_R[1], R @ J @ body_p[1] + R @ ELBOW + p)


def by_coordinates(proximal: Arm, side: Side = "right", frames: dict[str, LandmarkFrame] | None = None) -> Landmarks:
    own: dict[str, LandmarkFrame] = {name: "proximal" if name in ON_ARM else "distal" for name in NAMES}
    marks: dict[str, Any] = {
        name: Landmark(point=proximal.in_body(name, frame), frame=frame)
        for name, frame in (own | (frames or {})).items()
    }
    return Landmarks(side=side, **marks)


def by_markers(side: Side = "right", **names: tuple[str, ...]) -> Landmarks:
    marks: dict[str, Any] = {name: Landmark(markers=names.get(name, (name,))) for name in NAMES}
    return Landmarks(side=side, **marks)


def recorded(proximal: Arm) -> Recording:
    markers = tuple(Marker(name=name, position=place) for name, place in proximal.landmarks.items())
    return replace(Recording.from_bodies(proximal.bodies(), rate_hz=100), markers=markers)


def joint_of(recording: Recording, reference: int = 0) -> JointMotion:
    options: dict[str, Any] = {"reference_row": reference, "reference_window": 1, "max_gap_s": 0.0}
    bodies = recording.bodies
    return joint_from_bodies(bodies[0], bodies[1], recording.frame, recording.time_s, recording.rate_hz, **options)


def measured(
    landmarks: Landmarks, recording: Recording, reference: int = 0
) -> tuple[AnatomicalMotion, tuple[QualityWarning, ...]]:
    proximal, distal = recording.bodies
    return anatomical_motion(landmarks, recording, proximal, distal, joint_of(recording, reference), **NO_AXES)


def angles_of(landmarks: Landmarks, recording: Recording, reference: int = 0) -> Float:
    motion, warnings = measured(landmarks, recording, reference)
    assert not warnings
    return np.stack([motion.flexion, motion.carrying_angle, motion.pronation])


@pytest.mark.parametrize("side", SIDES)
@given(a=vectors, b=vectors, c=vectors)
def test_frames_are_orthonormal_and_right_handed(side: Side, a: Float, b: Float, c: Float) -> None:
    assume(min(np.linalg.norm(v) for v in (a - b, a - c, b - c, a - 0.5 * (b + c))) > 1e-6)
    for frame, proximal in (
        (proximal_frame(a, b, c, side), a - 0.5 * (b + c)),
        (forearm_frame(a, b, c, c, side), c - a),
    ):
        if np.isnan(frame).any():
            continue
        R = dq.matrix_from_dual_quat(frame)[:3, :3]
        assert R.T @ R == pytest.approx(np.eye(3), abs=1e-12)
        assert np.linalg.det(R) == pytest.approx(1.0, abs=1e-12)
        assert dq.pose_from_dual_quat(frame)[1] == pytest.approx(a, abs=1e-12)
        assert R[:, 1] @ proximal == pytest.approx(np.linalg.norm(proximal), abs=1e-12)
        assert R[:, 0] @ (b - c) == pytest.approx(0.0, abs=1e-12)


def test_frames_of_an_arm_that_hangs_down_are_the_anatomical_directions() -> None:
    for side in SIDES:
        at = STANDING if side == "right" else {name: MIRROR @ place for name, place in STANDING.items()}
        humerus = proximal_frame(at["GH"], at["EL"], at["EM"], side)
        distal = forearm_frame(at["US"], at["RS"], at["EL"], at["EM"], side)
        for frame in (humerus, distal):
            assert dq.matrix_from_dual_quat(frame)[:3, :3] == pytest.approx(np.eye(3), abs=1e-12)


def test_frames_broadcast_and_are_nan_where_the_landmarks_lie_on_one_line() -> None:
    GH, EL, EM = np.zeros((4, 3)), np.tile([0.0, -0.3, 0.03], (4, 1)), np.array([0.0, -0.3, -0.03])
    EL[1] = [0.0, -0.3, -0.03]
    EL[2] = 1.2 * EM + [0.0, 0.0, 5e-4]
    frames = proximal_frame(GH, EL, EM, "right")
    assert np.isnan(frames).any(axis=1).tolist() == [False, True, True, False]
    assert proximal_frame(GH[None], EL[None], EM, "left").shape == (1, 4, 8)
    assert np.isnan(forearm_frame([0, 0, 0], [0, 1, 0], [0, 2, 0], [0, 2, 0], "left")).all()


def test_angles_agree_with_scipy() -> None:
    poses = random_poses((2000,), seed=5)
    expected = Rotation.from_quat(poses[:, [1, 2, 3, 0]]).as_euler("ZXY")
    found = np.stack(bone_angles(poses, "right", "elbow"), axis=1)
    locked = np.abs(np.degrees(expected[:, 1])) > 85.0
    assert 0 < locked.sum() < 100
    assert np.isnan(found[locked][:, [0, 2]]).all()
    assert found[:, 1] == pytest.approx(expected[:, 1], abs=1e-7)
    assert found[~locked] == pytest.approx(expected[~locked], abs=1e-10)
    mirrored = np.stack(bone_angles(poses, "left", "elbow"), axis=1)
    assert mirrored[~locked] == pytest.approx(expected[~locked] * [1, -1, -1], abs=1e-10)


@given(st.tuples(st.floats(-3.1, 3.1), st.floats(-1.4, 1.4), st.floats(-3.1, 3.1)), st.sampled_from([-1, 1]))
def test_angles_are_those_the_pose_was_made_of(angles: tuple[float, float, float], sign: int) -> None:
    pose = dq.dual_quat_from_pose(qn.quat_from_euler_angles(angles, "ZXY"), [1.0, 2.0, 3.0])
    assert np.stack(bone_angles(sign * pose, "right", "elbow")) == pytest.approx(angles, abs=1e-9)


def test_flexion_about_the_epicondyles_is_flexion_alone() -> None:
    proximal = known_proximal(FLEX, 0 * FLEX, 0 * FLEX)
    for reference in (0, 60):
        found = angles_of(by_markers(), recorded(proximal), reference)
        assert found[0] == pytest.approx(FLEX, abs=1e-10)
        assert np.abs(found[1:]).max() < 1e-10


def test_pronation_about_the_forearm_is_pronation_alone() -> None:
    turn = np.radians(160.0) * np.sin(REACH) - 0.2
    found = angles_of(by_markers(), recorded(known_proximal(0 * FLEX + 1.5, 0 * FLEX, turn)))
    assert found[0] == pytest.approx(0 * FLEX + 1.5, abs=1e-10)
    assert found[2] == pytest.approx(turn, abs=1e-10)
    assert np.abs(found[1]).max() < 1e-10


def test_signs_are_the_anatomical_ones() -> None:
    """Of a right arm that hangs down: the hand goes forward, away from the body, and the thumb forward."""
    for angles, landmark, direction in (
        ((0.1, 0.0, 0.0), "US", [1, 0, 0]),
        ((0.0, -0.1, 0.0), "US", [0, 0, 1]),
        ((0.0, 0.0, 0.1), "RS", [1, 0, 0]),
    ):
        R = Rotation.from_euler("ZXY", angles).as_matrix()
        assert direction @ (R @ (STANDING[landmark] - ELBOW) - (STANDING[landmark] - ELBOW)) > 0.001


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("seed", range(4))
def test_all_three_angles_come_back_on_both_sides_and_in_any_laboratory(side: Side, seed: int) -> None:
    rng = np.random.default_rng(seed)
    turn = np.radians(80.0) * (1.0 - np.cos(2 * REACH))
    valgus = np.radians(-12.0) + 0.1 * np.sin(REACH)
    expected = np.stack([FLEX - 0.1, valgus, turn])
    proximal = known_proximal(expected[0], expected[1], expected[2], seed)
    if side == "left":
        proximal = proximal.moved(MIRROR, np.zeros(3))
    for lab in (
        proximal,
        proximal.moved(rodrigues(rng.normal(size=3), np.array([2.2]))[0], rng.normal(scale=5.0, size=3)),
    ):
        assert angles_of(by_coordinates(lab, side), recorded(lab)) == pytest.approx(expected, abs=1e-10)
        assert angles_of(by_markers(side), recorded(lab)) == pytest.approx(expected, abs=1e-10)


def test_landmarks_may_be_given_in_any_frame_at_the_reference() -> None:
    proximal = known_proximal(FLEX, 0.1 * FLEX, FLEX**2 - 1.0, seed=3)
    recording = recorded(proximal)
    expected = angles_of(by_markers(), recording)
    frames: tuple[LandmarkFrame, ...] = ("proximal", "distal", "lab")
    for frame in frames:
        assert angles_of(by_coordinates(proximal, frames=dict.fromkeys(NAMES, frame)), recording) == pytest.approx(
            expected, abs=1e-10
        )


@pytest.mark.parametrize("reference", [0, 77])
def test_any_landmarks_give_the_angles_of_their_frames_by_matrices(reference: int) -> None:
    """The epicondyles are no hinge here: the forearm's frame has them where they were at the reference."""
    proximal = known_proximal(FLEX, 0.2 * FLEX, FLEX - 1.0, seed=5)
    rng = np.random.default_rng(9)
    shift = {name: rng.normal(scale=0.015, size=3) for name in NAMES}
    holder = {name: proximal.proximal_R if name in ON_ARM else proximal.distal_R for name in NAMES}
    proximal = replace(
        proximal, landmarks={name: at + holder[name] @ shift[name] for name, at in proximal.landmarks.items()}
    )

    def axes(proximal: Float, radial: Float) -> Float:
        forward = np.cross(proximal, radial)
        rows = [v / np.linalg.norm(v) for v in (forward, proximal, np.cross(forward, proximal))]
        return np.stack(rows, axis=1)

    at = {name: proximal.in_body(name, "proximal" if name in ON_ARM else "distal", reference) for name in NAMES}
    H = axes(at["GH"] - (at["EL"] + at["EM"]) / 2, at["EL"] - at["EM"])
    middle = (proximal.in_body("EL", "distal", reference) + proximal.in_body("EM", "distal", reference)) / 2
    F = axes(middle - at["US"], at["RS"] - at["US"])
    R = np.swapaxes(proximal.proximal_R @ H, 1, 2) @ proximal.distal_R @ F
    expected = np.unwrap(Rotation.from_matrix(R).as_euler("ZXY"), axis=0).T
    assert angles_of(by_markers(), recorded(proximal), reference) == pytest.approx(expected, abs=1e-10)


def test_a_still_arm_has_the_laboratory_for_its_frame() -> None:
    proximal = known_proximal(FLEX, 0 * FLEX, 0 * FLEX, seed=2)
    R, p = proximal.proximal_R, proximal.proximal_p
    still = Arm(
        {name: (np.swapaxes(R, 1, 2) @ (at - p)[..., None])[..., 0] for name, at in proximal.landmarks.items()},
        np.tile(np.eye(3), (N, 1, 1)),
        np.zeros((N, 3)),
        np.swapaxes(R, 1, 2) @ proximal.distal_R,
        (np.swapaxes(R, 1, 2) @ (proximal.distal_p - p)[..., None])[..., 0],
    )
    recording = recorded(still)
    distal = recording.bodies[1]
    joint = joint_from_bodies(
        None, distal, recording.frame, recording.time_s, 100.0, reference_row=0, reference_window=1, max_gap_s=0.0
    )
    for landmarks in (by_markers(), by_coordinates(still), by_coordinates(still, frames=dict.fromkeys(NAMES, "lab"))):
        motion, warnings = anatomical_motion(landmarks, recording, None, distal, joint, **NO_AXES)
        assert not warnings
        assert motion.flexion == pytest.approx(FLEX, abs=1e-10)


def test_flexion_and_pronation_go_on_through_a_half_turn_and_over_gaps() -> None:
    flexion, pronation = np.linspace(0.0, 3.6, N), np.linspace(0.2, 3.9, N)
    recording = recorded(known_proximal(flexion, 0 * flexion, pronation))
    lost = np.isin(np.arange(N), [30, 31, *range(100, 110)])
    distal = recording.bodies[1]
    pose = np.where(lost[:, None], np.nan, distal.dual_quat_lab_body)
    gone = replace(distal, dual_quat_lab_body=pose, loss=lost.astype(np.uint8))
    found = angles_of(by_markers(), replace(recording, bodies=(recording.bodies[0], gone)))
    assert np.isnan(found).all(axis=0).tolist() == lost.tolist()
    assert found[0, ~lost] == pytest.approx(flexion[~lost], abs=1e-10)
    assert found[2, ~lost] == pytest.approx(pronation[~lost], abs=1e-10)


def test_near_gimbal_lock_only_the_carrying_angle_is_known() -> None:
    carrying = np.radians(np.linspace(0.0, 89.0, N))
    motion, _ = measured(by_markers(), recorded(known_proximal(0 * FLEX + 0.4, carrying, 0 * FLEX + 0.3)))
    assert motion.carrying_angle == pytest.approx(carrying, abs=1e-8)
    locked = np.degrees(carrying) > 85.0
    for angle, value in ((motion.flexion, 0.4), (motion.pronation, 0.3)):
        assert np.isnan(angle).tolist() == locked.tolist()
        assert angle[~locked] == pytest.approx(np.full(N, value)[~locked], abs=1e-9)
    locked_throughout = known_proximal(0 * FLEX, 0 * FLEX + 1.55, 0 * FLEX)
    motion, warnings = measured(by_coordinates(locked_throughout), recorded(locked_throughout))
    assert np.isnan(motion.flexion).all()
    assert not warnings


def test_a_marker_is_taken_at_its_median_and_several_at_their_middle() -> None:
    proximal = known_proximal(FLEX, 0 * FLEX, 0 * FLEX, seed=7)
    recording = recorded(proximal)
    expected = angles_of(by_markers(), recording)
    rng = np.random.default_rng(1)
    seen = {name: place.copy() for name, place in proximal.landmarks.items()}
    seen["GH"][5:9] += 0.03  # taken for another for a moment
    seen["US"][:50] = np.nan  # not seen
    seen["RS"][70:] = 0.0  # not seen, as some systems write it
    aside = (proximal.proximal_R @ rng.normal(scale=0.05, size=3)[:, None])[..., 0]
    seen["front"], seen["back"] = seen.pop("GH") + aside, proximal.landmarks["GH"] - aside
    markers = tuple(Marker(name=name.lower(), position=place) for name, place in seen.items())
    found = angles_of(by_markers(GH=("Front", "BACK")), replace(recording, markers=markers))
    assert found == pytest.approx(expected, abs=1e-10)


def test_a_name_is_taken_exactly_before_it_is_taken_in_any_case() -> None:
    recording = recorded(known_proximal(FLEX, 0 * FLEX, 0 * FLEX))
    other = Marker(name="el", position=np.zeros((N, 3)))
    assert angles_of(by_markers(), replace(recording, markers=(other, *recording.markers)))[0] == pytest.approx(FLEX)


def test_a_marker_that_does_not_rest_in_its_body_is_told() -> None:
    proximal = known_proximal(FLEX, 0 * FLEX, 0 * FLEX)
    wobble = np.where(np.arange(N) % 2 == 0, 1.0, -1.0)[:, None] * np.array([1.0, 0.0, 0.0])
    for size, told in ((0.019, False), (0.022, True)):
        shaken = replace(proximal, landmarks=proximal.landmarks | {"GH": proximal.landmarks["GH"] + size * wobble})
        _, warnings = measured(by_markers(), recorded(shaken))
        assert [warning.code for warning in warnings] == ["landmark-moves"] * told
        if told:
            assert "the marker 'GH' of landmark GH moves in the arm by 22 mm RMS" in warnings[0].message


@pytest.mark.parametrize(
    ("side", "change", "pronation"),
    [
        ("left", {}, 0.0),
        ("right", {"EL": ("EM",), "EM": ("EL",)}, 1.4),
        ("right", {"US": ("RS",), "RS": ("US",)}, 1.4),
    ],
)
def test_landmarks_taken_for_each_other_are_told(side: Side, change: dict[str, Any], pronation: float) -> None:
    recording = recorded(known_proximal(FLEX, 0 * FLEX, 0 * FLEX + pronation))
    motion, warnings = measured(by_markers(side, **change), recording)
    assert [warning.code for warning in warnings] == ["landmarks-doubtful"]
    assert "which no elbow does" in warnings[0].message
    assert "\n" not in warnings[0].message
    assert motion.side == side


def test_markers_that_cannot_be_found_are_named_together() -> None:
    recording = recorded(known_proximal(FLEX, 0 * FLEX, 0 * FLEX))
    twice = (*recording.markers, replace(recording.markers[0], name="us"), replace(recording.markers[0], name="Us"))
    never = replace(recording.markers[0], name="never", position=np.full((N, 3), np.nan))
    landmarks = replace(by_markers(EL=("elbow",), GH=("never",), US=("uS",)), source="arm.toml")
    with pytest.raises(SettingError) as caught:
        measured(landmarks, replace(recording, markers=(*twice, never)))
    message = str(caught.value)
    assert message.startswith("arm.toml: EL: there is no marker 'elbow'; ")
    assert "; the recording's markers: GH, EL, EM, US, RS, us, Us, never. Name others" in message
    assert "US: 3 markers of the recording are named 'uS'" in message
    assert "GH: marker 'never' is never seen together with the arm" in message
    assert "give coordinates" in message
    assert "\n" not in message
    with pytest.raises(SettingError, match="the recording's markers: none"):
        measured(by_markers(), replace(recording, markers=()))


def test_all_markers_of_the_file_are_named_also_those_that_were_not_read() -> None:
    of_file = Source(path="take.csv", sha256="", layout="", markers=("LatEpi", "MedEpi", "UlnSty", "C7"))
    recording = replace(recorded(known_proximal(FLEX, 0 * FLEX, 0 * FLEX)), source=of_file)
    with pytest.raises(SettingError) as caught:
        measured(by_markers(EL=("lat_epi",)), recording)
    message = str(caught.value)
    assert "EL: there is no marker 'lat_epi'; did you mean 'LatEpi'?; " in message
    assert "the recording's markers: LatEpi, MedEpi, UlnSty, C7. Name others" in message


def test_a_marker_seen_only_while_its_body_is_lost_is_an_error() -> None:
    recording = recorded(known_proximal(FLEX, 0 * FLEX, 0 * FLEX))
    markers = {marker.name: marker for marker in recording.markers}
    hidden = markers["RS"].position.copy()
    hidden[:-1] = np.nan
    proximal, distal = recording.bodies
    lost = replace(
        recording,
        bodies=(proximal, replace(distal, loss=(np.arange(N) == N - 1).astype(np.uint8))),
        markers=(*(markers | {"RS": replace(markers["RS"], position=hidden)}).values(),),
    )
    with pytest.raises(SettingError, match="RS: marker 'RS' is never seen together with the forearm"):
        measured(by_markers(), lost)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"EL": ("EM",)}, "landmarks: GH, EL and EM lie nearly on one line"),
        ({"RS": ("US",)}, "landmarks: US, RS and the middle of EL and EM lie nearly on one line"),
    ],
)
def test_landmarks_on_one_line_are_an_error(change: dict[str, Any], says: str) -> None:
    with pytest.raises(SettingError, match=says):
        measured(by_markers(**change), recorded(known_proximal(FLEX, 0 * FLEX, 0 * FLEX)))


@given(h=vectors, e=vectors, point=vectors, along=st.floats(-2.0, 2.0))
def test_angle_and_distance_of_lines(h: Float, e: Float, point: Float, along: float) -> None:
    assume(min(np.linalg.norm(h), np.linalg.norm(e)) > 1e-3)
    h, e = h / np.linalg.norm(h), e / np.linalg.norm(e)
    line = np.concatenate([e, np.zeros(3)])
    angle = float(angle_to_epicondyles(h, line))
    assert 0.0 <= angle <= np.pi / 2
    assert np.cos(angle) == pytest.approx(abs(h @ e), abs=1e-12)
    for other in (-h, h):
        assert angle_to_epicondyles(other, line) == pytest.approx(angle, abs=1e-12)
        axis = line_through(point + along * h, other)
        aside = np.cross(h, [0.3, -0.5, 0.8])
        assert distance_from_point(axis, point) == pytest.approx(0.0, abs=1e-9)
        assert distance_from_point(axis, point + aside) == pytest.approx(np.linalg.norm(aside), abs=1e-9)


@pytest.mark.parametrize("express_in", ["distal", "proximal", "lab"])
@pytest.mark.parametrize("proximal", ["moving", "still"])
def test_the_screw_axes_of_an_analysis_beside_the_epicondyles(express_in: Any, proximal: Any) -> None:
    tilt, aside = np.radians(6.6), 0.004
    trial = simulate_trial(marker_noise_mm=0, proximal=proximal, slide_mm=0.0)
    truth = trial.truth["axis"]["lab"]
    h, p = np.array(truth["direction"]), 1e-3 * np.array(truth["point_mm"])
    across = np.cross(h, [0.0, 1.0, 0.0])
    across /= np.linalg.norm(across)
    middle = p + 0.03 * h + aside * np.cross(h, across)
    epicondyle = 0.035 * (np.cos(tilt) * h + np.sin(tilt) * across)
    down = np.array([0.0, -0.25, 0.0])
    points = {
        "EL": middle + epicondyle,
        "EM": middle - epicondyle,
        "GH": middle - down,
        "US": middle + down,
        "RS": middle + down + epicondyle,
    }
    marks: dict[str, Any] = {name: Landmark(point=point, frame="lab") for name, point in points.items()}
    settings = Settings(express_in=express_in, proximal="none" if proximal == "still" else None)
    analysis = analyze(trial.recording, settings, landmarks=Landmarks(side="right", **marks))
    screw, motion = analysis.screw, analysis.anatomy
    assert motion is not None
    assert not {warning.code for warning in analysis.warnings if warning.code.startswith("landmark")}
    known = screw.axis_known
    assert np.isnan(motion.axis_angle).tolist() == (~known).tolist()
    assert motion.axis_angle[known] == pytest.approx(np.full(known.sum(), tilt), abs=1e-8)
    assert motion.axis_distance[known] == pytest.approx(np.full(known.sum(), aside), abs=1e-8)
    assert motion.functional_axis == "joint_axis"
    assert motion.functional_axis_angle.value == pytest.approx(tilt, abs=1e-7)
    assert motion.functional_axis_distance.value == pytest.approx(aside, abs=1e-7)
    lab_proximal, at_reference = analysis.joint.dual_quat_lab_proximal, analysis.joint.reference
    center = dq.transform_points(dq.conjugate(lab_proximal), middle)
    assert motion.joint_center_proximal == pytest.approx(center, abs=1e-12)
    lab_distal = dq.multiply(lab_proximal, at_reference)
    assert dq.transform_points(lab_distal, motion.joint_center_distal) == pytest.approx(middle, abs=1e-12)
    assert distance_from_point(motion.epicondyle_line, center) == pytest.approx(0.0, abs=1e-12)
    assert motion.epicondyle_width == pytest.approx(0.07, abs=1e-12)
    assert motion.frame is analysis.recording.frame


def test_without_a_single_axis_its_angle_is_not_known() -> None:
    proximal = known_proximal(FLEX, 0 * FLEX, 0 * FLEX)
    motion, _ = measured(by_coordinates(proximal), recorded(proximal))
    assert motion.functional_axis is None
    assert np.isnan([motion.functional_axis_angle, motion.functional_axis_distance]).all()
    assert np.isnan(motion.axis_angle).all()
    assert "120 rows" in repr(motion)
