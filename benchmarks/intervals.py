"""How often the intervals of a hinge hold the truth, under every kind of marker noise.

    python benchmarks/intervals.py [--quick] [--rms] [--prepared] [TRIALS]

Prints a table in Markdown: share of trials whose 95 % interval holds the true line, direction and place in the proximal
and in the distal body; mean radius over the 95th percentile of the error; and how often a pitch is told.
As in `analyze` of a file with markers; with ``--rms`` they tell no more than their RMS in each frame. With
``--prepared`` recordings of markers are analyzed instead: as they are, with gaps, filtered, resampled, robustly, and
without the markers, by their poses and errors.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "support"))

from cluster_noise import (
    Held,
    Hinge,
    Noise,
    coverage,
    line_errors,
    recording_of,
    skin,
    smooth_skin,
    turning,
    turning_with_flexion,
    wander,
    white,
)
from trials import LINE

from elbowscrew import Recording, RigidBody, Settings
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import pose_from_points, quaternion
from elbowscrew.motion.axes.measured import measured_mean_axis
from elbowscrew.motion.joint.interval import SkinMotion
from elbowscrew.motion.joint.lines import line_pose
from elbowscrew.motion.joint.measured import measured_joint_axis
from elbowscrew.motion.screws.measurement import Measurement, measure

HINGES = (
    Hinge(top_deg=140.0),
    Hinge(top_deg=60.0),
    Hinge(top_deg=20.0),
    Hinge(top_deg=140.0, cycles=8),
    Hinge(top_deg=60.0, cycles=8),
    Hinge(top_deg=140.0, markers=3),
    Hinge(top_deg=60.0, markers=3),
    Hinge(top_deg=140.0, still=True),
    Hinge(top_deg=60.0, still=True),
)
TURN, SHIFT = np.radians(2.0), 2e-3


def main() -> None:
    """Print one row for each hinge and each kind of noise."""
    words = [word for word in sys.argv[1:] if not word.startswith("--")]
    quick = "--quick" in sys.argv
    trials = int(words[0]) if words else 20 if quick else 300
    if "--prepared" in sys.argv:
        prepared(trials)
        return
    print("| top deg | cycles | markers | proximal | noise | direction | place | sharpness | pitch |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    for number, hinge in enumerate(HINGES[:3] if quick else HINGES):
        for name, (noise, stated) in kinds(hinge).items():
            alone = "--rms" in sys.argv
            found = coverage(hinge, noise, trials, seed=number, skin=stated, pitch=True, rms_alone=alone)
            held, sharp = found.held, found.sharpness
            print(
                f"| {hinge.top_deg:g} | {hinge.cycles} | {hinge.markers} | {'still' if hinge.still else 'moves'} "
                f"| {name} | {held[0]:.3f}, {held[2]:.3f} | {held[1]:.3f}, {held[3]:.3f} "
                f"| {sharp[0::2].max():.2f}, {sharp[1::2].max():.2f} | {found.spurious_pitch:.3f} |",
                flush=True,
            )


PREPARED: dict[str, dict[str, Any]] = {
    "as it is": {},
    "a fifth lost, in gaps": {},
    "low-pass 6 Hz": {"lowpass_hz": 6.0},
    "resampled to 50 Hz": {"resample_hz": 50.0},
    "robust": {"robust": True},
    "markers' errors alone": {},
}
# Of a distance in space that is normal in each coordinate: its mean over its RMS, as an error column has it.
MEAN_TO_RMS = float(np.sqrt(8.0 / (3.0 * np.pi)))


def prepared(trials: int) -> None:
    """Print the shares that hold the line in the proximal body, of a hinge of 60 deg in one cycle."""
    print("| noise | analyzed | direction | place | sharpness |\n| --- | --- | --- | --- | --- |")
    hinge = Hinge(top_deg=60.0)
    noises = {name: noise for name, (noise, stated) in kinds(hinge).items() if not stated}
    for name, noise in noises.items():
        rng = np.random.default_rng(77)
        error: dict[str, list[tuple[float, float]]] = {how: [] for how in PREPARED}
        radius: dict[str, list[tuple[float, float]]] = {how: [] for how in PREPARED}
        for _ in range(trials):
            off, lost = noise(hinge, rng), np.zeros(hinge.frames, dtype=np.bool_)
            for first in range(20, hinge.frames - 20, 40):
                lost[first : first + int(rng.integers(4, 16))] = True
            for how, chosen in PREPARED.items():
                seen = recording_of(hinge, off, lost if "gaps" in how else None)
                settings = Settings(
                    proximal_markers=("A*",),
                    distal_markers=("F*",),
                    joint_type="hinge",
                    express_in="proximal",
                    **chosen,
                )
                measured = whole = measure(seen, settings)
                if how == "markers' errors alone":
                    settings = Settings(joint_type="hinge", express_in="proximal")
                    measured = measure(errors_alone(whole), settings)
                found = measured_joint_axis(measured, measured_mean_axis(measured), settings).axis.hinge
                assert found is not None
                assert whole.proximal is not None
                assert whole.proximal.marker_offsets is not None
                # A body that is made of markers has axes of its own.
                shape = pose_from_points(whole.proximal.marker_offsets, hinge.shapes[0])
                direction = quaternion.rotate(shape[:4], found.line.direction_proximal)
                pose = line_pose(direction, dq.transform_points(shape, found.line.point_proximal))
                error[how].append(line_errors(pose, LINE))
                radius[how].append((found.axis_cone, found.point_radius))
        for how in PREPARED:
            told = Held(np.array(error[how]), np.array(radius[how]))
            held, sharp = told.held, told.sharpness
            print(f"| {name} | {how} | {held[0]:.3f} | {held[1]:.3f} | {sharp[0]:.2f}, {sharp[1]:.2f} |", flush=True)


def errors_alone(measured: Measurement) -> Recording:
    """The two bodies as an export without markers has them: poses, and a column of mean errors."""
    bodies = []
    for name, body in (("Upper Arm", measured.proximal), ("Forearm", measured.distal)):
        assert body is not None
        assert body.marker_residual is not None
        bodies.append(
            RigidBody(
                name=name,
                dual_quat_lab_body=body.dual_quat_lab_body,
                loss=body.loss,
                reported_error=MEAN_TO_RMS * body.marker_residual,
            )
        )
    return Recording.from_bodies(bodies, rate_hz=measured.recording.rate_hz)


def kinds(hinge: Hinge) -> dict[str, tuple[Noise, tuple[SkinMotion, ...]]]:
    """Kinds of noise, and the skin motion that is stated with them; smaller where the range is."""
    share = 0.2 if hinge.top_deg < 40.0 else 1.0
    stated = [SkinMotion(segment="distal", shift=SHIFT, turn=TURN)]
    if not hinge.still:
        stated.append(SkinMotion(segment="proximal", shift=0.5 * SHIFT, turn=0.5 * TURN))
    return {
        "white 0.2 mm": (white(), ()),
        f"wander {2 * share:g} mm": (wander(2e-3 * share), ()),
        f"skin, own ways, {5 * share:g} mm": (skin(5e-3 * share), ()),
        f"skin, smooth, {5 * share:g} mm": (smooth_skin(5e-3 * share), ()),
        f"clusters turn {2 * share:g} deg": (turning(TURN * share), ()),
        "flexion turns 2 deg, 2 mm, stated": (turning_with_flexion(TURN, SHIFT), tuple(stated)),
    }


if __name__ == "__main__":
    main()
