"""One integration of a run to a file: its states on disk, its checkpoints, and where it is taken up."""

from __future__ import annotations

import time as clock
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dynamics.assembly.assemble import System
from dynamics.errors import ResultError
from dynamics.integrators import Cancel, Progress, StaticSolution
from dynamics.integrators.march import Ending, March, ending, march_on, start_march
from dynamics.integrators.start_value import StartValue, Trail, start_from, widened
from dynamics.integrators.state_sink import StateSpool, fingerprint, restore
from dynamics.integrators.workspace import Count
from dynamics.motion.sampled_states import Widths
from dynamics.scene import Integration
from dynamics.simulation.violations import taken_over
from dynamics.types import Json, RunStatus


@dataclass(frozen=True)
class MadeRun:
    """A run as made: its status, effect ledger and wall time (s), its saved states, its records."""

    status: RunStatus
    ledger: Json
    seconds: float
    trail: Trail
    widths: Widths


class Leg:
    """One integration with its states on disk, resumed from its checkpoint."""

    def __init__(
        self,
        stack: ExitStack,
        path: Path,
        system: System,
        start: StaticSolution,
        integration: Integration,
        resume: bool,
        earlier: MadeRun | None = None,
    ) -> None:
        self.march: March = start_march(system, start, integration)
        work, control, duration = self.march.work, self.march.control, system.scene.duration
        self._mark = fingerprint(
            system.arrays, control, self.march.sampler, work.step_sizes, start.displacement, duration
        )
        self.spool = stack.enter_context(StateSpool(path, self.march.widths))
        self._seconds = 0.0
        self._status: RunStatus | None = None
        self.since = 0.0
        checkpoint = self.spool.checkpoint() if resume else None
        taken = earlier and taken_over(earlier.ledger, earlier.trail, self.spool.states, system)
        if checkpoint is not None:
            self._resume(path, *checkpoint)
        elif earlier and taken:
            self._go_on_for(earlier.widths, taken)
        else:
            self.spool.begin()

    def _resume(self, path: Path, arrays: dict[str, Any], facts: dict[str, Any]) -> None:
        if str(facts.get("mark")) != self._mark:
            raise ResultError(f"{path}: of another scene or version. Start a new run.")
        restore(self.march.state, arrays, path)
        self.spool.resume(int(facts["samples"]))
        self._seconds, self.since = float(facts["seconds"]), float(facts["since"])
        status = RunStatus(int(facts["status"]))
        self._status = None if status is RunStatus.CANCELLED else status

    def _go_on_for(self, widths: Widths, taken: StartValue) -> None:
        """Start from an earlier run, whose samples the spool holds; save at once, as its own are gone."""
        start_from(self.march, taken.at, taken.rows_of)
        samples = taken.at.samples
        self.spool.rewrite(widths, samples, lambda states: widened(states, taken.rows_of, self.march))
        self.spool.resume(samples)
        self.since = taken.at.time
        self._save(RunStatus.CANCELLED)

    def go(
        self, progress: Progress | None, cancel: Cancel | None, every: float, trail: Trail | None = None
    ) -> Ending:
        """March on to the end, with checkpoints; one that had ended stays as it is."""
        began = saved = clock.perf_counter()
        before = self._seconds
        remember = None if trail is None else trail.watch(self.march)

        def after_block() -> None:
            nonlocal saved
            if remember is not None:
                remember()
            if clock.perf_counter() - saved >= every:
                self._save(RunStatus.CANCELLED)
                saved = clock.perf_counter()
            self._seconds = before + clock.perf_counter() - began

        if self._status is None:
            status = march_on(self.march, self.spool, progress, cancel, after_block)
            self._seconds = before + clock.perf_counter() - began
            self._save(status)
            self._status = status
        return ending(self.march, self.spool, self._status, self._seconds)

    def _save(self, status: RunStatus) -> None:
        samples = int(self.march.work.counts[Count.OUTPUT])
        facts = {"mark": self._mark, "samples": samples, "seconds": self._seconds, "since": self.since}
        self.spool.save(self.march.state, **facts, status=int(status))
