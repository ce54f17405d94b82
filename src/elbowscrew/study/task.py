"""One trial of a batch as a worker does it: everything that can go wrong comes back as a value."""

from __future__ import annotations

import threading
import traceback
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from elbowscrew._process import collect_garbage
from elbowscrew._version import __version__
from elbowscrew.errors import ElbowscrewError, OutputError, UsageError, shortened
from elbowscrew.model import Landmarks
from elbowscrew.results.summary import library_versions
from elbowscrew.saving import analyze_file, write_result
from elbowscrew.settings import Settings
from elbowscrew.study.folder import at_work
from elbowscrew.study.outcome import DEFECT, Failure

# A worker of a cluster may have several threads, and matplotlib's style is one for all of them.
_ONE_AT_A_TIME: Final = threading.Lock()


@dataclass(frozen=True, slots=True, kw_only=True)
class TrialTask:
    """What a worker is told.

    Attributes
    ----------
    path, distal_path : Path
        Absolute; the latter where each body has a file of its own.
    label : str
        What the trial is called in messages.
    folder : Path
        Its result folder, absolute.
    settings : Settings
    landmarks : Landmarks or None
    versions : mapping
        Of this program and its libraries where the batch was started: the same is expected of the worker.
    """

    path: Path
    label: str
    distal_path: Path | None = None
    folder: Path
    settings: Settings
    landmarks: Landmarks | None
    versions: dict[str, str]


def versions_here() -> dict[str, str]:
    """Versions of the program and of the libraries its results stand on."""
    return {"elbowscrew": __version__, **library_versions()}


def told_apart(worker: Mapping[str, str], expected: Mapping[str, str]) -> str:
    """Say what a worker has in other versions than the batch; nothing if it has the same."""
    told = ", ".join(f"{name} {version}" for name, version in worker.items() if version != expected.get(name))
    return f"the worker has {told}: expected the same versions as here; install them there" if told else ""


def analyze_trial(task: TrialTask) -> Failure | None:
    """Analyze one trial into its folder, in the place of an earlier result.

    Returns
    -------
    Failure or None
        None if the result is in its place.
    """
    message = told_apart(versions_here(), task.versions)
    if message:
        return Failure(error_class="UsageError", message=message, exit_code=UsageError.exit_code, stops_all=True)
    try:
        with _ONE_AT_A_TIME, at_work(task.folder.parent):
            if task.folder.is_symlink():
                msg = f"{task.folder}: is a link; a batch writes into its own folder alone: remove it"
                raise OutputError(msg)
            analysis = analyze_file(task.path, task.settings, distal_path=task.distal_path, landmarks=task.landmarks)
            write_result(analysis, task.folder, force=True)
            del analysis
            collect_garbage()
    except ElbowscrewError as error:
        # What the disk does not take of one trial it will not take of the next; a folder of the user's is one trial's.
        full = isinstance(error, OutputError) and isinstance(error.__cause__, OSError)
        message = shortened(str(error).replace(str(task.path), task.label))
        return Failure(error_class=type(error).__name__, message=message, exit_code=error.exit_code, stops_all=full)
    except MemoryError:
        message = f"{task.label}: not enough memory; take fewer --workers, or export fewer columns"
        return Failure(error_class="MemoryError", message=message, exit_code=OutputError.exit_code)
    except OSError as error:
        message = f"{task.folder.parent}: cannot be written by the worker: {error.strerror or error}"
        return Failure(error_class="OutputError", message=message, exit_code=OutputError.exit_code, stops_all=True)
    except Exception as error:
        place = traceback.extract_tb(error.__traceback__)[-1]
        message = (
            f"{task.label}: a defect of the program: {type(error).__name__}: {' '.join(str(error).split())} "
            f"({Path(place.filename).name}:{place.lineno}); please report it"
        )
        return Failure(error_class=DEFECT, message=message, exit_code=1)
    return None
