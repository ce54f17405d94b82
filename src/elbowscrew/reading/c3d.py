"""C3D files, through ezc3d (the extra ``[c3d]``): markers, and the poses of the ROTATION block where there is one."""

from __future__ import annotations

import io
import json
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final, NamedTuple

import numpy as np

from elbowscrew._search_path import guarded_environment
from elbowscrew.errors import RecordingError
from elbowscrew.geometry.arrays import Float
from elbowscrew.model import QualityWarning, Recording, RigidBody, Source
from elbowscrew.opening import sha256_of
from elbowscrew.quantities import METERS
from elbowscrew.reading import c3d_worker
from elbowscrew.reading.builders import BodyBuilder, MarkerBuilder
from elbowscrew.reading.c3d_checks import check_sizes
from elbowscrew.reading.c3d_mending import mended
from elbowscrew.reading.c3d_parameters import read_statements
from elbowscrew.reading.clock import is_rate
from elbowscrew.reading.options import ReadOptions, nothing_wanted, stated_unit

_LONGEST_OPENING_S: Final = 600


class _Content(NamedTuple):
    """What the worker found: points (3, M, N), residuals (1, M, N), rotations (4, 4, K, N'), parameters."""

    points: Float
    residuals: Float
    rotations: Float
    first_frame: int
    frames: int
    groups: dict[str, dict[str, list[Any]]]

    def value(self, group: str, name: str) -> list[Any]:
        return self.groups.get(group, {}).get(name, [])

    def labels(self, group: str) -> list[str]:
        """LABELS, LABELS2, ...: a parameter holds 255 of them at the most."""
        names = [str(label).strip() for label in self.value(group, "LABELS")]
        more = 2
        while self.value(group, f"LABELS{more}"):
            names += [str(label).strip() for label in self.value(group, f"LABELS{more}")]
            more += 1
        return names


def recognizes(head: bytes) -> bool:
    """Tell by the second byte, which is 0x50 in every C3D file, and a first that is not a printable character."""
    return len(head) >= 2 and head[1] == 0x50 and head[0] < 0x20


def read(path: Path, options: ReadOptions) -> Recording:
    """Read a C3D file; see `elbowscrew.reading.registry.read_recording`."""
    content = _open(path)
    unit = stated_unit(path, "".join(str(text) for text in content.value("POINT", "UNITS")[:1]), options)
    rate = float((content.value("POINT", "RATE") or [0.0])[0])
    if not is_rate(rate):
        msg = f"{path}: POINT:RATE is {rate:g}, no possible frame rate; export the take again"
        raise RecordingError(msg)
    bodies, warnings = _bodies(content, METERS[unit])
    flagged = bool(content.residuals.size) and bool((content.residuals < 0.0).all())
    if flagged and not bodies:
        msg = (
            f"{path}: all points are flagged as not seen (residuals below 0) in every frame: there is nothing to read; "
            "export the take again"
        )
        raise RecordingError(msg)
    builders = _markers(content, METERS[unit], options)
    markers = tuple(marker.finish() for marker in builders)
    if not bodies and not markers:
        raise nothing_wanted(path, "no rigid bodies (rotations) in the file", content.labels("POINT"), options)
    count = bodies[0].loss.size if bodies else len(markers[0].position)
    if not count or content.frames not in (0, count):
        msg = f"{path}: the file is cut: its header states {content.frames} frames, it has {count}; export it again"
        raise RecordingError(msg)
    frame = np.arange(content.first_frame, content.first_frame + count, dtype=np.int64)
    return Recording(
        bodies=tuple(bodies),
        frame=frame,
        time_s=(frame - frame[0]) / rate,
        rate_hz=rate,
        markers=markers,
        source=Source(
            path=str(path),
            sha256=sha256_of(path),
            layout="C3D",
            length_unit=unit,
            rotation_type="matrix" if bodies else "",
            markers=tuple(content.labels("POINT")[: content.points.shape[1]]),
        ),
        warnings=(*warnings, *(warning for marker in builders for warning in marker.warnings())),
    )


def _open(path: Path) -> _Content:
    if find_spec("ezc3d") is None:
        msg = f"{path}: a C3D file needs ezc3d; install it with: pip install ezc3d"
        raise RecordingError(msg)
    reason = "the file is damaged"
    try:
        with _as_the_library_takes_it(path) as file, np.load(io.BytesIO(_worker_output(file))) as arrays:
            statement = json.loads(str(arrays["statement"]))
            points, residuals, rotations = (
                np.asarray(arrays[name], dtype=np.float64) for name in ("points", "residuals", "rotations")
            )
        content = _Content(
            points, residuals, rotations, int(statement["first_frame"]), int(statement["frames"]), statement["groups"]
        )
        if content.points.ndim == 3 and content.rotations.ndim == 4:
            return content
    except subprocess.CalledProcessError as error:
        told = error.stderr.decode("utf-8", "replace").strip().splitlines()
        if error.returncode == -getattr(signal, "SIGXCPU", 0):
            reason = "it takes longer than a file of its size may"
        elif told and error.returncode > 0:
            reason = told[-1]
    except subprocess.TimeoutExpired:
        reason = f"it is not open after {_LONGEST_OPENING_S} s"
    except ChildProcessError as error:
        msg = f"{path}: {error}"
        raise RecordingError(msg) from error
    except (OSError, ValueError, KeyError, TypeError) as error:
        reason = str(error)
    msg = f"{path}: not a C3D file that can be read: {reason}; export the take again"
    raise RecordingError(msg)


@contextmanager
def _as_the_library_takes_it(path: Path) -> Iterator[Path]:
    """Give the file, or one in its place that says the same."""
    stated = read_statements(path)
    if stated is not None:
        check_sizes(path, stated)
        data = mended(path, stated)
        if data is not None:
            with ExitStack() as held:
                try:
                    file = Path(held.enter_context(TemporaryDirectory(prefix="elbowscrew-"))) / "mended.c3d"
                    file.write_bytes(data)
                except OSError as error:
                    msg = f"{path}: a copy to open it by cannot be written: {error}; make room, or set TMPDIR"
                    raise RecordingError(msg) from error
                yield file
            return
    yield path


def _worker_output(file: Path) -> bytes:
    command = [sys.executable, "-P", c3d_worker.__file__, str(file)]
    try:
        done = subprocess.run(  # noqa: S603
            command, capture_output=True, check=True, timeout=_LONGEST_OPENING_S, env=guarded_environment()
        )
    except OSError as error:
        msg = f"the process that opens it cannot be started: {error.strerror or error}"
        raise ChildProcessError(msg) from error
    return done.stdout


def _markers(content: _Content, scale: float, options: ReadOptions) -> list[MarkerBuilder]:
    found = []
    for k, name in enumerate(content.labels("POINT")[: content.points.shape[1]]):
        if options.wants(name):
            position = scale * content.points[:, k].T
            if content.residuals.shape[-2:] == content.points.shape[-2:]:
                # A negative residual says: not seen.
                position = np.where((content.residuals[0, k] >= 0.0)[:, None], position, np.nan)
            found.append(MarkerBuilder(name))
            found[-1].append(position)
    return found


def _bodies(content: _Content, scale: float) -> tuple[list[RigidBody], list[QualityWarning]]:
    # Rotations may be written more often than points; the points give the clock.
    ratio = max(1, int((content.value("ROTATION", "RATIO") or [1])[0]))
    rotations = content.rotations[..., ::ratio]
    if not rotations.size:
        return [], []
    labels = content.labels("ROTATION")
    builders = []
    for k in range(rotations.shape[2]):
        matrix = np.moveaxis(rotations[:, :, k], -1, 0)
        builders.append(BodyBuilder(labels[k] if k < len(labels) else f"rotation {k + 1}"))
        builders[-1].append_matrices(matrix[:, :3, :3], scale * matrix[:, :3, 3])
    return [body.finish() for body in builders], [warning for body in builders for warning in body.warnings()]
