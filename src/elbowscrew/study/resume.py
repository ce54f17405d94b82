"""Whether a result in the output folder is what analyzing its trial again would give."""

from __future__ import annotations

import hashlib

from elbowscrew._version import __version__
from elbowscrew.errors import OutputError
from elbowscrew.results.summary import landmarks_summary, library_versions, settings_summary
from elbowscrew.saving import digests, read_summary
from elbowscrew.study.task import TrialTask


def is_current(task: TrialTask) -> bool:
    """Tell by the result's own summary.

    The same are: program and libraries, every setting, the landmarks, name and SHA-256 of the recording; and the result
    is whole: each file the summary tells of is there, with the SHA-256 it tells.
    """
    try:
        summary = read_summary(task.folder)
        source = summary.get("source") or {}
        return bool(
            summary["elbowscrew"] == __version__
            and summary.get("versions") == library_versions()
            and summary.get("settings") == settings_summary(task.settings)
            and summary.get("landmarks") == landmarks_summary(task.landmarks)
            and source.get("sha256") == _sha256(task)
            and summary.get("files") == digests(task.folder)
        )
    except (OSError, OutputError, AttributeError):
        return False


def _sha256(task: TrialTask) -> str:
    with task.path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()
