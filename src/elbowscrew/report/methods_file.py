"""Methods paragraph, references and reporting checklist as a file of plain text, to be taken over into a paper."""

from __future__ import annotations

from typing import Final

from elbowscrew.report.checklist import checklist_lines
from elbowscrew.report.methods import citations_of, methods_of
from elbowscrew.view.trial_view import TrialView

METHODS: Final = "methods.txt"


def methods_file(view: TrialView) -> str:
    """Give the content of ``methods.txt``: a paragraph, a reference or an entry of the checklist a line.

    Parameters
    ----------
    view : TrialView

    Returns
    -------
    str
        The same result gives the same text.
    """
    parts = {
        "Methods": (methods_of(view),),
        "References": citations_of(view),
        "Reporting checklist": checklist_lines(view),
    }
    return "\n".join(_part(title, lines) for title, lines in parts.items())


def _part(title: str, lines: tuple[str, ...]) -> str:
    return "\n".join((title, "", *(" ".join(line.split()) for line in lines), ""))
