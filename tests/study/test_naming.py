"""Result folders: whatever the trials are called, each gets one of its own, inside the output folder."""

from __future__ import annotations

import re
import unicodedata
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from elbowscrew.study.naming import result_names

# Characters that meet on some file system, that mean something to one, and any others.
MARKS = st.sampled_from('aAbBéÉe\u0301ßſsK\u212aﬁfiﬀ./\\:_- ~*?"<>|\n\r\t\0=+@1²٣\u202e\U0001f4a9\udcff')
TEXTS = st.text(MARKS | st.characters(), min_size=1, max_size=12) | st.sampled_from(
    ["..", ".", "../..", "CON", "nul.txt", "aux.csv", "COM1", "lpt¹.csv", "summary.csv", "index.html", "figures", "~"]
)
PATHS = st.lists(st.builds("/".join, st.lists(TEXTS, min_size=1, max_size=3)), min_size=1, max_size=12, unique=True)

DEVICE = re.compile(r"(con|prn|aux|nul|com[\d¹²³]|lpt[\d¹²³]) *(\..*)?", re.IGNORECASE | re.DOTALL)


def met(name: str) -> str:
    """What a file system makes of a name that tells neither case nor composition apart: HFS+, APFS, NTFS."""
    return unicodedata.normalize("NFD", unicodedata.normalize("NFD", name).casefold()).upper()


@given(paths=PATHS, alone=st.booleans())
def test_names_never_meet_and_never_lead_out(paths: list[str], alone: bool) -> None:
    names = result_names(paths, [alone] * len(paths))
    assert len({met(name) for name in names}) == len(paths)
    for name in names:
        assert name not in ("", ".", "..")
        assert not set(name) & set('/\\:*?"<>|\0\n\r\t')
        assert name[0] not in ".-= +@"
        assert name[-1] not in ". "
        assert len(name.encode()) < 200
        assert not DEVICE.fullmatch(name)
        assert (Path("/out") / name).resolve().parent == Path("/out")


@given(paths=PATHS)
def test_names_do_not_depend_on_the_order(paths: list[str]) -> None:
    named = dict(zip(paths, result_names(paths), strict=True))
    assert dict(zip(paths[::-1], result_names(paths[::-1]), strict=True)) == named


@given(paths=PATHS, more=PATHS)
def test_a_name_stays_when_trials_are_added_that_it_does_not_meet(paths: list[str], more: list[str]) -> None:
    before = dict(zip(paths, result_names(paths), strict=True))
    every = list(dict.fromkeys([*paths, *more]))
    after = dict(zip(every, result_names(every), strict=True))
    plain = {met(result_names([path])[0]) for path in more if path not in before}
    for path, name in before.items():
        if met(result_names([path])[0]) not in plain:
            assert after[path] == name


@pytest.mark.parametrize(
    ("path", "name"),
    [
        ("trial 1.csv", "trial 1"),
        ("P01/flexion/trial.CSV", "P01__flexion__trial"),
        ("P01/trial.c3d", "P01__trial.c3d"),
        ("試験 1.csv", "試験 1"),
        ("Übung.csv", "Übung"),
    ],
)
def test_plain_names_stay_readable(path: str, name: str) -> None:
    assert result_names([path]) == [name]


@pytest.mark.parametrize("path", ["a:b.csv", "con.csv", "x" * 300 + ".csv", "a..b.csv", ".csv", "summary.csv.csv"])
def test_other_names_get_a_digest_of_their_own_path(path: str) -> None:
    (name,) = result_names([path])
    assert len(name.rsplit("-", 1)[1]) == 8
    assert result_names([path, "other.csv"])[0] == name


def test_the_same_name_in_different_folders() -> None:
    names = result_names(["P01/t.csv", "P02/t.csv", "P03/u.csv"], [True, True, True])
    assert names == ["P01__t", "P02__t", "u"]


def test_names_that_differ_in_case_only() -> None:
    upper, lower = result_names(["T.csv", "t.csv"])
    assert upper.startswith("T-")
    assert lower.startswith("t-")
    assert upper[2:] != lower[2:]
