"""What pages weigh and cost: run ``python benchmarks/pages.py``; with playwright and Chromium also how they load."""

from __future__ import annotations

import shutil
import statistics
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from rows import Row, table

from elbowscrew import analyze, save_analysis, simulate_trial
from elbowscrew.report import write_trial_page
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


def measure(folder: Path, count: int = TRIALS) -> list[Row]:
    """Measure the page of a trial, and that of a study of so many."""
    places = []
    for k in range(10):
        recording = simulate_trial(proximal="moving", gaps=k % 3, top_deg=120.0 + k, seed=k).recording
        places.append(save_analysis(analyze(recording), folder / f"trial{k}", figure_formats=(), report=False))
    first = milliseconds(lambda: write_trial_page(places[0]))
    times = [milliseconds(lambda: write_trial_page(places[1])) for _ in range(ROUNDS)]
    trial, page = places[1] / "report.html", folder / "index.html"
    study = read_study(folder)
    trials = tuple(replace(study.trials[k % 10], folder=f"condition/trial {k}") for k in range(count))
    made = milliseconds(lambda: page.write_text(study_page(replace(study, trials=trials)), encoding="utf-8"))
    one, many = "page of a trial", f"page of a study of {count:,} trials"
    return [
        Row(what=one, value=trial.stat().st_size / 1e3, unit="kB"),
        Row(what=one, value=statistics.median(times), unit="ms to make", behind=f"the first in {first:.0f} ms"),
        Row(what=many, value=page.stat().st_size / 1e6, unit="MB", wanted=3.0),
        Row(what=many, value=made / 1e3, unit="s to make", behind="beside reading the trials"),
        *(
            Row(what=what, value=loaded / 1e3, unit="s to load in Chromium", wanted=2.0)
            for what, loaded in zip((one, many), load_times([trial, page]).values(), strict=False)
        ),
    ]


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as scratch:
        print(table(measure(Path(scratch))))
