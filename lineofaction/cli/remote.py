"""``loa jobs`` and ``loa dismiss``: list and end jobs of a service."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict

from lineofaction.cli.output import console, print_json, table
from lineofaction.client import LineOfActionClient


def run_jobs(
    service: str, process: Sequence[str], status: Sequence[str], limit: int, *, as_json: bool
) -> None:
    """List so many jobs of a service, the newest first, of these processes and states (empty: all)."""
    with LineOfActionClient(service) as client:
        jobs = list(client.jobs(process=process, status=status, limit=limit))
    if as_json:
        print_json({"jobs": [asdict(job) for job in jobs]})
        return
    head = ("job", "process", "state", "%", "left", "created (UTC)", "about")
    rows = [
        (
            *(job.id, job.process, job.activity, f"{job.progress}", job.time_left),
            *(job.created[:19].replace("T", " "), job.title or job.subject),
        )
        for job in jobs
    ]
    console().print(table(head, rows, text_columns=("job", "process", "state", "created (UTC)", "about")))


def run_dismiss(job: str, service: str, *, as_json: bool) -> None:
    """Dismiss a job."""
    with LineOfActionClient(service) as client:
        state = client.dismiss(job)
    if as_json:
        print_json({"job": state.id, "process": state.process, "status": state.status})
    else:
        console().print(f"job {state.id}, {state.process}: {state.status}", soft_wrap=True)
