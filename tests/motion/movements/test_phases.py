"""Movements between rests, and cycles: on motions whose times are known, and on real takes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.signal import find_peaks

from elbowscrew import Settings, analyze, read_recording, simulate_trial
from elbowscrew.motion.movements.phases import find_cycles, movement_phases, turning_points

Float = NDArray[np.float64]
RATE = 100.0
TIME = np.arange(3000) / RATE
# Minimum jerk: the speed over its highest is 16 tau^2 (1 - tau)^2, and 0.05 at this tau.
LATE = 0.5 - np.sqrt(0.25 - np.sqrt(0.05 / 16.0))


def moved(*steps: tuple[float, float, float]) -> Float:
    """Angle (rad) of moves by so many degrees from one time (s) to another, each with minimum jerk."""
    angle = np.zeros(TIME.size)
    for degrees, begin, end in steps:
        tau = np.clip((TIME - begin) / (end - begin), 0.0, 1.0)
        angle += np.radians(degrees) * tau**3 * (10.0 - 15.0 * tau + 6.0 * tau**2)
    return angle


def movements(angle: Float) -> list[tuple[float, float]]:
    """Times (s) of onset and offset."""
    phases = movement_phases(np.gradient(angle, TIME), TIME)
    return list(zip(TIME[phases.onset_rows].tolist(), TIME[phases.offset_rows].tolist(), strict=True))


def cycles(angle: Float) -> list[list[float]]:
    """Times (s) of start, inversion and end."""
    found: list[list[float]] = TIME[find_cycles(angle, movement_phases(np.gradient(angle, TIME), TIME))].tolist()
    return found


def test_a_movement_begins_and_ends_at_a_twentieth_of_its_speed() -> None:
    angle = moved((120, 5.0, 7.0), (-120, 12.0, 15.0))
    found = movements(angle)
    # The highest speed is that of the faster move; the slower one reaches two thirds of it.
    later = 0.5 - np.sqrt(0.25 - np.sqrt(0.05 * 1.5 / 16.0))
    expected = [(5 + 2 * LATE, 7 - 2 * LATE), (12 + 3 * later, 15 - 3 * later)]
    assert np.abs(np.array(found) - expected).max() < 0.03


def test_neither_the_size_nor_the_sense_of_the_speed_matters() -> None:
    velocity = np.gradient(moved((120, 5, 7), (-120, 12, 15), (20, 20, 21)), TIME)
    phases = movement_phases(velocity, TIME)
    for factor in (-1.0, 8.0, 0.125):
        other = movement_phases(factor * velocity, TIME)
        assert np.array_equal(other.moving, phases.moving)
        assert other.threshold == pytest.approx(abs(factor) * phases.threshold)


def test_a_motion_run_backward_has_the_same_phases_and_cycles() -> None:
    angle = moved((120, 5, 7), (-120, 7.2, 10), (90, 15, 16), (-90, 18, 20))
    phases = movement_phases(np.gradient(angle, TIME), TIME)
    back = movement_phases(np.gradient(angle[::-1], TIME), TIME)
    assert np.array_equal(back.moving[::-1], phases.moving)
    last = TIME.size - 1
    assert np.array_equal(last - back.offset_rows[::-1], phases.onset_rows)
    mirrored = last - find_cycles(angle[::-1].copy(), back)[::-1, ::-1]
    # A flat top has several rows of the largest angle to its last digits; the feet are the same ones.
    assert np.array_equal(mirrored[:, [0, 2]], find_cycles(angle, phases)[:, [0, 2]])


def test_the_rows_of_phases_and_their_mask_are_one() -> None:
    phases = movement_phases(np.gradient(moved((120, 5, 7), (-120, 12, 15)), TIME), TIME)
    mask = np.zeros(TIME.size, dtype=np.bool_)
    for onset, offset in zip(phases.onset_rows, phases.offset_rows, strict=True):
        mask[onset : offset + 1] = True
    assert np.array_equal(mask, phases.moving)


@pytest.mark.parametrize(("pause", "count"), [(0.0, 1), (0.1, 1), (0.6, 2)])
def test_a_rest_lasts_a_quarter_of_a_second(pause: float, count: int) -> None:
    """Below a twentieth of the speed are the pause and twice 6 % of a second: 0.12, 0.22 and 0.72 s."""
    assert len(movements(moved((60, 5, 6), (60, 6 + pause, 7 + pause)))) == count


def test_a_spike_is_no_movement() -> None:
    velocity = np.gradient(moved((120, 5, 7), (-120, 7, 9)), TIME)
    expected = movement_phases(velocity, TIME)
    velocity[2000:2005] = 30.0
    found = movement_phases(velocity, TIME)
    assert np.array_equal(found.moving, expected.moving)


def test_a_short_gap_in_a_movement_does_not_part_it() -> None:
    velocity = np.gradient(moved((120, 5, 7)), TIME)
    whole = movement_phases(velocity, TIME)
    velocity[580:600] = np.nan
    assert np.array_equal(movement_phases(velocity, TIME).moving, whole.moving)


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
    ("too small", [(4, 2, 3), (-4, 5, 6)], [], []),
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
        assert (start, end) == pytest.approx((begin, finish), abs=0.2)
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
    velocity = np.gradient(angle, TIME)
    velocity[540:560] = angle[540:560] = np.nan
    found = TIME[find_cycles(angle, movement_phases(velocity, TIME))]
    assert found[:, [0, 2]] == pytest.approx(np.array([(2.0, 10.0), (15.0, 19.0)]), abs=0.1)


REAL = [
    # file, arm, movements that must be among those found (s), cycles: start, inversion, end (s)
    ("v121_thomazach_20230627_0117", 1, [(3.58, 4.39)], []),
    ("v121_thomazach_20230627_0117", 2, [(3.59, 4.95), (9.83, 10.89)], []),
    (
        "v121_thomazach_20230706_122504", 1, [(13.57, 16.52), (19.50, 22.44), (25.43, 25.86)],
        [(13.56, 13.88, 14.50), (14.50, 15.04, 15.42), (15.42, 15.93, 16.52), (19.49, 19.82, 20.44),
         (20.44, 21.82, 22.45)],
    ),
    # Held flexed from 16.5 to 19.8 s, and the cycle goes on; the rise at 22 s falls by an eighth only and is none.
    (
        "v121_thomazach_20230706_122504", 2, [(13.64, 16.51), (19.77, 20.95)],
        [(14.03, 14.55, 15.02), (15.02, 16.26, 20.88)],
    ),
]  # fmt: skip


@pytest.mark.parametrize(("name", "proximal", "moves", "turns"), REAL)
def test_real_takes_as_they_look(
    real_data: Path, name: str, proximal: int, moves: list[tuple[float, float]], turns: list[tuple[float, float, float]]
) -> None:
    """Times read off the plotted angle."""
    recording = read_recording(real_data / "real" / f"{name}.csv")
    analysis = analyze(recording, Settings(proximal=f"Rigid Body {proximal}", distal=f"Rigid Body {proximal + 1}"))
    time = recording.time_s - recording.time_s[0]
    phases, found = analysis.phases, analysis.repetitions
    bounds = np.stack([time[phases.onset_rows], time[phases.offset_rows]], axis=1)
    for move in moves:
        assert np.abs(bounds - move).max(axis=1).min() < 0.06
    frames = np.stack([found.start_frame, found.inversion_frame, found.end_frame], axis=1)
    assert time[frames - recording.frame[0]] == pytest.approx(np.array(turns).reshape(-1, 3), abs=0.06)


@pytest.mark.parametrize("rest_s", [1.0, 60.0, 300.0])
def test_a_long_rest_does_not_hide_a_short_movement(rest_s: float) -> None:
    """The highest speed is not a share of the frames, which noise at rest has nearly all of."""
    turned = moved((90, 0.0, 0.5), (-90, 0.5, 1.0))[:101]
    velocity = np.concatenate([np.zeros(int(rest_s * RATE)), np.gradient(turned, TIME[:101])])
    velocity = np.concatenate([velocity, np.zeros(int(rest_s * RATE))])
    velocity += np.random.default_rng(1).normal(scale=np.radians(0.5), size=velocity.size)
    phases = movement_phases(velocity, np.arange(velocity.size) / RATE)
    assert phases.onset_rows / RATE == pytest.approx([rest_s + 0.03], abs=0.03)
    assert phases.offset_rows / RATE == pytest.approx([rest_s + 0.97], abs=0.03)


def test_a_long_gap_is_movement_only_between_movements() -> None:
    velocity = np.where((TIME >= 5.0) & (TIME < 15.0), 1.0, 0.0)
    for gap in ((2.0, 6.0), (7.0, 9.0), (14.0, 20.0), (25.0, 31.0), (0.0, 3.0)):
        velocity[(TIME >= gap[0]) & (TIME < gap[1])] = np.nan
    phases = movement_phases(velocity, TIME)
    assert TIME[phases.onset_rows] == pytest.approx([6.0])
    assert TIME[phases.offset_rows] == pytest.approx([13.99])


def test_a_rest_without_any_noise_is_a_rest() -> None:
    """Poses that repeat to the last digit count as lost tracking: nothing is known there, and nothing moves."""
    trial = simulate_trial(frames=300, inversion=120, marker_noise_mm=0.0, rest_before_s=1.0, rest_after_s=1.0)
    phases = analyze(trial.recording).phases
    assert phases.onset_rows[0] == pytest.approx(100, abs=25)
    assert phases.offset_rows[-1] == pytest.approx(100 + 299, abs=25)


def test_noise_of_a_slow_trial_is_no_movement() -> None:
    """Fifteen seconds up and fifteen down: the noise at rest exceeds a twentieth of the speed now and then."""
    trial = simulate_trial(
        frames=3000, inversion=1500, rest_before_s=5.0, rest_after_s=5.0, marker_noise_mm=0.5, seed=1
    )
    phases = analyze(trial.recording).phases
    assert phases.onset_rows / RATE == pytest.approx([5.0 + 15.0 * LATE, 20.0 + 15.0 * LATE], abs=0.3)
    assert phases.offset_rows / RATE == pytest.approx([20.0 - 15.0 * LATE, 35.0 - 15.0 * LATE], abs=0.3)
