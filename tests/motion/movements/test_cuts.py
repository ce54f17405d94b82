from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from elbowscrew.geometry.arrays import Float
from elbowscrew.motion.movements import feet, foot_laws
from elbowscrew.motion.movements.boundaries import Cuts
from elbowscrew.motion.movements.cuts import cut
from elbowscrew.motion.movements.swings import _by_local_rule, _prominences, lowpass_series, noise_of

sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "benchmarks"))

from cycles import LAWS, NOISES, SET_UPS, Motion, Trial, battery, coverage, likeness

RATE = 100.0


def still() -> np.random.Generator:
    return np.random.default_rng(7)


def cuts_of(motion: Motion, noise: float = 0.0, rate_hz: float = RATE) -> Cuts:
    return motion.trial(rate_hz, noise, still()).found()


def several(hold: float = 0.0, rest: float = 0.6, tops: tuple[float, ...] = (90.0, 84.0, 95.0, 88.0)) -> Motion:
    motion = Motion().hold(0.7)
    for top in tops:
        motion.cycle(top, 0.8, hold).hold(rest)
    return motion.hold(0.5)


def rotations() -> list[Trial]:
    return [
        several(hold, rest).trial(RATE, noise, still())
        for hold, rest, noise in ((0.0, 0.0, 0.2), (0.5, 0.6, 0.2), (0.0, 1.0, 0.5), (0.3, 0.1, 0.0))
    ]


@pytest.mark.parametrize("trial", rotations())
def test_later_is_later(trial: Trial) -> None:
    found = trial.found()
    later = cut(np.radians(trial.angle), trial.time_s + 512.0, RATE)
    assert np.array_equal(later.cycles.times_s, found.cycles.times_s)
    assert np.array_equal(later.movements.onset_s, found.movements.onset_s)


@pytest.mark.parametrize("trial", rotations())
def test_backward_is_the_mirror_image(trial: Trial) -> None:
    found = trial.found()
    back = trial._replace(angle=trial.angle[::-1].copy()).found()
    whole = trial.time_s[-1]
    assert np.allclose(whole - back.cycles.times_s[::-1, ::-1], found.cycles.times_s, rtol=0.0, atol=1e-9)
    assert np.allclose(whole - back.movements.offset_s[::-1], found.movements.onset_s, rtol=0.0, atol=1e-9)
    assert np.allclose(back.cycles.end_sd_s[::-1], found.cycles.start_sd_s, rtol=1e-9)


@pytest.mark.parametrize("trial", rotations())
def test_a_constant_and_a_scale_of_time_change_nothing_but_the_time(trial: Trial) -> None:
    found = trial.found()
    moved = cut(np.radians(trial.angle + 77.0), trial.time_s, RATE)
    assert np.allclose(moved.cycles.times_s, found.cycles.times_s, rtol=0.0, atol=1e-9)
    # Half as fast at half the rate: the same samples. The cut-off is at its 2 Hz, so the filter's share differs.
    slow = cut(np.radians(trial.angle), 1.25 * trial.time_s, RATE / 1.25)
    assert slow.cycles.times_s.shape == found.cycles.times_s.shape
    assert np.allclose(slow.cycles.times_s / 1.25, found.cycles.times_s, rtol=0.0, atol=0.012)


@pytest.mark.parametrize("noise", [0.0, 0.2, 0.5])
@pytest.mark.parametrize(("hold", "rest"), [(0.0, 0.0), (0.0, 0.6), (0.5, 0.6)])
def test_minimum_jerk_cycles_are_cut_within_their_uncertainty(noise: float, hold: float, rest: float) -> None:
    motion = several(hold, rest)
    found = cuts_of(motion, noise).cycles
    truth = np.array(motion.cycles)
    sd = np.column_stack([found.start_sd_s, found.inversion_sd_s, found.end_sd_s])
    assert np.all(np.abs(found.times_s - truth) < 3.0 * np.maximum(sd, 1e-3))
    assert np.mean(found.end_s - found.start_s) == pytest.approx(np.mean(truth[:, 2] - truth[:, 0]), rel=0.01)
    assert not found.incomplete.any()
    assert not found.uncertain.any()


def test_a_flat_top_turns_in_its_middle() -> None:
    motion = several(hold=1.3)
    found = cuts_of(motion, 0.3).cycles
    assert found.inversion_s == pytest.approx(np.array(motion.cycles)[:, 1], abs=0.02)


def test_fatigue_and_small_noisy_cycles_are_all_counted() -> None:
    tired = Motion().hold(0.5)
    for top in (120.0, 90.0, 60.0, 35.0, 30.0):
        tired.cycle(top, 0.8).hold(0.2)
    assert cuts_of(tired.hold(0.3), 0.05).cycles.start_s.size == 5
    small = several(tops=(12.0,) * 5, rest=0.1)
    for seed in range(20):
        assert small.trial(RATE, 0.8, np.random.default_rng(seed)).found().cycles.start_s.size == 5


def test_a_stop_on_the_way_parts_movements_and_is_no_turn() -> None:
    motion = Motion().hold(0.6).to(45.0, 0.6).hold(0.8).to(100.0, 0.6).hold(0.9).to(0.0, 0.9).hold(0.5)
    found = cuts_of(motion, 0.1)
    moves = found.movements
    assert moves.onset_s == pytest.approx([0.6, 2.0, 3.5], abs=0.03)
    assert moves.offset_s == pytest.approx([1.2, 2.6, 4.4], abs=0.03)
    assert moves.reverses.tolist() == [False, True]
    assert moves.outward.tolist() == [True, True, False]
    assert found.cycles.times_s == pytest.approx(np.array([[0.6, 3.05, 4.4]]), abs=0.03)


def test_a_recording_that_begins_on_the_way_has_an_incomplete_cycle() -> None:
    motion = Motion(50.0).to(90.0, 0.6).to(0.0, 0.8).cycle(90.0, 0.8)
    found = cuts_of(motion.to(60.0, 0.5), 0.05).cycles
    assert found.incomplete.tolist() == [True, False]
    assert found.start_s[0] < 0.1


def test_a_stop_at_the_limit_of_a_rest_is_in_doubt() -> None:
    found = cuts_of(several(rest=0.25), 0.3)
    assert any("rest-in-doubt" in reasons for reasons in found.cycles.end_reasons)


def test_a_swing_hardly_large_enough_is_in_doubt_and_one_asked_for_is_not() -> None:
    tiny = several(tops=(2.5,) * 4)
    assert all("small-swing" in reasons for reasons in cut_with_swing(tiny, None).cycles.inversion_reasons)
    assert not cut_with_swing(tiny, 1.5).cycles.uncertain.any()
    motion = several(tops=(90.0, 11.0, 90.0))
    assert [cut_with_swing(motion, swing).cycles.start_s.size for swing in (None, 8.0, 20.0)] == [2, 3, 2]


def cut_with_swing(motion: Motion, degrees: float | None) -> Cuts:
    trial = motion.trial(RATE, 0.02, still())
    swing = None if degrees is None else float(np.radians(degrees))
    return cut(np.radians(trial.angle), trial.time_s, RATE, least_swing=swing)


def test_a_cut_in_a_gap_is_in_doubt() -> None:
    trial = several().trial(RATE, 0.05, still())
    trial.angle[(trial.time_s > 1.3) & (trial.time_s < 1.7)] = np.nan  # the first top, at 1.5 s
    found = trial.found().cycles
    assert found.start_s.size == 4
    assert "gap" in found.inversion_reasons[0]
    assert not found.inversion_reasons[1]


@pytest.mark.parametrize("length", [0.2, 0.4, 0.7])
def test_what_is_told_from_a_gap_is_known_no_better_than_the_gap_allows(length: float) -> None:
    """Cycle 2 lasts from 2.9 to 4.5 s: a straight line over a gap puts its foot up to 0.4 s outside the gap."""
    for begin in np.arange(2.3, 4.6, 0.1):
        trial = several().trial(RATE, 0.05, still())
        trial.angle[(trial.time_s > begin) & (trial.time_s < begin + length)] = np.nan
        found = trial.found()
        if found.cycles.start_s.size != 4:
            assert len(found.hidden_s)
            continue
        away = np.abs(found.cycles.times_s[1] - [2.9, 3.7, 4.5])
        cycles = found.cycles
        sd = np.array([cycles.start_sd_s[1], cycles.inversion_sd_s[1], cycles.end_sd_s[1]])
        told = ["gap" in codes[1] for codes in (cycles.start_reasons, cycles.inversion_reasons, cycles.end_reasons)]
        assert (away <= np.where(told, 2.0, 4.0) * sd + 0.02).all()


def test_a_fast_burst_in_a_slow_motion_is_told() -> None:
    motion = Motion().hold(0.5)
    for _ in range(4):
        motion.cycle(60.0, 5.0)
    for _ in range(6):
        motion.to(25.0, 0.12).to(0.0, 0.12)
    found = cuts_of(motion.hold(1.0).cycle(60.0, 5.0).hold(1.0), 0.02)
    assert all("fast" in reasons for reasons in found.cycles.start_reasons)


def test_nothing_known_is_no_movement() -> None:
    found = cut(np.full(50, np.nan), np.arange(50) / RATE, RATE)
    assert found.cycles.times_s.shape == (0, 3)
    assert found.movements.onset_s.size == 0
    still_joint = cut(np.zeros(50), np.arange(50) / RATE, RATE)
    assert still_joint.cycles.times_s.shape == (0, 3)
    assert still_joint.movements.onset_s.size == 0


def test_an_uneven_clock_changes_little() -> None:
    motion = several()
    whole = motion.trial(RATE, 0.0, still())
    kept = np.r_[0:250:1, 250 : whole.angle.size : 2]
    found = cut(np.radians(whole.angle[kept]), whole.time_s[kept], RATE)
    assert np.allclose(found.cycles.times_s, whole.found().cycles.times_s, rtol=0.0, atol=0.01)
    rows = found.rows(found.cycles.start_s, whole.time_s[kept])
    assert np.allclose(np.interp(rows, np.arange(kept.size), whole.time_s[kept]), found.cycles.start_s)


def test_the_local_rule_takes_out_the_smallest_again_and_again() -> None:
    """Beside the rule as it is worded, which looks at all turns after each one."""
    random = np.random.default_rng(3)
    for _ in range(300):
        count = int(random.integers(4, 40))
        steps = np.where(np.arange(count) % 2, 1.0, -1.0) * random.gamma(0.7, 10.0, count)
        values = np.cumsum(steps)
        left, rest = list(range(count)), values.copy()
        while len(left) > 3:
            _, ratio = _prominences(rest)
            bad = np.flatnonzero(np.minimum(ratio[1:-2], ratio[2:-1]) < 0.375)
            if not bad.size:
                break
            k = int(bad[np.argmin(np.abs(np.diff(rest))[1:-1][bad])]) + 1
            del left[k : k + 2]
            rest = np.delete(rest, [k, k + 1])
        assert _by_local_rule(np.arange(count), values)[0].tolist() == left


def test_the_filter_is_scipy_s() -> None:
    signal = pytest.importorskip("scipy.signal")
    random = np.random.default_rng(5)
    series = np.cumsum(random.normal(0.0, 1.0, 900))
    corner = 4.0 / (np.sqrt(2.0) - 1.0) ** 0.25  # about: the correction is in the tangent
    corner = np.arctan(np.tan(np.pi * 4.0 / RATE) / (np.sqrt(2.0) - 1.0) ** 0.25) * RATE / np.pi
    b, a = signal.butter(2, corner, fs=RATE)
    expected = signal.filtfilt(b, a, series, padlen=75)
    assert np.abs(lowpass_series(series, RATE, 4.0) - expected).max() < 0.02 * np.ptp(series)
    assert np.abs(lowpass_series(series, RATE, 4.0) - expected)[100:-100].max() < 1e-3


def test_noise_by_third_differences() -> None:
    random = np.random.default_rng(2)
    slow = np.sin(np.linspace(0.0, 20.0, 4000))
    assert noise_of(slow + random.normal(0.0, 0.01, 4000)) == pytest.approx(0.01, rel=0.05)


def test_what_the_filter_makes_of_a_stroke_is_taken_back() -> None:
    for kappa in (0.2, 0.25, 0.3, 0.4, 0.6, 1.0):  # at 2 Hz
        time = np.arange(-4.0, 4.0 + 2.0 * kappa, 0.0025)
        x = np.clip(time / (2.0 * kappa), 0.0, 1.0)
        smooth = lowpass_series(10.0 * x**3 - 15.0 * x**4 + 6.0 * x**5, 400.0, 2.0)
        inner = smooth[600:-600]
        low, top = np.array([int(np.argmin(inner[: inner.size // 2]))]), np.array([int(np.argmax(inner))])
        found = feet.feet_of(inner, low, top, inner[low], inner[top], 0.0, 2.0 / 400.0)
        assert found.low[0] / 400.0 == pytest.approx(kappa, rel=0.01)
        assert found.top[0] / 400.0 == pytest.approx(kappa, rel=0.01)


def test_the_battery_of_nasty_signals() -> None:
    wrong = {kind: sum(found != true for found, true, _ in pairs) for kind, pairs in battery(3).items()}
    assert sum(wrong.values()) <= 1, wrong  # at most 3 % of 42


@pytest.mark.parametrize("set_up", SET_UPS)
def test_equal_cycles_are_cut_equally(set_up: str) -> None:
    cases = [likeness(set_up, noise, seed) for noise in NOISES for seed in range(2)]
    assert len({(case.cycles, case.movements) for case in cases}) == 1
    assert np.median([case.ratio for case in cases]) <= 1.3
    assert max(case.ratio for case in cases) <= 1.6
    assert np.mean([case.duration for case in cases]) == pytest.approx(1.0, abs=0.01)


def test_the_stated_uncertainty_covers_minimum_jerk() -> None:
    found = coverage(120)
    inside = np.abs(found.error) <= 1.96 * found.sd
    assert ((inside.mean(axis=0) >= 0.90) & (inside.mean(axis=0) <= 0.985)).all(), inside.mean(axis=0)
    assert found.told.mean() < 0.1


def test_the_stated_uncertainty_covers_strokes_back_at_another_speed() -> None:
    found = coverage(80, first=900, uneven=True)
    inside = (np.abs(found.error) <= 1.96 * found.sd) | (np.abs(found.error) < 1e-3)
    assert inside.mean(axis=0).min() >= 0.9, inside.mean(axis=0)


@pytest.mark.parametrize("back", [0.12, 0.2, 0.4])
def test_a_fast_stroke_moves_no_cut_of_the_slow_one_beside_it(back: float) -> None:
    motion = Motion().hold(0.5)
    for _ in range(3):
        motion.cycle(110.0, 1.2, 0.1, back).hold(0.5)
    for rate_hz in (100.0, 250.0):
        found = cuts_of(motion, 0.15, rate_hz).cycles
        assert np.abs(found.times_s - np.array(motion.cycles)).max() < 0.012


@pytest.mark.parametrize(("top", "rate_hz", "noise"), [(8.0, 60.0, 0.8), (6.0, 100.0, 0.6)])
def test_noise_on_a_long_top_does_not_move_its_middle(top: float, rate_hz: float, noise: float) -> None:
    motion = Motion().hold(0.5)
    for _ in range(3):
        motion.cycle(top, 0.3, 1.0).hold(0.6)
    for seed in range(10, 20):
        found = motion.trial(rate_hz, noise, np.random.default_rng([5, seed])).found().cycles
        off = np.abs(found.inversion_s - np.array(motion.cycles)[:, 1])
        assert (off < 3.0 * found.inversion_sd_s).all(), (off, found.inversion_sd_s)


@pytest.mark.parametrize("law", LAWS)
def test_a_foot_by_another_law_is_right_or_in_doubt(law: str) -> None:
    found = coverage(60, first=300, law=LAWS[law])
    inside = np.abs(found.error) <= 1.96 * found.sd
    assert inside.mean(axis=0).min() >= 0.75
    assert (inside | found.told).mean(axis=0).min() >= 0.9
    assert np.quantile(np.abs(found.error), 0.95) < 0.1


def test_the_stated_uncertainty_covers_harmonic_movements() -> None:
    found = coverage(120, first=700, law=LAWS["harmonic"])
    inside = (np.abs(found.error) <= 1.96 * found.sd)[:, [0, 2]]
    assert 0.90 <= inside.mean() <= 0.985


def test_robots_begin_at_once() -> None:
    motion = Motion().hold(1.0)
    for _ in range(3):
        motion.to(70.0, 1.0).hold(1.0).to(0.0, 1.5).hold(1.0)
    moves = motion.trial(RATE, 0.1, still(), LAWS["constant speed"]).found().movements
    assert moves.onset_s == pytest.approx([1.0, 3.0, 5.5, 7.5, 10.0, 12.0], abs=0.05)
    assert moves.offset_s == pytest.approx([2.0, 4.5, 6.5, 9.0, 11.0, 13.5], abs=0.06)


@pytest.mark.parametrize("decay_s", [0.2, 0.4, 0.6])
def test_a_motion_that_ends_by_no_law_is_in_doubt(decay_s: float) -> None:
    """It begins at its highest speed, and creeps to its end."""
    time = np.arange(600) / RATE
    angle = np.where(time > 1.0, 60.0 * (1.0 - np.exp(-(time - 1.0) / decay_s)), 0.0)
    moves = cut(np.radians(angle + still().normal(0.0, 0.02, time.size)), time, RATE).movements
    assert "law" in moves.onset_reasons[0]
    assert "law" in moves.offset_reasons[0]
    assert abs(moves.onset_s[0] - 1.0) < 1.96 * moves.onset_sd_s[0]
    assert moves.offset_sd_s[0] > 0.25 * decay_s


@pytest.mark.parametrize("frames", [50, 200, 500])
def test_a_record_that_begins_and_ends_amid_the_motion_is_moving_all_along(frames: int) -> None:
    angle = np.linspace(0.0, 2.0, frames) + still().normal(0.0, 0.002, frames)
    moves = cut(angle, np.arange(frames) / RATE, RATE).movements
    assert (moves.onset_s.tolist(), moves.offset_s.tolist()) == ([0.0], [pytest.approx((frames - 1) / RATE)])


@pytest.mark.parametrize("share", [0.02, 0.037, 0.1])
def test_laws_by_their_closed_forms(share: float) -> None:
    special = pytest.importorskip("scipy.special")
    ratios, scales = foot_laws._laws(share)
    levels = np.array([share, 0.25])

    def ratio_and_scale(at: Float) -> tuple[float, float]:
        return float((0.5 - at[0]) / (0.5 - at[1])), float(0.5 / (0.5 - at[0]))

    known = {
        0: special.betaincinv(3.0, 3.0, levels),
        2: np.arccos(1.0 - 2.0 * levels) / np.pi,
        3: levels,  # constant speed
        8: np.where(levels < 0.5 * 0.1 / 0.9, np.sqrt(2.0 * 0.1 * 0.9 * levels), 0.9 * levels + 0.05),  # ramps of 10 %
    }
    assert foot_laws._RAMPS[8 - 3] == pytest.approx(0.1)
    for k, times in known.items():
        assert (ratios[k], scales[k]) == pytest.approx(ratio_and_scale(times), abs=2e-4)
    cycloid = 0.5 - 0.5 / scales[1]
    assert cycloid - np.sin(2.0 * np.pi * cycloid) / (2.0 * np.pi) == pytest.approx(share, abs=1e-4)


@pytest.mark.parametrize("ratio", [0.26, 0.28, 0.36, 0.4])
@pytest.mark.parametrize("noise", [0.2, 1.5])
def test_whether_small_strokes_between_large_ones_count_is_told_to_be_uncertain(ratio: float, noise: float) -> None:
    """Tops of 90 and 25 deg in turn may be eight cycles, or four with a hesitation each."""
    for seed in range(4):
        motion = Motion().hold(0.5)
        for k in range(8):
            motion.to(90.0 * (ratio if k % 2 else 1.0), 0.7).to(0.0, 0.7)
        found = motion.hold(0.5).trial(100.0, noise, np.random.default_rng(seed)).found().cycles
        assert any("small-beside-neighbors" in codes for codes in found.inversion_reasons + found.start_reasons)
