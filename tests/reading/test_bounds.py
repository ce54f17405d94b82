"""What a file can cost: memory and time are bounded by its size, and so is what is said of it."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from elbowscrew.cli import main
from elbowscrew.errors import RecordingError, shortened, shown
from elbowscrew.reading import c3d, cells, motive_header, row_tagged
from elbowscrew.reading.clock import cut_warnings
from elbowscrew.reading.registry import read_recording
from elbowscrew.reading.source import open_source
from elbowscrew.results import table_text
from elbowscrew.study import trials

DIGITS = "1" * 200_000


@pytest.mark.parametrize(
    "match",
    [
        cells._NUMBER.fullmatch,
        trials._NUMBER.fullmatch,
        table_text._NUMBER.fullmatch,
        row_tagged._DECIMAL_COMMA.fullmatch,
        motive_header._LAST_NUMBER.search,
    ],
)
@pytest.mark.parametrize("ending", ["x", f".{DIGITS}x", f",{DIGITS}x", f"e{DIGITS}x"])
def test_numbers_without_end_are_looked_at_in_linear_time(match: Callable[[str], object], ending: str) -> None:
    """A quadratic pattern takes the better part of an hour for these."""
    assert match(DIGITS + ending) is None


@pytest.mark.parametrize("text", ["1", "-1.5", ".5", "1.", "+1e5", "1.5E-7"])
def test_numbers_are_read_as_before(text: str) -> None:
    assert cells.parse_number(text) == float(text)


def test_a_number_of_40000_digits_is_told_in_one_short_line(
    real_data: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["info", str(real_data / "cases" / "number_of_40000_digits.csv")]) == 3
    told = capsys.readouterr().err
    assert "expected a number" in told
    assert len(told) < 1000


def test_a_count_of_frames_of_5000_digits_is_none(samples: Path) -> None:
    source = open_source(samples / "elbow_paper.csv")
    (warning,) = cut_warnings(source, "9" * 5000, 450)
    assert warning.code == "frame-count"
    assert not cut_warnings(source, "000450", 450)


def test_a_c3d_file_that_states_more_than_it_has_is_refused_before_it_is_opened(real_data: Path) -> None:
    with pytest.raises(RecordingError, match=r"parameters up to .LABELS. state \d{10,} values, .* has 7680 bytes"):
        read_recording(real_data / "cases" / "c3d_giant_dims.c3d", markers="*")


def test_many_parameters_may_not_state_it_together_either(real_data: Path, tmp_path: Path) -> None:
    """Each within the file's size, all of them far beyond: entries that lie over each other."""
    good = bytearray((real_data / "cases" / "c3d_ok.c3d").read_bytes())
    entries = b"".join(b"\x01\x01P\x08\x00\xff\x02\xff\x1d\x00" for _ in range(40))
    start = 512 * (good[0] - 1) + 4
    good[start : start + len(entries)] = entries
    (tmp_path / "bad.c3d").write_bytes(good)
    with pytest.raises(RecordingError, match="state"):
        read_recording(tmp_path / "bad.c3d", markers="*")


@pytest.mark.skipif(sys.platform != "linux", reason="the system's limits")
def test_whoever_opens_a_c3d_file_has_limits(real_data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A library that takes all memory there is, as ezc3d does of some files."""
    (tmp_path / "ezc3d.py").write_text("def c3d(path):\n    bytearray(3 << 30)\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    with pytest.raises(RecordingError, match="MemoryError"):
        read_recording(real_data / "cases" / "c3d_ok.c3d", markers="*")
    limits = "import resource\ndef c3d(path):\n    raise ValueError(resource.getrlimit(resource.RLIMIT_CPU)[0])\n"
    (tmp_path / "ezc3d.py").write_text(limits)
    with pytest.raises(RecordingError, match="ValueError: 4;"):
        read_recording(real_data / "cases" / "c3d_ok.c3d", markers="*")


def test_a_c3d_file_that_takes_too_long_is_told_so(
    real_data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    signal = pytest.importorskip("signal")
    if not hasattr(signal, "SIGXCPU"):
        pytest.skip("no limit of time on this system")
    (tmp_path / "ezc3d.py").write_text("import os, signal\ndef c3d(path):\n    os.kill(os.getpid(), signal.SIGXCPU)\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    with pytest.raises(RecordingError, match="longer than a file of its size may"):
        read_recording(real_data / "cases" / "c3d_ok.c3d", markers="*")


def test_a_message_has_an_end() -> None:
    assert shortened("short") == "short"
    cut = shortened("begin " + "x" * 100_000 + " end")
    assert len(cut) < 2100
    assert cut.startswith("begin")
    assert cut.endswith("end")


def test_every_value_can_be_shown() -> None:
    endless: list[object] = []
    for _ in range(100_000):
        endless = [endless]
    assert shown("a") == "'a'"
    assert len(shown("a" * 1000)) < 100
    assert "int" in shown(10**5000)
    assert "list" in shown(endless)


@pytest.mark.parametrize(
    "line",
    [
        f"rate = 0x{'F' * 5000}",
        f"max-gap = 1{'0' * 400}",
        f"lowpass = -0x{'F' * 5000}",
        f"lowpass = 0x{'F' * 5000}",
        f"arm = 1{'0' * 4000}",
        f"arm = {'[' * 5000}",
        f"{'a' * 70_000} = 1",
    ],
)
@pytest.mark.parametrize("option", ["--config", "--landmarks"])
def test_no_toml_ends_in_a_traceback(
    samples: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], line: str, option: str
) -> None:
    (tmp_path / "a.toml").write_text(line)
    take = str(samples / "elbow_paper.csv")
    assert main(["analyze", take, "-o", str(tmp_path / "out"), option, str(tmp_path / "a.toml")]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert len(told) < 2200
    assert re.match("elbowscrew: error: .*a.toml: ", told)


def test_trials_with_numbers_of_5000_digits_have_an_order() -> None:
    names = ["t9", "t10", "t" + "1" * 5000, "t" + "2" * 5000, "t010b", "t1" + "0" * 6000]
    assert sorted(names, key=trials.natural_key) == [*names[:2], names[4], names[2], names[3], names[5]]


def test_a_c3d_file_that_ends_among_its_parameters_is_refused_before_it_is_opened(
    real_data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The library reads on beyond the end until its time is over."""

    def opened(_file: Path) -> bytes:
        raise AssertionError

    monkeypatch.setattr(c3d, "_worker_output", opened)
    data = (real_data / "cases" / "c3d_ok.c3d").read_bytes()
    blocks = data[514]
    last = data[: 512 * (1 + blocks)].rstrip(b"\0")
    for size in range(540, len(last), 29):
        (tmp_path / "t.c3d").write_bytes(data[:size])
        with pytest.raises(RecordingError, match="ends among its parameters"):
            read_recording(tmp_path / "t.c3d")
