"""The output folder of a batch: held by one batch at a time, and swept of what a killed one has left."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import IO, Final

from elbowscrew.disk.folders import make_parents, sweep
from elbowscrew.errors import OutputError
from elbowscrew.opening import open_own
from elbowscrew.results.result_files import BATCH_MARK, is_stray

_WORK: Final = ".elbowscrew-work.lock"
_LONGEST_WAIT_S: Final = 60.0


@contextmanager
def batch_folder(folder: Path) -> Iterator[None]:
    """Make and hold an output folder; when the block begins and when it ends, nothing half-written is in it.

    The locks are the system's own: they end with the process that holds them, however it ends.

    Raises
    ------
    OutputError
        If the folder is something else's, another batch is running there, or the disk does not take it.
    """
    with ExitStack() as held:
        try:
            _check_folder(folder)
            make_parents(folder / BATCH_MARK)
            _hold(folder, held.enter_context(open_own(folder / BATCH_MARK)))
            _wait_for_workers(folder)
            sweep(folder, held=True)
        except OSError as error:
            msg = f"{folder}: cannot be written: {error.strerror or error}"
            raise OutputError(msg) from error
        try:
            yield
        finally:
            with suppress(OSError, OutputError):
                _wait_for_workers(folder)
                sweep(folder, held=True)


def _hold(folder: Path, mark: IO[bytes]) -> None:
    if not _lock(mark):
        msg = f"{folder}: another batch is running there{_who(mark)}; wait for it, or give another --output"
        raise OutputError(msg)
    # Not by the stream: what a full disk does not take would be written again when it closes.
    os.lseek(mark.fileno(), 0, os.SEEK_SET)
    os.ftruncate(mark.fileno(), 0)
    os.write(mark.fileno(), f"process {os.getpid()}\n".encode())


@contextmanager
def at_work(folder: Path) -> Iterator[None]:
    """Tell, while a worker writes into an output folder, that it does: it may outlive its batch for a moment."""
    if sys.platform == "win32":
        yield
        return
    import fcntl

    with open_own(folder / _WORK) as stream:
        fcntl.flock(stream, fcntl.LOCK_SH)
        yield


def _wait_for_workers(folder: Path) -> None:
    if sys.platform == "win32":
        return
    import fcntl

    deadline = time.monotonic() + _LONGEST_WAIT_S
    with open_own(folder / _WORK) as stream:
        while True:
            try:
                fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError as error:
                if time.monotonic() > deadline:
                    msg = f"{folder}: a worker of an earlier batch still writes there; end it, or wait"
                    raise OutputError(msg) from error
                time.sleep(0.02)
            else:
                return


def _check_folder(folder: Path) -> None:
    if not os.path.lexists(folder):
        return
    if not folder.is_dir():
        msg = f"{folder}: exists and is not a folder; give another --output"
        raise OutputError(msg)
    if folder.resolve() == Path.cwd():
        msg = f"{folder}: is the current folder; give --output a folder of its own"
        raise OutputError(msg)
    if (folder / BATCH_MARK).exists():
        return
    with os.scandir(folder) as entries:  # it may have a million
        stranger = next((one.name for one in entries if not is_stray(one.name)), None)
    if stranger is not None:
        msg = f"{folder}: the folder holds {stranger!r} and is no output of a batch; give another --output"
        raise OutputError(msg)


def _lock(stream: IO[bytes]) -> bool:
    """Take the system's lock on a file; it is given back when the file is closed."""
    try:
        if sys.platform == "win32":
            import msvcrt

            stream.seek(1 << 30)  # beyond the text, which others may want to read
            msvcrt.locking(stream.fileno(), msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except (BlockingIOError, PermissionError):
        return False
    return True


def _who(stream: IO[bytes]) -> str:
    try:
        stream.seek(0)
        told = stream.read(100).decode("ascii", "replace").strip()
    except OSError:
        return ""
    return f" ({told})" if told else ""
