"""Each cell of a batch's table is the number of that name in the trial's `summary.json`, in the units asked for."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from motive_files import write_columns

from elbowscrew.cli import main

BONES = ("motion", "anatomy")
# Names that say where they come from otherwise than by their key.
NAMED: dict[str, tuple[str | int, ...]] = {
    "proximal_body": ("trial", "proximal", "name"),
    "distal_body": ("trial", "distal", "name"),
    "joint_name": ("trial", "joint", "name"),
    "joint_side": ("trial", "joint", "side"),
    "proximal_tracked_share": ("trial", "proximal", "tracked_share"),
    "distal_tracked_share": ("trial", "distal", "tracked_share"),
    "dominant_axis_ratio": ("motion", "dominant_axis", "ratio"),
    "joint_model": ("motion", "joint_axis", "model"),
    "joint_axis_cone95": ("motion", "joint_axis", "axis_cone95_deg"),
    "joint_point_radius95": ("motion", "joint_axis", "point_radius95_mm"),
    "joint_pitch": ("motion", "joint_axis", "pitch_mm_per_rad"),
    "radius_of_gyration": ("interpolation", "points", "radius_of_gyration_mm"),
    "radius_from": ("interpolation", "points", "from"),
    "source_sha256": ("source", "sha256"),
    "joint_type": ("motion", "joint_type", "type"),
    "joint_type_status": ("motion", "joint_type", "status"),
    "axes_angle": ("motion", "joint_numbers", "two_axes", "angle_between_deg"),
    "axes_distance": ("motion", "joint_numbers", "two_axes", "distance_mm"),
    **{
        f"axis{k}_{name}": ("motion", "joint_numbers", "two_axes", f"axis{k}", f"{name}_deg")
        for k in (1, 2)
        for name in ("range", "cone95")
    },
    **{f"axis{k}_determined": ("motion", "joint_numbers", "two_axes", f"axis{k}", "determined") for k in (1, 2)},
    **{f"axis{k}_radius95": ("motion", "joint_numbers", "two_axes", f"axis{k}", "radius95_mm") for k in (1, 2)},
    **{
        f"axis{k}{column}_{x}": ("motion", "joint_numbers", "two_axes", f"axis{k}", key.format(body), n)
        for k, body in ((1, "proximal"), (2, "distal"))
        for column, key in (("", "direction_in_{}"), ("_point", "point_in_{}_mm"))
        for n, x in enumerate("xyz")
    },
    **{
        f"{column}_{x}": ("motion", "joint_numbers", "ball", f"center_in_{body}_mm", n)
        for column, body in (("center", "proximal"), ("center_in_distal", "distal"))
        for n, x in enumerate("xyz")
    },
    "center_radius95": ("motion", "joint_numbers", "ball", "radius95_mm"),
    "axis_wander": ("motion", "joint_numbers", "wander", "size_deg"),
    "landmarks_side": (*BONES, "side"),
    **{
        f"{angle}_{kind}": (*BONES, angle, f"{kind}_deg")
        for angle in ("flexion", "carrying_angle", "pronation", "adduction", "internal_rotation")
        for kind in ("start", "min", "max", "range")
    },
    "epicondyle_axis": (*BONES, "axis"),
    **{f"epicondyle_angle{end}": (*BONES, f"axis_angle_deg{end}") for end in ("", "_low", "_high")},
    **{f"epicondyle_distance{end}": (*BONES, f"axis_distance_mm{end}") for end in ("", "_low", "_high")},
    **{f"joint_center_{x}": (*BONES, "joint_center_in_proximal_mm", k) for k, x in enumerate("xyz")},
    "elbowscrew": ("elbowscrew",),
    **{f"axis_{x}": ("motion", "mean_axis", "direction", k) for k, x in enumerate("xyz")},
    **{f"point_{x}": ("motion", "mean_axis", "point_mm", k) for k, x in enumerate("xyz")},
    **{f"joint_axis_{x}": ("motion", "joint_axis", "direction", k) for k, x in enumerate("xyz")},
    **{f"joint_point_{x}": ("motion", "joint_axis", "point_mm", k) for k, x in enumerate("xyz")},
}
UNIT = re.compile(r"_(deg|rad|mm|m)(_per_rad)?$")


def found(summary: Any, name: str) -> Any:
    """The value of a name: at its place, or under the only key of that name and a unit."""
    if name in ("warnings", "notes"):
        return ";".join(one["code"] for one in summary["warnings"] if f"{one['severity']}s" == name)
    if name in NAMED:
        for key in NAMED[name]:
            summary = None if summary is None else summary[key]
        return summary
    (value,) = (
        summary[part][key]
        for part in ("trial", "motion", "interpolation")
        for key in (name, f"{name}_deg", f"{name}_mm")
        if key in summary[part]
    )
    return ";".join(map(str, value)) if isinstance(value, list) else value


@pytest.mark.parametrize(("angle", "length"), [("deg", "mm"), ("rad", "m")])
def test_cells_are_those_of_the_results(
    angle: str, length: str, root: Path, tmp_path: Path, two_rotations: list[Any], capsys: pytest.CaptureFixture[str]
) -> None:
    data, out = tmp_path / "data", tmp_path / "out"
    data.mkdir()
    for name in ("elbow_left.csv", "knee.csv"):
        shutil.copy(root / "sample_data" / name, data / name)
    write_columns(data / "ball.csv", two_rotations)
    (data / "trials.csv").write_text(
        "path,distal,proximal,landmarks\nelbow_left.csv,,,arm.toml\nknee.csv,,,leg.toml\nball.csv,Thigh,none,\n"
    )
    shutil.copy(root / "sample_data" / "elbow_left.landmarks.toml", data / "arm.toml")
    shutil.copy(root / "sample_data" / "knee.landmarks.toml", data / "leg.toml")
    units = ["--angle-unit", angle, "--length-unit", length]
    asked = ["batch", str(data / "trials.csv"), "-o", str(out), "-q", "--figure-format", "none"]
    assert main([*asked, *units]) == 0, capsys.readouterr().err
    table = pd.read_csv(out / "summary.csv", keep_default_na=False)
    assert len(table) == 3
    scales = {"deg": 1.0, "rad": np.pi / 180.0, "mm": 1.0, "m": 1e-3}
    for _, row in table.iterrows():
        summary = json.loads((out / row["trial"] / "summary.json").read_text(encoding="utf-8"))
        assert row["path"].endswith(summary["source"]["name"])
        for column in table.columns.drop(["trial", "path", "distal", "proximal", "landmarks"]):
            match = UNIT.search(column)
            value = found(summary, column[: match.start()] if match else column)
            cell = row[column]
            if value is None:
                assert cell == "", column
            elif isinstance(value, bool):
                assert str(cell) == str(int(value)), column
            elif isinstance(value, str):
                assert str(cell) == value, column
            else:
                assert float(cell) == pytest.approx(value * scales[match[1]] if match else value, rel=1e-12), column
                assert match is None or match[1] in (angle, length), column
    assert {"", "screw_hinge"} <= set(table["joint_model"])
    assert {0, 1} == set(table["signed"])
    assert list(table["landmarks_side"]) == ["", "left", "right"]
    sides = set(zip(table["joint_name"], table["joint_side"], strict=True))
    assert sides == {("joint", ""), ("elbow", "left"), ("knee", "")}
