"""The passes of a run under a tolerance, and what all of them cost."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from fe_contact.analysis.database.refinement import Refinement
from fe_contact.analysis.request.decided import Decided, model_name
from fe_contact.ste import SteDatabase
from fe_contact.types import Json


@dataclass(frozen=True)
class Pass:
    """One run of the table on one discretization.

    Attributes
    ----------
    decided : Decided
        Model and discretization.
    cost : dict
        Times by stage and memory, as in a receipt.
    table : SteDatabase or None
        None: the pass failed.
    refinement : Refinement or None
        What was refined before it; None: the first one.
    failure : str
        Why there is no table.
    """

    decided: Decided
    cost: Json
    table: SteDatabase | None
    refinement: Refinement | None = None
    failure: str = ""

    @property
    def used(self) -> float:
        """Part of the tolerance that the measured errors use; infinite where that is not known."""
        used = None if self.table is None else self.table.metadata.receipt["tolerance"]["used"]
        return float("inf") if used is None else float(used)

    @property
    def name(self) -> str:
        """Model, mesh and slices in words."""
        return f"{model_name(self.decided.checked)}, {self.decided.mesh.option.name}"

    def to_json(self) -> Json:
        """Return what ran, what it cost, what it used, and what was refined before it and why."""
        mesh, made, table = self.decided.mesh, self.refinement, self.table
        failed = {"failure": self.failure} if self.failure else {}
        return failed | {
            "model": model_name(self.decided.checked),
            "level": mesh.level,
            "slices": mesh.slices,
            "positions": None if table is None else int(table.position.size),
            "cpu_seconds": self.cost["cpu_seconds"],
            "used": None if table is None else table.metadata.receipt["tolerance"]["used"],
            "refined": [] if made is None else list(made.steps),
            "because": mesh.reason,
            "expected_used": None if made is None else made.expected,
        }


def of_all_passes(passes: Sequence[Pass], kept: SteDatabase, reason: str) -> SteDatabase:
    """Return the table of one pass with the receipt of all of them.

    Parameters
    ----------
    passes : sequence of Pass
        In the order in which they ran.
    kept : SteDatabase
        The table of one of them.
    reason : str
        Why no further pass was made.
    """
    receipt = kept.metadata.receipt | _summed([done.cost for done in passes])
    receipt["tolerance"] = receipt["tolerance"] | {"reason": reason}
    receipt["passes"] = [done.to_json() | {"kept": done.table is kept} for done in passes]
    return replace(kept, metadata=replace(kept.metadata, receipt=receipt))


def _summed(costs: Sequence[Json]) -> Json:
    """Add up times by stage; memory is the largest."""
    kinds = ("cpu_seconds", "wall_seconds")
    names = dict.fromkeys(name for cost in costs for name in cost["stages"])
    times = {name: [cost["stages"][name] for cost in costs if name in cost["stages"]] for name in names}
    stages = {
        name: {kind: sum(time[kind] for time in each) for kind in kinds} for name, each in times.items()
    }
    total: Json = {kind: sum(cost[kind] for cost in costs) for kind in kinds}
    total |= {"stages": stages, "peak_memory_bytes": max(cost["peak_memory_bytes"] for cost in costs)}
    others = [cost["elsewhere"] for cost in costs if "elsewhere" in cost]
    if others:  # the peak and the loss of workers are those of all passes so far
        sums = {name: sum(remote[name] for remote in others) for name in ("tasks", "cpu_seconds")}
        total["elsewhere"] = others[-1] | sums
    return total
