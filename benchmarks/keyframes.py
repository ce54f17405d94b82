"""Time of the fewest keyframes: 450 and 10,000 frames of a synthetic elbow, by tolerance.

Run: python benchmarks/keyframes.py
"""

from __future__ import annotations

import time

from elbowscrew import Settings, simulate_trial
from elbowscrew.motion.difference import points_from_markers
from elbowscrew.motion.keyframe_selection import select_keyframes
from elbowscrew.motion.measurement import measure

RUNS = {450: 5, 10_000: 1}
TARGET_S = {450: 1.0, 10_000: 20.0}


def main() -> None:
    print(f"{'frames':>7} {'tolerance':>10} {'method':>7} {'keyframes':>10} {'time, s':>8} {'target':>7}")
    for frames, runs in RUNS.items():
        recording = simulate_trial(frames=frames, inversion=frames * 211 // 450, marker_noise_mm=0.1).recording
        measured = measure(recording, Settings())
        offsets = measured.forearm.marker_offsets
        assert offsets is not None
        points = points_from_markers(offsets)
        for tolerance in (2e-3, 5e-3):
            for method in ("sclerp", "sdlb"):
                times = []
                for _ in range(runs):
                    start = time.perf_counter()
                    found = select_keyframes(measured.displacement, measured.elapsed, points, tolerance, method=method)
                    times.append(time.perf_counter() - start)
                row = f"{frames:7d} {1e3 * tolerance:7g} mm {method:>7} {found.row.size:10d} {min(times):8.2f}"
                print(f"{row} {TARGET_S[frames]:7g}")


if __name__ == "__main__":
    main()
