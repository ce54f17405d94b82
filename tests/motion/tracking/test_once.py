"""Work on the whole length of a recording is done once in an analysis."""

from __future__ import annotations

from collections import Counter
from types import ModuleType
from typing import Any

import pytest

from elbowscrew import Settings, analyze, simulate_trial
from elbowscrew.motion.screws import measurement
from elbowscrew.motion.smoothing import resampling
from elbowscrew.motion.tracking import quality
from elbowscrew.results.summary import summary_from_analysis


def test_clock_and_signs_are_looked_at_once_in_an_analysis(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: Counter[str] = Counter()

    def counted(home: ModuleType, name: str) -> None:
        function = getattr(home, name)

        def call(*arguments: Any) -> Any:
            seen[name] += 1
            return function(*arguments)

        monkeypatch.setattr(home, name, call)

    counted(quality, "elapsed_time")
    counted(measurement, "elapsed_time")
    counted(resampling, "elapsed_time")
    counted(quality, "_sign_flips")
    recording = simulate_trial(frames=80, inversion=40, proximal="moving", sign_flips=True).recording
    analysis = analyze(recording)
    summary_from_analysis(analysis)
    assert seen == {"elapsed_time": 1, "_sign_flips": 2}
    analyze(recording, Settings(resample_hz=60.0))
    assert seen == {"elapsed_time": 3, "_sign_flips": 4}  # the clock of the recording, and the new one
