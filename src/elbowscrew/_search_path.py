"""Where modules are looked for: never in the current folder, which holds recordings and whatever came along with them.

Nothing may be imported here that the interpreter has not loaded when it starts: it would be looked for there, too.
"""

from __future__ import annotations

import os
import sys

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping

_OWN_FOLDER = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))  # noqa: PTH100, PTH120 - pathlib is not loaded


def leave_out_current_folder() -> None:
    """Take the current folder out of this process' search path, and out of that of every process it starts."""
    sys.path[:] = _others(sys.path)
    os.environ.update(_guards(os.environ))


def guarded_environment() -> dict[str, str]:
    """Environment for a Python process that is not to look for modules in the current folder."""
    return {**os.environ, **_guards(os.environ)}


class CurrentFolderLeftOut:
    """Context in which processes that are started do not look for modules in the current folder."""

    def __enter__(self) -> None:
        guards = _guards(os.environ)
        self._before = {name: os.environ.get(name) for name in guards}
        os.environ.update(guards)

    def __exit__(self, *_error: object) -> None:
        for name, value in self._before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


def _guards(environment: Mapping[str, str]) -> dict[str, str]:
    guards = {"PYTHONSAFEPATH": "1"}
    if "PYTHONPATH" in environment:  # an empty part of it is the current folder
        guards["PYTHONPATH"] = os.pathsep.join(_others(environment["PYTHONPATH"].split(os.pathsep)))
    return guards


def _others(folders: list[str]) -> list[str]:
    """All folders but the current one, unless the program itself lies there."""
    return [folder for folder in folders if not _is_current(folder)]


def _is_current(folder: str) -> bool:
    try:
        here = os.path.realpath(os.getcwd())  # noqa: PTH109
    except OSError:  # it is gone: nothing can be loaded from it
        return not folder
    return os.path.realpath(folder or here) == here != os.path.realpath(_OWN_FOLDER)
