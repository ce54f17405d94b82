"""Landmarks from a TOML file: what it says is what is meant, and all that is wrong is named at once."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from elbowscrew.errors import UsageError
from elbowscrew.model.anatomy import LANDMARKS, LANDMARKS_OF, Landmark
from elbowscrew.reading.landmarks import read_landmarks

GOOD = {
    "EL": '"lateral_epicondyle"',
    "EM": '{ body = "arm", mm = [30.0, -131, 4.5] }',
    "US": '["wrist front", "Wrist:Marker 002"]',
    "RS": '{ body = "forearm", mm = [0, 0.5, -10] }',
    "GH": '{ body = "lab", mm = [10000.0, -10000, 0] }',
}


def written(folder: Path, landmarks: dict[str, str], side: str = 'side = "right"') -> Path:
    path = folder / "arm.toml"
    lines = [side, "[landmarks]", *(f"{name} = {value}" for name, value in landmarks.items())]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def test_names_and_coordinates(tmp_path: Path) -> None:
    path = written(tmp_path, GOOD)
    found = read_landmarks(path)
    assert found.side == "right"
    assert found.source == str(path)
    assert list(found.by_name) == list(LANDMARKS_OF["elbow"])
    assert found.by_name["EL"].markers == ("lateral_epicondyle",)
    assert found.by_name["US"].markers == ("wrist front", "Wrist:Marker 002")
    assert found.by_name["EL"].point is None
    assert [found.by_name["EM"].frame, found.by_name["RS"].frame, found.by_name["GH"].frame] == [
        "proximal",
        "distal",
        "lab",
    ]
    assert found.by_name["EM"].point == pytest.approx([0.030, -0.131, 0.0045], abs=1e-15)
    assert found.by_name["GH"].point == pytest.approx([10.0, -10.0, 0.0], abs=1e-15)
    assert found.markers == ("lateral_epicondyle", "wrist front", "Wrist:Marker 002")
    assert read_landmarks(str(path)).by_name["EL"].markers == found.by_name["EL"].markers


def test_the_documents_example_is_one(root: Path, tmp_path: Path) -> None:
    text = (root / "docs" / "explanation" / "anatomy.md").read_text(encoding="utf-8")
    (tmp_path / "arm.toml").write_text(text.split("```toml\n")[1].split("```")[0], encoding="utf-8")
    found = read_landmarks(tmp_path / "arm.toml")
    assert found.markers == ("lateral_epicondyle", "radial_styloid", "shoulder_front", "shoulder_back")
    assert all(f"`{name}`" in text for name in LANDMARKS)


def test_a_left_arm_and_the_mark_that_editors_put_before_a_file(tmp_path: Path) -> None:
    path = written(tmp_path, GOOD, 'side = "left"')
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes().replace(b"\n", b"\r\n"))
    assert read_landmarks(path).side == "left"


@pytest.mark.parametrize(
    ("name", "value", "says"),
    [
        ("EL", "3", "landmarks.EL: expected a marker's name, a list of names, or {"),
        ("EL", '" "', "landmarks.EL: expected a marker's name, a list of names, or {"),
        ("EL", "[]", "found []"),
        ("EL", '["a", 3]', "found ['a', 3]"),
        ("EL", "[10.0, 20.0, 30.0]", "found [10.0, 20.0, 30.0]"),
        ("EM", '{ body = "hand", mm = [1, 2, 3] }', "EM: body: expected 'arm', 'forearm' or 'lab', found 'hand'"),
        ("EM", "{ body = [1], mm = [1, 2, 3] }", "landmarks.EM: body: expected 'arm', 'forearm' or 'lab', found [1]"),
        ("EM", "{ mm = [1, 2, 3] }", "landmarks.EM: body: expected 'arm', 'forearm' or 'lab', found none"),
        ("EM", '{ body = "arm" }', "landmarks.EM: mm: expected three numbers, [x, y, z], found none"),
        ("EM", '{ body = "arm", mm = [1, 2] }', "landmarks.EM: mm: expected three numbers, [x, y, z], found [1, 2]"),
        ("EM", '{ body = "arm", mm = 3 }', "expected three numbers, [x, y, z], found 3"),
        ("EM", '{ body = "arm", mm = [1, 2, "3"] }', "expected three numbers, [x, y, z], found [1, 2, '3']"),
        ("EM", '{ body = "arm", mm = [1, 2, true] }', "expected three numbers, [x, y, z], found [1, 2, True]"),
        ("EM", '{ body = "arm", mm = [1, 2, nan] }', "landmarks.EM: mm: expected numbers within 10 m of the origin"),
        ("EM", '{ body = "arm", mm = [1, -inf, 3] }', "within 10 m of the origin, found [1, -inf, 3]"),
        ("EM", '{ body = "arm", mm = [1, 2, 10000.1] }', "within 10 m of the origin, found [1, 2, 10000.1]"),
        ("EM", '{ body = "arm", mm = [1, 2, 1' + 400 * "0" + "] }", "within 10 m of the origin"),
        ("EM", '{ Body = "arm", mm = [1, 2, 3] }', "landmarks.EM: unknown key 'Body'; did you mean 'body'?"),
        ("EM", '{ body = "arm", mm = [1, 2, 3], note = "n" }', "landmarks.EM: unknown key 'note'; possible: body, mm"),
        ("el", '"a"', "unknown landmark 'el'; did you mean 'EL'?"),
        ("acromion", '"a"', "unknown landmark 'acromion'; possible: EL, EM, US, RS, GH"),
        ('"a\\nb"', '"a"', "unknown landmark 'a\\nb'"),
    ],
)  # fmt: skip
def test_a_bad_landmark_is_named_with_its_file(tmp_path: Path, name: str, value: str, says: str) -> None:
    with pytest.raises(UsageError) as caught:
        read_landmarks(written(tmp_path, GOOD | {name: value}))
    assert says in str(caught.value)
    assert str(caught.value).startswith(f"{tmp_path / 'arm.toml'}: ")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "side is missing: write side = "),
        ('side = "both"', "side: expected 'right' or 'left', found 'both'"),
        ("side = 1", "side: expected 'right' or 'left', found 1"),
        ("landmarks = 3", "landmarks: expected a table, [landmarks] on a line of its own, found 3"),
        ('sides = "left"', "unknown key 'sides'; did you mean 'side'?"),
        ('EL = "a"', "unknown key 'EL'; possible: side, landmarks"),
        ("= 3", "not TOML"),
        ("a = " + "[" * 20000, "not TOML"),
    ],
)
def test_a_bad_file_is_an_error(tmp_path: Path, text: str, says: str) -> None:
    path = tmp_path / "arm.toml"
    path.write_text(text)
    with pytest.raises(UsageError) as caught:
        read_landmarks(path)
    assert says in str(caught.value)
    assert "arm.toml" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_all_faults_are_named_together(tmp_path: Path) -> None:
    given = {"EL": "3", "EM": '{ body = "arm", mm = [1] }', "XX": '"x"', "US": '"us"'}
    with pytest.raises(UsageError) as caught:
        read_landmarks(written(tmp_path, given, 'side = "up"'))
    for says in (
        "side: expected",
        "landmarks.EL: expected",
        "landmarks.EM: mm: expected",
        "unknown landmark 'XX'",
        "missing in [landmarks]: RS (radial styloid), GH (glenohumeral center); give each a marker's name",
    ):
        assert says in str(caught.value)


def test_an_unreadable_file_is_an_error(tmp_path: Path) -> None:
    for path in (tmp_path / "none.toml", tmp_path):
        with pytest.raises(UsageError, match="cannot be read as a file of landmarks"):
            read_landmarks(path)
    binary = tmp_path / "b.toml"
    binary.write_bytes(b"\xff\xfe")
    with pytest.raises(UsageError, match="not TOML"):
        read_landmarks(binary)


@pytest.mark.parametrize(
    "given",
    [
        {},
        {"markers": ("a",), "point": np.zeros(3), "frame": "proximal"},
        {"point": np.zeros(3)},
        {"markers": ("a",), "frame": "proximal"},
    ],
)
def test_a_landmark_is_markers_or_a_point_with_its_frame(given: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match="by markers, or by a point"):
        Landmark(**given)
