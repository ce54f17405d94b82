"""``elbowscrew batch``: every trial of a study into one folder."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from elbowscrew.cli import options
from elbowscrew.cli.analysis_options import OUTPUT, settings_options

_TRIALS, _WORK = "Trials", "Work"

SOME_FAILED = 7

_HANDED_TO_CLUSTER = 1000  # it may grow while it works


@settings_options()
def batch(
    paths: Annotated[
        list[str],
        typer.Argument(
            metavar="PATH",
            help="Folders, files, patterns, or a manifest: a CSV with a column 'path'.",
            show_default=False,
        ),
    ],
    output: Annotated[
        Path,
        typer.Option("--output", "-o", metavar="DIR", rich_help_panel=OUTPUT, help="Output folder."),
    ] = Path("batch_elbowscrew"),
    recursive: Annotated[
        bool, typer.Option("--recursive", help="Search subfolders, too.", rich_help_panel=_TRIALS)
    ] = False,
    follow_symlinks: Annotated[
        bool,
        typer.Option("--follow-symlinks", help="Follow links that lead out of the folder.", rich_help_panel=_TRIALS),
    ] = False,
    workers: Annotated[
        int | None,
        typer.Option(
            min=1,
            max=1024,
            metavar="N",
            rich_help_panel=_WORK,
            help="Trials analyzed at the same time.",
            show_default="all cores",
        ),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            rich_help_panel=_WORK,
            help="Dask scheduler: tcp://host:port, tls://host:port or local-cluster.",
            show_default="this machine's cores",
        ),
    ] = None,
    wait: Annotated[
        float,
        typer.Option(
            min=0.0,
            max=1e6,
            metavar="SECONDS",
            rich_help_panel=_WORK,
            help="How long to wait for a cluster's first worker.",
        ),
    ] = 10.0,
    restart: Annotated[
        bool,
        typer.Option(
            "--restart",
            "--force",
            rich_help_panel=_WORK,
            help="Analyze all trials again, even those whose results are up to date.",
        ),
    ] = False,
    *,
    given: dict[str, Any],
    landmarks: options.LandmarksFile = None,
    config: Annotated[
        Path | None, typer.Option(metavar="FILE.toml", rich_help_panel=OUTPUT, help="Settings; options override them.")
    ] = None,
    json_output: Annotated[bool, typer.Option("--json", help="Print one JSON object.", rich_help_panel=OUTPUT)] = False,
    quiet: options.Quiet = False,
    verbose: Annotated[
        bool,
        typer.Option("--verbose", "-v", help="Name every file that was skipped or failed.", rich_help_panel=OUTPUT),
    ] = False,
) -> None:
    """Analyze every trial of a study.

    A result folder for each, summary.csv and failures.csv; what is up to date stays. Exit code 7: some failed.
    """
    from elbowscrew.cli import render, render_study
    from elbowscrew.cli.progress import shown_progress
    from elbowscrew.configuring import settings_from
    from elbowscrew.errors import ResultError
    from elbowscrew.study.cluster import LOCAL_CLUSTER
    from elbowscrew.study.executors import available_cores, open_executor
    from elbowscrew.study.study import run_study
    from elbowscrew.study.trials import find_trials

    of_cluster = scheduler is not None and scheduler != LOCAL_CLUSTER
    count = workers or (_HANDED_TO_CLUSTER if of_cluster else available_cores())
    executor = open_executor(scheduler, count, wait)
    study = find_trials(
        paths,
        recursive=recursive,
        follow_symlinks=follow_symlinks,
        exclude=output,
        any_table=settings_from(config, given).columns is not None,
    )
    render_study.skipped_files(study.skipped, verbose=verbose)
    with shown_progress(quiet=quiet, verbose=verbose) as report:
        result = run_study(
            study.trials,
            output,
            executor,
            count,
            config=config,
            options=given,
            landmarks=landmarks,
            restart=restart,
            report=report,
        )
    render_study.changed_results(result)
    render_study.other_results(result)
    if json_output:
        render.json_object(render_study.study_statement(result, study.skipped))
    elif not quiet:
        render_study.study_table(result)
    render_study.unread_results(result)
    if result.failed:
        raise typer.Exit(SOME_FAILED)
    if result.unread:
        raise typer.Exit(ResultError.exit_code)
