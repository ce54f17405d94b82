"""What pages weigh and cost: run ``python benchmarks/report.py``; with playwright and Chromium also how they load."""

from __future__ import annotations

import shutil
import statistics
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from elbowscrew import analyze, save_analysis, simulate_trial
from elbowscrew.report import write_study_page, write_trial_page
from elbowscrew.report.study import read_study
from elbowscrew.report.study_page import study_page

ROUNDS = 9
TRIALS = 10_000


def milliseconds(run: Callable[[], object]) -> float:
    start = time.perf_counter()
    run()
    return 1000.0 * (time.perf_counter() - start)


def load_times(pages: list[Path]) -> dict[str, float]:
    """Median time to the end of the load event in Chromium, milliseconds; empty without it."""
    chromium = shutil.which("chromium")
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        return {}
    if chromium is None:
        return {}
    found = {}
    with sync_playwright() as started:
        browser = started.chromium.launch(executable_path=chromium, args=["--no-sandbox", "--disable-gpu"])
        for path in pages:
            times = []
            for _ in range(ROUNDS):
                page = browser.new_page()
                page.goto(path.as_uri())
                times.append(page.evaluate("performance.getEntriesByType('navigation')[0].loadEventEnd"))
                page.close()
            found[path.name] = statistics.median(times)
        browser.close()
    return found


def main() -> None:
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        places = []
        for k in range(10):
            recording = simulate_trial(proximal="moving", gaps=k % 3, top_deg=120.0 + k, seed=k).recording
            places.append(save_analysis(analyze(recording), folder / f"trial{k}", figure_formats=(), report=False))
        first = milliseconds(lambda: write_trial_page(places[0]))
        times = [milliseconds(lambda: write_trial_page(places[1])) for _ in range(ROUNDS)]
        trial = places[1] / "report.html"
        size, median = trial.stat().st_size, statistics.median(times)
        print(f"page of a trial   {size:9d} bytes, {median:.1f} ms, first {first:.0f} ms")
        study = read_study(folder)
        trials = tuple(replace(study.trials[k % 10], folder=f"condition/trial {k}") for k in range(TRIALS))
        page = folder / "index.html"
        made = milliseconds(lambda: page.write_text(study_page(replace(study, trials=trials)), encoding="utf-8"))
        print(f"page of {TRIALS} trials {page.stat().st_size:9d} bytes, {made:.0f} ms beside reading them")
        for name, loaded in load_times([trial, page]).items():
            print(f"{name} loads in {loaded:.0f} ms")
        page.unlink()
        read = milliseconds(lambda: write_study_page(folder))
        print(f"page of 10 trials, read from disk: {read:.0f} ms")


if __name__ == "__main__":
    main()
