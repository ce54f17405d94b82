"""Whether a result in the output folder is what analyzing its trial again would give."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any, NamedTuple

from elbowscrew._version import __version__
from elbowscrew.choices import FRAMES, JOINT_NAMES
from elbowscrew.errors import OutputError, ResultError
from elbowscrew.joints import ends_called, joints_of
from elbowscrew.model.summary_types import Summary
from elbowscrew.opening import sha256_of
from elbowscrew.results.exporting import EXPORTS
from elbowscrew.results.plugged import missing
from elbowscrew.results.proof import proof_of
from elbowscrew.results.staging import settle
from elbowscrew.results.summary import are_installed, landmarks_summary, settings_summary
from elbowscrew.results.summary_reading import read_summary
from elbowscrew.study.task import TrialTask


class Standing(NamedTuple):
    """Whether a result is what analyzing again would give, and which of its files are not as they were written."""

    current: bool
    changed: tuple[str, ...] = ()


def standing_of(task: TrialTask) -> Standing:
    """Tell by the result's own summary and digests.

    The same are: program and libraries, every setting, the landmarks, name and SHA-256 of the recording; and the result
    is whole: each file is there as it was written, and each export that a plug-in was to write.
    """
    if task.folder.is_symlink():  # it may lead out of the folder that is held
        return Standing(False)
    try:
        settle(task.folder)
        proof = proof_of(task.folder)
        changed = proof.changed()
        return Standing(not changed and _is_of(task, read_summary(proof), proof.sums), changed)
    except (ResultError, OutputError):  # the trial's own failure, when it is analyzed
        return Standing(False)


def _is_of(task: TrialTask, summary: Summary, files: Collection[str]) -> bool:
    try:
        return (
            summary["elbowscrew"] == __version__
            and are_installed(summary["versions"])
            and summary["settings"] == _settings(task, summary)
            and summary["landmarks"] == landmarks_summary(task.landmarks)
            and summary["source"]["sha256"] == sha256_of(task.path)
            and not missing([name for name in task.settings.export if name not in EXPORTS], files)
            and _distal_digest(summary) == (None if task.distal_path is None else sha256_of(task.distal_path))
        )
    except OSError:
        return False


def _distal_digest(summary: Summary) -> str | None:
    file = summary["source"]["distal_file"]
    return None if file is None else file["sha256"]


def _settings(task: TrialTask, summary: Summary) -> dict[str, Any]:
    """Settings as the result would tell them: a segment's word is the frame that it is in the result's joint."""
    asked = settings_summary(task.settings)
    if task.settings.express_in not in FRAMES:
        name = summary["trial"]["joint"]["name"]
        ends = ends_called(task.settings.express_in, joints_of(name if name in JOINT_NAMES else "elbow"))
        asked["express-in"] = ends.pop() if len(ends) == 1 else None  # not known: analyze again
    return asked
