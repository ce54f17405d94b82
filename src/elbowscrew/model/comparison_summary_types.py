"""What stands in ``compare.json``, as types, so that a misspelled key is an error of the type checker.

A text below a key says what it is where name and unit do not; `docs/schemas` is made from it. Angles are degrees and
lengths millimeters; None is what is not known or not defined.
"""

from __future__ import annotations

from typing import Any, NotRequired, final

from typing_extensions import TypedDict

from elbowscrew.model.summary_types import (
    LawErrorSummary,
    RecordingSummary,
    SelectionSummary,
    SourceSummary,
    WarningSummary,
)


class LawSummary(LawErrorSummary):
    """A law of motion over one phase of the recording as it is."""

    law: str
    peak: float | None
    """Share of the phase at which the velocity is highest; None for the law's own."""


class PhaseSummary(TypedDict):
    """Where a phase of the models begins and ends."""

    start_frame: int
    end_frame: int


class ModelChoice(TypedDict):
    """A model that was compared."""

    rank: int
    data: str
    """What the keyframes are taken from."""
    method: str
    blend: str
    law: str
    knots: str
    keyframes_per_phase: int


class ComparedModel(ModelChoice):
    """A model of one recording, with its errors at measured frames."""

    keyframes: int
    rms_displacement_mm: float | None
    max_displacement_mm: float | None
    max_displacement_frame: NotRequired[int]
    """Left out where no error is known."""
    rms_angle_error_deg: float | None
    max_angle_error_deg: float | None
    rms_translation_error_mm: float | None
    max_translation_error_mm: float | None
    rms_axis_error_deg: float | None
    max_axis_error_deg: float | None
    rms_axis_distance_mm: float | None
    max_axis_distance_mm: float | None
    ns_per_frame: float | None
    """Time that one frame takes, nanoseconds."""


class ModelOverTrials(ModelChoice):
    """A model over several recordings: mean and standard deviation (N - 1) of its errors."""

    trials: int
    """Recordings that have this model."""
    rms_displacement_mean_mm: float | None
    rms_displacement_sd_mm: float | None
    max_displacement_mean_mm: float | None
    max_displacement_sd_mm: float | None
    rms_angle_error_mean_deg: float | None
    rms_angle_error_sd_deg: float | None
    max_angle_error_mean_deg: float | None
    max_angle_error_sd_deg: float | None
    ns_per_frame_mean: float | None
    ns_per_frame_sd: float | None


@final
class ComparisonSummary(TypedDict):
    """What ``compare.json`` holds of one recording."""

    elbowscrew: str
    """Version of the program."""
    source: SourceSummary
    settings: dict[str, Any]
    """Every setting by the name of its option."""
    trial: RecordingSummary
    phases: list[PhaseSummary]
    laws: dict[str, list[LawSummary]]
    """Law of each phase, under every name that was compared."""
    models: int
    """How many models were compared."""
    refused: int
    """How many of them could not be made."""
    best: list[ComparedModel]
    best_by_keyframes: list[ComparedModel]
    """The best of each number of keyframes."""
    selections: dict[str, SelectionSummary]
    """Fewest keyframes within the tolerance, by method."""
    warnings: list[WarningSummary]


class SelectionsOfTrial(TypedDict):
    """What one of several recordings needs."""

    source: SourceSummary
    selections: dict[str, SelectionSummary]
    """Fewest keyframes within the tolerance, by method."""


class FailureSummary(TypedDict):
    """A recording that could not be compared."""

    path: str
    error: str
    message: str


@final
class TrialsSummary(TypedDict):
    """What ``compare.json`` holds of several recordings."""

    elbowscrew: str
    """Version of the program."""
    settings: dict[str, Any]
    """Every setting by the name of its option."""
    trials: list[SelectionsOfTrial]
    failures: list[FailureSummary]
    models: int
    """How many models were compared."""
    best: list[ModelOverTrials]
    best_by_keyframes: list[ModelOverTrials]
    """The best of each number of keyframes."""
