"""What a person reads on the terminal: results on standard output, warnings on standard error."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console, RenderableType
from rich.table import Table
from rich.text import Text

from elbowscrew.cli.render_joint import anatomy_rows, joint_axis_text, joint_text, place_text
from elbowscrew.cli.text import emit, one_line, printable, tell, two_decimals, vector_text

if TYPE_CHECKING:
    from elbowscrew.model.comparison_summary_types import ComparisonSummary, ModelChoice, TrialsSummary
    from elbowscrew.model.summary_types import (
        JointWords,
        ModelSummary,
        MotionSummary,
        QualitySummary,
        SelectionSummary,
        SpreadSummary,
        Summary,
        TrialSummary,
        WarningSummary,
    )
    from elbowscrew.paper import PrintedValue

_FRAMES_TOLD = 12
_SKIPPED_TOLD = 5
_PEAKS_TOLD = 6
_FAILURES_TOLD = 10


def warnings(found: Iterable[WarningSummary]) -> None:
    """Write one line a warning; notes are for those who look at the recording."""
    for warning in found:
        if warning["severity"] != "warning":
            continue
        tell(f"elbowscrew: warning: {one_line(warning['message'])} [{warning['code']}]")


def note(text: str) -> None:
    """Write one line of what went wrong beside the result."""
    tell(f"elbowscrew: {one_line(text)}")


def json_object(value: Mapping[str, object]) -> None:
    """Write one JSON object."""
    emit(json.dumps(value, indent=2, ensure_ascii=True, allow_nan=False) + "\n")


def files(folder: Path) -> None:
    """Name the files of a result on standard error."""
    for path in sorted(folder.rglob("*")):
        if path.is_file():
            tell(printable(str(path)))


def analysis_table(summary: Summary, folder: Path) -> None:
    """Write the result of one trial at a glance."""
    trial, motion, model = summary["trial"], summary["motion"], summary["interpolation"]
    rows = [
        ("Bodies", f"{_body(trial['proximal'], trial['joint'])} → {_body(trial['distal'], trial['joint'])}"),
        ("Frames", _frames(trial)),
        (
            "Angle θ",
            f"{two_decimals(motion['theta_min_deg'])} to {two_decimals(motion['theta_max_deg'])} deg"
            + ("" if motion["signed"] else ", without a sense"),
        ),
        ("Inversion", _inversions(motion["inversion_frames"])),
        (
            "Slide",
            f"median {two_decimals(motion['slide_median_mm'])} mm ({two_decimals(motion['slide_min_mm'])} to "
            f"{two_decimals(motion['slide_max_mm'])})"
            if trial["positions"]
            else "not known, as all places: there are orientations and no positions",
        ),
        (
            "Mean axis",
            f"direction ({vector_text(motion['mean_axis']['direction'], 4)})"
            + place_text(motion["mean_axis"]["point_mm"])
            + f", in the {motion['expressed_in']} frame",
        ),
        ("Joint", joint_text(motion["joint_type"])),
        ("Joint axis", joint_axis_text(motion, located=trial["positions"])),
        *anatomy_rows(motion["anatomy"]),
        ("Dispersion", _dispersion(motion)),
        (
            "Model",
            f"{model['method']} {model['blend']}, {model['law']} law, keyframes {_numbers(model['keyframes'])}"
            f"; covers {100.0 * model['covered_share']:.0f} % of the recording",
        ),
        *_fitted_peaks(model),
        (
            "Model error",
            f"rotation {two_decimals(model['rms_angle_error_deg'])} deg RMS, "
            f"{two_decimals(model['max_angle_error_deg'])} at most (frame {model['max_angle_error_frame']})"
            + _displacement(model),
        ),
        ("Results", str(folder)),
        *([("Open", str(page))] if (page := folder / "report.html").is_file() else []),
    ]
    print_rows(printable(summary["source"]["name"] or ""), rows)


def comparison_table(summary: ComparisonSummary | TrialsSummary, folder: Path) -> None:
    """Write the best models of each number of keyframes, and the fewest keyframes within the tolerance."""
    table = Table(box=None, pad_edge=False, header_style="bold")
    unit = _unit_of_errors(summary)
    for column in ("N", "Method", "Law", "Keyframes from", f"RMS, {unit}", f"Max, {unit}", "ns/frame"):
        text = column in ("Method", "Law", "Keyframes from")
        table.add_column(column, justify="left" if text else "right", no_wrap="trials" not in summary)
    models = f"{summary['models']} compared"
    if "trials" in summary:
        for mean in summary["best_by_keyframes"]:
            if unit == "mm":
                rms = _mean_sd(mean["rms_displacement_mean_mm"], mean["rms_displacement_sd_mm"])
                most = _mean_sd(mean["max_displacement_mean_mm"], mean["max_displacement_sd_mm"])
            else:
                rms = _mean_sd(mean["rms_angle_error_mean_deg"], mean["rms_angle_error_sd_deg"])
                most = _mean_sd(mean["max_angle_error_mean_deg"], mean["max_angle_error_sd_deg"])
            table.add_row(*_model(mean), rms, most, f"{mean['ns_per_frame_mean']:.0f}")
        rows = [
            ("Models", models),
            ("Trials", f"{len(summary['trials'])} compared, {len(summary['failures'])} failed"),
        ]
    else:
        for one in summary["best_by_keyframes"]:
            errors = one["rms_displacement_mm"], one["max_displacement_mm"]
            errors = errors if unit == "mm" else (one["rms_angle_error_deg"], one["max_angle_error_deg"])
            rms, most = map(two_decimals, errors)
            table.add_row(*_model(one), rms, most, f"{one['ns_per_frame']:.0f}")
        refused = f", {summary['refused']} of them refused" if summary["refused"] else ""
        rows = [("Models", models + refused)]
        rows += [(f"Fewest, {method}", _fewest(found)) for method, found in summary["selections"].items()]
    rows.append(("Results", str(folder)))
    what = "RMS displacement of the distal body's points" if unit == "mm" else "Angle between model and measurement"
    print_parts(Text(f"{what}, for N keyframes in each phase", style="bold"), table)
    print_rows("", rows)


def _unit_of_errors(summary: ComparisonSummary | TrialsSummary) -> str:
    """Models are told by their displacements; of orientations alone, or where trials are, by their angles."""
    if "trials" in summary:
        means = [one["rms_displacement_mean_mm"] for one in summary["best_by_keyframes"]]
        return "mm" if all(mean is not None for mean in means) else "deg"
    return "mm" if all(one["rms_displacement_mm"] is not None for one in summary["best_by_keyframes"]) else "deg"


def _fewest(found: SelectionSummary) -> str:
    count = f"{found['keyframes']} keyframes of {found['frames']} frames (1 : {found['compression_ratio']:.1f})"
    deg = found["tolerance_deg"]
    limit = f"{found['tolerance_mm']:g} mm" if deg is None else f"{deg:g} deg"
    return f"{count} within {limit}: {_numbers(found['keyframe_frames'])}"


def _inversions(frames: Sequence[int]) -> str:
    return f"frame{'s' if len(frames) > 1 else ''} {_numbers(frames)}" if frames else "none"


def _numbers(frames: Sequence[int]) -> str:
    """Frame numbers, of many the first."""
    told = ", ".join(map(str, frames[:_FRAMES_TOLD]))
    return told if len(frames) <= _FRAMES_TOLD else f"{told} and {len(frames) - _FRAMES_TOLD} more"


def _model(best: ModelChoice) -> tuple[str, str, str, str]:
    method = best["method"] + ("" if best["blend"] == "piecewise" else " global")
    return str(best["keyframes_per_phase"]), method, best["law"], best["data"]


def _mean_sd(mean: float | None, sd: float | None) -> str:
    return two_decimals(mean) + ("" if sd is None else f" ± {sd:.2f}")


def spread(found: SpreadSummary | None) -> str:
    """Give median and maximum."""
    return "–" if found is None else f"{found['median']:.2f}, max {found['largest']:.2f}"


def paper_table(found: Iterable[PrintedValue]) -> None:
    """Write printed and computed numbers side by side."""
    table = Table(box=None, pad_edge=False, header_style="bold")
    for column, justify in (
        ("In the paper", "left"),
        ("", "left"),
        ("printed", "right"),
        ("computed", "right"),
        ("", "left"),
    ):
        table.add_column(column, justify=justify)  # type: ignore[arg-type]
    counts = [0, 0]
    for one in found:
        counts[one.agrees] += 1
        word = "" if one.rounded == one.printed else one.note if one.agrees else "DIFFERS"
        table.add_row(one.place, one.quantity, one.printed, one.rounded, word)
    print_parts(table, Text(f"{counts[1]} numbers agree, {counts[0]} differ"))


def print_parts(*parts: RenderableType) -> None:
    """Write tables and texts."""
    console = Console(highlight=False)
    with console.capture() as captured:
        for part in parts:
            console.print(part)
    emit(captured.get())


def print_rows(title: str, rows: Iterable[tuple[str, str]]) -> None:
    """Write a table of names and values, under a title if there is one."""
    table = Table(box=None, show_header=False, pad_edge=False)
    table.add_column(style="bold", no_wrap=True)
    table.add_column(overflow="fold")
    for name, value in rows:
        table.add_row(name, Text(printable(value)))
    print_parts(*([Text(title, style="bold")] if title else []), table)


def _body(body: QualitySummary | None, joint: JointWords) -> str:
    if body is None:
        return f"still {joint['proximal']}"
    return f"{body['name']} ({100.0 * body['tracked_share']:.1f} % tracked)"


def _frames(trial: TrialSummary) -> str:
    lost = trial["frames"] - trial["measured_frames"] - trial["filled_frames"]
    parts = [f"{trial['frames']} at {trial['rate_hz']:.6g} Hz ({trial['duration_s']:.2f} s)"]
    parts += [f"{trial['filled_frames']} filled"] if trial["filled_frames"] else []
    parts += [f"{lost} lost"] if lost else []
    return ", ".join(parts)


def _fitted_peaks(model: ModelSummary) -> Iterable[tuple[str, str]]:
    """Tell where in each phase the velocity of a fitted law is highest, and how far that is known."""
    known = [(law["peak"], law["peak_sd"]) for law in model["phase_laws"]]
    fitted = [(peak, sd) for peak, sd in known if peak is not None and sd is not None]
    if fitted:
        shown = ", ".join(f"{100.0 * peak:.1f} ± {100.0 * sd:.1f}" for peak, sd in fitted[:_PEAKS_TOLD])
        more = f" and {len(fitted) - _PEAKS_TOLD} more" if len(fitted) > _PEAKS_TOLD else ""
        yield "Highest velocity", f"at {shown}{more} % of the phases (± one standard deviation)"


def _dispersion(motion: MotionSummary) -> str:
    dispersion, of_frames = motion["axis_dispersion_deg"], motion["axis_dispersion_all_frames_deg"]
    if dispersion is None or of_frames is None:
        return "none: one frame alone has an axis"
    return (
        f"median {dispersion:.2f} deg by equal steps of the angle, {of_frames:.2f} over the {motion['axis_frames']} "
        "frames with an axis"
    )


def _displacement(model: ModelSummary) -> str:
    if model["points"]["radius_of_gyration_mm"] is None:
        return ""
    over = "" if model["points"]["from"] == "markers" else f" ({_radius(model)})"
    return f"; displacement {two_decimals(model['rms_displacement_mm'])} mm RMS{over}"


def _radius(model: ModelSummary) -> str:
    return f"radius of gyration {model['points']['radius_of_gyration_mm']:g} mm"
