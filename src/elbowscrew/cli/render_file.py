"""What a person reads on the terminal of ``info``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from rich.table import Table
from rich.text import Text

from elbowscrew.cli.render import print_parts, print_rows, spread
from elbowscrew.cli.text import emit, one_line, printable

if TYPE_CHECKING:
    from elbowscrew.model.summary_types import FileSummary, FileTrial, QualitySummary

_TOLD = 24
_BONES = "solved by a model that constrains their joints; analyzed where --proximal and --distal name them"
_STATEMENTS = {"units", "rotation", "rate"}


def info_table(summary: FileSummary, *, everything: bool) -> None:
    """Write what a file holds: of many bodies, bones and markers the first, unless all are asked for."""
    source, trial = summary["source"], summary["trial"]
    missing = {one["option"] for one in summary["missing"]}
    most = None if everything else _TOLD
    rows = [
        ("Layout", ", ".join(filter(None, (source["layout"], _rotation(summary, missing), _unit(summary, missing))))),
        ("Take", source["take"] or "–"),
        ("Frames", _frames(trial)),
    ]
    clear = summary["roles"]["distal"] is not None
    if clear or not missing & _STATEMENTS:  # roles that are not clear are a question themselves
        rows.append(("Roles", summary["roles"]["text"]))
    if missing & _STATEMENTS:
        rows.append(("Not told", _question(summary)))
    print_rows(printable(source["name"] or ""), rows)
    told = [_marker(one["name"], one["seen_share"]) for one in summary["markers"]]
    lists = [(f"{len(told)} markers", _listed(told, most))] if told else []
    if summary["bones"]:
        lists.append((f"{len(summary['bones'])} bones", f"{_listed(summary['bones'], most)} ({_BONES})"))
    if lists:
        print_rows("", lists)
    if trial["bodies"]:
        _bodies_table(trial["bodies"], summary, most)
    notes = [warning for warning in summary["warnings"] if warning["severity"] == "note"]
    if notes:
        told = [one_line(f"{note['message']} [{note['code']}]") for note in notes]
        print_parts(Text("Notes", style="bold"), *map(Text, told))


def next_line(command: str, *, guessed: bool, seldom: Sequence[str], least_percent: float) -> None:
    """Write the command that analyzes the file, in one line of its own, as it is to be typed.

    Of bodies that are tracked too seldom it is told that they are refused.
    """
    which = ", if the first of the two is the proximal one" if guessed else ""
    if seldom:
        names = ", ".join(map(printable, seldom))
        emit(f"As it is, analyze refuses it: tracked in less than {least_percent:g} % of the frames: {names}.\n")
        which += ", once that is mended"
    emit(f"To analyze it{which}:\n{printable(command)}\n")


def _rotation(summary: FileSummary, missing: set[str]) -> str:
    rotation = summary["source"]["rotation"]
    if "rotation" in missing:
        return "Euler angles of unknown order"
    if not rotation:
        return "no rotations"
    return f"Euler {rotation} (deg)" if rotation.isupper() else rotation


def _unit(summary: FileSummary, missing: set[str]) -> str:
    return "unit of length unknown" if "units" in missing else summary["source"]["length_unit"] or "no positions"


def _frames(trial: FileTrial) -> str:
    counted = f"{trial['frames']} ({trial['first_frame']} to {trial['last_frame']})"
    if trial["rate_hz"] is None or trial["duration_s"] is None:
        return f"{counted}, rate unknown"
    return f"{counted}, {trial['rate_hz']:.6g} Hz, {trial['duration_s']:.3f} s"


def _question(summary: FileSummary) -> str:
    """All that is missing, in one question."""
    lacks, give = ([one[key] for one in summary["missing"]] for key in ("lacks", "give"))
    return f"the file {', '.join(lacks[:-1])}{' and ' if lacks[:-1] else ''}{lacks[-1]}: give {'; '.join(give)}"


def _marker(name: str, seen_share: float | None) -> str:
    return name if seen_share is None else f"{name} {100.0 * seen_share:.0f} %"


def _listed(items: Sequence[str], most: int | None) -> str:
    more = 0 if most is None else len(items) - most
    return ", ".join(items[:most]) + (f" and {more} more (--all)" if more > 0 else "")


def _bodies_table(bodies: Sequence[QualitySummary], summary: FileSummary, most: int | None) -> None:
    table = Table(box=None, pad_edge=False, header_style="bold")
    for column in ("", "Body", "Tracked", "Lost frames", "Fastest", "Fit, mm", "Error, mm"):
        table.add_column(column, overflow="fold")
    no_speed = None if "units" in {one["option"] for one in summary["missing"]} else "no positions"
    for number, body in enumerate(bodies[:most], 1):
        turn, speed = body["fastest_turn_deg_s"], body["fastest_speed_m_s"]
        told_speed = no_speed if speed is None else f"{speed:.1f} m/s"
        table.add_row(
            "bone" if body["name"] in summary["bones"] else f"#{number}",
            Text(printable(body["name"])),
            f"{100.0 * body['tracked_share']:.1f} %",
            ", ".join(f"{count} {reason}" for reason, count in body["lost_frames"].items()) or "–",
            ", ".join(filter(None, (None if turn is None else f"{turn:.0f} deg/s", told_speed))) or "–",
            spread(body["marker_residual_mm"]),
            spread(body["reported_error_mm"]),
        )
    more = 0 if most is None else len(bodies) - most
    print_parts(table, *([Text(f"and {more} more bodies (--all)")] if more > 0 else []))
