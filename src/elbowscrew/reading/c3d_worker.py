"""Opens one C3D file in a process of its own: ``python -P c3d_worker.py FILE`` writes its arrays.

A damaged file makes the library behind ezc3d abort, which no ``try`` can catch; here it takes nobody with it.
"""

from __future__ import annotations

import io
import json
import sys
from typing import Any

import numpy as np


def main(path: str) -> None:
    """Write points, residuals, rotations and parameters of a file to standard output, as an npz archive."""
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


if __name__ == "__main__":
    main(sys.argv[1])
