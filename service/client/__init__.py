"""The Python client: typed, blocking and awaited, light (no mesher, no finite elements, no web framework)."""

from service.client.bars import progress_bars
from service.client.batch import AsyncBatch, Batch
from service.client.cache import ResultCache
from service.client.client import AsyncLineOfActionClient, LineOfActionClient
from service.client.job import AsyncJob, Job
from service.client.live_options import LiveOptions
from service.client.process import AsyncProcess, Process
from service.client.report import Report
from service.client.status import JobState, OfflineWarning, Result, Watch

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
    "progress_bars",
]
