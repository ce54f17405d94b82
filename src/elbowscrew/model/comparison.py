"""Models of one motion beside each other; frozen, in SI units and radians."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from elbowscrew import tables
from elbowscrew.choices import AngleUnit, LengthUnit
from elbowscrew.geometry.arrays import Float, Index
from elbowscrew.model.array_record import ArrayRecord
from elbowscrew.model.modeled import ModelPhases, PhaseLaw, Selection
from elbowscrew.model.table_record import TableRecord

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from elbowscrew.errors import ElbowscrewError
    from elbowscrew.model.modeled import BodyPoints
    from elbowscrew.model.recording import QualityWarning, Recording
    from elbowscrew.settings import Settings

MaskedIndex = np.ma.MaskedArray[Any, np.dtype[np.int64]]
Label = NDArray[np.str_]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ComparedModels(TableRecord):
    """Models and their errors, the best first; those that could not be made last, with the reason.

    Errors are those of the model against the measured motion, unfiltered and at the recording's own rate, over the
    measured frames from the first keyframe to the last.

    Attributes
    ----------
    rank : ndarray of int, shape (M,)
        1, 2, ...
    data : ndarray of str, shape (M,)
        What the keyframes are taken from: "raw", "lowpass 6 Hz", "every 2nd", ...
    method, blend, law, knots : ndarray of str, shape (M,)
    keyframes_per_phase, keyframes : ndarray of int, shape (M,)
    rms_displacement, max_displacement : ndarray, shape (M,)
        RMS and largest RMS displacement of the distal body's points, meters; NaN where there is no model.
    max_displacement_frame : masked ndarray of int, shape (M,)
        Frame of the largest one.
    rms_angle_error, max_angle_error : ndarray, shape (M,)
        Angle between modeled and measured orientation, radians.
    rms_translation_error, max_translation_error : ndarray, shape (M,)
        Of the distal body's origin, meters.
    rms_axis_error, max_axis_error : ndarray, shape (M,)
        Angle between modeled and measured screw axis, radians.
    rms_axis_distance, max_axis_distance : ndarray, shape (M,)
        Distance between the two at the distal body, meters.
    ns_per_frame : ndarray, shape (M,)
        Time it takes to make the modeled poses.
    note : ndarray of str, shape (M,)
        Why there is no model; empty where there is one.
    """

    table: ClassVar = tables.COMPARISON_COLUMNS

    rank: Index
    data: Label
    method: Label
    blend: Label
    law: Label
    knots: Label
    keyframes_per_phase: Index
    keyframes: Index
    rms_displacement: Float
    max_displacement: Float
    max_displacement_frame: MaskedIndex
    rms_angle_error: Float
    max_angle_error: Float
    rms_translation_error: Float
    max_translation_error: Float
    rms_axis_error: Float
    max_axis_error: Float
    rms_axis_distance: Float
    max_axis_distance: Float
    ns_per_frame: Float
    note: Label


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Comparison(ArrayRecord):
    """Everything `elbowscrew.compare` found of one recording.

    Attributes
    ----------
    recording : Recording
    settings : Settings
    models : ComparedModels
    phases : ModelPhases
    frame : ndarray of int, shape (N,)
        Frame numbers.
    laws : mapping of str to tuple of PhaseLaw
        Law of each phase, under every name that was compared; of the recording as it is.
    selections : mapping of str to Selection
        Fewest keyframes within the tolerance, by method.
    points : BodyPoints
    warnings : tuple of QualityWarning
    """

    recording: Recording
    settings: Settings
    models: ComparedModels
    phases: ModelPhases
    frame: Index
    laws: dict[str, tuple[PhaseLaw, ...]]
    selections: dict[str, Selection]
    points: BodyPoints
    warnings: tuple[QualityWarning, ...]

    def __repr__(self) -> str:
        return f"Comparison({_told(self.models)}; {len(self.warnings)} warnings and notes)"

    def to_frame(self, angle_unit: AngleUnit = "deg", length_unit: LengthUnit = "mm") -> pd.DataFrame:
        """Return the models and their errors, the best first, as a pandas data frame."""
        return self.models.to_frame(angle_unit, length_unit)

    def to_xarray(self, angle_unit: AngleUnit = "deg", length_unit: LengthUnit = "mm") -> xr.Dataset:
        """Return the same as an xarray Dataset over ``rank``; see `TableRecord.to_xarray`."""
        return self.models.to_xarray(angle_unit, length_unit)

    def _repr_html_(self) -> str:
        return self.models._repr_html_()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ComparedOverTrials(TableRecord):
    """The same models over several trials: mean and standard deviation of each error; the best mean first.

    Attributes
    ----------
    rank : ndarray of int, shape (M,)
    data, method, blend, law, knots : ndarray of str, shape (M,)
    keyframes_per_phase : ndarray of int, shape (M,)
    trials : ndarray of int, shape (M,)
        Trials that have this model.
    rms_displacement_mean, rms_displacement_sd, max_displacement_mean, max_displacement_sd : ndarray, shape (M,)
        Meters; the standard deviation (N - 1) is NaN for a single trial.
    rms_angle_error_mean, rms_angle_error_sd, max_angle_error_mean, max_angle_error_sd : ndarray, shape (M,)
        Radians.
    ns_per_frame_mean, ns_per_frame_sd : ndarray, shape (M,)
    """

    table: ClassVar = tables.TRIALS_COMPARISON_COLUMNS

    rank: Index
    data: Label
    method: Label
    blend: Label
    law: Label
    knots: Label
    keyframes_per_phase: Index
    trials: Index
    rms_displacement_mean: Float
    rms_displacement_sd: Float
    max_displacement_mean: Float
    max_displacement_sd: Float
    rms_angle_error_mean: Float
    rms_angle_error_sd: Float
    max_angle_error_mean: Float
    max_angle_error_sd: Float
    ns_per_frame_mean: Float
    ns_per_frame_sd: Float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class TrialsComparison(ArrayRecord):
    """Everything `elbowscrew.compare_trials` found.

    Attributes
    ----------
    settings : Settings
    models : ComparedOverTrials
    trials : tuple of Comparison
        Those that could be compared.
    failures : tuple of (str, ElbowscrewError)
        Paths of the others, and why.
    """

    settings: Settings
    models: ComparedOverTrials
    trials: tuple[Comparison, ...]
    failures: tuple[tuple[str, ElbowscrewError], ...]

    def __repr__(self) -> str:
        failed = f", {len(self.failures)} failed" if self.failures else ""
        return f"TrialsComparison({_told(self.models)}; {len(self.trials)} trials{failed})"

    def to_frame(self, angle_unit: AngleUnit = "deg", length_unit: LengthUnit = "mm") -> pd.DataFrame:
        """Return the models and their errors, the best first, as a pandas data frame."""
        return self.models.to_frame(angle_unit, length_unit)

    def to_xarray(self, angle_unit: AngleUnit = "deg", length_unit: LengthUnit = "mm") -> xr.Dataset:
        """Return the same as an xarray Dataset over ``rank``; see `TableRecord.to_xarray`."""
        return self.models.to_xarray(angle_unit, length_unit)

    def _repr_html_(self) -> str:
        return self.models._repr_html_()


def _told(models: ComparedModels | ComparedOverTrials) -> str:
    """Say how many models there are, and which is the best."""
    best = f": the best {models.method[0]}, {models.law[0]} law, {models.blend[0]}" if len(models) else ""
    return f"{len(models)} models{best}"
