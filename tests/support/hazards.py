"""Work that goes wrong, for workers to import: each task is a word and a folder for its traces."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path
from typing import NamedTuple

from elbowscrew.study.outcome import Failure


class Hazard(NamedTuple):
    label: str
    kind: str
    folder: str

    @property
    def traces(self) -> int:
        """How often it was begun."""
        return len(list(Path(self.folder).glob(f"{self.label}.*")))


def work(task: Hazard) -> Failure | None:
    again = task.traces
    Path(task.folder, f"{task.label}.{again}").touch()
    match task.kind:
        case "fails":
            return Failure(error_class="AnalysisError", message=f"{task.label}: no", exit_code=5)
        case "kills":
            os.kill(os.getpid(), signal.SIGKILL)
        case "kills once" if not again:
            os.kill(os.getpid(), signal.SIGKILL)
        case "exits":
            os._exit(3)
        case "full":
            return Failure(error_class="OutputError", message="the disk is full", exit_code=6, stops_all=True)
        case "slow":
            time.sleep(60)
            Path(task.folder, "waited for").touch()
    return None
