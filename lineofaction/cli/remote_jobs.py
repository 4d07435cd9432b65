"""``loa jobs`` and ``loa dismiss``, and waiting for a job of a service on the terminal."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import asdict, dataclass

from rich.console import Console

from lineofaction.cli.output import console, print_json, table
from lineofaction.client import LineOfActionClient, Result, progress_bars


@dataclass(frozen=True)
class JobSelection:
    """Which jobs are listed: of these processes and states (empty: all), at most so many."""

    process: Sequence[str]
    status: Sequence[str]
    limit: int


def waited(client: LineOfActionClient, job: str) -> Result:
    """Say which job it is, wait for it with a bar on a terminal; Ctrl-C says what can be done with it."""
    screen = Console(stderr=True)
    screen.print(f"job {job}", highlight=False)
    at = f"--service {client.session.exchange.base_url}"
    try:
        with progress_bars(screen) if sys.stderr.isatty() else nullcontext() as watch:
            return client.wait(job, watch)
    except KeyboardInterrupt as stop:
        stop.add_note(f"To get its result: loa fetch {job} {at} --wait -o FILE")
        stop.add_note(f"To end it: loa dismiss {job} {at}")
        raise


def run_jobs(service: str, wanted: JobSelection, *, as_json: bool) -> None:
    """List the jobs of a service, the newest first."""
    with LineOfActionClient(service) as client:
        jobs = list(client.jobs(process=wanted.process, status=wanted.status, limit=wanted.limit))
    if as_json:
        print_json({"jobs": [asdict(job) for job in jobs]})
        return
    head = ("job", "process", "state", "%", "left", "created (UTC)", "about")
    rows = [
        (
            *(job.id, job.process, job.words, f"{job.progress}", job.time_left),
            *(job.created[:19].replace("T", " "), job.title or job.subject),
        )
        for job in jobs
    ]
    console().print(table(head, rows, words=("job", "process", "state", "created (UTC)", "about")))


def run_dismiss(job: str, service: str, *, as_json: bool) -> None:
    """Dismiss a job."""
    with LineOfActionClient(service) as client:
        state = client.dismiss(job)
    if as_json:
        print_json({"job": state.id, "process": state.process, "status": state.status})
    else:
        console().print(f"job {state.id}, {state.process}: {state.status}", highlight=False, soft_wrap=True)
