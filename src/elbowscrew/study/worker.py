"""What a worker process of this machine does before its first trial; nothing heavy may be imported before it."""

from __future__ import annotations

import os
import threading
from contextlib import suppress
from multiprocessing.connection import Connection

from elbowscrew._process import set_up_process


def prepare_worker(watched: Connection) -> None:
    """Set up a worker: one thread for BLAS, no windows, and an end as soon as the batch ends.

    Parameters
    ----------
    watched : Connection
        Nothing ever comes through it: it closes when the batch stops or its process dies, be it by kill -9.
    """
    import signal
    import sys
    import warnings

    for name in ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS", "VECLIB_MAXIMUM_THREADS"):
        os.environ[name] = "1"  # the workers share the cores among them already
    set_up_process()
    if not sys.warnoptions:
        warnings.simplefilter("ignore")
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches all processes; the batch itself ends its workers
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    threading.Thread(target=_end_with_the_batch, args=(watched,), daemon=True).start()


def _end_with_the_batch(watched: Connection) -> None:
    with suppress(EOFError, OSError):
        watched.recv_bytes()
    os._exit(1)
