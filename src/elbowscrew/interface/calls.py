"""The functions of the Python interface: each takes a path or what was read from it, and settings as keywords."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

from elbowscrew import comparing, simulate
from elbowscrew.configuring import settings_with
from elbowscrew.errors import ElbowscrewError, ResultError, UsageError
from elbowscrew.interface.analysis import Analysis
from elbowscrew.interface.fields import ComparisonFields, SettingsFields, SimulationFields
from elbowscrew.model import Analysis as Findings
from elbowscrew.model import Comparison, KeyframeSet, Landmarks, RebuiltMotion, Recording, TrialsComparison
from elbowscrew.motion import analysis as analyzing
from elbowscrew.motion.interpolation import comparison, rebuilding
from elbowscrew.motion.interpolation.keyframe_sources import ComparisonPlan
from elbowscrew.reading.landmarks import read_landmarks
from elbowscrew.reading.registry import read_recording
from elbowscrew.results.keyframe_table import read_keyframes
from elbowscrew.saving import analyze_file
from elbowscrew.settings import Settings
from elbowscrew.simulate import SimulatedTrial, Simulation

if TYPE_CHECKING:
    from elbowscrew.interface.study import StudyResult

StrPath = str | os.PathLike[str]


def analyze(
    recording: Recording | SimulatedTrial | StrPath,
    settings: Settings | None = None,
    *,
    landmarks: Landmarks | StrPath | None = None,
    **fields: Unpack[SettingsFields],
) -> Analysis:
    """Analyze one recording: screw motion, joint, cycles, model from keyframes, and their difference.

    Parameters
    ----------
    recording : Recording, SimulatedTrial or path-like
        A file, or what `elbowscrew.read_recording` gives, or a recording built from bodies, or a synthetic trial.
    settings : Settings, optional
        The paper's choices by default.
    landmarks : Landmarks or path-like, optional
        For the anatomical angles: a file, or what `elbowscrew.read_landmarks` gives; a recording that was read before
        must have their markers.
    **fields
        Fields of `elbowscrew.Settings`, stronger than `settings`.

    Returns
    -------
    Analysis
        In SI units and radians; NaN where something is not defined or not known.

    Raises
    ------
    UsageError
        If a field or its value is not a possible one.
    SettingError
        If a setting does not fit the recording.
    AnalysisError
        If there is too little tracking or rotation.
    RecordingError
        If the file cannot be read, or has no usable clock.

    References
    ----------
    P 33-36.

    Examples
    --------
    >>> import elbowscrew
    >>> recording = elbowscrew.simulate_trial(marker_noise_mm=0).recording
    >>> analysis = elbowscrew.analyze(recording, keyframes=[0, 211, 449])
    >>> analysis.keyframes.frame.tolist()
    [0, 211, 449]
    """
    wanted = settings_with(settings, fields)
    recording = _recording_or_path(recording)
    known = read_landmarks(landmarks) if isinstance(landmarks, str | os.PathLike) else landmarks
    if isinstance(recording, Recording):
        return Analysis.of(analyzing.analyze(recording, wanted, landmarks=known))
    return Analysis.of(analyze_file(Path(recording), wanted, landmarks=known))


def _recording_or_path(given: Recording | SimulatedTrial | StrPath) -> Recording | StrPath:
    if isinstance(given, SimulatedTrial):
        return given.recording
    if not isinstance(given, Recording | str | os.PathLike):
        msg = (
            f"expected a recording or the path of one, found {type(given).__name__}; arrays become one by "
            "RigidBody.from_quaternions or RigidBody.from_matrices, and Recording.from_bodies"
        )
        raise UsageError(msg)
    return given


def read_result(folder: StrPath) -> Analysis:
    """Read the result of a trial back, without analyzing anything again.

    Parameters
    ----------
    folder : path-like
        As `elbowscrew.save_analysis` or the command line wrote it, in whatever units.

    Returns
    -------
    Analysis
        With all that the files hold, but for the last digit of some numbers: tables, summaries, plots. What they do not
        hold raises `NotKeptError` when it is asked for; the class says what that is.

    Raises
    ------
    ResultError
        If the folder holds no finished result, or one that is damaged or was edited.

    Examples
    --------
    >>> import elbowscrew, tempfile
    >>> analysis = elbowscrew.analyze(elbowscrew.simulate_trial().recording)
    >>> with tempfile.TemporaryDirectory() as place:
    ...     folder = elbowscrew.save_analysis(analysis, f"{place}/result", figure_formats=(), report=False)
    ...     bool((elbowscrew.read_result(folder).screw.valid == analysis.screw.valid).all())
    True
    """
    place = Path(folder)
    if place.is_file():
        msg = f"{place}: is a file; give the folder of the result, as {place.parent}"
        raise ResultError(msg)
    return Analysis.read(place)


def compare(
    recording: Recording | SimulatedTrial | StrPath,
    settings: Settings | None = None,
    plan: ComparisonPlan | None = None,
    *,
    report: Callable[[int, int], None] = lambda _done, _total: None,
    **fields: Unpack[ComparisonFields],
) -> Comparison:
    """Compare models of one motion: methods, laws of motion and numbers of keyframes, the best first.

    Each model's keyframes stand evenly in time in each phase of the motion. The difference is that from the measured
    motion, unfiltered and at its own rate, whatever the keyframes were taken from, so that all models have the same
    yardstick. Combinations that are the same model by definition are there once: between two poses DLB is sDLB, and
    DIB and Catmull-Rom are ScLERP; with the law's knots ScLERP, sDLB and the joint's angles do not know of the blend.

    Parameters
    ----------
    recording : Recording, SimulatedTrial or path-like
        A file, or what `elbowscrew.read_recording` gives, or a synthetic trial.
    settings : Settings, optional
        What does not belong to the plan: bodies, phases, points, and so on. Its tolerance is that of the selection,
        2 mm by default (2 deg of orientations alone), and its low-pass that of the filtered keyframes, found by
        residual analysis by default.
    plan : ComparisonPlan, optional
        Which models; all by default.
    report : callable
        Told after each step how many are done, and of how many: a step a model, and the fewest keyframes as the last.
    **fields
        Fields of `elbowscrew.Settings` and of `elbowscrew.ComparisonPlan`, stronger than `settings` and `plan`; of the
        latter not ``knots``, which is a field of both.

    Returns
    -------
    Comparison

    Raises
    ------
    UsageError, SettingError, AnalysisError, RecordingError
        As `elbowscrew.analyze`.

    Examples
    --------
    >>> import elbowscrew
    >>> recording = elbowscrew.simulate_trial(marker_noise_mm=0).recording
    >>> compared = elbowscrew.compare(recording, laws=["linear", "polynomial-345"], counts=[2], data=["raw"])
    >>> str(compared.models.law[0])
    'polynomial-345'
    """
    plan, others = _planned(plan, fields)
    wanted = settings_with(settings, others)
    recording = _recording_or_path(recording)
    if isinstance(recording, Recording):
        return comparison.compare(recording, wanted, plan, report=report)
    read = read_recording(recording, markers=wanted.markers, **wanted.statements)
    try:
        return comparison.compare(read, wanted, plan, report=report)
    except ElbowscrewError as error:
        error.args = (f"{recording}: {error}", *error.args[1:])
        raise


def compare_trials(
    paths: Iterable[StrPath] | StrPath,
    settings: Settings | None = None,
    plan: ComparisonPlan | None = None,
    *,
    report: Callable[[int, int], None] = lambda _done, _total: None,
    **fields: Unpack[ComparisonFields],
) -> TrialsComparison:
    """Compare models over several recordings: mean and standard deviation of their errors.

    Parameters
    ----------
    paths : iterable of path-like, or path-like
        Recordings, each compared by itself as `elbowscrew.compare` does.
    settings : Settings, optional
    plan : ComparisonPlan, optional
    report : callable
        Told after each recording how many are done, and of how many.
    **fields
        Fields of `elbowscrew.Settings` and of `elbowscrew.ComparisonPlan`, stronger than `settings` and `plan`; of the
        latter not ``knots``, which is a field of both.

    Returns
    -------
    TrialsComparison
        Filtered keyframes count as one choice, whatever cut-off each trial has. A model that fails in a trial counts
        over the others.

    Raises
    ------
    UsageError
        If a field or its value is not a possible one.
    AnalysisError
        If no recording can be compared; it says why of the first.

    Examples
    --------
    >>> import elbowscrew, tempfile
    >>> plan = elbowscrew.ComparisonPlan(laws=("linear",), counts=(2,), data=("raw",))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     paths = [f"{folder}/{seed}.csv" for seed in range(2)]
    ...     for seed, path in enumerate(paths):
    ...         trial = elbowscrew.simulate_trial(frames=60, inversion=30, seed=seed)
    ...         _ = elbowscrew.save_simulation(trial, path)
    ...     set(elbowscrew.compare_trials(paths, plan=plan).models.trials.tolist())
    {2}
    """
    plan, others = _planned(plan, fields)
    return comparing.compare_trials(paths, settings_with(settings, others), plan, report=report)


def _planned(plan: ComparisonPlan | None, fields: ComparisonFields) -> tuple[ComparisonPlan | None, dict[str, Any]]:
    """Take the fields of a plan out of keywords."""
    own = set(ComparisonFields.__annotations__) - set(SettingsFields.__annotations__)
    others = {name: value for name, value in fields.items() if name not in own}
    asked = {name: _several(value) for name, value in fields.items() if name in own}
    return (replace(plan or ComparisonPlan(), **asked) if asked else plan), others


def _several(value: Any) -> tuple[Any, ...]:
    return (value,) if isinstance(value, str | int) else tuple(value)


def batch(
    paths: StrPath | Sequence[StrPath],
    folder: StrPath = "batch_elbowscrew",
    settings: Settings | None = None,
    *,
    landmarks: StrPath | None = None,
    recursive: bool = False,
    workers: int | None = None,
    overwrite: bool = False,
    report: Callable[[int, int], None] = lambda _done, _total: None,
    **fields: Unpack[SettingsFields],
) -> StudyResult:
    """Analyze every trial of a study into one folder, as the command ``elbowscrew batch`` does.

    The trials are analyzed by processes of their own, which import the script that calls this: in a file, let it stand
    below ``if __name__ == "__main__":``; in a notebook nothing is needed.

    Parameters
    ----------
    paths : path-like or sequence of path-like
        Folders, files, patterns, or a manifest: a CSV with a column ``path``.
    folder : path-like
        Where to: new, empty, or of an earlier batch, which is taken up where it was left.
    settings : Settings, optional
        For all trials; what a manifest sets for a trial is stronger.
    landmarks : path-like, optional
        Landmarks of trials for which a manifest names none.
    recursive : bool
        Look into the folders below, too.
    workers : int, optional
        Trials analyzed at the same time; as many as there are cores by default.
    overwrite : bool
        Analyze all trials again, even those whose results are up to date.
    report : callable
        Told after each trial how many are done, and of how many.
    **fields
        Fields of `elbowscrew.Settings`, stronger than `settings`.

    Returns
    -------
    StudyResult
        A row a trial, the failures, and each trial's result.

    Raises
    ------
    UsageError
        If settings, landmarks or paths are not possible ones.
    OutputError
        If the output folder is held by another batch, or the disk does not take the results.

    Examples
    --------
    >>> import elbowscrew  # doctest: +SKIP
    >>> study = elbowscrew.batch("trials", "results", lowpass_hz=6)  # doctest: +SKIP
    >>> study.to_frame()["theta_max_deg"].mean()  # doctest: +SKIP
    """
    from elbowscrew.interface.study import run  # with pages and processes, which one trial does not need

    given = [paths] if isinstance(paths, str | os.PathLike) else list(paths)
    return run(
        [os.fspath(path) for path in given],
        Path(folder),
        settings_with(settings, fields),
        landmarks=None if landmarks is None else Path(landmarks),
        recursive=recursive,
        workers=workers,
        overwrite=overwrite,
        report=report,
    )


def interpolate(keyframes: KeyframeSet | Findings | StrPath, frames: int) -> RebuiltMotion:
    """Rebuild the motion between keyframes, frames evenly in time from the first to the last.

    Parameters
    ----------
    keyframes : KeyframeSet, Analysis or path-like
        From `elbowscrew.keyframes_of` or `elbowscrew.read_keyframes`, the analysis that has them, or its folder, or a
        file.
    frames : int
        Two at least.

    Returns
    -------
    RebuiltMotion
        The angle has the sense that it has at the keyframes.

    Raises
    ------
    RecordingError
        If a file cannot be read.
    SettingError
        If a law is not known in closed form, or the poses cannot be blended so.

    References
    ----------
    P 30-36.

    Examples
    --------
    >>> import elbowscrew
    >>> analysis = elbowscrew.analyze(elbowscrew.simulate_trial(marker_noise_mm=0).recording)
    >>> motion = elbowscrew.interpolate(analysis, 450)
    >>> bool(abs(motion.angle - analysis.interpolated.angle).max() < 1e-9)
    True
    """
    if isinstance(keyframes, Findings):
        return rebuilding.interpolate(rebuilding.keyframes_of(keyframes), frames)
    if isinstance(keyframes, KeyframeSet):
        return rebuilding.interpolate(keyframes, frames)
    place = Path(keyframes)
    return rebuilding.interpolate(read_keyframes(place / "keyframes.csv" if place.is_dir() else place), frames)


def simulate_trial(simulation: Simulation | None = None, **fields: Unpack[SimulationFields]) -> SimulatedTrial:
    """Simulate a joint of a known type.

    Parameters
    ----------
    simulation : Simulation, optional
        An elbow's plain flexion and extension by default, about one line along which it slides.
    **fields
        Fields of `elbowscrew.Simulation`, stronger than `simulation`.

    Returns
    -------
    SimulatedTrial
        With bodies named as the joint's segments, such as Upper Arm and Forearm.

    Raises
    ------
    UsageError
        If a value is not a possible one.

    Examples
    --------
    >>> import elbowscrew
    >>> trial = elbowscrew.simulate_trial(top_deg=142, seed=3)
    >>> [body.name for body in trial.recording.bodies], trial.recording.frame.size
    (['Upper Arm', 'Forearm'], 450)
    >>> elbowscrew.simulate_trial(joint_type="two-axes").truth["two_axes"]["angle_between_deg"] > 70
    True
    """
    return simulate.simulate_trial(simulation, **fields)
