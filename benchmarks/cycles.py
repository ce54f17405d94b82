"""How well cycles, movements and their times are found, on seeded rotations with known truth.

Run ``python benchmarks/cycles.py [--seeds 10] [--first 0]``: a battery of nasty signals (number of cycles), identical
cycles (largest standard deviation of the time-normalized curve beside the one at the true cuts, constancy of the
counts), and the coverage of the stated uncertainty of the cuts, for movements of several laws. ``--first`` takes other
seeds.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from elbowscrew.geometry.arrays import Bool, Float
from elbowscrew.motion.movements.boundaries import Cuts
from elbowscrew.motion.movements.cuts import cut

Random = np.random.Generator


class Trial(NamedTuple):
    """A rotation (N,) in degrees, its rate, and the true start, inversion and end of its cycles (C, 3), seconds."""

    angle: Float
    rate_hz: float
    truth: Float

    @property
    def time_s(self) -> Float:
        return np.arange(self.angle.size) / self.rate_hz

    def found(self) -> Cuts:
        return cut(np.radians(self.angle), self.time_s, self.rate_hz)


Law = Callable[[Float], Float]


def minimum_jerk(x: Float) -> Float:
    return 10.0 * x**3 - 15.0 * x**4 + 6.0 * x**5


def cycloidal(x: Float) -> Float:
    return x - np.sin(2.0 * np.pi * x) / (2.0 * np.pi)


def harmonic(x: Float) -> Float:
    return 0.5 - 0.5 * np.cos(np.pi * x)


def constant(x: Float) -> Float:
    return x


def ramps(share: float) -> Law:
    """Speed that rises and falls evenly over such shares of the time, and is constant between."""

    def law(x: Float) -> Float:
        near = np.minimum(x, 1.0 - x)
        low = np.where(near < share, 0.5 * near**2 / share, near - 0.5 * share) / (1.0 - share)
        return np.where(x <= 0.5, low, 1.0 - low)

    return law


LAWS: dict[str, Law] = {
    "minimum jerk": minimum_jerk,
    "cycloidal": cycloidal,
    "harmonic": harmonic,
    "speed ramps of 20 %": ramps(0.2),
    "speed ramps of 10 %": ramps(0.1),
    "constant speed": constant,
}


class Motion:
    """A rotation put together of strokes by one law and holds."""

    def __init__(self, start: float = 0.0) -> None:
        self._strokes: list[tuple[float, float, float, float]] = []
        self.now = 0.0
        self.level = start
        self._start = start
        self.cycles: list[tuple[float, float, float]] = []

    def to(self, level: float, duration: float) -> Motion:
        self._strokes.append((self.now, duration, self.level, level))
        self.now, self.level = self.now + duration, level
        return self

    def hold(self, duration: float) -> Motion:
        self.now += duration
        return self

    def cycle(self, top: float, duration: float, hold: float = 0.0, back: float | None = None) -> Motion:
        """Out and back; the way back takes as long as the way out by itself."""
        start = self.now
        self.to(top, duration).hold(hold)
        turn = self.now - 0.5 * hold
        self.to(0.0, duration if back is None else back)
        self.cycles.append((start, turn, self.now))
        return self

    def sampled(self, rate_hz: float, law: Law = minimum_jerk) -> Float:
        time = np.arange(int(self.now * rate_hz) + 1) / rate_hz
        angle = np.full(time.size, self._start)
        for begin, duration, low, high in self._strokes:
            x = np.clip((time - begin) / duration, 0.0, 1.0)
            angle += (high - low) * law(x)
        return angle

    def trial(self, rate_hz: float, noise: float, random: Random, law: Law = minimum_jerk) -> Trial:
        angle = self.sampled(rate_hz, law)
        return Trial(angle + random.normal(0.0, noise, angle.size), rate_hz, np.array(self.cycles).reshape(-1, 3))


def _plain(random: Random, count: int) -> Motion:
    top, duration = random.uniform(50.0, 120.0), random.uniform(0.5, 1.2)
    motion = Motion().hold(random.uniform(0.2, 1.0))
    for _ in range(count):
        spread = 1.0 + random.normal(0.0, 0.05, 2)
        motion.cycle(top * spread[0], duration * spread[1]).hold(random.choice([0.0, 0.1, 0.6]))
    return motion.hold(random.uniform(0.2, 1.0))


def pauses(random: Random) -> tuple[Motion, int]:
    count = int(random.integers(3, 8))
    motion, top = Motion().hold(0.5), random.uniform(50.0, 120.0)
    for _ in range(count):
        share = random.uniform(0.3, 0.7, 2)
        motion.to(share[0] * top, 0.5).hold(random.uniform(0.2, 1.5)).to(top, 0.5)
        motion.to(share[1] * top, 0.5).hold(random.uniform(0.2, 1.5)).to(0.0, 0.5)
    return motion.hold(0.5), count


def plateaus(random: Random) -> tuple[Motion, int]:
    count = int(random.integers(3, 8))
    motion, top = Motion().hold(0.5), random.uniform(50.0, 120.0)
    for _ in range(count):
        sag = random.uniform(0.0, 0.08) * top
        motion.to(top, 0.7).to(top - sag, random.uniform(0.3, 2.0)).to(0.0, 0.7).hold(random.uniform(0.0, 0.5))
    return motion.hold(0.5), count


def tremor(random: Random) -> tuple[Motion, int]:
    count = int(random.integers(3, 8))
    return _plain(random, count), count  # the tremor is put on in `battery`


def drift(random: Random) -> tuple[Motion, int]:
    count = int(random.integers(4, 9))
    step = random.uniform(-6.0, 6.0)
    motion, top = Motion().hold(0.5), random.uniform(50.0, 120.0)
    for k in range(count):
        motion.to(top + k * step, 0.8).to((k + 1) * step, 0.8)
    return motion.hold(0.5), count


def fatigue(random: Random) -> tuple[Motion, int]:
    count = int(random.integers(4, 9))
    tops = random.uniform(90.0, 130.0) * np.geomspace(1.0, random.uniform(0.2, 0.5), count)
    motion = Motion().hold(0.5)
    for top in tops.tolist():
        motion.to(top, 0.8).to(0.0, 0.8).hold(random.choice([0.0, 0.4]))
    return motion.hold(0.5), count


def incomplete_returns(random: Random) -> tuple[Motion, int]:
    count = int(random.integers(3, 8))
    motion, top = Motion().hold(0.5), random.uniform(60.0, 120.0)
    for k in range(count):
        low = 0.0 if k == count - 1 else random.uniform(0.1, 0.45) * top
        motion.to(top * random.uniform(0.93, 1.07), 0.7).to(low, 0.7)
    return motion.hold(0.5), count


def double_tops(random: Random) -> tuple[Motion, int]:
    count = int(random.integers(3, 8))
    motion, top = Motion().hold(0.5), random.uniform(60.0, 120.0)
    for _ in range(count):
        dip = random.uniform(0.05, 0.25) * top
        motion.to(top, 0.7).to(top - dip, 0.35).to(top * random.uniform(0.95, 1.03), 0.35).to(0.0, 0.7)
    return motion.hold(0.5), count


def alternation(random: Random) -> tuple[Motion, int]:
    count = int(random.integers(4, 10))
    small = random.uniform(0.5, 0.7)
    motion, top = Motion().hold(0.5), random.uniform(60.0, 120.0)
    for k in range(count):
        motion.to(top * (small if k % 2 else 1.0), 0.7).to(0.0, 0.7)
    return motion.hold(0.5), count


def slow_and_jerky(random: Random) -> tuple[Motion, int]:
    count = int(random.integers(2, 5))
    motion, top = Motion().hold(1.0), random.uniform(60.0, 120.0)
    for _ in range(count):
        steps = np.sort(random.uniform(0.1, 0.9, int(random.integers(3, 8)))) * top
        for level in (*steps.tolist(), top, *steps[::-1].tolist(), 0.0):
            motion.to(level, random.uniform(0.3, 0.9)).hold(random.uniform(0.0, 0.4))
    return motion.hold(1.0), count


def fast(random: Random) -> tuple[Motion, int]:
    count = int(random.integers(4, 12))
    motion, top, duration = Motion().hold(0.3), random.uniform(50.0, 100.0), random.uniform(0.15, 0.3)
    for _ in range(count):
        motion.to(top, duration).to(0.0, duration).hold(random.choice([0.0, 0.1]))
    return motion.hold(0.3), count


def noisy_small(random: Random) -> tuple[Motion, int]:
    count = int(random.integers(3, 8))
    motion, top, duration = Motion().hold(0.5), random.uniform(10.0, 15.0), random.uniform(0.6, 1.2)
    for _ in range(count):
        motion.to(top, duration).to(0.0, duration).hold(random.choice([0.0, 0.3]))
    return motion.hold(0.5), count  # with much noise, in `battery`


def half_cycles(random: Random) -> tuple[Motion, int]:
    count = int(random.integers(2, 7))
    top = random.uniform(50.0, 120.0)
    motion = Motion(top).hold(0.3).to(0.0, 0.8)
    for _ in range(count):
        motion.to(top, 0.8).to(0.0, 0.8)
    if random.random() < 0.5:
        motion.to(top, 0.8)
    return motion.hold(0.3), count


def rests(random: Random) -> tuple[Motion, int]:
    count = int(random.integers(2, 6))
    motion = Motion().hold(random.uniform(0.0, 4.0))
    for _ in range(count):
        motion.to(random.uniform(70.0, 110.0), random.uniform(0.4, 1.5)).to(0.0, random.uniform(0.4, 1.5))
        motion.hold(random.uniform(0.5, 6.0))
    return motion, count


def no_return(random: Random) -> tuple[Motion, int]:
    motion = Motion().hold(random.uniform(0.2, 1.0)).to(random.uniform(40.0, 120.0), random.uniform(0.5, 2.0))
    return motion.hold(random.uniform(0.2, 1.0)), 0


KINDS: dict[str, Callable[[Random], tuple[Motion, int]]] = {
    "pauses": pauses,
    "plateaus": plateaus,
    "tremor": tremor,
    "drift": drift,
    "fatigue": fatigue,
    "incomplete returns": incomplete_returns,
    "double tops": double_tops,
    "alternation": alternation,
    "slow and jerky": slow_and_jerky,
    "fast": fast,
    "noisy small": noisy_small,
    "half cycles": half_cycles,
    "rests": rests,
    "no return": no_return,
}


def battery(seeds: int, first: int = 0) -> dict[str, list[tuple[int, int, bool]]]:
    """Cycles found, true ones, and whether a doubt is told, of every kind and seed."""
    results: dict[str, list[tuple[int, int, bool]]] = {kind: [] for kind in KINDS}
    for number, (kind, make) in enumerate(KINDS.items()):
        for seed in range(first, first + seeds):
            random = np.random.default_rng([14, number, seed])
            motion, count = make(random)
            rate_hz = float(random.choice([60.0, 100.0, 200.0]))
            noise = random.uniform(0.4, 0.8) if kind == "noisy small" else random.choice([0.02, 0.1, 0.4])
            trial = motion.trial(rate_hz, noise, random)
            angle = trial.angle
            if kind == "tremor":
                shake = random.uniform(1.0, 3.0) * np.sin(2.0 * np.pi * random.uniform(4.0, 8.0) * trial.time_s)
                angle = angle + shake
            found = trial._replace(angle=angle).found().cycles
            results[kind].append((found.start_s.size, count, bool(found.uncertain.any())))
    return results


SET_UPS: dict[str, tuple[float, float, float, float]] = {
    # top (deg), duration of a stroke, hold at the top, rest between (s)
    "to and fro": (90.0, 0.8, 0.0, 0.0),
    "rests": (90.0, 0.7, 0.0, 1.0),
    "flat tops": (100.0, 0.8, 0.6, 0.1),
    "small": (15.0, 0.8, 0.0, 0.6),
    "fast": (90.0, 0.3, 0.0, 0.1),
    "slow": (120.0, 2.5, 0.4, 0.5),
}
NOISES = (0.05, 0.2, 0.6)


def identical(set_up: str, noise: float, seed: int, count: int = 8) -> Trial:
    """Equal cycles under white noise (deg), 100 frames a second."""
    top, duration, hold, rest = SET_UPS[set_up]
    motion = Motion().hold(0.6)
    for _ in range(count):
        motion.cycle(top, duration, hold).hold(rest)
    return motion.hold(0.6).trial(100.0, noise, np.random.default_rng([14, seed]))


def largest_sd(trial: Trial, starts: Float, ends: Float) -> float:
    """Largest standard deviation of the time-normalized curves, degrees."""
    share = np.linspace(0.0, 1.0, 101)
    curves = [np.interp(a + share * (b - a), trial.time_s, trial.angle) for a, b in zip(starts, ends, strict=True)]
    return float(np.std(curves, axis=0, ddof=1).max())


class Likeness(NamedTuple):
    """Ratio of the largest standard deviations, numbers of cycles and movements, mean duration over the true one."""

    ratio: float
    cycles: int
    movements: int
    duration: float


def likeness(set_up: str, noise: float, seed: int) -> Likeness:
    trial = identical(set_up, noise, seed)
    cuts = trial.found()
    found, truth = cuts.cycles, trial.truth
    ratio = largest_sd(trial, found.start_s, found.end_s) / largest_sd(trial, truth[:, 0], truth[:, 2])
    duration = float(np.mean(found.end_s - found.start_s) / np.mean(truth[:, 2] - truth[:, 0]))
    return Likeness(ratio, found.start_s.size, cuts.movements.onset_s.size, duration)


class Covered(NamedTuple):
    """Errors (s) of starts, inversions and ends, shape (K, 3), with their stated sd and whether a doubt is told."""

    error: Float
    sd: Float
    told: Bool


def coverage(
    seeds: int, first: int = 0, law: Law = minimum_jerk, noises: tuple[float, ...] = NOISES, *, uneven: bool = False
) -> Covered:
    """Cycles of all speeds by one law, some with rests between them, and what is stated of their cuts.

    Uneven ones go out in 0.12 to 0.8 s and back three times as fast to eight times as slowly.
    """
    parts: list[Covered] = []
    for seed in range(first, first + seeds):
        random = np.random.default_rng([15, seed])
        top, duration = random.uniform(30.0, 130.0), random.uniform(0.5, 2.0)
        motion = Motion().hold(random.uniform(0.3, 1.0))
        rest = random.choice([0.0, 0.1, 0.5, 1.5])
        times = 1.0
        if uneven:
            duration, times = random.uniform(0.12, 0.8), np.exp(random.uniform(np.log(1.0 / 3.0), np.log(8.0)))
        for _ in range(int(random.integers(1, 8))):
            spread = 1.0 + random.normal(0.0, 0.06, 2)
            out, hold = duration * spread[1], random.choice([0.0, 0.3])
            motion.cycle(top * spread[0], out, hold, float(np.clip(times * out, 0.1, 3.0))).hold(rest)
        trial = motion.hold(0.5).trial(100.0, random.choice(noises), random, law)
        found = trial.found().cycles
        if found.start_s.size == len(trial.truth):
            sd = np.column_stack([found.start_sd_s, found.inversion_sd_s, found.end_sd_s])
            parts.append(Covered(found.times_s - trial.truth, sd, found.uncertain))
    return Covered(*(np.concatenate(values) for values in zip(*parts, strict=True)))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=10, help="trials of each kind")
    parser.add_argument("--first", type=int, default=0, help="first seed")
    options = parser.parse_args()
    seeds, first = options.seeds, options.first
    results = battery(seeds, first)
    wrong = {kind: sum(found != true for found, true, _ in pairs) for kind, pairs in results.items()}
    silent = sum(found != true and not told for pairs in results.values() for found, true, told in pairs)
    told = sum(doubt for pairs in results.values() for *_, doubt in pairs)
    total = seeds * len(KINDS)
    print(f"battery: {sum(wrong.values())} of {total} wrong, {silent} without a doubt told; doubts told in {told}")
    print("  " + ", ".join(f"{kind} {number}" for kind, number in wrong.items() if number))
    ratios = []
    for set_up in SET_UPS:
        for noise in NOISES:
            cases = [likeness(set_up, noise, seed) for seed in range(first, first + seeds)]
            ratio = np.array([case.ratio for case in cases])
            ratios.append(ratio)
            counts = {(case.cycles, case.movements) for case in cases}
            duration = np.mean([case.duration for case in cases])
            print(f"{set_up:>12} {noise:5.2f} deg: sd {ratio.max():.2f}, {counts}, duration {duration:.3f}")
    every = np.concatenate(ratios)
    print(f"identical cycles: {np.mean(every <= 1.3):.1%} within 1.3, largest {every.max():.2f}")
    print("| law | boundary | within 1.96 sd | error, median / 95 % s | stated sd, median s | doubts told |")
    print("| --- | --- | ---: | ---: | ---: | ---: |")
    sets = [(name, law, False) for name, law in LAWS.items()]
    for name, law, uneven in [*sets, ("minimum jerk, back at another speed", minimum_jerk, True)]:
        found = coverage(20 * seeds, first, law, uneven=uneven)
        for k, kind in enumerate(("start", "inversion", "end")):
            error, sd = np.abs(found.error[:, k]), found.sd[:, k]
            print(
                f"| {name} | {kind} | {np.mean(error <= 1.96 * sd):.1%} of {error.size} | {np.median(error):.3f} / "
                f"{np.quantile(error, 0.95):.3f} | {np.median(sd):.3f} | {np.mean(found.told[:, k]):.0%} |"
            )


if __name__ == "__main__":
    main()
