"""What a process of the program sets for itself, be it the command or a worker; a library leaves it to its user."""

from __future__ import annotations

import gc
import logging
import os
from contextlib import chdir
from pathlib import Path
from typing import Final

_HERE: Final = Path(__file__).parent

# The first trial leaves two hundred thousand, with all modules: to look through them takes a thirtieth of its time.
_OBJECTS_BETWEEN_COLLECTIONS: Final = 500_000


def set_up_process() -> None:
    """Let figures go to files without windows or words of their own, and collect garbage less often."""
    os.environ["MPLBACKEND"] = "agg"  # whatever the notebook or the shell prefers
    os.environ["MATPLOTLIBRC"] = str(_HERE / "matplotlibrc")
    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # its words on fonts and caches are not the result
    if os.path.lexists("matplotlibrc"):
        with chdir(_HERE):  # a file of this name in the current folder comes before all others, be it a pipe
            import matplotlib  # noqa: F401
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")  # a search through all that is installed, for none
    gc.set_threshold(_OBJECTS_BETWEEN_COLLECTIONS)


def collect_garbage() -> None:
    """Collect what a finished trial has left, in a process that `set_up_process` lets collect less often.

    What is there after its first trial lives as long as the process and is not looked at again.
    """
    if not _is_set_up():
        return
    gc.collect()
    if not gc.get_freeze_count():
        gc.freeze()


def load_matplotlib() -> None:
    """Load matplotlib, before figures, in a process of the program without the manual of its artists.

    It writes that at each start, into docstrings that only an interactive user reads: a quarter of what loading takes.
    """
    if not _is_set_up():
        return
    from matplotlib import artist

    artist.kwdoc = lambda artist: ""


def _is_set_up() -> bool:
    return gc.get_threshold()[0] == _OBJECTS_BETWEEN_COLLECTIONS


def has_spare_cores() -> bool:
    """Whether a thread may do work beside: not where the environment says that there is one core for this process."""
    return os.environ.get("OMP_NUM_THREADS") != "1"
