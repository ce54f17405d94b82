"""What a process sets for itself, tried in processes of their own."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

MAKE = """
import gc, weakref
from elbowscrew._process import collect_garbage, set_up_process
class Knot: pass
def knot():
    one = Knot()
    one.itself = one
    return weakref.ref(one)
"""


def run(code: str) -> None:
    subprocess.run([sys.executable, "-c", MAKE + code], check=True)


def test_a_worker_lets_go_of_every_trials_garbage() -> None:
    run(
        """
set_up_process()
for _ in range(3):
    left = knot()
    assert left() is not None
    collect_garbage()
    assert left() is None
assert gc.get_freeze_count() > 0
"""
    )


def test_a_process_of_somebody_else_is_left_alone() -> None:
    run(
        """
before = gc.get_threshold()
left = knot()
collect_garbage()
assert left() is not None
assert gc.get_freeze_count() == 0
assert gc.get_threshold() == before
"""
    )


LOAD = """
from elbowscrew._process import load_matplotlib
load_matplotlib()
from matplotlib.patches import Patch
"""


def test_the_program_loads_matplotlib_without_its_manual() -> None:
    run(f"set_up_process(){LOAD}assert 'antialiased' not in Patch.set.__doc__")


def test_matplotlib_keeps_its_manual_in_a_process_of_somebody_else() -> None:
    run(f"{LOAD}assert 'antialiased' in Patch.set.__doc__")


def test_a_first_trial_is_finished_without_a_search_for_garbage(tmp_path: Path) -> None:
    run(
        f"""
set_up_process()
searched = []
gc.callbacks.append(lambda phase, info: searched.append(info))
from elbowscrew import analyze, save_analysis, simulate_trial
save_analysis(analyze(simulate_trial(frames=450).recording), {str(tmp_path / "result")!r})
assert not searched, searched
from matplotlib.patches import Patch
assert 'antialiased' not in Patch.set.__doc__
"""
    )
