"""What the client says about a job."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class JobState:
    """State of a job.

    Attributes
    ----------
    id, process, status, message, stage : str
        As in the service's status document.
    progress : int
        Per cent of the whole job.
    stage_progress : int
        Per cent of the stage.
    """

    id: str
    process: str
    status: str
    message: str
    stage: str
    progress: int
    stage_progress: int

    @property
    def ended(self) -> bool:
        """Whether nothing more will happen to it."""
        return self.status in ("successful", "failed", "dismissed")

    @classmethod
    def from_json(cls, facts: dict[str, Any]) -> JobState:
        """Read a status document."""
        names = ("status", "message", "stage", "progress", "stage_progress")
        return cls(facts["jobID"], facts["processID"], **{name: facts[name] for name in names})


@dataclass(frozen=True)
class Result:
    """Where a result is: its content hash, its kind (the name of the output) and its path on the service."""

    key: str
    kind: str
    href: str
