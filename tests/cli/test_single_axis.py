"""A motion of which a single frame turns far enough for an axis: nothing is said of a spread that it has not."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
from plain_pages import plain

from elbowscrew import Settings, analyze
from elbowscrew.cli import main


def test_one_axis_has_no_dispersion(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source = tmp_path / "one.csv"
    assert main(["simulate", str(source), "--top", "30", "--seed", "3", "-q"]) == 0
    angle = np.sort(np.degrees(analyze(source, Settings(min_angle_deg=20.0)).screw.angle))
    limit = float(angle[-2:].mean())
    target = tmp_path / "result"
    options = ["--min-angle", f"{limit:.6f}", "--figures", "all", "-o", str(target)]
    assert main(["analyze", str(source), *options]) == 0
    summary, joint = (json.loads((target / name).read_text()) for name in ("summary.json", "joint.json"))
    assert summary["motion"]["axis_frames"] == 1
    told = {key: value for key, value in summary["motion"].items() if key.startswith("axis_d")}
    assert len(told) == 6
    assert set(told.values()) | set(joint["dispersion"].values()) == {None}
    assert "Dispersion   none: one frame alone has an axis" in capsys.readouterr().out
    page = " ".join(re.sub(r"<[^>]*>", " ", plain((target / "report.html").read_text())).split())
    assert "Dispersion of the axes – one frame alone has an axis" in page
    assert "Dispersion of the frames" not in page
