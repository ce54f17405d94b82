"""Each doubt about the sense is told where it is one, with its numbers and with what decides."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from elbowscrew.geometry.arrays import Float
from elbowscrew.model import Sense
from elbowscrew.motion.screws.sense import DOMINANT_RATIO, sense_of
from elbowscrew.motion.screws.sense_doubts import sense_warnings
from elbowscrew.settings import SETTINGS

OPTIONS = {setting.option for setting in SETTINGS}


def sense(**changes: Any) -> Sense:
    """One that nothing is doubtful about, but for what is given."""
    fields: dict[str, Any] = {name: getattr(PLAIN, name) for name in Sense.__dataclass_fields__}
    return Sense(**{**fields, **changes})


def about(axis: list[float], degrees: Float) -> Float:
    turned = Rotation.from_rotvec(np.radians(degrees)[:, None] * np.array(axis))
    return np.asarray(turned.as_quat(canonical=True, scalar_first=True))


PLAIN = sense_of(about([1.0, 0.0, 0.0], 60.0 - 60.0 * np.cos(np.linspace(0.0, 6.0, 200))), np.arange(200) / 100.0, 0)
FRAME = np.arange(1000, 1200)


def told(one: Sense, chosen: Any = "auto") -> dict[str, str]:
    found = {warning.code: warning.message for warning in sense_warnings(one, FRAME, chosen)}
    for message in found.values():
        assert set(re.findall(r"--([a-z-]+)", message)) <= OPTIONS  # an option that there is
    return found


def test_nothing_is_told_of_a_hinge() -> None:
    assert told(PLAIN) == {}


@pytest.mark.parametrize("chosen", ["auto", "yes", "no"])
def test_no_sense_is_told_with_its_ratio_unless_somebody_decided(chosen: str) -> None:
    one = sense(signed=False, ratio=0.4567)
    found = told(one, chosen)
    assert set(found) == {"auto": {"unsigned"}, "yes": {"sense-forced"}, "no": set()}[chosen]
    if chosen == "auto":
        message = found["unsigned"]
        assert message.startswith(
            "no axis dominates the motion (the ratio of the second direction to the first is 0.457;"
        )
        assert f"; one axis leaves {DOMINANT_RATIO:.2f} at most)" in message
        assert "--signed yes" in message  # the other answer than the one found


@pytest.mark.parametrize(("signed", "ratio"), [(True, 0.19), (False, 0.21)])
def test_a_ratio_near_the_limit_is_told_with_the_answer_found(signed: bool, ratio: float) -> None:
    found = told(sense(signed=signed, ratio=ratio))
    message = found["sense-doubtful"]
    assert f"{ratio:.3f}, close to {DOMINANT_RATIO:.2f}" in message
    assert ("it has a sense" in message) == signed
    assert ("it has none" in message) == (not signed)
    assert "--signed" in message
    assert "--reference" in message
    assert ("unsigned" in found) == (not signed)
    assert set(told(sense(signed=signed, ratio=ratio), "yes")) == (
        {"sense-forced"} if ratio > DOMINANT_RATIO else set()
    )


def test_a_sense_that_the_motion_does_not_support_is_told() -> None:
    message = told(sense(signed=True, ratio=0.74), "yes")["sense-forced"]
    assert message.startswith("no axis dominates the motion (the ratio of the second direction to the first is 0.740;")
    assert "only because --signed yes asks for it" in message
    assert not told(sense(signed=True, ratio=0.1), "yes")


def test_a_tie_is_told_whoever_decided() -> None:
    for chosen in ("auto", "yes"):
        message = told(sense(tied=True), chosen)["sense-tied"]
        assert "the side it went to first is the positive one" in message
        assert "--reference" in message


@pytest.mark.parametrize(("jumps", "steps"), [(1, "in 1 step theta"), (3, "in 3 steps theta")])
def test_a_jump_is_told_with_its_size_and_frame(jumps: int, steps: str) -> None:
    message = told(sense(largest_jump=np.radians(47.0), jump_row=12, jumps=jumps))["theta-jumps"]
    assert message.startswith(steps)
    assert "more than 20 deg beyond" in message
    assert "by 47 deg after frame 1012" in message
    assert message.endswith("does not know of it")


@pytest.mark.parametrize(("degrees", "is_told"), [(19.9, False), (20.1, True)])
def test_a_jump_is_one_over_20_degrees(degrees: float, is_told: bool) -> None:
    """docs/reference/conventions.md says the limit."""
    found = told(sense(largest_jump=np.radians(degrees), jump_row=3, jumps=1))
    assert ("theta-jumps" in found) == is_told


@pytest.mark.parametrize(("rows", "gaps"), [((5,), "in a gap (the first"), ((5, 60), "in 2 gaps (the first")])
def test_whole_turns_over_gaps_are_told_with_the_first_gap(rows: tuple[int, ...], gaps: str) -> None:
    message = told(sense(counted=True, bridged_rows=rows))["turns-over-gap"]
    assert gaps in message
    assert "after frame 1005)" in message
    assert message.endswith("theta after it is counted by that speed, and depends on that")
    told_without = told(sense(counted=False, bridged_rows=rows))["turns-over-gap"]
    assert told_without.endswith("theta after it is told as if it did not, and depends on that")


@pytest.mark.parametrize(("amplitude", "tied"), [(60.0, True), (55.0, True), (54.0, False)])
def test_excursions_that_differ_by_less_than_five_percent_of_their_sum_are_tied(amplitude: float, tied: bool) -> None:
    """docs/reference/conventions.md: of two that differ by less than 5 % of their sum the first is positive."""
    wave = np.sin(np.linspace(0.0, 4.0 * np.pi, 401))
    degrees = np.where(wave > 0.0, amplitude, 60.0) * wave
    found = sense_of(about([0.0, 0.0, 1.0], degrees), np.arange(401) / 100.0, 0)
    assert found.tied == tied
    way = 1.0 if tied else -1.0  # the larger one is the second, and negative
    assert np.degrees(found.angle) == pytest.approx(way * degrees, abs=1e-6)


@pytest.mark.parametrize("sizes", [(60.0, 15.0), (60.0, 28.0), (60.0, 45.0)])
def test_the_ratio_is_that_of_the_second_moments_of_the_axes(sizes: tuple[float, float]) -> None:
    """Of sin^2(phi / 2) h h^T, less the share of noise that is told."""
    wave = np.sin(np.linspace(0.0, 2.0 * np.pi, 201))
    quat = np.concatenate([about([1.0, 0.0, 0.0], sizes[0] * wave), about([0.0, 1.0, 0.0], sizes[1] * wave)])
    first, second = (np.sum(np.sin(0.5 * np.radians(size) * wave) ** 2) for size in sizes)
    noise = np.radians(3.0)
    share = 0.25 * noise**2 * len(quat)
    for sigma, wanted in ((0.0, second / first), (noise, (second - share) / (first - share))):
        found = sense_of(quat, np.arange(402) / 100.0, 0, sigma=sigma)
        assert found.ratio == pytest.approx(wanted)
        assert found.sigma == sigma
        assert found.signed == (wanted <= 0.20)
