"""Jobs that have no result."""

from __future__ import annotations

from collections.abc import Iterable

from lineofaction.gearbox.problems.error import EXIT_FAILED, OGC, ServiceError
from lineofaction.gearbox.problems.fault import Fault
from lineofaction.gearbox.problems.refused import NotFound


class ResultNotReady(NotFound):
    """The job has not ended."""

    type = f"{OGC}result-not-ready"
    title = "The result is not ready"


class JobDismissed(ServiceError):
    """The job was cancelled and has no result."""

    status = 410
    type = "urn:lineofaction:problem:job-dismissed"
    title = "The job was cancelled"
    exit_code = EXIT_FAILED


class JobFailed(ServiceError):
    """The job ended without a result: mesh, solve, worker or deadline."""

    status = 500
    type = "urn:lineofaction:problem:job-failed"
    title = "The job failed"
    exit_code = EXIT_FAILED

    def __init__(self, message: str, faults: Iterable[Fault] = ()) -> None:
        super().__init__(message)
        self.faults = tuple(faults)


class StillRunning(ServiceError, TimeoutError):
    """The job did not end in the time it was waited for; it goes on."""

    status = 504
    type = "urn:lineofaction:problem:still-running"
    title = "The job has not ended yet"
    exit_code = EXIT_FAILED
