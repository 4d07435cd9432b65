"""The resources of a run: workers, cache, progress."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from fe_contact.workers import InProcess, Workers
from model_studies import Progress, silent

OnPlan = Callable[[Mapping[str, float]], None]
"""Called with the predicted CPU seconds of the stages of a table, in their order, before it is computed."""


def _unplanned(_stages: Mapping[str, float]) -> None:
    """Take no note of a plan."""


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
    on_plan : callable
        Called with the predicted CPU seconds by stage of each table, and of each pass of one.
    """

    workers: Workers = InProcess()  # noqa: RUF009 (frozen)
    cache: Path | None = None
    progress: Progress = silent
    on_plan: OnPlan = _unplanned

    @property
    def silent(self) -> Run:
        """The same without reports of progress."""
        return replace(self, progress=silent, on_plan=_unplanned)
