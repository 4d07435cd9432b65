"""The Python client: typed, blocking and awaited, light (no mesher, no finite elements, no web framework)."""

from lineofaction.client.batch import AsyncBatch, Batch
from lineofaction.client.cache import ResultCache
from lineofaction.client.client import AsyncLineOfActionClient, LineOfActionClient
from lineofaction.client.job import AsyncJob, Job
from lineofaction.client.process import AsyncProcess, Process
from lineofaction.client.report import Report
from lineofaction.client.result_calls import LiveOptions
from lineofaction.client.status import JobState, OfflineWarning, Result, Watch

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
