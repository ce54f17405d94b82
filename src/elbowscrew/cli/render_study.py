"""What a person reads on the terminal of a batch."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from elbowscrew.cli.render import print_rows
from elbowscrew.cli.text import one_line, tell

if TYPE_CHECKING:
    from elbowscrew.study.study import StudyResult
    from elbowscrew.study.trials import Skipped

_SKIPPED_TOLD = 5
_FAILURES_TOLD = 10


def skipped_files(skipped: Sequence[Skipped], *, verbose: bool) -> None:
    """Tell what was passed over: of many the first few, unless all are asked for."""
    for one in skipped if verbose else skipped[:_SKIPPED_TOLD]:
        tell(f"elbowscrew: passed over: {one_line(f'{one.path}: {one.reason}')}")
    if len(skipped) > _SKIPPED_TOLD and not verbose:
        tell(f"elbowscrew: passed over: {len(skipped) - _SKIPPED_TOLD} more; --verbose names them")


def other_results(result: StudyResult) -> None:
    """Warn of results in the output folder that the tables do not tell of."""
    if result.others:
        told = ", ".join(result.others[:_SKIPPED_TOLD]) + (", ..." if len(result.others) > _SKIPPED_TOLD else "")
        message = f"{result.folder} holds results that do not belong to this batch and are not in summary.csv: {told}"
        tell(f"elbowscrew: warning: {one_line(message)} [other-results]")


def changed_results(result: StudyResult) -> None:
    """Warn of files of earlier results that were not as they had been written."""
    if result.changed:
        told = ", ".join(result.changed[:_SKIPPED_TOLD]) + (", ..." if len(result.changed) > _SKIPPED_TOLD else "")
        message = f"{result.folder}: edited, cut or missing, and made again by analyzing their trials: {told}"
        tell(f"elbowscrew: warning: {one_line(message)} [changed-results]")


def unread_results(result: StudyResult) -> None:
    """Tell of results that the page could not show, although they had just been finished."""
    for message in result.unread:
        tell(f"elbowscrew: error: {one_line(message)}")


def study_statement(result: StudyResult, skipped: Sequence[Skipped]) -> dict[str, Any]:
    """What a batch has done, ready for JSON."""
    return {
        "output": str(result.folder),
        "trials": len(result.names),
        "analyzed": len(result.names) - result.kept - len(result.failed),
        "up_to_date": result.kept,
        "with_warnings": result.warned,
        "failed": len(result.failed),
        "failures": [
            {
                "path": one.path,
                "error_class": one.failure.error_class,
                "message": one.failure.message,
                "exit_code": one.failure.exit_code,
            }
            for one in result.failed
        ],
        "skipped": [{"path": one.path, "reason": one.reason} for one in skipped],
        "changed_results": list(result.changed),
        "other_results": list(result.others),
    }


def study_table(result: StudyResult) -> None:
    """Write what a batch has done, and the first of its failures."""
    good = len(result.names) - len(result.failed)
    kept = f", {result.kept} of them up to date already" if result.kept else ""
    warned = f"; {result.warned} with warnings, see summary.csv" if result.warned else ""
    rows = [
        ("Trials", f"{len(result.names)}"),
        ("Results", f"{good}{kept}{warned}"),
        ("Failed", f"{len(result.failed)}"),
    ]
    rows += [("", one_line(one.failure.message)) for one in result.failed[:_FAILURES_TOLD]]
    if len(result.failed) > _FAILURES_TOLD:
        rows.append(("", f"and {len(result.failed) - _FAILURES_TOLD} more in failures.csv"))
    tables = ", ".join(("summary.csv", "failures.csv", "cycles.csv", "repetitions.csv"))
    print_rows("", [*rows, ("Tables", f"{tables} in {result.folder}"), ("Open", str(result.folder / "index.html"))])
