"""The resources of a run: workers, cache, progress."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from fe_contact.workers import InProcess, Workers
from model_studies import Progress, silent


@dataclass(frozen=True)
class Run:
    """Workers, cache and progress of a run. They change no bit of its results.

    Attributes
    ----------
    workers : Workers
        Executor of condensation, contact, searches and samples: this process, a pool or a cluster. Receipts
        count the CPU time of all workers.
    cache : Path, optional
        Directory of flank compliances: with it a gear is condensed once.
    progress : callable
        Called as progress(stage, fraction); studies of several tables start again with each table.
    """

    workers: Workers = InProcess()  # noqa: RUF009 (frozen)
    cache: Path | None = None
    progress: Progress = silent

    @property
    def silent(self) -> Run:
        """The same without reports of progress."""
        return replace(self, progress=silent)
