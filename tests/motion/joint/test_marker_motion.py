"""Markers that move among themselves, from a recording to the joint's interval."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from cluster_noise import Hinge, Noise, fitted, interval_of, recording_of, seen, skin, white, with_rms_alone
from oracles import rodrigues

from elbowscrew import Recording, Settings, analyze
from elbowscrew.model import FittedJoint, Marker

CHOICE = Settings(proximal_markers=("A*",), distal_markers=("F*",), joint_type="hinge", express_in="proximal")


def hinge_of(recording: Recording, settings: Settings = CHOICE) -> FittedJoint:
    found = analyze(recording, settings).joint_axis.hinge
    assert found is not None
    return found


@pytest.mark.parametrize(("noise", "gain"), [(white(), 1.0), (skin(3e-3), 1.1)])
def test_an_analysis_knows_of_the_markers_what_there_is_to_know(noise: Noise, gain: float) -> None:
    """The interval that the coverage is measured of, in place of that of the RMS alone."""
    hinge = Hinge(top_deg=60.0, cycles=4)
    off = noise(hinge, np.random.default_rng(6))
    found = hinge_of(recording_of(hinge, off))
    case = seen(hinge, off)
    case = case._replace(clusters=tuple(replace(cluster, own_shape=True) for cluster in case.clusters))
    rows = np.eye(9)[:2]
    wanted = interval_of(case, fitted(case)[1]).radius(rows)
    assert found.axis_cone == pytest.approx(wanted, rel=0.05)
    alone = with_rms_alone(case)
    assert interval_of(alone, fitted(alone)[1]).radius(rows) > gain * 0.95 * wanted


@pytest.mark.parametrize("moving", [0, 1])
def test_each_body_is_judged_by_its_own_markers(moving: int) -> None:
    """Skin of one cluster alone: the proximal body's, or the distal one's."""
    hinge = Hinge(top_deg=60.0, cycles=2)
    rng = np.random.default_rng(7)
    off = [white()(hinge, rng), skin(4e-3)(hinge, rng)]
    pair = (off[moving == 0][0], off[moving == 1][1])
    found = hinge_of(recording_of(hinge, pair))
    case = seen(hinge, pair)
    case = case._replace(clusters=tuple(replace(cluster, own_shape=True) for cluster in case.clusters))
    wanted = interval_of(case, fitted(case)[1])
    assert found.decided_by == "A"
    assert found.axis_cone == pytest.approx(wanted.radius(np.eye(9)[:2]), rel=0.05)
    first, second = case.clusters
    exchanged = (replace(first, nonrigid=second.nonrigid), replace(second, nonrigid=first.nonrigid))
    wrong = interval_of(case._replace(clusters=exchanged), fitted(case)[1])
    assert abs(wrong.radius(np.eye(9)[:2]) / found.axis_cone - 1.0) > 0.1  # it matters whose markers move


@pytest.mark.parametrize("frames", [8, 12, 16])
def test_markers_at_rest_to_the_last_digit_have_no_spectrum(frames: int) -> None:
    shape = np.array([[0.0, 0.0, 0.001], [0.09, 0.0, 0.0], [0.0, 0.06, 0.0]])
    angle = np.linspace(0.0, 1.2, frames)
    turning = rodrigues(np.array([0.0, 0.0, 1.0]), angle) @ shape.T + np.array([[0.3], [0.01], [0.005]])
    still = [Marker(name=f"A{k}", position=np.tile(place, (frames, 1))) for k, place in enumerate(shape)]
    moved = [Marker(name=f"F{k}", position=turning[:, :, k].round(9)) for k in range(3)]
    frame = np.arange(frames)
    recording = Recording(bodies=(), frame=frame, time_s=frame / 100.0, rate_hz=100.0, markers=(*still, *moved))
    assert analyze(recording, CHOICE).screw.angle == pytest.approx(angle, abs=1e-7)
