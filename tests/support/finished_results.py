"""Recordings whose results are hard to show: names that mean harm, a motion without an axis."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np

from elbowscrew import Recording, RigidBody, simulate_trial
from elbowscrew.geometry.quaternion import quat_from_rotation_vector
from elbowscrew.model import Source

HOSTILE = "</script><script>alert('x')</script><img src=x onerror=alert(1)>\"'&\u2028{{ 7 * 7 }}"


def hostile_recording() -> Recording:
    """Names that would be markup, script or template if anything took them for it."""
    recording = simulate_trial(frames=120, inversion=60, proximal="moving", gaps=1, seed=2).recording
    proximal, distal = recording.bodies
    source = Source(
        path=f"in/{HOSTILE.replace('/', '|')}.csv",
        sha256="0" * 64,
        layout=HOSTILE,
        take_name=HOSTILE,
        length_unit="m",
        rotation_type="quaternion",
    )
    bodies = (replace(proximal, name=f"arm {HOSTILE}"), replace(distal, name=f"forearm {HOSTILE}"))
    return replace(recording, bodies=bodies, source=source)


def ball() -> Recording:
    """Two rotations across each other: a motion without a single axis, of bodies without markers."""
    turn = np.linspace(0.0, 2.0 * np.pi, 150)
    vector = np.stack([np.sin(turn), np.sin(2.0 * turn), 0.3 * np.cos(turn)], axis=1)
    place = np.stack([0.1 * np.cos(turn), 0.2 + 0.1 * np.sin(turn), 0.0 * turn], axis=1)
    body = RigidBody.from_quaternions("Forearm", quat_from_rotation_vector(vector), place)
    return Recording.from_bodies([body], rate_hz=100.0)


def flexion_only() -> Recording:
    """A movement that does not turn back."""
    recording = simulate_trial(frames=160, inversion=80, seed=6).recording
    rows = slice(0, 80)
    bodies = tuple(
        replace(
            body,
            dual_quat_lab_body=body.dual_quat_lab_body[rows],
            loss=body.loss[rows],
            reported_error=None,
            marker_residual=None,
            shape_deviation=None,
        )
        for body in recording.bodies
    )
    return replace(recording, bodies=bodies, frame=recording.frame[rows], time_s=recording.time_s[rows], markers=())


def write_rows(path: Path, rows: list[list[str]]) -> None:
    with path.open("w", encoding="utf-8", newline="") as stream:
        csv.writer(stream).writerows(rows)
