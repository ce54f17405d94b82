"""What a process sets for itself, tried in processes of their own."""

from __future__ import annotations

import subprocess
import sys

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
