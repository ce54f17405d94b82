"""Opens one C3D file in a process of its own: ``python -P c3d_worker.py FILE`` writes its arrays.

A damaged file makes the library behind ezc3d abort, which no ``try`` can catch; here it takes nobody with it.
"""

from __future__ import annotations

import io
import json
import os
import sys
from typing import Any, Final

import numpy as np

# Sound files take up to 0.1 s and 25 bytes for each megabyte and byte of theirs, and as much again to be given on.
_MEMORY: Final = (1 << 30, 100)
_SECONDS: Final = (4, 2e-6)


def main(path: str) -> None:
    """Write points, residuals, rotations and parameters of a file to standard output, as an npz archive."""
    _limit_resources(os.path.getsize(path))  # noqa: PTH202 - pathlib is not needed for it
    import ezc3d

    content: Any = ezc3d.c3d(path)
    parameters = content["parameters"]
    statement = {
        # The library counts from 0, the file from 1.
        "first_frame": int(content["header"]["points"]["first_frame"]) + 1,
        "frames": int(content["header"]["points"]["last_frame"]) - int(content["header"]["points"]["first_frame"]) + 1,
        "groups": {
            group: {
                name: [value.item() if hasattr(value, "item") else value for value in parameters[group][name]["value"]]
                for name in parameters[group]
                if not name.startswith("__") and name.rstrip("0123456789") in ("UNITS", "RATE", "LABELS", "RATIO")
            }
            for group in ("POINT", "ROTATION")
            if group in parameters
        },
    }
    arrays = {
        "points": content["data"]["points"][:3],
        "residuals": content["data"]["meta_points"]["residuals"],
        "rotations": content["data"].get("rotations", np.empty((4, 4, 0, 0))),
    }
    stream = io.BytesIO()
    np.savez(stream, statement=np.array(json.dumps(statement)), **arrays)
    sys.stdout.buffer.write(stream.getvalue())


def _limit_resources(size: int) -> None:
    """Let a damaged file of some kilobytes not take gigabytes or minutes; not on Windows, which has no such limits."""
    try:
        import resource
    except ImportError:
        return
    bounds = {"RLIMIT_AS": _MEMORY, "RLIMIT_CPU": _SECONDS}
    for name, (least, per_byte) in bounds.items():
        limit = int(least + per_byte * size)
        kind = getattr(resource, name)
        hard = resource.getrlimit(kind)[1]
        try:
            resource.setrlimit(kind, (limit if hard == resource.RLIM_INFINITY else min(limit, hard), hard))
        except (ValueError, OSError):  # macOS refuses some
            continue


if __name__ == "__main__":
    main(sys.argv[1])
