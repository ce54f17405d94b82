"""``elbowscrew paper``: the printed numbers, computed."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def paper(
    figures: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR", help="Write counterparts of figures 7 to 10, from a synthetic trial, to this folder."
        ),
    ] = None,
    json_output: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
) -> None:
    """Compute every number the 2010 paper prints.

    Each stands beside the printed one; the exit code is 1 if any differs.
    """
    from elbowscrew.cli import render
    from elbowscrew.paper import comparisons

    found = comparisons()
    if figures is not None:
        from elbowscrew.saving import save_paper_figures

        save_paper_figures(figures)
    if json_output:
        render.json_object(
            {
                "agree": sum(one.agrees for one in found),
                "differ": sum(not one.agrees for one in found),
                "numbers": [
                    {
                        "place": one.place,
                        "quantity": one.quantity,
                        "printed": one.printed,
                        "computed": one.computed,
                        "agrees": one.agrees,
                        "note": one.note if one.rounded != one.printed else "",
                    }
                    for one in found
                ],
            }
        )
    else:
        render.paper_table(found)
    if not all(one.agrees for one in found):
        raise typer.Exit(1)
