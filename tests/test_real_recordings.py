"""Real recordings, where they are at hand; the figures come from the index that describes them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from elbowscrew import Recording, RigidBody, Settings, analyze, read_recording
from elbowscrew.errors import RecordingError, SettingError
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import conjugate, transform_points
from elbowscrew.model import JointAxis, MeanAxis
from elbowscrew.motion.axes.measured import measured_mean_axis
from elbowscrew.motion.joint.joint_axis import BodyMarkers, distal_line, estimate_joint_axis, fitted_frames
from elbowscrew.motion.joint.measured import axis_of_type, markers_of
from elbowscrew.motion.joint.typed import identify_joint
from elbowscrew.motion.screws.measurement import Measurement, measure

HINGES = [
    # file, arm, forearm, range deg, dispersion deg, median slide mm, its 5 and 95 % mm
    ("v121_thomazach_20230627_0117", 1, 2, 72.7, 0.08, -0.51, (-0.77, -0.07)),
    ("v121_thomazach_20230627_0117", 2, 3, 88.7, 0.23, -0.10, (-0.15, 0.45)),
    ("v121_thomazach_20230706_122504", 1, 2, 55.6, 1.43, -0.29, (-0.67, 0.64)),
    ("v121_thomazach_20230706_122504", 2, 3, 58.6, 0.61, -0.25, (-0.50, 0.48)),
]


@pytest.mark.parametrize(("name", "proximal", "distal", "top", "dispersion", "slide", "spread"), HINGES)
def test_mechanical_hinges(
    real_data: Path, name: str, proximal: int, distal: int, top: float, dispersion: float, slide: float,
    spread: tuple[float, float],
) -> None:  # fmt: skip
    recording = read_recording(real_data / "real" / f"{name}.csv")
    settings = Settings(proximal=f"Rigid Body {proximal}", distal=f"Rigid Body {distal}")
    analysis = analyze(recording, settings)
    assert np.degrees(np.nanmax(analysis.screw.angle)) == pytest.approx(top, abs=0.05)
    assert np.degrees(np.nanmedian(analysis.mean_axis.deviation)) == pytest.approx(dispersion, abs=0.006)
    slides = 1000 * analysis.screw.slide[np.isfinite(analysis.screw.slide)]
    assert np.median(slides) == pytest.approx(slide, abs=0.006)
    assert np.percentile(slides, [5, 95]) == pytest.approx(spread, abs=0.011)


@pytest.fixture(scope="module")
def parts_of_hinges(real_data: Path) -> list[list[tuple[JointAxis, JointAxis]]]:
    """Neighboring halves and quarters of each hinge, analyzed each for itself."""
    pairs = []
    for name, proximal, distal, *_ in HINGES:
        recording = read_recording(real_data / "real" / f"{name}.csv")
        bodies = Settings(proximal=f"Rigid Body {proximal}", distal=f"Rigid Body {distal}", express_in="proximal")
        measured = measure(recording, bodies)
        mean = measured_mean_axis(measured)
        found = []
        for count in (2, 4):
            cuts = np.linspace(0, len(measured.course), count + 1).astype(int)
            axes = [axis_of_part(measured, mean, slice(*cut)) for cut in pairwise(cuts)]
            found += list(pairwise(axes))
        pairs.append(found)
    return pairs


def of_rows(markers: BodyMarkers, rows: slice) -> BodyMarkers:
    motion, rms = markers.motion, markers.rms
    assert motion is not None
    assert rms is not None
    return markers._replace(motion=replace(motion, row=motion.row - rows.start), rms=rms[rows])


def axis_of_part(measured: Measurement, mean: MeanAxis, rows: slice) -> JointAxis:
    joint = measured.joint
    part = replace(
        joint,
        dual_quat_proximal_distal=joint.dual_quat_proximal_distal[rows],
        measured=joint.measured[rows],
        filled=joint.filled[rows],
        reference_row=0,
    )
    line = distal_line(np.concatenate([mean.direction, np.cross(mean.point, mean.direction)]), measured.change)
    markers = tuple(of_rows(one, rows) for one in markers_of(measured))
    gain = measured.noise_gain[rows]
    axis = estimate_joint_axis(
        part, measured.course[rows], line, measured.noise, gain, express_in="proximal", robust=False, markers=markers
    ).axis
    _, poses, covariance = fitted_frames(part, measured.noise, gain)
    kind = identify_joint(poses, covariance, joint.reference, noise_known=True, one=axis.preferred)
    return axis_of_type(axis, kind)


def test_parts_of_a_real_hinge_agree_within_their_intervals(
    parts_of_hinges: list[list[tuple[JointAxis, JointAxis]]],
) -> None:
    """Where both parts tell an axis: a part in which the joint hardly moves tells none."""
    told = agree = places = 0
    for first, second in (pair for pairs in parts_of_hinges for pair in pairs):
        one, two = first.headline, second.headline
        if one is None or two is None:
            continue
        told += 1
        h, g = one.line.direction, two.line.direction
        angle = float(np.arctan2(np.linalg.norm(np.cross(h, g)), abs(h @ g)))
        agree += angle <= np.hypot(one.axis_cone, two.axis_cone)
        off = two.line.point - one.line.point
        off = off - g * (off @ g)  # the other line where it is nearest
        places += float(np.linalg.norm(np.cross(off, h))) <= np.hypot(one.point_radius, two.point_radius)
    assert told >= 10  # of 16
    assert agree >= told - 2
    assert places >= told - 2


def test_intervals_of_a_hinge_hold_in_the_robots_other_take(real_data: Path) -> None:
    """The rigid bodies were made anew in between; the middle link's two hinges, seen from it, are the same ones."""
    angle: list[float] = []
    length: list[float] = []
    spread: list[list[float]] = []
    for take in ("v121_thomazach_20230627_0117", "v121_thomazach_20230706_122504"):
        recording = read_recording(real_data / "real" / f"{take}.csv")
        fits = []
        for proximal, distal in ((1, 2), (2, 3)):
            settings = Settings(
                proximal=f"Rigid Body {proximal}",
                distal=f"Rigid Body {distal}",
                express_in="distal" if proximal == 1 else "proximal",
            )
            analysis = analyze(recording, settings)
            fit = analysis.joint_axis.hinge
            assert analysis.joint_axis.single
            assert fit is not None
            assert fit.correlation > 50  # no white noise: see docs/explanation/joint-axis.md
            fits.append(fit)
        n, m = (fit.line.direction for fit in fits)
        angle.append(float(np.arcsin(np.linalg.norm(np.cross(n, m)))))
        between = fits[1].line.point - fits[0].line.point
        between = between - (between @ n) / (m @ n) * m  # in the plane across the first hinge
        length.append(float(np.linalg.norm(between)))
        spread.append(
            [float(np.hypot(fits[0].axis_sd, fits[1].axis_sd)), float(np.hypot(fits[0].point_sd, fits[1].point_sd))]
        )
    joint_spread = np.hypot(np.array(spread[0]), np.array(spread[1]))
    assert abs(angle[0] - angle[1]) < 1.96 * joint_spread[0]
    assert abs(length[0] - length[1]) < 1.96 * joint_spread[1]
    assert length[0] == pytest.approx(0.216, abs=0.001)


def test_simulated_curl_through_the_python_interface(real_data: Path) -> None:
    folder = real_data / "haexplorer_curl"

    def body(name: str) -> RigidBody:
        rotation = np.loadtxt(folder / f"{name}_rot.txt").reshape(-1, 3, 3)
        return RigidBody.from_matrices(name, rotation, np.loadtxt(folder / f"{name}_pos.txt"))

    recording = Recording.from_bodies([body("humerus"), body("radius")], rate_hz=1000)
    analysis = analyze(recording, Settings(express_in="proximal"))
    assert np.degrees(analysis.screw.angle.max()) == pytest.approx(66.06, abs=0.005)
    assert analysis.mean_axis.direction == pytest.approx([0.99756, 0.00122, -0.06975], abs=1e-4)
    assert analysis.mean_axis.point == pytest.approx([-0.01146, 0.01998, -0.16357], abs=1e-4)
    assert np.nanmax(np.abs(analysis.screw.slide)) < 1e-6


READ = {
    "excerpt_v123_rofunc_interleaved_3frames": ("Motive columns 1.23", "mm", "quaternion", 3, {"Left": 3, "Right": 3}),
    "motive_rowtag_v11_1body": ("row-tagged 1.1", "m", "quaternion", 548, {"Rigid Body 1": 528}),
    "v121_hmv_sample": ("Motive columns 1.21", "m", "quaternion", 250, {"Rigid Body 1": 250}),
    "v123_decar_155_imu": ("Motive columns 1.23", "m", "quaternion", 2194, {"RigidBody": 2193}),
    "v123_kronium_recording": ("Motive columns 1.23", "mm", "quaternion", 9420, {"drone": 9356}),
    "v123_parseoptitrack_test": ("Motive columns 1.23", "m", "quaternion", 499, {"ernesto_body": 498}),
    "v123_pool_20191122_excel": ("Motive columns 1.23", "mm", "quaternion", 1451, {"Cue Ball": 1451}),
    "v124_saito_hopping": ("Motive columns 1.24", "mm", "YXZ", 666, {"RED_WShip": 666, "Wheel": 666}),
}


@pytest.mark.parametrize("name", READ)
def test_real_variants_are_read(real_data: Path, name: str) -> None:
    recording = read_recording(real_data / "real" / f"{name}.csv")
    assert recording.source is not None
    found = (
        recording.source.layout,
        recording.source.length_unit,
        recording.source.rotation_type,
        recording.frame.size,
        {body.name: int(body.tracked.sum()) for body in recording.bodies},
    )
    assert found == READ[name]


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("tt2011_gimbal_Rotation_stripped", "header is missing"),
        ("tt2011_gimbal_Abduction_stripped", "header is missing"),
        ("v123_nmotive_default", "no data columns at all"),
        ("v121_dance_zyx_mm_local", "found: Marker"),
        ("excerpt_v124_timecode_cm", "found: Marker"),
        ("natnethelper_rowtag_2bodies", "not certain which pose is whose"),
    ],
)
def test_what_cannot_be_read_safely_is_refused(real_data: Path, name: str, says: str) -> None:
    with pytest.raises(RecordingError, match=says):
        read_recording(real_data / "real" / f"{name}.csv")


@pytest.mark.parametrize(("name", "pivot_mm"), [("v121_hmv_sample", 0.0), ("v123_decar_155_imu", 135.0)])
def test_markers_are_at_rest_in_their_body(real_data: Path, name: str, pivot_mm: float) -> None:
    """Only with the right order and sense of the quaternion; where the pivot is, the index tells."""
    recording = read_recording(real_data / "real" / f"{name}.csv")
    offsets = recording.bodies[0].marker_offsets
    assert offsets is not None
    assert 1000 * np.linalg.norm(offsets.mean(axis=0)) == pytest.approx(pivot_mm, abs=0.5)


def test_local_coordinate_space_gives_the_offsets_themselves(real_data: Path) -> None:
    recording = read_recording(real_data / "real" / "v124_saito_hopping.csv")
    offsets = recording.bodies[1].marker_offsets
    assert offsets == pytest.approx(
        1e-3 * np.array([[23.2168, 19.6676, 0.292987], [-26.6404, 10.9816, 0.39503], [3.42361, -30.6491, -0.688046]]),
        abs=2e-9,
    )


def test_mirrored_bodies_of_version_1_1_are_corrected(real_data: Path) -> None:
    path = real_data / "real" / "v11_handsyn_20141028_body.csv"
    with pytest.raises(SettingError, match="give units m"):
        read_recording(path)
    recording = read_recording(path, units="m")
    assert [warning.code for warning in recording.warnings] == ["mirrored"]
    body = recording.bodies[0]
    assert body.marker_offsets is not None
    # The body's markers, columns 11 on in the file, are at rest in the body.
    columns = [first + axis for first in range(10, 26, 4) for axis in range(3)]
    cells = np.genfromtxt(path, delimiter=",", skip_header=7, usecols=columns)
    in_body = transform_points(conjugate(body.dual_quat_lab_body)[:, None, :], cells.reshape(-1, 4, 3))
    assert np.nanmedian(np.linalg.norm(in_body - body.marker_offsets, axis=2)) < 1e-6


def test_one_take_saved_twice_gives_the_same_poses(real_data: Path) -> None:
    plain, excel = (read_recording(real_data / "real" / f"v123_pathviewr_july29_{kind}.csv") for kind in ("a", "excel"))
    shared, rows, others = np.intersect1d(plain.frame, excel.frame, return_indices=True)
    assert shared.size > 1000
    for one, other in zip(plain.bodies, excel.bodies, strict=True):
        assert one.dual_quat_lab_body[rows] == pytest.approx(other.dual_quat_lab_body[others], abs=1e-9, nan_ok=True)


def gimbal_markers(path: Path) -> tuple[list[str], Float]:
    """Frames and times as text, and the markers of a stripped Tracking Tools file followed from frame to frame.

    Every row has frame, time, 0, the number of markers, and x, y, z, 0 for each, in an order that changes.
    """
    head: list[str] = []
    positions: list[Float] = []
    for line in path.read_text().splitlines():
        cells = line.split(",")
        head.append(f"{cells[0]},{cells[1]}")
        values = [float(cell) for cell in cells[4:] if cell]
        seen = np.array(values[: 4 * (len(values) // 4)]).reshape(-1, 4)[:, :3]
        if not positions:
            positions.append(seen)
            last = seen.copy()
            continue
        distance = np.linalg.norm(seen[:, None] - last[None], axis=2)
        found = np.full_like(last, np.nan)
        for k in np.argsort(distance.min(axis=1)):
            nearest = int(np.argmin(distance[k]))
            if distance[k, nearest] < 0.03 and np.isnan(found[nearest, 0]):
                found[nearest] = last[nearest] = seen[k]
        positions.append(found)
    return head, np.array(positions)


def plain_table_of(stripped: Path, folder: Path) -> Recording:
    head, positions = gimbal_markers(stripped)
    lines = [",".join(["frame,time_s", *(f"marker{k}_{axis}_m" for k in range(positions.shape[1]) for axis in "xyz")])]
    for k, row in enumerate(positions.reshape(len(positions), -1).tolist()):
        lines.append(",".join([head[k], *("" if value != value else repr(value) for value in row)]))
    path = folder / "gimbal.csv"
    path.write_text("\n".join(lines) + "\n")
    return read_recording(path, markers="*")


def named_columns_of(stripped: Path, folder: Path) -> Recording:
    """In these two files the first eight markers keep their places."""
    said = ["[clock]", 'frame = "#1"', 'time = "#2"']
    for k in range(8):
        columns = [f"#{5 + 4 * k + axis}" for axis in range(3)]
        said += [f"[markers.marker{k}]", f"position = {columns}", 'unit = "m"']
    path = folder / "columns.toml"
    path.write_text("\n".join(said) + "\n")
    return read_recording(stripped, columns=path, markers="*")


@pytest.mark.parametrize("way", [plain_table_of, named_columns_of])
@pytest.mark.parametrize(
    ("name", "proximal", "distal", "top", "mean_deg", "largest_deg", "slide_mm"),
    [
        ("Rotation", (0, 3, 4), (2, 5, 6), 41.6, 0.54, 2.2, (0.09, 0.49)),
        ("Abduction", (4, 5, 7), (0, 1, 2), 24.0, 2.9, 4.5, (-3.3, 0.6)),
    ],
)
def test_gimbals_whose_files_lost_their_headers(
    real_data: Path, tmp_path: Path, name: str, proximal: tuple[int, ...], distal: tuple[int, ...], top: float,
    mean_deg: float, largest_deg: float, slide_mm: tuple[float, float], way: Callable[[Path, Path], Recording],
) -> None:  # fmt: skip
    """The two recipes of docs/reference/plain-table.md; the figures are of angles above 15 deg.

    The index gives Abduction's slide along the line of the axis markers, -0.6 to 3.3 mm; here the angle is positive.
    """
    recording = way(real_data / "real" / f"tt2011_gimbal_{name}_stripped.csv", tmp_path)
    settings = Settings(
        proximal_markers=tuple(f"marker{k}" for k in proximal),
        distal_markers=tuple(f"marker{k}" for k in distal),
        min_angle_deg=15,
    )
    analysis = analyze(recording, settings)
    assert np.degrees(np.nanmax(analysis.screw.angle)) == pytest.approx(top, abs=0.06)
    deviation = np.degrees(analysis.mean_axis.deviation)
    assert np.nanmean(deviation) == pytest.approx(mean_deg, abs=0.05)
    assert np.nanmax(deviation) == pytest.approx(largest_deg, abs=0.06)
    assert 1000 * np.nanmin(analysis.screw.slide) == pytest.approx(slide_mm[0], abs=0.06)
    assert 1000 * np.nanmax(analysis.screw.slide) == pytest.approx(slide_mm[1], abs=0.06)


def test_bodies_of_different_sides_are_refused_with_both_sides_and_the_options(real_data: Path) -> None:
    recording = read_recording(real_data / "cases" / "sides_mixed.csv")
    with pytest.raises(SettingError) as caught:
        analyze(recording)
    told = str(caught.value)
    assert caught.value.exit_code == 4
    for word in ("'Upper Arm L' is left", "'Forearm R' is right", "give both proximal and distal"):
        assert word in told
    named = analyze(recording, Settings(proximal="Upper Arm L", distal="Forearm R"))
    assert "sides-differ" in [warning.code for warning in named.warnings]


def test_error_bars_that_are_not_there_rest_on_nothing(real_data: Path) -> None:
    """Only one of the two bodies has a still stretch: what errors rest on is not told of errors that are not given."""
    found = analyze(
        read_recording(real_data / "cases" / "knee_screwhome.csv"), Settings(proximal="R_Thigh", distal="R_Shank")
    )
    assert np.isnan(found.screw.angle_sd).all()
    told = {warning.code for warning in found.warnings}
    assert "noise-unknown" in told
    assert "noise-from-jitter" not in told
