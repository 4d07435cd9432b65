"""``loa jobs`` and ``loa dismiss``, and waiting for a job of a service on the terminal."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import asdict, dataclass

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from lineofaction.cli.output import console, print_json, table
from lineofaction.client import JobState, LineOfActionClient, Result, Watch

_COLORS = {"failed": "red", "dismissed": "yellow"}


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
        with _bar(screen) if sys.stderr.isatty() else nullcontext() as watch:
            return client.wait(job, watch)
    except KeyboardInterrupt as stop:
        stop.add_note(f"To get its result: loa fetch {job} {at} --wait -o FILE")
        stop.add_note(f"To end it: loa dismiss {job} {at}")
        raise


@contextmanager
def _bar(screen: Console) -> Iterator[Watch]:
    """Yield a watch that draws the bar of a job: its stage, per cent, time taken and time left."""
    percent, left = TextColumn("{task.percentage:>3.0f} %"), TextColumn("{task.fields[left]}")
    columns = (TextColumn("{task.description}"), BarColumn(), percent, TimeElapsedColumn(), left)
    with Progress(*columns, console=screen) as bar:
        task = bar.add_task("", total=100, left="")

        def see(state: JobState) -> None:
            name = escape(f"{state.process} {state.title}".rstrip())
            words = f"[{_COLORS.get(state.status, 'none')}]{name}: {escape(state.words)}[/]"
            bar.update(task, completed=state.progress, description=words, left=state.time_left)
            if state.ended:
                bar.stop_task(task)

        yield see


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
