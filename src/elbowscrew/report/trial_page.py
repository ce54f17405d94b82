"""The page of one trial, from its finished result."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew.choices import JOINT_TYPE_WORDS
from elbowscrew.geometry._blocks import evenly_thinned
from elbowscrew.model.joint_summary_types import EstimateSummary, JointSummary
from elbowscrew.model.mesh import Mesh
from elbowscrew.report.bones_words import bone_angles, bone_words, bones_sentences
from elbowscrew.report.caption_words import frame_name
from elbowscrew.report.captions import caption_of
from elbowscrew.report.checklist import MISSING, checklist_of
from elbowscrew.report.joint_charts import angles_chart, wander_chart
from elbowscrew.report.joint_words import joint_sentences
from elbowscrew.report.methods import citations_of, methods_of
from elbowscrew.report.methods_file import METHODS
from elbowscrew.report.pages import INDEX, MARK, UNSHOWABLE, render, unshowable
from elbowscrew.report.scene import WIDEST, scene_of
from elbowscrew.report.trial_charts import (
    axis_chart,
    error_chart,
    euler_chart,
    model_name,
    repetition_chart,
    theta_chart,
)
from elbowscrew.results.joint_summary import preferred_fit
from elbowscrew.results.meshes_file import MESHES, MESHES_MARK, meshes_file, placed_meshes
from elbowscrew.results.proof import proof_of
from elbowscrew.results.result_files import BATCH_MARK, SUMS
from elbowscrew.results.staging import settle, write_files
from elbowscrew.results.summary import settings_summary
from elbowscrew.results.summary_reading import SUMMARY
from elbowscrew.results.trial_views import view_of_proved
from elbowscrew.settings import SETTINGS, Settings
from elbowscrew.view.figure_names import FIGURE_ENTRIES, caption_file
from elbowscrew.view.long_trials import stretch_of
from elbowscrew.view.trial_view import TrialView

_SCRIPTS: Final = ("page.js", "trial.js")
_DEEPEST: Final = 8  # folders between a result and that of its study
_FRAMES_TOLD: Final = 24
_LONG_TABLE: Final = 8  # rows; one that is longer is folded
_HARDLY_DEG: Final = 30.0  # a cone wider than this tells of no direction
_FILES: Final = (
    ("screw.csv", "measured motion and screw axis, frame by frame"),
    ("interpolation.csv", "modeled motion and its error, frame by frame"),
    ("keyframes.csv", "the poses of the model, with all that rebuilds it"),
    ("instantaneous.csv", "instantaneous axis, frame by frame"),
    ("repetitions.csv", "movement cycles, out and back"),
    ("cycles.csv", "every cycle over its own time"),
    ("repetition_curve.csv", "mean and standard deviation over the cycles"),
    ("steps.csv", "axes from step to step"),
    ("anatomy.csv", "anatomical angles"),
    ("summary.json", "results, quality, settings, provenance"),
    ("joint_angles.csv", "the joint's own angles, frame by frame"),
    ("axis_path.csv", "the joint's axis against its angle"),
    ("joint.json", "joint axis by all estimators"),
    ("meshes.json", "bones that are drawn"),
    (METHODS, "methods paragraph, references and reporting checklist as text"),
)


PAGE: Final = "report.html"
_TOLD_BY_TABLES: Final = ("cycles",)  # figures whose captions need more than a page does


def write_trial_page(folder: Path, meshes: Mapping[str, Mesh] | None = None) -> Path:
    """Write ``report.html`` into a result folder; see `elbowscrew.report.write_trial_page`."""
    settle(folder)
    proof = proof_of(folder)
    view = view_of_proved(proof, [name for name in _TOLD_BY_TABLES if _is_drawn(folder, name)])
    files: dict[str, bytes] = {}
    if meshes:
        view = replace(view, meshes=placed_meshes(view, meshes))
        files[MESHES] = meshes_file(view.meshes)
    try:
        files[PAGE] = trial_page(view, folder).encode("utf-8", "replace")
    except UNSHOWABLE as error:
        raise unshowable(folder, error) from error
    contents = {**files, SUMS: proof.with_files(files)}
    write_files(folder, contents, replaceable=(MARK, MESHES_MARK, f"  {SUMMARY}\n"))
    return folder / PAGE


def trial_page(trial: TrialView, folder: Path, *, place: Path | None = None) -> str:
    """Make the page of one trial.

    Parameters
    ----------
    trial : TrialView
        From `elbowscrew.results.trial_views.view_of_result`.
    folder : Path
        What else is in it is named.
    place : Path, optional
        Where the folder will be, if it is elsewhere while it is made.

    Returns
    -------
    str
        One HTML file that needs no other. The same result gives the same bytes.
    """
    summary, joint = trial.summary, trial.joint_summary
    curve, words = trial.repetition_curve, trial.named_joint
    warnings = summary["warnings"]
    content = {
        **_about_space(trial),
        "summary": summary,
        "source": summary["source"],
        "trial": summary["trial"],
        "model": summary["interpolation"],
        "proximal_name": f"still {words.proximal.name}" if trial.proximal_name is None else trial.proximal_name,
        "distal_name": trial.distal_name,
        "bodies": [body for body in (summary["trial"]["proximal"], summary["trial"]["distal"]) if body is not None],
        "lost_frames": int((~trial.valid & ~trial.filled).sum()),
        "warnings": [warning for warning in warnings if warning["severity"] == "warning"],
        "notes": [warning for warning in warnings if warning["severity"] != "warning"],
        "model_name": model_name(trial),
        "laws": " and ".join(dict.fromkeys(law["law"] for law in summary["interpolation"]["phase_laws"])),
        "min_angle_deg": trial.settings.min_angle_deg,
        "axis_sd_deg": trial.settings.axis_sd_deg,
        "long_table": _LONG_TABLE,
        "hardly_deg": _HARDLY_DEG,
        "stretch": stretch_of(trial),
        "theta_chart": theta_chart(trial),
        "angles_chart": angles_chart(trial),
        "wander_chart": wander_chart(trial),
        "axis_chart": axis_chart(trial) if trial.located else None,
        "error_chart": error_chart(trial),
        "euler_chart": euler_chart(trial),
        "curve_chart": None if curve is None else repetition_chart(curve, trial.repetitions.number.size),
        "estimates": _estimates(joint),
        "joint_sentences": joint_sentences(trial),
        "joint_words": JOINT_TYPE_WORDS,
        "bones": bone_words(trial),
        "bone_angles": bone_angles(trial),
        "bones_sentences": bones_sentences(trial),
        "axis_rows": _axis_rows(trial),
        "repetitions": _repetition_rows(trial),
        "settings": _settings(trial.settings),
        "other_units": (trial.settings.angle_unit, trial.settings.length_unit) != ("deg", "mm"),
        "methods": methods_of(trial),
        "citations": citations_of(trial),
        "checklist": checklist_of(trial),
        "missing": MISSING,
        "captions": [(name, caption_of(name, trial)) for name in FIGURE_ENTRIES if _is_drawn(folder, name)],
        "study": _study_page(place or folder),
        # Bones that are given with the page are written together with it.
        "files": [
            (name, text)
            for name, text in _FILES
            if (folder / name).is_file() or (name == MESHES and bool(trial.meshes))
        ],
    }
    scene = scene_of(trial) if trial.located else None
    source = summary["source"]
    names = (source["name"], source["take"], *(body["name"] for body in summary["trial"]["bodies"]))
    return render("trial.html", styles=("page.css",), scripts=_SCRIPTS, data=scene, content=content, names=names)


def _is_drawn(folder: Path, name: str) -> bool:
    return (folder / "figures" / caption_file(name)).is_file()


def _study_page(folder: Path) -> str | None:
    """Where the page of the study lies whose batch made a result: the batch's mark is there before its page."""
    above = folder.absolute().parents[:_DEEPEST]
    found = next((depth for depth, parent in enumerate(above, 1) if (parent / BATCH_MARK).is_file()), None)
    return None if found is None else "../" * found + INDEX


def space_page(trial: TrialView) -> str:
    """Make a page of the view in space alone, of a trial that has places."""
    return render(
        "space.html", styles=("page.css",), scripts=_SCRIPTS, data=scene_of(trial), content=_about_space(trial)
    )


def _about_space(trial: TrialView) -> dict[str, Any]:
    """What the view in space says beside what it draws."""
    summary, words = trial.summary, trial.named_joint
    return {
        "title": summary["source"]["name"] or "trial",
        "motion": summary["motion"],
        "joint": trial.joint_summary,
        "proximal_word": words.proximal.name,
        "distal_word": words.distal.name,
        "bones_drawn": [
            {"word": words.proximal.name if end == "proximal" else words.distal.name, "mesh": mesh}
            for end, mesh in trial.meshes.items()
        ],
        "frame_name": frame_name(trial),
        "widest_deg": float(np.degrees(WIDEST)),
    }


def _estimates(joint: JointSummary) -> list[dict[str, Any]]:
    """Rows of the table of the joint's axis, the one that is told at the top of the page marked."""
    estimates: list[tuple[str, EstimateSummary | None]] = [
        ("Mean of the axis as it wanders", joint["mean_axis"]),
        ("Hinge, maximum likelihood", joint["hinge"]),
        ("Screw-hinge, maximum likelihood", joint["screw_hinge"]),
        ("Weighted mean helical axis", joint["weighted_mean"]),
        ("SARA", joint["sara"]),
    ]
    best = joint["mean_axis"] or preferred_fit(joint)
    blank = dict.fromkeys(
        ("axis_cone95_deg", "point_radius95_mm", "pitch_mm_per_rad", "residual_rotation_deg", "residual_translation_mm")
    )
    return [
        {**blank, **estimate, "name": name, "preferred": estimate is best}
        for name, estimate in estimates
        if estimate is not None
    ]


def _axis_rows(trial: TrialView) -> list[dict[str, Any]]:
    """Some frames with an axis, evenly chosen over the time that has one."""
    known = np.flatnonzero(trial.axis_known & trial.valid)
    rows = evenly_thinned(known, _FRAMES_TOLD)
    columns = {
        "frame": trial.frame[rows],
        "time_s": trial.time_s[rows],
        "theta": np.degrees(trial.angle[rows]),
        "slide": 1000.0 * trial.slide[rows],
        "direction": trial.axis_direction[rows],
        "point": 1000.0 * trial.axis_point[rows],
        "cone": np.degrees(trial.axis_cone[rows]),
        "radius": 1000.0 * trial.point_radius[rows],
    }
    return _rows(columns)


def _repetition_rows(trial: TrialView) -> list[dict[str, Any]]:
    found = trial.repetitions
    return _rows(
        {
            "number": found.number,
            "frames": np.column_stack([found.start_frame, found.inversion_frame, found.end_frame]),
            "duration": found.duration_s,
            "top": np.degrees(found.top_angle),
            "range": np.degrees(found.angle_range),
            "slide": 1000.0 * found.slide_range,
            "outward": np.degrees(found.outward_speed),
            "back": np.degrees(found.back_speed),
            "deviation": np.degrees(found.axis_deviation),
        }
    )


def _rows(columns: Mapping[str, NDArray[Any]]) -> list[dict[str, Any]]:
    """Turn columns of equal length into rows."""
    values = zip(*(column.tolist() for column in columns.values()), strict=True)
    return [dict(zip(columns, row, strict=True)) for row in values]


def _settings(settings: Settings) -> list[tuple[str, Any, str, bool]]:
    """Give option, value, what it is, and whether it was chosen otherwise than by default."""
    values = settings_summary(settings)
    usual = settings_summary(Settings(tolerance_mm=settings.tolerance_mm))  # method and law go by the tolerance
    usual["tolerance"] = None
    if settings.columns is not None:
        values["columns"] = settings.columns.name
    return [(one.option, values[one.option], one.text, values[one.option] != usual[one.option]) for one in SETTINGS]
