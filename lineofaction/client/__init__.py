"""The Python client: typed, blocking and awaited, light (no mesher, no finite elements, no web framework)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from lineofaction.client.batch import AsyncBatch, Batch
from lineofaction.client.cache import ResultCache
from lineofaction.client.client import AsyncLineOfActionClient, LineOfActionClient
from lineofaction.client.job import AsyncJob, Job
from lineofaction.client.process import AsyncProcess, Process
from lineofaction.client.result_calls import LiveOptions
from lineofaction.client.status import JobState, OfflineWarning, Result, Watch

if TYPE_CHECKING:
    from lineofaction.client.report import Report

__all__ = [
    "AsyncBatch",
    "AsyncJob",
    "AsyncLineOfActionClient",
    "AsyncProcess",
    "Batch",
    "Job",
    "JobState",
    "LineOfActionClient",
    "LiveOptions",
    "OfflineWarning",
    "Process",
    "Report",
    "Result",
    "ResultCache",
    "Watch",
]


def __getattr__(name: str) -> Any:
    """Load the report with its first use: nothing else here needs models of answers."""
    if name != "Report":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from lineofaction.client.report import Report  # noqa: PLC0415

    return Report
