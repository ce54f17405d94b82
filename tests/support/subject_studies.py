"""A study of subjects under two conditions whose every number is known: result folders made from one, and sealed."""

from __future__ import annotations

import csv
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from finished_results import write_rows
from scipy.spatial.transform import Rotation
from sealed import resealed

from elbowscrew.geometry.arrays import Float

EFFECT_DEG, BETWEEN_DEG, WITHIN_DEG = 6.0, 5.0, 2.0
PERCENT = np.arange(101)
SHAPE = np.sin(np.pi * PERCENT / 100.0) ** 2
# A right arm in its humerus' own frame: forward, proximal, lateral; millimeters.
LANDMARKS_MM = {"GH": [0.0, 0.0, 0.0], "EL": [0.0, -300.0, 32.0], "EM": [0.0, -300.0, -32.0]}
MIDDLE_MM = np.array([0.0, -300.0, 0.0])


@dataclass(frozen=True, kw_only=True)
class Made:
    """One trial: what its result says. `direction` and `point_mm` are its axis in the humerus' own frame."""

    folder: str
    subject: str
    condition: str
    top_deg: float
    dispersion_deg: float
    error_deg: float
    cycles_deg: Sequence[float]
    direction: Float
    point_mm: Float
    cluster: int


def made_trials(seed: int = 8) -> list[Made]:
    """Eight subjects, two conditions, three to six trials of one to three cycles; subject S8 has most."""
    rng = np.random.default_rng(seed)
    found = []
    for k in range(8):
        own, way, place = BETWEEN_DEG * rng.standard_normal(), 0.05 * rng.standard_normal(2), rng.standard_normal(2)
        for condition, effect in (("fast", EFFECT_DEG), ("slow", 0.0)):
            for trial in range(6 if k == 7 else int(rng.integers(3, 6))):
                top = 120.0 + own + effect + WITHIN_DEG * rng.standard_normal()
                tilt = way + 0.01 * rng.standard_normal(2)
                direction = np.array([tilt[0], tilt[1], 1.0])
                found.append(
                    Made(
                        folder=f"S{k + 1}_{condition}_{trial}",
                        subject=f"S{k + 1}",
                        condition=condition,
                        top_deg=top,
                        dispersion_deg=float(np.exp(0.3 * rng.standard_normal())),
                        error_deg=float(0.5 * np.exp(0.2 * rng.standard_normal())),
                        cycles_deg=(top + 0.5 * rng.standard_normal(1 + trial % 3)).tolist(),
                        direction=direction / np.linalg.norm(direction),
                        point_mm=MIDDLE_MM + np.append(2.0 * place + 0.3 * rng.standard_normal(2), 4.0),
                        cluster=100 * k + (condition == "slow"),
                    )
                )
    return found


def write_made(template: Path, folder: Path, trials: Sequence[Made], *, landmarks: bool = True) -> None:
    """Write a result folder for each trial, with a template's other numbers, and ``summary.csv`` over them."""
    summary, joint = (
        json.loads((template / name).read_text(encoding="utf-8")) for name in ("summary.json", "joint.json")
    )
    with (template / "repetitions.csv").open(encoding="utf-8", newline="") as stream:
        header, row, *_ = csv.reader(stream)
    for one in trials:
        place = folder / one.folder
        place.mkdir(parents=True)
        (place / "screw.csv").write_bytes((template / "screw.csv").read_bytes())
        summary["motion"] |= {"theta_max_deg": one.top_deg, "axis_dispersion_deg": one.dispersion_deg}
        summary["motion"]["repetitions"] = len(one.cycles_deg)
        summary["interpolation"]["rms_angle_error_deg"] = one.error_deg
        (place / "summary.json").write_text(json.dumps(summary | ({} if landmarks else {"landmarks": None})))
        (place / "joint.json").write_text(json.dumps(_joint(joint, one) | ({} if landmarks else {"anatomy": None})))
        number = header.index("number")
        repeated = [[*row[:number], str(k + 1), *row[number + 1 :]] for k in range(len(one.cycles_deg))]
        write_rows(place / "repetitions.csv", [header, *repeated])
        cycles = pd.DataFrame(
            {
                "cycle": np.repeat(np.arange(1, len(one.cycles_deg) + 1), 101),
                "percent": np.tile(PERCENT.astype(np.float64), len(one.cycles_deg)),
                "theta_deg": np.concatenate([height * SHAPE for height in one.cycles_deg]),
            }
        )
        cycles.to_csv(place / "cycles.csv", index=False, lineterminator="\n")
        (place / "repetitions.csv").write_text((place / "repetitions.csv").read_text().replace("\r\n", "\n"))
        resealed(place)
    rows = [[one.folder, f"in/{one.folder}.csv", one.subject, one.condition, "60", str(one.top_deg)] for one in trials]
    write_rows(folder / "summary.csv", [["trial", "path", "subject", "condition", "frames", "theta_max_deg"], *rows])


def _joint(joint: dict[str, Any], one: Made) -> dict[str, Any]:
    """Say where the axis is as a cluster sees it that lies on the arm anyhow."""
    turn, shift = Rotation.random(rng=one.cluster), 50.0 * np.random.default_rng(one.cluster).standard_normal(3)
    landmarks = {name: (turn.apply(at) + shift).tolist() for name, at in LANDMARKS_MM.items()}
    line = {
        "direction_in_proximal": turn.apply(one.direction).tolist(),
        "point_in_proximal_mm": (turn.apply(one.point_mm) + shift).tolist(),
    }
    anatomy = joint["anatomy"] | {"landmarks_mm": joint["anatomy"]["landmarks_mm"] | landmarks, "side": "right"}
    fit = joint[joint["preferred"]] | line
    return joint | {joint["preferred"]: fit, "mean_axis": None, "two_axes": None, "anatomy": anatomy}
