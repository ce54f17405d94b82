"""Movements between rests, and cycles: on motions whose times are known, and on real takes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from read_off import read_off
from scipy.signal import find_peaks

from elbowscrew import Settings, analyze, read_recording, simulate_trial
from elbowscrew.geometry.arrays import Float
from elbowscrew.motion.movements.boundaries import Cuts
from elbowscrew.motion.movements.cuts import cut
from elbowscrew.motion.movements.measured import measured_cuts
from elbowscrew.motion.movements.phases import movement_phases, turning_points
from elbowscrew.motion.screws.measurement import measure

RATE = 100.0
TIME = np.arange(3000) / RATE


def moved(*steps: tuple[float, float, float]) -> Float:
    """Angle (rad) of moves by so many degrees from one time (s) to another, each with minimum jerk."""
    angle = np.zeros(TIME.size)
    for degrees, begin, end in steps:
        tau = np.clip((TIME - begin) / (end - begin), 0.0, 1.0)
        angle += np.radians(degrees) * tau**3 * (10.0 - 15.0 * tau + 6.0 * tau**2)
    return angle


def cut_of(angle: Float) -> Cuts:
    return cut(angle, TIME, RATE)


def movements(angle: Float) -> list[tuple[float, float]]:
    """Times (s) of onset and offset."""
    found = cut_of(angle).movements
    return list(zip(found.onset_s.tolist(), found.offset_s.tolist(), strict=True))


def cycles(angle: Float) -> list[list[float]]:
    """Times (s) of start, inversion and end."""
    found: list[list[float]] = cut_of(angle).cycles.times_s.tolist()
    return found


def test_a_movement_begins_and_ends_at_its_feet() -> None:
    found = movements(moved((120, 5.0, 7.0), (-120, 12.0, 15.0)))
    assert np.abs(np.array(found) - [(5, 7), (12, 15)]).max() < 0.02


def test_neither_the_size_nor_the_sense_of_the_rotation_matters() -> None:
    angle = moved((120, 5, 7), (-120, 12, 15), (20, 20, 21))
    expected = movements(angle)
    for factor in (-1.0, 8.0, 0.5):
        assert np.array(movements(factor * angle)) == pytest.approx(np.array(expected), abs=1e-6)


def test_a_motion_run_backward_has_the_same_phases_and_cycles() -> None:
    angle = moved((120, 5, 7), (-120, 7.2, 10), (90, 15, 16), (-90, 18, 20))
    last = TIME[-1]
    assert last - np.array(movements(angle[::-1]))[::-1, ::-1] == pytest.approx(np.array(movements(angle)), abs=1e-9)
    assert last - np.array(cycles(angle[::-1]))[::-1, ::-1] == pytest.approx(np.array(cycles(angle)), abs=1e-9)


def test_the_rows_of_phases_and_their_mask_are_one() -> None:
    found = cut_of(moved((120, 5, 7), (-120, 12, 15))).movements
    phases = movement_phases(found.onset_s, found.offset_s, TIME + 3.0)
    mask = np.zeros(TIME.size, dtype=np.bool_)
    for onset, offset in zip(phases.onset_rows, phases.offset_rows, strict=True):
        mask[onset : offset + 1] = True
    assert np.array_equal(mask, phases.moving)
    assert np.abs(TIME[phases.onset_rows] - found.onset_s).max() <= 0.5 / RATE + 1e-9


@pytest.mark.parametrize(("pause", "count"), [(0.0, 1), (0.1, 1), (0.6, 2)])
def test_a_rest_lasts_a_quarter_of_a_second(pause: float, count: int) -> None:
    assert len(movements(moved((60, 5, 6), (60, 6 + pause, 7 + pause)))) == count


def test_a_short_gap_in_a_movement_does_not_part_it() -> None:
    angle = moved((120, 5, 7))
    whole = movements(angle)
    angle[590:600] = np.nan
    assert np.array(movements(angle)) == pytest.approx(np.array(whole), abs=0.02)


HELD = [
    # moves, expected start and end of each cycle, between which times its top lies
    ("held at the top", [(100, 2, 3), (-100, 9, 10)], [(2, 10)], [(3, 9)]),
    ("a rest between", [(100, 2, 3), (-100, 3, 4), (100, 8, 9), (-100, 9, 10)], [(2, 4), (8, 10)], [(3, 3), (9, 9)]),
    ("none between", [(100, 2, 3), (-100, 3, 4), (100, 4, 5), (-100, 5, 6)], [(2, 4), (4, 6)], [(3, 3), (5, 5)]),
    ("sags by 20 %", [(100, 2, 3), (-20, 4, 5), (20, 6, 7), (-100, 9, 10)], [(2, 10)], [(3, 9)]),
    ("sags by 40 %", [(100, 2, 3), (-40, 4, 5), (40, 6, 7), (-100, 9, 10)], [(2, 5), (6, 10)], [(3, 4), (7, 9)]),
    ("rests on the way down", [(100, 2, 3), (-80, 5, 6), (-20, 8, 9)], [(2, 9)], [(3, 5)]),
    ("extends first", [(-60, 2, 3), (130, 3, 5), (-130, 7, 9), (60, 12, 13)], [(3, 9)], [(5, 7)]),
    ("starts flexed", [(-100, 2, 3), (100, 5, 6), (-100, 8, 9), (100, 11, 12)], [(5, 9)], [(6, 8)]),
    ("does not return", [(100, 2, 3)], [], []),
    ("returns by a tenth", [(100, 2, 3), (-10, 5, 6)], [], []),
    ("ends flexed", [(100, 2, 3), (-100, 5, 6), (100, 8, 9)], [(2, 6)], [(3, 5)]),
    ("too small", [(1.9, 2, 3), (-1.9, 5, 6)], [], []),
]


@pytest.mark.parametrize(("steps", "feet", "tops"), [case[1:] for case in HELD], ids=[case[0] for case in HELD])
@pytest.mark.parametrize("offset_deg", [0.0, -200.0, 45.0])
def test_cycles(
    steps: list[tuple[float, float, float]], feet: list[tuple[float, float]], tops: list[tuple[float, float]],
    offset_deg: float,
) -> None:  # fmt: skip
    found = cycles(moved(*steps) + np.radians(offset_deg))
    assert len(found) == len(feet)
    for (start, top, end), (begin, finish), (early, late) in zip(found, feet, tops, strict=True):
        assert (start, end) == pytest.approx((begin, finish), abs=0.1)
        assert early - 0.02 <= top <= late + 0.02


@given(st.permutations(range(40)), st.integers(0, 38))
def test_highs_are_the_prominent_peaks_of_scipy(values: list[int], swing: int) -> None:
    """All of them and no others; a high that the series does not rise to, or fall from, is none for either."""
    series = np.array(values, dtype=np.float64)
    turns = turning_points(series, swing + 0.5)
    highs = turns[1:-1][series[turns[1:-1]] > series[turns[:-2]]]
    assert highs.tolist() == find_peaks(series, prominence=swing + 0.5)[0].tolist()


def test_gaps_in_the_angle_leave_the_cycles_around_them() -> None:
    angle = moved((100, 2, 3), (-100, 9, 10), (100, 15, 16), (-100, 18, 19))
    angle[540:560] = np.nan
    found = np.array(cycles(angle))
    assert found[:, [0, 2]] == pytest.approx(np.array([(2.0, 10.0), (15.0, 19.0)]), abs=0.1)


# The robot starts and stops abruptly, which the feet of a minimum-jerk movement miss by up to a quarter of a second
# (docs/reference/outputs.md); where it only creeps on, the end of the movement is not a time that can be read off.
# Two standard deviations of the Gaussian under which it is read off: so far it spreads an abrupt end.
READ_OFF_S = 0.08


@pytest.mark.parametrize(
    ("name", "proximal"),
    [(f"v121_thomazach_{take}", body) for take in ("20230627_0117", "20230706_122504") for body in (1, 2)],
)
def test_real_takes_as_they_look(real_data: Path, name: str, proximal: int) -> None:
    """Beside plain rules for the speed and the extremes of the angle, on a reading of their own.

    A rest that is told to be in doubt may be read either way.
    """
    path, bodies = real_data / "real" / f"{name}.csv", (f"Rigid Body {proximal}", f"Rigid Body {proximal + 1}")
    seen = read_off(path, *bodies)
    settings = Settings(proximal=bodies[0], distal=bodies[1])
    found = measured_cuts(measure(read_recording(path), settings), settings)
    moves, cycles = found.movements, found.cycles
    near = (seen.onsets[:, 0] - READ_OFF_S < moves.onset_s[:, None]) & (
        moves.onset_s[:, None] < seen.onsets[:, 1] + READ_OFF_S
    )
    begins = near.any(axis=1) | np.array(["rest-in-doubt" not in codes for codes in moves.onset_reasons])
    stops = np.append(begins[1:], True)
    assert begins.sum() == len(seen.onsets)
    ends = (
        (moves.onset_s[begins], moves.onset_sd_s[begins], seen.onsets),
        (moves.offset_s[stops], moves.offset_sd_s[stops], seen.offsets),
    )
    for told, sd, read in ends:
        assert (read[:, 0] - READ_OFF_S < told + 1.96 * sd).all()
        assert (told - 1.96 * sd < read[:, 1] + READ_OFF_S).all()
        assert (sd < 0.15).all()
    joined = cycles.start_s[1:][cycles.start_s[1:] == cycles.end_s[:-1]]
    for times, extremes in ((cycles.inversion_s, seen.tops), (joined, seen.valleys)):
        for time in times:
            assert ((extremes[:, 0] - READ_OFF_S < time) & (time < extremes[:, 1] + READ_OFF_S)).any()


@pytest.mark.parametrize("rest_s", [1.0, 60.0, 300.0])
def test_a_long_rest_does_not_hide_a_short_movement(rest_s: float) -> None:
    turned = moved((90, 0.0, 0.5), (-90, 0.5, 1.0))[:101]
    angle = np.concatenate([np.zeros(int(rest_s * RATE)), turned, np.zeros(int(rest_s * RATE))])
    angle += np.random.default_rng(1).normal(scale=np.radians(0.3), size=angle.size)
    found = cut(angle, np.arange(angle.size) / RATE, RATE).movements
    assert found.onset_s == pytest.approx([rest_s], abs=0.03)
    assert found.offset_s == pytest.approx([rest_s + 1.0], abs=0.03)


def test_a_long_gap_is_movement_only_between_movements() -> None:
    angle = moved((100, 5.0, 15.0))
    for gap in ((1.0, 3.0), (9.0, 11.0), (20.0, 22.0)):
        angle[(TIME >= gap[0]) & (TIME < gap[1])] = np.nan
    assert np.array(movements(angle)) == pytest.approx(np.array([(5.0, 15.0)]), abs=0.25)


def test_a_rest_without_any_noise_is_a_rest() -> None:
    """Poses that repeat to the last digit count as lost tracking: nothing is known there, and nothing moves."""
    trial = simulate_trial(frames=300, inversion=120, marker_noise_mm=0.0, rest_before_s=1.0, rest_after_s=1.0)
    phases = analyze(trial.recording).phases
    assert phases.onset_rows[0] == pytest.approx(100, abs=5)
    assert phases.offset_rows[-1] == pytest.approx(100 + 299, abs=5)


def test_noise_of_a_slow_trial_is_no_movement() -> None:
    """Fifteen seconds up and fifteen down, without a stop between."""
    trial = simulate_trial(
        frames=3000, inversion=1500, rest_before_s=5.0, rest_after_s=5.0, marker_noise_mm=0.5, seed=1
    )
    phases = analyze(trial.recording).phases
    assert phases.onset_rows / RATE == pytest.approx([5.0], abs=0.3)
    assert phases.offset_rows / RATE == pytest.approx([35.0], abs=0.3)
