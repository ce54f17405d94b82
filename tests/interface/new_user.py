# %% [markdown]
# A new user's first notebook: every cell is what one would guess. `test_notebook.py` runs them.

# %%
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import elbowscrew
from elbowscrew import samples

# %%
elbowscrew.__version__

# %%
dir(elbowscrew)

# %%
samples.SAMPLES

# %%
trial = samples.path("elbow_natural")
trial

# %%
analysis = elbowscrew.analyze(trial)
analysis

# %%
print(analysis)

# %%
elbowscrew.analyze(str(trial), elbowscrew.Settings(min_angle_deg=5)).settings.min_angle_deg

# %%
recording = elbowscrew.read_recording(trial)
recording

# %%
recording.bodies

# %%
recording.rate_hz, recording.frame.size

# %%
same = elbowscrew.analyze(recording, express_in="proximal", lowpass_hz=8, keyframes=[0, 140, 299])
same.keyframes.frame

# %%
analysis.to_frame()

# %%
analysis.to_frame()[["time_s", "theta_deg"]].describe()

# %%
analysis.screw

# %%
analysis.screw.to_frame(angle_unit="rad", length_unit="m")

# %%
np.degrees(np.nanmax(analysis.screw.angle))

# %%
analysis.to_frame("keyframes")

# %%
analysis.to_frame("repetitions")

# %%
analysis.to_frame("joint")

# %%
analysis.to_frame("joint_angles")

# %%
analysis.to_frame("warnings")

# %%
[warning.message for warning in analysis.warnings]

# %%
analysis.tables.keys()

# %%
analysis.joint_summary["joint_type"]["type"]

# %%
analysis.summary["motion"]["theta_max_deg"]

# %%
data = analysis.to_xarray()
data

# %%
data["theta"].attrs["units"]

# %%
data["point"].sel(component="x").mean("frame")

# %%
data["theta"].sel(frame=140).item()

# %%
data.to_netcdf("trial.nc")

# %%
analysis.plot()

# %%
analysis.plot

# %%
analysis.plot.theta()

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3))
analysis.plot.theta(ax=left, color="tab:red", label="natural elbow")
analysis.plot.slide(ax=right)
left.set_title("flexion")

# %%
figure, axes = plt.subplots(2, 2)
analysis.plot.euler_parameters(axes, linewidth=2)

# %%
analysis.plot.joint()

# %%
figure, ax = plt.subplots()
elbowscrew.plots.plot_theta(ax, analysis)

# %%
plt.close("all")

# %%
analysis.view_3d()

# %%
folder = elbowscrew.save_analysis(analysis, "result", figure_formats=[])
sorted(path.name for path in folder.iterdir())

# %%
again = elbowscrew.read_result("result")
again

# %%
np.abs(again.to_frame()["theta_deg"] - analysis.to_frame()["theta_deg"]).max()

# %%
again.plot.theta(color="black")

# %%
try:
    elbowscrew.save_analysis(analysis, "result")
except elbowscrew.ElbowscrewError as error:
    print(error)

# %%
elbowscrew.save_analysis(analysis, "result", overwrite=True, figure_formats=[])

# %%
motion = elbowscrew.interpolate(analysis, frames=100)
motion

# %%
motion.to_frame().tail()

# %%
elbowscrew.interpolate("result/keyframes.csv", frames=50).to_xarray()["theta"].max().item()

# %%
plan = elbowscrew.ComparisonPlan(methods=("dlb", "sclerp"), laws=("cycloidal",), counts=(2, 3), data=("raw",))
compared = elbowscrew.compare(trial, plan=plan)
compared

# %%
compared.to_frame().head()

# %%
knee = elbowscrew.simulate_trial(joint="knee", joint_type="hinge", top_deg=60, seed=3)
elbowscrew.analyze(knee.recording)

# %%
elbowscrew.save_simulation(knee, "knee.csv")

# %%
landmarks = samples.path("elbow_natural.landmarks.toml")
bones = elbowscrew.analyze(trial, landmarks=landmarks)
bones.to_frame("anatomy")[["flexion_deg", "carrying_deg", "pronation_deg"]].max()

# %%
bones.plot.anatomy()

# %%
paths = [samples.path("study") / f"P01_{number}.csv" for number in (1,)] + ["broken.csv"]
Path("broken.csv").write_text("no recording")
study = elbowscrew.batch(paths, "study_results", workers=1, figure_format=["none"])
study

# %%
study.failures

# %%
study.to_frame()[["trial", "theta_max_deg"]]

# %%
{name: study[name].summary["motion"]["theta_max_deg"] for name in study}
