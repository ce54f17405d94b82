"""Readers of other distributions, by their entry points: the one of the documentation, and ones that fail."""

from __future__ import annotations

import hashlib
import html
import importlib
import json
import re
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from plain_pages import plain

import elbowscrew
from elbowscrew import plug_ins
from elbowscrew.cli import main
from elbowscrew.errors import OutputError, RecordingError, SettingError, UsageError
from elbowscrew.geometry.dual_quaternion import pose_from_dual_quat
from elbowscrew.reading import plugged
from elbowscrew.reading.registry import recordings_in
from elbowscrew.results.summary import are_installed, library_versions, summary_from_analysis
from elbowscrew.study.resume import standing_of
from elbowscrew.study.task import TrialTask, analyze_trial, versions_here
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
    for name in ("mylab_elbowscrew", "mylab_laws", "mylab_export"):
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
    versions = summary_from_analysis(found)["versions"]
    assert versions == {**library_versions(), "mylab_elbowscrew": "1.0"}
    # A batch keeps what was made with the plug-in that is installed, and only that.
    assert are_installed(versions)
    assert not are_installed({**versions, "mylab_elbowscrew": "1.1"})
    assert not are_installed({**versions, "another": "1.0"})
    assert not are_installed({"mylab_elbowscrew": "1.0"})


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
    assert json.loads((folder / "summary.json").read_text())["versions"]["mylab_laws"] == "1.0"
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


@pytest.fixture
def exporter(root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The exporter of the documentation."""
    module = install(root, tmp_path / "site", 2)
    monkeypatch.syspath_prepend(str(tmp_path / "site"))
    look_anew()
    yield module
    look_anew()


def short_trial() -> elbowscrew.Analysis:
    return elbowscrew.analyze(
        elbowscrew.simulate_trial(frames=80, inversion=40, seed=1).recording, export=["mylab-angle", "sto"]
    )


def test_the_exporter_of_the_documentation_writes_into_the_result(exporter: Path, tmp_path: Path) -> None:
    analysis = short_trial()
    folder = elbowscrew.save_analysis(analysis, tmp_path / "result", figure_formats=(), report=False)
    assert json.loads((folder / "summary.json").read_text())["versions"]["mylab_export"] == "1.0"
    placed = folder / "exports" / "mylab-angle"
    assert sorted(path.name for path in placed.iterdir()) == ["angle.txt", "joint.txt"]
    angle = np.loadtxt(placed / "angle.txt", skiprows=1)[:, 1]
    np.testing.assert_allclose(angle, np.degrees(analysis.screw.angle), rtol=1e-9)
    lines = (folder / "SHA256SUMS").read_text().splitlines()
    assert hashlib.sha256((placed / "angle.txt").read_bytes()).hexdigest() in {line.split()[0] for line in lines}
    assert {"exports/mylab-angle/angle.txt", "joint_angle.sto"} < {line.split()[1] for line in lines}
    elbowscrew.save_analysis(analysis, folder, overwrite=True, figure_formats=(), report=False, exports=())
    assert not (folder / "exports").exists()


def test_a_result_is_read_where_its_plug_ins_are_not_installed(
    exporter: Path, root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install(root, tmp_path / "site", 1)
    look_anew()
    recording = elbowscrew.simulate_trial(frames=80, inversion=40, seed=1).recording
    folder = elbowscrew.save_analysis(
        elbowscrew.analyze(recording, law="my-law", export=["mylab-angle"]), tmp_path / "result", figure_formats=()
    )
    monkeypatch.setattr(sys, "path", [one for one in sys.path if one != str(tmp_path / "site")])
    look_anew()
    again = elbowscrew.read_result(folder)
    assert again.settings.export == ("mylab-angle",)
    assert again.settings.law == "my-law"
    assert again.plot.theta().lines
    with pytest.raises(UsageError, match="export: expected parquet, mat, sto, found 'mylab-angle'"):
        elbowscrew.Settings(export=("mylab-angle",))


def test_an_exporter_takes_an_analysis_and_one_read_back(exporter: Path, tmp_path: Path) -> None:
    write = importlib.import_module("mylab_export").write
    analysis = short_trial()
    again = elbowscrew.read_result(elbowscrew.save_analysis(analysis, tmp_path / "r", figure_formats=(), exports=()))
    written: list[str] = []
    for trial in (analysis, again):
        (place := tmp_path / f"out{len(written)}").mkdir()
        write(trial, place)
        written.append((place / "joint.txt").read_text())
    assert written[0] == written[1]


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("    1 / 0", "ZeroDivisionError division by zero"),
        ("    (folder / 'deep').mkdir()", "it left 'deep': expected files alone"),
        ("    (folder / 'a b').touch()", "it left 'a b': expected files alone"),
        ("    [one.unlink() for one in folder.iterdir()]", "it wrote no file"),
        ("    raise SystemExit('enough')", "SystemExit enough"),
        ("    import shutil; shutil.rmtree(folder)", "it wrote outside its folder, or removed it"),
        ("    import shutil; shutil.rmtree(folder); folder.symlink_to('.')", "it wrote outside its folder"),
        ("    (folder.parent / 'beside.txt').touch()", "it wrote outside its folder"),
        ("    (folder.parent.parent / 'screw.csv').write_text('frame')", "it wrote outside its folder"),
        ("    (folder / 'con.txt').touch()", "'con.txt', which is no name of a file on Windows"),
        ("    (folder / 'Angle.txt').touch()", "twice but for the case of letters"),
        ("    raise type('E', (Exception,), {'__str__': lambda _: 1 / 0})", "was not written: E"),
    ],
)
def test_an_exporter_that_fails_does_not_cost_the_result(
    exporter: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], line: str, told: str
) -> None:
    exporter.write_text(f"{exporter.read_text()}\n{line}\n")
    look_anew()
    target = tmp_path / "result"
    with pytest.raises(OutputError, match="the result is there, but the export 'mylab-angle'") as caught:
        elbowscrew.save_analysis(short_trial(), target, figure_formats=())
    assert told in str(caught.value)
    assert "\n" not in str(caught.value)
    assert not (target / "exports").exists()
    again = elbowscrew.read_result(target)
    assert [one["code"] for one in again.summary["warnings"]].count("export-failed") == 1
    assert told in html.unescape(plain((target / "report.html").read_text(encoding="utf-8")))


def test_an_exporter_may_go_to_another_folder(exporter: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    exporter.write_text(f"{exporter.read_text()}\n    import os; os.chdir(folder)\n")
    look_anew()
    monkeypatch.chdir(tmp_path)
    elbowscrew.save_analysis(short_trial(), "result", figure_formats=(), report=False)
    assert Path.cwd() == tmp_path
    assert (tmp_path / "result" / "exports" / "mylab-angle" / "angle.txt").exists()


def test_two_plug_ins_of_one_name_are_told_not_chosen_from(exporter: Path, root: Path, tmp_path: Path) -> None:
    other = tmp_path / "site" / "other-1.0.dist-info"
    other.mkdir()
    (other / "METADATA").write_text("Metadata-Version: 2.1\nName: other\nVersion: 1.0\n")
    (other / "entry_points.txt").write_text("[elbowscrew.exporters]\nmylab-angle = other:write\nnul = other:write\n")
    look_anew()
    with pytest.raises(UsageError, match=r"'mylab_export' .* and .*'other' .* have one name; uninstall all but one"):
        elbowscrew.save_analysis(short_trial(), tmp_path / "result", figure_formats=())
    with pytest.raises(UsageError, match=r"its name is that of a folder: .*no device of Windows"):
        elbowscrew.save_analysis(short_trial(), tmp_path / "result", figure_formats=(), exports=["nul"])
    assert not (tmp_path / "result").exists()


def test_a_reader_that_exits_or_gives_no_answer_is_told(installed: Path) -> None:
    module = installed.parent.parent / "site" / "mylab_elbowscrew.py"
    good = module.read_text()
    for wrong in ("raise SystemExit(3)", "return np.zeros(3)"):
        module.write_text(good.replace("    table = ", f"    {wrong}\n    table = ", 1))
        look_anew()
        with pytest.raises(RecordingError, match='the reader "My lab\'s poses"'):
            elbowscrew.read_recording(installed)
    module.write_text(good.replace('head.startswith(b"MYLAB")', "np.zeros(3)"))
    look_anew()
    with pytest.raises(RecordingError, match="a plug-in, failed: ValueError"):
        elbowscrew.read_recording(installed)


def test_an_exporter_cannot_change_the_numbers(exporter: Path, tmp_path: Path) -> None:
    analysis = short_trial()
    known = elbowscrew.save_analysis(analysis, tmp_path / "known", figure_formats=("svg",), exports=("sto",))
    lines = "trial.summary['warnings'].clear(); frame = trial.to_frame(); frame.loc[:, ['time_s', 'theta_deg']] = 0.0"
    exporter.write_text(exporter.read_text().replace("    angle =", f"    {lines}\n    angle ="))
    look_anew()
    changed = elbowscrew.save_analysis(analysis, tmp_path / "changed", figure_formats=("svg",))
    for name in ("screw.csv", "summary.json", "joint.json", "figures/theta.svg"):
        assert (known / name).read_bytes() == (changed / name).read_bytes()


def test_what_no_exporter_has_written_is_not_removed(exporter: Path, tmp_path: Path) -> None:
    analysis = short_trial()
    folder = elbowscrew.save_analysis(analysis, tmp_path / "result", figure_formats=(), report=False)
    note = folder / "exports" / "mylab-angle" / "note.txt"
    note.write_text("mine")
    with pytest.raises(OutputError, match=r"'exports/mylab-angle/note.txt', which is not ours"):
        elbowscrew.save_analysis(analysis, folder, overwrite=True, figure_formats=())
    assert note.read_text() == "mine"


def test_a_batch_makes_a_trial_again_whose_export_is_missing(exporter: Path, tmp_path: Path) -> None:
    trial = elbowscrew.simulate_trial(frames=80, inversion=40, seed=1)
    source, _ = elbowscrew.save_simulation(trial, tmp_path / "trial.csv")
    settings = elbowscrew.Settings(export=("mylab-angle",), figure_format=("none",))
    task = TrialTask(
        path=source, label="trial", folder=tmp_path / "study" / "trial", settings=settings, landmarks=None,
        versions=versions_here(),
    )  # fmt: skip
    (tmp_path / "study").mkdir()
    good = exporter.read_text()
    exporter.write_text(f"{good}\n    1 / 0\n")
    look_anew()
    assert analyze_trial(task) is None
    assert not standing_of(task).current
    exporter.write_text(good)
    look_anew()
    assert analyze_trial(task) is None
    assert standing_of(task).current
    (task.folder / "exports" / "mylab-angle" / "angle.txt").write_text("edited")
    assert standing_of(task).changed == ("exports/mylab-angle/angle.txt",)


def test_an_exporter_that_cannot_be_loaded_is_told_before_the_work(
    exporter: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    exporter.write_text("write = 3")
    look_anew()
    monkeypatch.chdir(tmp_path)
    elbowscrew.save_simulation(elbowscrew.simulate_trial(frames=80, inversion=40, seed=1), "trial.csv")
    assert main(["analyze", "trial.csv", "--export", "mylab-angle"]) == UsageError.exit_code
    assert "'mylab-angle' of the distribution 'mylab_export'" in capsys.readouterr().err
    assert main(["analyze", "trial.csv", "--export", "mylab-angel"]) == UsageError.exit_code
    assert "did you mean 'mylab-angle'?" in capsys.readouterr().err
    exporter.write_text("def write(trial, folder): 1 / 0")
    look_anew()
    assert main(["analyze", "trial.csv", "--export", "mylab-angle", "--figure-format", "none"]) == OutputError.exit_code
    assert "the result is there, but the export 'mylab-angle'" in capsys.readouterr().err
