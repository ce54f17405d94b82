"""Readers of other distributions, by their entry points: the one of the documentation, and ones that fail."""

from __future__ import annotations

import importlib
import re
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import elbowscrew
from elbowscrew import plug_ins
from elbowscrew.errors import RecordingError, SettingError, UsageError
from elbowscrew.geometry.dual_quaternion import pose_from_dual_quat
from elbowscrew.reading import plugged
from elbowscrew.reading.registry import recordings_in
from elbowscrew.study.trials import find_trials


def install(root: Path, site: Path, number: int) -> Path:
    """Make a distribution of an example of the documentation."""
    page = (root / "docs" / "howto" / "plug-ins.md").read_text(encoding="utf-8")
    code = re.findall(r"^```python\n(.*?)^```", page, re.M | re.S)[number]
    toml = re.findall(r"^```toml\n(.*?)^```", page, re.M | re.S)[number]
    group, name, module, thing = re.findall(r'entry-points\."(.*?)"\]\n([\w-]+) = "(\w+):(\w+)"', toml)[0]
    info = site / f"{module}-1.0.dist-info"
    info.mkdir(parents=True)
    (site / f"{module}.py").write_text(code, encoding="utf-8")
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {module}\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(f"[{group}]\n{name} = {module}:{thing}\n")
    return site / f"{module}.py"


def look_anew() -> None:
    importlib.invalidate_caches()
    for name in ("mylab_elbowscrew", "mylab_laws"):
        sys.modules.pop(name, None)
    plug_ins.forget()
    plugged.readers.cache_clear()


@pytest.fixture
def installed(root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The reader of the documentation as a distribution on the path, with a file of its format."""
    install(root, tmp_path / "site", 0)
    monkeypatch.syspath_prepend(str(tmp_path / "site"))
    look_anew()
    trial = elbowscrew.simulate_trial(frames=80, inversion=40, seed=1).recording
    poses = [np.column_stack(pose_from_dual_quat(body.dual_quat_lab_body)) for body in trial.bodies]
    (tmp_path / "data").mkdir()
    file = tmp_path / "data" / "trial.poses"
    np.savetxt(file, np.column_stack(poses), header="MYLAB 1", comments="", fmt="%.17g")
    yield file
    look_anew()


def test_the_plug_in_of_the_documentation_reads_its_format(installed: Path) -> None:
    found = elbowscrew.analyze(installed, rate_hz=100)
    known = elbowscrew.analyze(elbowscrew.simulate_trial(frames=80, inversion=40, seed=1).recording)
    np.testing.assert_allclose(found.screw.angle, known.screw.angle, atol=1e-12)
    source = found.recording.source
    assert source is not None
    assert source.layout == "My lab's poses"
    assert len(source.sha256) == 64


def test_its_files_are_found_in_folders(installed: Path) -> None:
    assert [path.name for path in recordings_in(installed.parent)] == ["trial.poses"]
    assert [trial.label for trial in find_trials([str(installed.parent)]).trials] == ["trial.poses"]


def test_what_means_nothing_for_it_is_refused(installed: Path) -> None:
    with pytest.raises(SettingError, match="units: a file of this format"):
        elbowscrew.read_recording(installed, units="mm")


def test_an_error_of_a_plug_in_is_one_line_with_its_name(installed: Path) -> None:
    installed.write_text("MYLAB 1\n1 2 three\n")
    with pytest.raises(RecordingError, match='the reader "My lab\'s poses", a plug-in, failed: ValueError') as caught:
        elbowscrew.read_recording(installed)
    assert "\n" not in str(caught.value)
    installed.write_text("MYLAB 1\n1 2 3\n1 2 3\n")
    with pytest.raises(RecordingError, match="expected 14 columns"):
        elbowscrew.read_recording(installed)


@pytest.mark.parametrize(
    ("code", "told"),
    [("1 / 0", "cannot be loaded: ZeroDivisionError"), ("READER = 3", "expected a Reader, found int")],
)
def test_a_plug_in_that_is_none_is_told_and_harms_nothing_else(
    installed: Path, samples: Path, code: str, told: str
) -> None:
    (installed.parent.parent / "site" / "mylab_elbowscrew.py").write_text(code)
    look_anew()
    with pytest.raises(UsageError, match=rf"reader 'mylab' of the distribution 'mylab_elbowscrew' .*{told}"):
        elbowscrew.read_recording(installed)
    assert elbowscrew.read_recording(samples / "knee.csv").rate_hz == 100


def test_a_file_that_nobody_reads_is_refused_as_before(installed: Path) -> None:
    installed.write_bytes(b"\x00\x01other")
    with pytest.raises(RecordingError):
        elbowscrew.read_recording(installed)
    with pytest.raises(RecordingError, match="no such file"):
        elbowscrew.read_recording(installed.with_name("nothing.poses"))


@pytest.fixture
def law(root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The law of the documentation, which is the cycloidal one under another name."""
    module = install(root, tmp_path / "site", 1)
    monkeypatch.syspath_prepend(str(tmp_path / "site"))
    look_anew()
    yield module
    look_anew()


@pytest.mark.parametrize("peak", [None, 0.4])
def test_a_law_of_a_plug_in_is_taken_kept_and_rebuilt(law: Path, tmp_path: Path, peak: float | None) -> None:
    recording = elbowscrew.simulate_trial(frames=80, inversion=40, seed=1).recording
    found = elbowscrew.analyze(recording, law="my-law", law_peak=peak)
    known = elbowscrew.analyze(recording, law="cycloidal", law_peak=peak)
    np.testing.assert_allclose(found.interpolated.angle, known.interpolated.angle, atol=1e-12)
    folder = elbowscrew.save_analysis(found, tmp_path / "result", figure_formats=())
    assert elbowscrew.read_result(folder).settings.law == "my-law"
    rebuilt = elbowscrew.interpolate(folder / "keyframes.csv", frames=80)
    np.testing.assert_allclose(rebuilt.angle, found.interpolated.angle, atol=1e-9)


def test_a_law_that_is_none_is_refused(law: Path) -> None:
    recording = elbowscrew.simulate_trial(frames=80, inversion=40, seed=1).recording
    with pytest.raises(UsageError, match="found 'my-lw'; did you mean 'my-law'"):
        elbowscrew.analyze(recording, law="my-lw")
    text = law.read_text()
    law.write_text(text.replace("lambda x: x - np.sin", "lambda x: x**2 + 0 * np.sin"))
    look_anew()
    with pytest.raises(UsageError, match=r"the law 'my-law' of the distribution 'mylab_laws' .*symmetric"):
        elbowscrew.analyze(recording, law="my-law")
    law.write_text(text.replace("lambda x: x - np.sin", "lambda x: x / nothing - np.sin"))
    look_anew()
    with pytest.raises(UsageError, match=r"the law 'my-law' .*NameError"):
        elbowscrew.analyze(recording, law="my-law")


def test_without_plug_ins_a_law_is_asked_back() -> None:
    with pytest.raises(UsageError, match=r"expected cycloidal, .*found 'cyclodial'; did you mean 'cycloidal'"):
        elbowscrew.analyze(elbowscrew.simulate_trial(frames=80, inversion=40).recording, law="cyclodial")
