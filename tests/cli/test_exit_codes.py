"""Bad input: the right exit code and one clear line, through `main` as the command runs it."""

from __future__ import annotations

import errno
import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from motive_files import bodies_of, write_columns, write_row_tagged
from oracles import known_trial
from trials import LANDMARKS

from elbowscrew import opening
from elbowscrew.cli import main

TRIAL = known_trial(120.0, frames=120, inversion=60, seed=1, gentle=True)


@pytest.fixture
def take(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return write_columns(tmp_path / "take.csv", bodies_of(TRIAL))


def run(capsys: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, str, str]:
    code = main([str(argument) for argument in arguments])
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def assert_one_line(error: str) -> None:
    lines = [line for line in error.splitlines() if not line.startswith("elbowscrew: warning: ")]
    assert len(lines) == 1
    assert lines[0].startswith("elbowscrew: error: ")


def test_a_good_trial_ends_with_0_and_a_whole_result(take: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, err = run(capsys, "analyze", take)
    assert (code, re.findall(r"\[(\S+)\]\n", err)) == (0, ["skin-unseen"])  # poses alone, without markers
    assert "Mean axis" in out
    folder = take.parent / "take_elbowscrew"
    names = sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())
    assert names == ["SHA256SUMS", "cycles.csv",
                     "figures/error.caption.txt", "figures/error.png", "figures/euler_parameters.caption.txt",
                     "figures/euler_parameters.png", "figures/joint.caption.txt", "figures/joint.png",
                     "figures/slide.caption.txt", "figures/slide.png", "figures/theta.caption.txt", "figures/theta.png",
                     "instantaneous.csv", "interpolation.csv", "joint.json", "joint_angles.csv", "keyframes.csv",
                     "methods.txt", "repetitions.csv", "report.html", "screw.csv", "summary.json"]  # fmt: skip
    assert sorted(path.name for path in take.parent.iterdir()) == ["take.csv", "take_elbowscrew"]


def test_json_is_the_summary_and_nothing_else(take: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = run(capsys, "analyze", take, "--json", "--figure-format", "none")
    summary = json.loads(out)
    assert code == 0
    assert summary == json.loads((take.parent / "take_elbowscrew" / "summary.json").read_text())
    assert not (take.parent / "take_elbowscrew" / "figures").exists()
    for keys in (("elbowscrew",), ("source", "sha256"), ("settings",), ("trial", "frames"), ("trial", "rate_hz"),
                 ("trial", "bodies"), ("trial", "missing_share"), ("motion", "theta_max_deg"),
                 ("motion", "inversion_frames"), ("motion", "mean_axis"), ("motion", "axis_dispersion_deg"),
                 ("interpolation", "rmse_theta_deg"), ("interpolation", "max_theta_error_deg"),
                 ("interpolation", "rms_displacement_mm"), ("warnings",)):  # fmt: skip
        value = summary
        for key in keys:
            value = value[key]
    assert summary["motion"]["theta_max_deg"] == pytest.approx(120.0, abs=1e-6)


def test_quiet_and_several_figure_formats_do_not_depend_on_when_they_are_made(
    take: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    formats = [word for kind in ("png", "svg", "pdf") for word in ("--figure-format", kind)]
    for name in ("a", "b"):
        assert run(capsys, "analyze", take, "-q", "-o", name, *formats)[:2] == (0, "")
    assert {path.suffix for path in (take.parent / "a" / "figures").iterdir()} == {".png", ".svg", ".pdf", ".txt"}
    for path in (take.parent / "a").rglob("*"):
        if path.is_file():
            assert path.read_bytes() == (take.parent / "b" / path.relative_to(take.parent / "a")).read_bytes(), path


def test_the_file_of_settings_and_the_options(take: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("lab.toml").write_text('express-in = "arm"\nmin-angle = 20\nfigure-format = "none"\n')
    code, out, _ = run(capsys, "analyze", take, "--config", "lab.toml", "--min-angle", "15", "--json")
    settings = json.loads(out)["settings"]
    assert (code, settings["express-in"], settings["min-angle"]) == (0, "proximal", 15.0)


BAD_FILES: dict[str, tuple[bytes | None, int]] = {
    "missing": (None, 3),
    "empty": (b"", 3),
    "binary": (b"\x7fELF\x00\x00", 3),
    "truncated header": (b"Format Version,1.23,Length Units,Meters\n\n,Type,Rigid Body\n", 3),
    "no rigid bodies": (b"Format Version,1.23,Length Units,Meters\n\n,Type\n,Name\n,ID\n,\nFrame,Time\n0,0\n", 3),
}


@pytest.mark.parametrize(("content", "code"), BAD_FILES.values(), ids=BAD_FILES.keys())
@pytest.mark.parametrize("command", ["analyze", "info"])
def test_bad_files(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], command: str, content: bytes | None, code: int
) -> None:
    path = tmp_path / "bad.csv"
    if content is not None:
        path.write_bytes(content)
    found, out, err = run(capsys, command, path, *(["-o", tmp_path / "out"] if command == "analyze" else []))
    assert (found, out) == (code, "")
    assert_one_line(err)
    assert "bad.csv" in err
    assert not (tmp_path / "out").exists()


def test_info_refuses_for_the_reason_that_analyze_gives(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = write_row_tagged(tmp_path / "take.csv", bodies_of(TRIAL))
    path.write_text(path.read_text().replace("righthanded", "lefthanded"))
    told = [run(capsys, command, path) for command in ("analyze", "info")]
    assert told[0] == told[1]
    assert told[0][0] == 3
    assert "left-handed" in told[0][2]


def test_a_folder_is_no_trial(take: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, _, err = run(capsys, "analyze", take.parent)
    assert code == 3
    assert "folder" in err
    assert_one_line(err)


@pytest.mark.parametrize(
    ("arguments", "code", "says"),
    [
        (["--nonsense"], 2, "No such option"),
        (["--method", "magic"], 2, "'magic' is not one of"),
        (["--keyframes", "0,x"], 2, "expected frame numbers"),
        (["--keyframes", "30,10"], 2, "increase"),
        (["--min-angle", "-1"], 2, "min-angle"),
        (["--express-in", "thigh"], 4, "the joint is the elbow"),
        (["--express-in", "thing"], 2, "expected distal, proximal, lab"),
        (["--figure-format", "png,bmp"], 2, "figure-format"),
        (["--min-angle", "nan"], 2, "min-angle"),
        (["--max-gap", "inf"], 2, "max-gap"),
        (["--units", "mm"], 4, "contradicts"),
        (["--config", "none.toml"], 2, "none.toml"),
        (["--inversion", "60", "--keyframes", "0,119"], 2, "inversion"),
        (["--arm", "Leg"], 4, "no such body; the file has 'Upper Arm'"),
        (["--arm", "Forearm", "--forearm", "Forearm"], 4, "both as proximal and as distal"),
        (["--arm", "Upper Arm", "--proximal", "#1"], 2, "--proximal is given twice, as 'Upper Arm' and '#1'"),
        (["--distal", "Forearm", "--distal", "#2"], 2, "--distal is given twice"),
        (["--reference", "120"], 4, "frames 0 to 119"),
        (["--inversion", "-3"], 4, "no such frame"),
        (["--keyframes", "0,30,1000"], 4, "no such frame"),
        (["--rotation", "XYZ"], 4, "the file has quaternions"),
        (["--radius", "1e308"], 2, "radius"),
        (["--min-angle", "150"], 5, "no rotation"),
        (["--output", "take.csv"], 6, "not a folder"),
        (["--output", "/proc/elbowscrew"], 6, "cannot be written"),
    ],
)
def test_bad_settings(
    take: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], code: int, says: str
) -> None:
    found, out, err = run(capsys, "analyze", take, *arguments)
    assert (found, out) == (code, "")
    assert_one_line(err)
    assert says in err
    assert sorted(path.name for path in take.parent.iterdir()) == ["take.csv"]


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        (("analyze", "take.csv", "--config"), "a.toml"),
        (("analyze", "take.csv", "--landmarks"), "a.toml"),
        (("analyze", "take.csv", "--columns"), "a.toml"),
        (("analyze", "take.csv", "--cycles"), "a.csv"),
        (("batch",), "a.csv"),
        (("report", "results", "--mesh"), "a.stl"),
    ],
)
@pytest.mark.parametrize(("number", "code"), [(errno.EIO, 3), (errno.ENOSPC, 3), (errno.EACCES, 2)])
def test_a_disk_that_does_not_give_a_file_is_no_wrong_usage(
    take: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    arguments: tuple[str, ...],
    name: str,
    number: int,
    code: int,
) -> None:
    (take.parent / name).write_text("path\n")
    real = opening.open_bytes

    def failing(path: Path) -> Any:
        if path.name == name:
            raise OSError(number, os.strerror(number))
        return real(path)

    monkeypatch.setattr(opening, "open_bytes", failing)
    given = f"arm={name}" if "--mesh" in arguments else name
    found, out, err = run(capsys, *arguments, given)
    assert (found, out) == (code, "")
    assert_one_line(err)
    assert f"{name}: cannot be read as a" in err
    assert os.strerror(number) in err


def test_all_frames_blank_cannot_be_analyzed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bodies = bodies_of(TRIAL)
    bodies[0].lost = TRIAL.angle > -1.0
    path = write_columns(tmp_path / "blank.csv", bodies)
    code, _, err = run(capsys, "analyze", path, "-o", tmp_path / "out")
    assert code == 5
    assert "0.0 % of 120 frames (120 blank)" in err
    assert_one_line(err)


def test_an_existing_result_is_kept_until_forced(take: Path, capsys: pytest.CaptureFixture[str]) -> None:
    options = ("-q", "--figure-format", "none")
    assert run(capsys, "analyze", take, *options)[0] == 0
    before = (take.parent / "take_elbowscrew" / "summary.json").read_bytes()
    code, _, err = run(capsys, "analyze", take, *options, "--min-angle", "20")
    assert code == 6
    assert_one_line(err)
    assert (take.parent / "take_elbowscrew" / "summary.json").read_bytes() == before
    assert run(capsys, "analyze", take, *options, "--min-angle", "20", "--force")[0] == 0
    assert (take.parent / "take_elbowscrew" / "summary.json").read_bytes() != before


LIMITED = """
import resource, sys
from elbowscrew.cli import main
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[1]), int(sys.argv[1])))
sys.exit(main(sys.argv[2:]))
"""


@pytest.mark.skipif(sys.platform == "win32", reason="POSIX limits")
@pytest.mark.parametrize("size", [0, 1000, 12_000, 60_000])
def test_a_disk_that_takes_no_more_leaves_nothing(take: Path, size: int) -> None:
    """Files cannot grow beyond the limit: the tables fail, or the summary, or a figure."""
    result = subprocess.run(
        [sys.executable, "-c", LIMITED, str(size), "analyze", str(take), "-o", "out"],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert result.returncode == 6
    assert_one_line(result.stderr)
    assert "cannot be written" in result.stderr
    assert sorted(path.name for path in take.parent.iterdir()) == ["take.csv"]


def test_names_of_files_and_bodies_cannot_speak_to_the_terminal(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write_columns(tmp_path / "[red]a\x1b[31m.csv", bodies_of(TRIAL, ("Arm [bold]", "Forearm\x1b[2J[/]")))
    code, out, _ = run(capsys, "analyze", path, "-o", tmp_path / "o", "--figure-format", "none")
    assert code == 0
    assert "\x1b" not in out
    assert "[bold]" in out
    code, out, err = run(capsys, "info", path)
    assert code == 0
    assert "\x1b" not in out + err
    code, _, err = run(capsys, "analyze", tmp_path / "a\nb\x1b[2J.csv", "-o", tmp_path / "p")
    assert code == 3
    assert "\x1b" not in err
    assert_one_line(err)


def test_no_command_shows_the_help(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = run(capsys)
    assert code == 2
    assert "analyze" in out


@pytest.mark.parametrize("encoding", ["ascii", "cp1252"])
def test_a_terminal_that_lacks_characters_gets_the_rest(take: Path, encoding: str) -> None:
    result = command("analyze", str(take), "--figure-format", "none", env={**os.environ, "PYTHONIOENCODING": encoding})
    assert (result.returncode, re.findall(r"\[(\S+)\]\n", result.stderr)) == (0, ["skin-unseen"])
    assert "Mean axis" in result.stdout


@pytest.mark.skipif(sys.platform == "win32", reason="POSIX shell")
@pytest.mark.parametrize("redirection", ["| true", ">&-", "2>&-", "2>/dev/full"])
def test_streams_that_nobody_reads_are_no_failure(take: Path, redirection: str) -> None:
    script = f"set -o pipefail; {sys.executable} -m elbowscrew info take.csv --json {redirection}"
    result = subprocess.run(["bash", "-c", script], cwd=take.parent, capture_output=True, text=True, check=False)
    assert result.returncode == 0
    assert "Traceback" not in result.stderr


def test_the_exit_code_does_not_depend_on_who_hears_the_error(take: Path) -> None:
    for redirection in ("2>&-", "2>/dev/full"):
        script = f"{sys.executable} -m elbowscrew info nothing.csv {redirection}"
        assert subprocess.run(["bash", "-c", script], cwd=take.parent, check=False).returncode == 3


def command(*arguments: str, **options: Any) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "elbowscrew", *arguments], capture_output=True, text=True, check=False, **options
    )


def test_the_installed_command_speaks_of_itself_as_elbowscrew() -> None:
    result = command("analyze", "nothing.csv")
    assert (result.returncode, result.stdout) == (3, "")
    assert result.stderr.startswith("elbowscrew: error: nothing.csv: no such file")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
@pytest.mark.parametrize("arguments", [["info", "take.csv"], ["--version"], ["info", "--help"], ["--help"]])
@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_an_output_that_takes_nothing_is_named_and_exit_6(take: Path, arguments: list[str], unbuffered: str) -> None:
    with Path("/dev/full").open("w") as full:
        result = subprocess.run(
            [sys.executable, "-m", "elbowscrew", *arguments], env={**os.environ, "PYTHONUNBUFFERED": unbuffered},
            cwd=take.parent, stdout=full, stderr=subprocess.PIPE, text=True, check=False,
        )  # fmt: skip
    assert result.returncode == 6
    assert result.stderr == "elbowscrew: error: standard output cannot be written: No space left on device\n"


@pytest.mark.skipif(sys.platform == "win32", reason="POSIX signals")
@pytest.mark.parametrize(("sent", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_an_interrupted_run_leaves_nothing(take: Path, sent: signal.Signals, code: int) -> None:
    """Stopped while it writes: there are figures enough for the temporary folder to be seen."""
    folder = take.parent
    process = subprocess.Popen(
        [sys.executable, "-m", "elbowscrew", "analyze", take.name, "-o", "out", "--figure-format", "png,svg,pdf"],
        cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # a shell's background job ignores it
    )  # fmt: skip
    deadline = time.monotonic() + 60.0
    while not list(folder.glob(".elbowscrew-*")) and process.poll() is None and time.monotonic() < deadline:
        time.sleep(0.002)
    process.send_signal(sent)
    process.communicate(timeout=60)
    assert process.returncode == code
    assert sorted(path.name for path in folder.iterdir()) == [take.name]


@pytest.mark.skipif(sys.platform == "win32", reason="POSIX signals")
@pytest.mark.parametrize(("sent", "code"), [("SIGINT", 130), ("SIGTERM", 143), ("SIGHUP", 129)])
def test_signals_that_come_again_do_not_cut_the_cleaning_up(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], sent: str, code: int
) -> None:
    usual = signal.default_int_handler if sent == "SIGINT" else signal.SIG_DFL
    cleaned: list[str] = []

    def work(_given: list[str]) -> int:
        try:
            signal.raise_signal(signal.Signals[sent])
        finally:
            for _ in range(3):
                signal.raise_signal(signal.Signals[sent])
                cleaned.append(sent)
        return 0

    monkeypatch.setattr("elbowscrew.cli.program._run", work)
    before = signal.signal(signal.Signals[sent], usual)  # in the background or by nohup it would be ignored
    try:
        assert main([]) == code
        assert len(cleaned) == 3
        assert_one_line(capsys.readouterr().err)
        assert signal.getsignal(signal.Signals[sent]) == usual
    finally:
        signal.signal(signal.Signals[sent], before)


@pytest.mark.skipif(sys.platform == "win32", reason="POSIX signals")
def test_a_closed_terminal_does_not_end_what_was_started_by_nohup(monkeypatch: pytest.MonkeyPatch) -> None:
    def work(_given: list[str]) -> int:
        signal.raise_signal(signal.SIGHUP)
        return 0

    monkeypatch.setattr("elbowscrew.cli.program._run", work)
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        assert main([]) == 0
    finally:
        signal.signal(signal.SIGHUP, before)


def test_landmarks_add_anatomical_angles(take: Path, capsys: pytest.CaptureFixture[str]) -> None:
    toml = take.with_name("arm.toml")
    toml.write_text(LANDMARKS)
    assert run(capsys, "analyze", take, "--landmarks", toml, "--figure-format", "none")[0] == 0
    folder = take.parent / "take_elbowscrew"
    lines = (folder / "anatomy.csv").read_text().splitlines()
    assert lines[0] == "frame,time_s,flexion_deg,carrying_deg,pronation_deg,axis_angle_deg,axis_distance_mm"
    assert json.loads((folder / "joint.json").read_text())["anatomy"]["side"] == "right"
    toml.write_text(LANDMARKS.replace("EL =", "EK ="))
    code, _, err = run(capsys, "analyze", take, "--landmarks", toml, "--force")
    assert code == 2
    assert_one_line(err)
    toml.write_text(LANDMARKS.replace('{ body = "lab", mm = [352, 1105, -190] }', '"nobody"'))
    code, _, err = run(capsys, "analyze", take, "--landmarks", toml, "--force")
    assert code == 4
    assert_one_line(err)


def test_landmarks_of_markers_that_are_not_there_are_told_beside_those_that_are(
    tmp_path: Path, samples: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    toml = tmp_path / "arm.toml"
    toml.write_text(LANDMARKS.replace('"right"', '"left"').replace('{ body = "lab", mm = [352, 1105, -190] }', '"M5"'))
    code, _, err = run(capsys, "analyze", samples / "elbow_left.csv", "--landmarks", toml, "-o", tmp_path / "out")
    assert code == 4
    assert_one_line(err)
    assert "EL: there is no marker 'M5'" in err
    assert all(f"Left {body}:Marker{k}" in err for body in ("Upper Arm", "Forearm") for k in (1, 2, 3, 4))
    code, _, err = run(capsys, "analyze", samples / "elbow_row_tagged.csv", "--landmarks", toml, "-o", tmp_path / "out")
    assert code == 4
    assert_one_line(err)
    assert "give landmarks as coordinates" in err


def test_a_list_of_a_comparison_is_told_as_an_option(capsys: pytest.CaptureFixture[str], take: Path) -> None:
    code, _, err = run(capsys, "compare", take, "--data", "low-pass")
    assert code == 2
    assert "error: --data: expected some of raw, lowpass, decimated, found low-pass; did you mean 'lowpass'?" in err
