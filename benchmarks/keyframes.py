"""Time of the fewest keyframes, and of a comparison of models: ``python benchmarks/keyframes.py``."""

from __future__ import annotations

from functools import partial

from rows import Row, alternate, clean_environment, table

from elbowscrew import Settings, compare, simulate_trial
from elbowscrew.motion.difference import points_from_markers
from elbowscrew.motion.interpolation.keyframe_selection import select_keyframes
from elbowscrew.motion.screws.measurement import measure as measured_motion

WANTED_S = {450: 1.0, 10_000: 2.0}


def selection(frames: int, rounds: int) -> list[Row]:
    """Fewest keyframes of a synthetic elbow, by tolerance and method."""
    recording = simulate_trial(frames=frames, inversion=frames * 211 // 450, marker_noise_mm=0.1).recording
    measured = measured_motion(recording, Settings())
    offsets = measured.distal.marker_offsets
    assert offsets is not None
    points = points_from_markers(offsets)
    rows = []
    for tolerance in (2e-3, 5e-3):
        for method in ("sclerp", "sdlb"):
            select = partial(
                select_keyframes, measured.displacement, measured.elapsed, points, tolerance, method=method
            )
            times = alternate({"ours": select}, rounds, warm=False)["ours"]
            rows.append(
                Row(
                    what=f"keyframes of {frames:,} frames, {1e3 * tolerance:g} mm, {method}",
                    value=min(times),
                    unit="s",
                    wanted=WANTED_S[frames],
                    behind=f"{select().row.size} keyframes",
                )
            )
    return rows


def measure(*, quick: bool) -> list[Row]:
    """Measure the selection, and a comparison with the default plan."""
    rows = [*selection(450, 2 if quick else 5), *selection(10_000, 1)]
    recording = simulate_trial(marker_noise_mm=0.1).recording
    count = len(compare(recording).models.rank)
    taken = alternate({"ours": lambda: compare(recording)}, 1 if quick else 3, warm=False)["ours"]
    return [*rows, Row(what=f"compare of 450 frames, {count:,} models", value=min(taken), unit="s", wanted=3.5)]


if __name__ == "__main__":
    clean_environment()
    print(table(measure(quick=False)))
