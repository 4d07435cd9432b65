"""Passes of a run under a tolerance, and their total cost."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from fe_contact.analysis.database.refinement import Refinement
from fe_contact.analysis.request.model_choice import Decision
from fe_contact.ste import SteDatabase
from fe_contact.types import Json


@dataclass(frozen=True)
class Pass:
    """One run of the table on one discretization."""

    decision: Decision
    """Model and discretization."""
    cost: Json
    """Times by stage and memory, as in a receipt."""
    table: SteDatabase | None
    """Table of the pass; None if the pass failed."""
    refinement: Refinement | None = None
    """Refinement before the pass; None for the first pass."""
    failure: str = ""
    """Reason why the pass has no table; empty where it has one."""

    @property
    def used(self) -> float:
        """Part of the tolerance that the measured errors use; infinite where that is not known."""
        used = None if self.table is None else self.table.metadata.receipt["tolerance"]["used"]
        return float("inf") if used is None else float(used)

    @property
    def failed(self) -> int:
        """Number of points without a solution; 0 without a table."""
        return 0 if self.table is None else self.table.n_failed

    @property
    def quality(self) -> tuple[int, float]:
        """Points without a solution and part of the tolerance that is used, by which passes compare."""
        return self.failed, self.used

    @property
    def name(self) -> str:
        """Model, mesh and slices in words."""
        return f"{self.decision.checked.model_name}, {self.decision.mesh.option.name}"

    def to_json(self) -> Json:
        """Return model, discretization, cost and refinement of the pass as plain JSON.

        `used_at_nodes` compares with `expected_used`, what was expected. `used` is more: loads
        and alignments are inserted until errors between nodes, too, are within what is left.
        """
        mesh, refinement = self.decision.mesh, self.refinement
        tolerance = {} if self.table is None else self.table.metadata.receipt["tolerance"]
        expected = mesh.option.error.reducible / self.decision.checked.request.options.allowed.relative
        failure = {"failure": self.failure} if self.failure else {}
        return failure | {
            "model": self.decision.checked.model_name,
            "level": mesh.level,
            "slices": mesh.slices,
            "positions": None if self.table is None else int(self.table.position.size),
            "cpu_seconds": self.cost["cpu_seconds"],
            "used": tolerance.get("used"),
            "used_at_nodes": tolerance.get("used_at_nodes"),
            "refined": [] if refinement is None else list(refinement.steps),
            "because": mesh.reason,
            "expected_used": expected if refinement is None else refinement.expected,
        }


def table_of_passes(passes: Sequence[Pass], table: SteDatabase, reason: str) -> SteDatabase:
    """Return the table of one pass with the receipt of all, and the reason why there was no further one."""
    receipt = table.metadata.receipt | _summed([run.cost for run in passes])
    receipt["tolerance"] = receipt["tolerance"] | {"reason": reason}
    receipt["prediction"] = receipt["prediction"] | _predicted(passes)
    receipt["passes"] = [run.to_json() | {"kept": run.table is table} for run in passes]
    return replace(table, metadata=replace(table.metadata, receipt=receipt))


def _predicted(passes: Sequence[Pass]) -> Json:
    """Add up the predictions of all passes before they began; memory is the largest."""
    predictions = [run.table.metadata.receipt["prediction"] for run in passes if run.table is not None]
    stages = {
        name: sum(prediction["stages"][name] for prediction in predictions)
        for name in predictions[0]["stages"]
    }
    memory = max(prediction["memory_bytes"] for prediction in predictions)
    return {"stages": stages, "cpu_seconds": sum(stages.values()), "memory_bytes": memory}


def _summed(costs: Sequence[Json]) -> Json:
    """Add up times by stage; memory is the largest."""
    kinds = ("cpu_seconds", "wall_seconds")
    times: dict[str, list[Json]] = {}
    for cost in costs:
        for stage, time in cost["stages"].items():
            times.setdefault(stage, []).append(time)
    total: Json = {kind: sum(cost[kind] for cost in costs) for kind in kinds}
    total["stages"] = {
        stage: {kind: sum(time[kind] for time in passes) for kind in kinds} for stage, passes in times.items()
    }
    total["peak_memory_bytes"] = max(cost["peak_memory_bytes"] for cost in costs)
    remote = [cost["elsewhere"] for cost in costs if "elsewhere" in cost]
    if remote:  # the peak and the loss of workers are those of all passes so far
        sums = {name: sum(cost[name] for cost in remote) for name in ("tasks", "cpu_seconds")}
        total["elsewhere"] = remote[-1] | sums
    return total
