"""The keywords of the Python interface, for type checkers: fields of `Settings` and of `Simulation`."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Literal, TypedDict

from elbowscrew.choices import (
    AngleUnit,
    BlendName,
    ExportName,
    FigureChoice,
    FigureFormat,
    FileUnit,
    JointName,
    KeyframeSource,
    KnotName,
    LawName,
    LengthUnit,
    MethodName,
    NoiseSource,
    RotationType,
    SimulatedJointType,
    SimulatedLaw,
    StatedJoint,
)
from elbowscrew.column_file import ColumnFile


class SettingsFields(TypedDict, total=False):
    """Fields of `elbowscrew.Settings`, where lists and paths may stand for tuples and what files hold."""

    joint: JointName | None
    proximal: str | None
    distal: str | None
    arm: str | None
    forearm: str | None
    proximal_markers: Sequence[str] | None
    distal_markers: Sequence[str] | None
    arm_markers: Sequence[str] | None
    forearm_markers: Sequence[str] | None
    pose_method: Literal["svd", "dual-qr"]
    reference: int | None
    reference_window: int
    express_in: Literal["distal", "proximal", "lab", "arm", "forearm"] | str
    max_gap_s: float
    frozen: Literal["lost", "keep"]
    max_turn_deg_s: float
    max_speed_m_s: float
    min_tracked_percent: float
    lowpass_hz: float | Literal["auto"] | None
    resample_hz: float | None
    min_rate_rad_s: float
    min_angle_deg: float
    axis_sd_deg: float | str | None
    step_deg: float | None
    marker_noise_mm: float | None
    noise: Literal["auto", NoiseSource, "none"]
    signed: Literal["auto", "yes", "no"]
    joint_type: Literal["auto", StatedJoint] | str
    skin_motion: Sequence[float] | None
    robust: bool
    cycle_swing_deg: float | None
    cycles: Sequence[tuple[float, float]] | str | os.PathLike[str] | None
    no_cycles: bool
    inversion: int | None
    keyframes: Sequence[int] | None
    phases: Literal["movement", "whole"]
    tolerance_mm: float | str | None
    method: MethodName | None
    blend: BlendName
    law: LawName | str | None
    law_peak: float | None
    knots: KnotName
    radius_mm: float | None
    angle_unit: AngleUnit
    length_unit: LengthUnit
    figure_format: Sequence[FigureFormat]
    figures: Sequence[FigureChoice] | None
    font: str | None
    export: Sequence[ExportName | str]
    units: FileUnit | None
    rotation: RotationType | None
    rate_hz: float | None
    columns: ColumnFile | str | os.PathLike[str] | None


class ComparisonFields(SettingsFields, total=False):
    """Fields of `elbowscrew.Settings`, and those of `elbowscrew.ComparisonPlan` but ``knots``, which both have."""

    methods: Sequence[MethodName]
    laws: Sequence[LawName]
    blends: Sequence[BlendName]
    counts: Sequence[int]
    data: Sequence[KeyframeSource]
    decimation: Sequence[int]


class SimulationFields(TypedDict, total=False):
    """Fields of `elbowscrew.Simulation`, and the former names of two."""

    joint: JointName
    side: Literal["left", "right"] | None
    frames: int
    rate_hz: float
    top_deg: float
    inversion: int
    joint_type: SimulatedJointType
    slide_mm: float | None
    pronation_deg: float | None
    law: SimulatedLaw
    marker_noise_mm: float
    gaps: int
    gap_frames: int
    sign_flips: bool
    proximal: Literal["moving", "still"]
    repetitions: int
    rest_before_s: float
    hold_s: float
    rest_after_s: float
    skin_mm: float
    wander_deg: float
    tremor_deg: float
    tremor_hz: float
    seed: int
    arm: Literal["moving", "still"]
    axis_drift_deg: float
