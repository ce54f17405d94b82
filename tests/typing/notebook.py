"""A user's script: every line must be clean under ``mypy --strict`` and pyright, without a plugin."""

from __future__ import annotations

import elbowscrew
from elbowscrew import Settings


def notebook() -> None:
    recording = elbowscrew.read_recording("sample_data/elbow_paper.csv")
    analysis = elbowscrew.analyze(recording, elbowscrew.Settings(express_in="arm"))
    table = analysis.screw.to_frame()
    joint = analysis.joint_axis.best
    elbowscrew.save_analysis(analysis, "result")
    print(table, joint)  # noqa: T201


def settings() -> list[Settings]:
    given = Settings(express_in="arm", lowpass_hz=6)
    cutoff: float | str | None = given.lowpass_hz
    body: str | None = given.arm
    print(cutoff, body)  # noqa: T201
    return [
        given,
        Settings(),
        Settings(express_in="lab", lowpass_hz="auto", law="best", tolerance_mm=None),
        Settings(arm="A", forearm="B", arm_markers=("UA*",), forearm_markers=("FA*",)),
        Settings(joint="knee", express_in="thigh", keyframes=(0, 211, 449), method="dlb"),
        Settings(tolerance_mm=2, figure_format=("png", "pdf"), export=("parquet",)),
    ]
