"""What is known of a trial without its tables: enough to say how it was recorded and analyzed."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from elbowscrew.joints import Joint, joint_called
from elbowscrew.model.summary_types import Summary
from elbowscrew.settings import Settings


class Facts(Protocol):
    """A trial by its summary; an `elbowscrew.view.trial_view.TrialView` is one, too."""

    @property
    def summary(self) -> Summary:
        """``summary.json``."""

    @property
    def settings(self) -> Settings:
        """The settings in it."""

    @property
    def named_joint(self) -> Joint:
        """What the joint and its segments are called."""

    @property
    def located(self) -> bool:
        """Whether positions were measured."""


class SummaryFacts(NamedTuple):
    """The facts that a summary has, and the settings in it."""

    summary: Summary
    settings: Settings

    @property
    def named_joint(self) -> Joint:
        """What the joint and its segments are called."""
        words = self.summary["trial"]["joint"]
        return joint_called(words["name"], words["proximal"], words["distal"])

    @property
    def located(self) -> bool:
        """Whether positions were measured."""
        return self.summary["trial"]["positions"]
