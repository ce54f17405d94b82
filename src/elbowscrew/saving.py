"""Results on disk: an analysis into one folder, a synthetic trial into its two files."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from elbowscrew._process import load_matplotlib
from elbowscrew.choices import DRAWN_FORMATS
from elbowscrew.errors import ElbowscrewError, OutputError, UsageError
from elbowscrew.model import Analysis, Comparison, Landmarks, RebuiltMotion, TrialsComparison
from elbowscrew.model.comparison_summary_types import ComparisonSummary, TrialsSummary
from elbowscrew.model.mesh import Mesh
from elbowscrew.model.summary_types import Summary
from elbowscrew.motion.analysis import analyze
from elbowscrew.opening import write_new
from elbowscrew.reading.registry import read_recording
from elbowscrew.results.exporting import EXPORTS, check_exports, write_exports
from elbowscrew.results.joint_summary import joint_summary
from elbowscrew.results.meshes_file import MESHES, meshes_file, placed_meshes
from elbowscrew.results.plugged import FAILED, write_by_plug_ins
from elbowscrew.results.result_files import COMPARISON
from elbowscrew.results.staging import result_folder, write_files
from elbowscrew.results.summary import summary_from_analysis
from elbowscrew.results.summary_reading import JOINT, SUMMARY
from elbowscrew.results.trial_views import view_of_analysis
from elbowscrew.results.writing import results_by_table, table_bytes, write_table, write_tables
from elbowscrew.settings import Settings
from elbowscrew.view.figure_names import caption_file, chosen_figures
from elbowscrew.view.trial_view import TrialView

if TYPE_CHECKING:
    from elbowscrew.simulate import SimulatedTrial


def analyze_file(
    path: Path, settings: Settings, *, distal_path: Path | None = None, landmarks: Landmarks | None = None
) -> Analysis:
    """Read one recording, of one file or of a file a body, with its markers, and analyze it; errors name the file.

    Raises
    ------
    RecordingError, SettingError, AnalysisError
        As `elbowscrew.read_recording` and `elbowscrew.analyze` do.
    """
    markers = (*settings.markers, *(() if landmarks is None else landmarks.markers))
    recording = read_recording(path, distal_path=distal_path, markers=markers, **settings.statements)
    try:
        return analyze(recording, settings, landmarks=landmarks)
    except ElbowscrewError as error:
        msg = f"{path}: {error}"
        raise type(error)(msg) from error


def check_output(settings: Settings) -> None:
    """Raise `UsageError` if what is to be written needs a library or a font that is not installed."""
    check_exports(settings.export)
    if settings.font is not None:
        from elbowscrew.plots.style import known_font

        known_font(settings.font)


def save_analysis(
    analysis: Analysis,
    folder: str | os.PathLike[str],
    *,
    overwrite: bool = False,
    figure_formats: Sequence[str] | None = None,
    exports: Sequence[str] | None = None,
    report: bool = True,
    meshes: Mapping[str, Mesh] | None = None,
) -> Path:
    """Write tables, ``summary.json``, ``joint.json``, ``figures/``, ``report.html`` and ``methods.txt`` into a folder.

    Whole or not at all. Figures and page are made of the numbers as the tables and JSON hold them, so that
    ``elbowscrew report`` makes the same of the folder at any later time.

    ``SHA256SUMS`` has the digests of all files, as ``sha256sum --check`` reads them.

    Parameters
    ----------
    analysis : Analysis
        From `elbowscrew.analyze`.
    folder : path-like
        Where to; it is made.
    overwrite : bool
        Replace an earlier result.
    figure_formats : sequence of {"png", "svg", "pdf", "tiff", "eps"}, optional
        Those of the analysis' settings by default; may be empty.
    exports : sequence of {"parquet", "mat", "sto"} or names of plug-ins, optional
        Formats of other programs to write the tables in, too; those of the analysis' settings by default.
    report : bool
        Write the page, and the methods as text.
    meshes : mapping of str to Mesh, optional
        Bones to draw in space, from `elbowscrew.read_mesh`, by the segment or the name of their body, in its frame.

    Returns
    -------
    Path
        The folder.

    Raises
    ------
    OutputError
        If a result is there already, or the disk does not take it; or if an export of a plug-in was not written: then
        all else is.
    UsageError
        If a format is not known, or its library is not installed, or a mesh is of no body of the trial.

    Examples
    --------
    >>> import elbowscrew, tempfile
    >>> analysis = elbowscrew.analyze(elbowscrew.simulate_trial().recording)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     (save_analysis(analysis, f"{folder}/result", figure_formats=()) / "screw.csv").exists()
    True
    """
    target = Path(folder)
    written = write_result(
        analysis, target, force=overwrite, figure_formats=figure_formats, exports=exports, report=report, meshes=meshes
    )
    check_written(written, target)
    return target


def check_written(summary: Summary, target: Path) -> None:
    """Raise `OutputError` if an export of a plug-in was not written, as the summary of a result tells."""
    failed = [one["message"] for one in summary["warnings"] if one["code"] == FAILED]
    if failed:
        msg = f"{target}: the result is there, but {'; '.join(failed)}"
        raise OutputError(msg)


def write_result(
    analysis: Analysis,
    target: Path,
    *,
    force: bool = False,
    figure_formats: Sequence[str] | None = None,
    exports: Sequence[str] | None = None,
    report: bool = True,
    meshes: Mapping[str, Mesh] | None = None,
) -> Summary:
    """Do what `save_analysis` does, and give the summary that was written; see `check_written`."""
    formats = _known_formats(analysis.settings.figure_formats if figure_formats is None else tuple(figure_formats))
    others = analysis.settings.export if exports is None else tuple(exports)
    check_exports(others)
    found, joint = summary_from_analysis(analysis), joint_summary(analysis)
    with result_folder(target, force=force) as staged:
        write_tables(staged, analysis)
        _write_json(staged / JOINT, joint)
        plugged = [name for name in dict.fromkeys(others) if name not in EXPORTS]
        failed = write_by_plug_ins(staged, plugged, results_by_table(analysis), found, joint)
        found["warnings"] = sorted([*found["warnings"], *failed], key=lambda one: one["severity"] == "note")
        figures = chosen_figures(analysis.settings.figures)
        view = view_of_analysis(analysis, found, joint, figures if formats else ())
        if meshes:
            view = replace(view, meshes=placed_meshes(view, meshes))
            write_new(staged / MESHES, meshes_file(view.meshes))
        if formats:
            _write_figures(staged, view, figures, formats)
        write_exports(staged, analysis, found, others)
        _write_json(staged / SUMMARY, found)
        if report:
            from elbowscrew.report.methods_file import METHODS, methods_file
            from elbowscrew.report.trial_page import PAGE, trial_page

            write_new(staged / METHODS, methods_file(view).encode("utf-8", "replace"))
            write_new(staged / PAGE, trial_page(view, staged, place=target).encode("utf-8", "replace"))
    return found


def _known_formats(formats: tuple[str, ...]) -> tuple[str, ...]:
    unknown = sorted(set(formats) - set(DRAWN_FORMATS))
    if unknown:
        msg = f"figure formats: expected {', '.join(DRAWN_FORMATS)}, found {', '.join(unknown)}"
        raise UsageError(msg)
    return formats


def _write_json(path: Path, content: Mapping[str, object]) -> None:
    text = json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    write_new(path, text.encode("utf-8", "replace"))


def _write_figures(staged: Path, view: TrialView, figures: Sequence[str], formats: Sequence[str]) -> None:
    load_matplotlib()
    from elbowscrew.report.figure_files import figure_files

    _write_all(staged / "figures", figure_files(view, figures, formats))


def _write_all(folder: Path, files: Mapping[str, bytes]) -> None:
    folder.mkdir()
    for name, content in files.items():
        write_new(folder / name, content)


def save_simulation(
    trial: SimulatedTrial,
    path: str | os.PathLike[str],
    *,
    layout: Literal["motive", "row-tagged"] = "motive",
    length_unit: Literal["m", "cm", "mm"] = "m",
    landmarks: bool = False,
    overwrite: bool = False,
) -> tuple[Path, ...]:
    """Write a synthetic trial in an OptiTrack layout, and the truth about it beside it.

    Parameters
    ----------
    trial : SimulatedTrial
        From `elbowscrew.simulate_trial`.
    path : path-like
        The export; the truth goes to the same name with ``.truth.json``.
    layout : {"motive", "row-tagged"}
        Motive's columns 1.23, or the row-tagged layout 1.1.
    length_unit : {"m", "cm", "mm"}
        Unit in the export; the row-tagged layout has meters always.
    landmarks : bool
        Write the landmarks of an elbow or a knee, too, to the same name with ``.landmarks.toml``.
    overwrite : bool
        Replace files of an earlier simulation.

    Returns
    -------
    tuple of Path
        The export, the truth and, if asked for, the landmarks.

    Raises
    ------
    UsageError
        If the layout does not have the unit, the joint has no landmarks, or the path is no name of a file.
    OutputError
        If a file exists, or the disk does not take it.

    Examples
    --------
    >>> import elbowscrew, tempfile
    >>> trial = elbowscrew.simulate_trial(frames=60, inversion=30)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     [path.name for path in save_simulation(trial, f"{folder}/trial.csv")]
    ['trial.csv', 'trial.truth.json']
    """
    from elbowscrew.results.landmarks_writer import landmarks_lines
    from elbowscrew.results.optitrack_writer import motive_columns_lines, row_tagged_lines

    export = Path(path)
    if not export.name or export.name in (".", ".."):
        msg = f"{str(path)!r} is not the name of a file to write; give one such as trial.csv"
        raise UsageError(msg)
    truth = export.with_suffix(".truth.json")
    if layout == "row-tagged" and length_unit != "m":
        msg = f"--length-unit {length_unit}: the row-tagged layout has meters always; leave the option out"
        raise UsageError(msg)
    if layout == "motive":
        take = " ".join(export.stem.encode("utf-8", "replace").decode("utf-8").split())
        lines = motive_columns_lines(trial.recording, trial.markers, length_unit, take)
    else:
        lines = row_tagged_lines(trial.recording, trial.markers)
    statement = {"about": "truth of a synthetic trial", **trial.truth}
    contents: dict[str, Iterable[str] | bytes] = {
        export.name: lines,
        truth.name: [json.dumps(statement, indent=1)],
    }
    if landmarks:
        if trial.landmarks is None:
            msg = "--landmarks: only an elbow and a knee have landmarks; leave it out, or give --joint elbow or knee"
            raise UsageError(msg)
        about = f"landmarks of a synthetic {trial.landmarks.joint}, in the frames of its two bodies"
        contents[export.with_suffix(".landmarks.toml").name] = landmarks_lines(trial.landmarks, about)
    write_files(export.parent, contents, replaceable=("synthetic",) if overwrite else None)
    return tuple(export.parent / name for name in contents)


def save_paper_figures(folder: str | os.PathLike[str]) -> tuple[Path, ...]:
    """Write the counterparts of the paper's figures 7 to 10: angle and Euler parameters, measured and modeled.

    They show a synthetic trial like the paper's: 450 frames at 100 Hz with the inversion at frame 211.

    Raises
    ------
    OutputError
        If a file is there already, or the disk does not take them.
    """
    load_matplotlib()
    from elbowscrew.report.figure_files import figure_files
    from elbowscrew.simulate import simulate_trial

    analysis = analyze(simulate_trial(marker_noise_mm=0.1, seed=2010).recording, Settings(inversion=211))
    names = {"figures_7_and_8.png": "theta", "figures_9_and_10.png": "euler_parameters"}
    drawn = figure_files(analysis, tuple(names.values()), ("png",))
    contents = {file: drawn[f"{name}.png"] for file, name in names.items()}
    write_files(Path(folder), contents, replaceable=None)
    return tuple(Path(folder) / name for name in contents)


def save_motion(motion: RebuiltMotion, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
    """Write a rebuilt motion as CSV, in degrees and millimeters.

    Parameters
    ----------
    motion : RebuiltMotion
        From `elbowscrew.interpolate`.
    path : path-like
        The file.
    overwrite : bool
        Replace an earlier such file.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    OutputError
        If a file is there, or the disk does not take it.

    Examples
    --------
    >>> import elbowscrew, tempfile
    >>> keyframes = elbowscrew.keyframes_of(elbowscrew.analyze(elbowscrew.simulate_trial().recording))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     save_motion(elbowscrew.interpolate(keyframes, 20), f"{folder}/motion.csv").name
    'motion.csv'
    """
    target = Path(path)
    content = table_bytes(motion, "deg", "mm")
    write_files(
        target.parent, {target.name: content}, replaceable=("frame,time_s,phase,t,theta",) if overwrite else None
    )
    return target


def save_comparison(
    comparison: Comparison | TrialsComparison,
    folder: str | os.PathLike[str],
    *,
    overwrite: bool = False,
    figure_formats: Sequence[str] | None = None,
) -> Path:
    """Write ``compare.csv``, ``compare.json`` and the figures of a comparison into a folder, whole or not at all.

    Parameters
    ----------
    comparison : Comparison or TrialsComparison
        From `elbowscrew.compare` or `elbowscrew.compare_trials`.
    folder : path-like
        Where to; it is made.
    overwrite : bool
        Replace an earlier comparison.
    figure_formats : sequence of {"png", "svg", "pdf", "tiff", "eps"}, optional
        Those of the settings by default; may be empty.

    Returns
    -------
    Path
        The folder.

    Raises
    ------
    OutputError
        If a result is there already, or the disk does not take it.
    UsageError
        If a figure format is not known.

    Examples
    --------
    >>> import elbowscrew, tempfile
    >>> plan = elbowscrew.ComparisonPlan(laws=("linear",), counts=(2,), data=("raw",))
    >>> found = elbowscrew.compare(elbowscrew.simulate_trial(frames=60, inversion=30).recording, plan=plan)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     (save_comparison(found, f"{folder}/result", figure_formats=()) / "compare.csv").exists()
    True
    """
    target = Path(folder)
    write_comparison(comparison, target, force=overwrite, figure_formats=figure_formats)
    return target


def write_comparison(
    comparison: Comparison | TrialsComparison,
    target: Path,
    *,
    force: bool = False,
    figure_formats: Sequence[str] | None = None,
) -> ComparisonSummary | TrialsSummary:
    """Do what `save_comparison` does, and give the summary that was written."""
    from elbowscrew.results.comparison_summary import comparison_summary, trials_summary

    settings = comparison.settings
    formats = _known_formats(settings.figure_formats if figure_formats is None else tuple(figure_formats))
    summary: ComparisonSummary | TrialsSummary = (
        comparison_summary(comparison) if isinstance(comparison, Comparison) else trials_summary(comparison)
    )
    with result_folder(target, force=force, kind=COMPARISON) as staged:
        write_table(staged / "compare.csv", comparison.models, settings.angle_unit, settings.length_unit)
        _write_json(staged / "compare.json", summary)
        if formats:
            load_matplotlib()
            from elbowscrew.plots.comparison import comparison_figure
            from elbowscrew.report.captions import comparison_caption
            from elbowscrew.report.figure_files import files_of

            drawn = files_of({"compare": lambda: comparison_figure(comparison)}, formats, settings.font)
            _write_all(staged / "figures", drawn | {caption_file("compare"): comparison_caption(comparison).encode()})
    return summary
