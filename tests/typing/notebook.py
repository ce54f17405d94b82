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


def interface() -> None:
    analysis = elbowscrew.analyze("trial.csv", express_in="thigh", lowpass_hz="auto", keyframes=[0, 9], law="best")
    table = analysis.to_frame("joint", "rad", "m")
    widest: float = table["axis_cone95_rad"].max()
    told: str = analysis.summary["motion"]["joint_type"]["type"]
    ax = analysis.plot.theta(color="red")
    ax.set_title(told)
    first, *_ = analysis.plot.error()
    first.set_ylabel(f"{widest}")
    again = elbowscrew.read_result("result")
    again.to_xarray().to_netcdf("trial.nc")
    study = elbowscrew.batch(["a.csv"], "results", workers=1, figure_format=["none"])
    angles: list[float] = [study[name].summary["motion"]["theta_max_deg"] for name in study]
    compared = elbowscrew.compare("trial.csv", joint="knee", plan=elbowscrew.ComparisonPlan(counts=(2,)))
    trial = elbowscrew.simulate_trial(joint="hip", joint_type="ball", seed=1)
    motion = elbowscrew.interpolate(analysis, frames=20)
    shown = elbowscrew.plots.plot_theta(ax, again)
    print(angles, compared.models.law, trial.truth, motion.angle, shown, elbowscrew.samples.path("knee").name)  # noqa: T201


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
