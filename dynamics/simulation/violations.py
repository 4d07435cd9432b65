"""The reaction to a run that violates its assumptions."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from dynamics.assembly.assemble import System
from dynamics.errors import ResultError
from dynamics.influence import Decision
from dynamics.influence.neglected_check import ANY_PART
from dynamics.integrators.start_value import StartValue, Trail, added_rows
from dynamics.motion.sampled_states import States
from dynamics.types import Json

StatesOf = Callable[[int, int], States]


REPEATED = "repeated.json"
"""File in the folder of a run that repeats another: effects that are on for that reason, and the earlier
cost.
"""


@dataclass(frozen=True)
class EarlierRun:
    """A run that is repeated."""

    turned_on: Mapping[str, str] = field(default_factory=dict)
    """Automatic effects that it showed to be needed, and why."""
    seconds: float = 0.0
    """CPU time of the earlier run, s."""
    since: float = 0.0
    """Time from which on it is repeated, s: before that the effects carry no force."""

    @property
    def reasons(self) -> dict[str, str]:
        """Reasons why the effects are on, for the ledger."""
        return {name: f"on after a run without it: {reason}" for name, reason in self.turned_on.items()}

    def to_json(self) -> Json:
        """Return the entry of the receipt of the repetition; empty for a first run."""
        if not self.turned_on:
            return {}
        return {"repeated": {"turned_on": dict(self.turned_on), "seconds": self.seconds, "since": self.since}}

    @classmethod
    def read(cls, folder: Path) -> EarlierRun:
        """Return the run that an interrupted one in `folder` repeats; the first run if it repeats none.

        Raises `ResultError`: the file is damaged.
        """
        try:
            run = json.loads((folder / REPEATED).read_text(encoding="utf-8"))["repeated"]
            return cls({str(k): str(v) for k, v in run["turned_on"].items()}, float(run["seconds"]))
        except FileNotFoundError:
            return FIRST
        except (OSError, ValueError, KeyError, AttributeError) as error:
            raise ResultError(f"{REPEATED}: not readable. Start a new run.") from error

    def write(self, folder: Path) -> None:
        """Leave it to whoever continues in `folder`, where it removes the checkpoints of the run before."""
        for checkpoint in folder.glob("*.checkpoint"):
            checkpoint.unlink()  # of a system without these effects
        (folder / REPEATED).write_text(json.dumps(self.to_json()), encoding="utf-8")

    def then(self, needed: Mapping[str, str], seconds: float) -> EarlierRun:
        """Return the account that a further repetition has."""
        return EarlierRun({**self.turned_on, **needed}, self.seconds + seconds)

    def of(self, decision: Decision) -> Decision:
        """Return the scene with these effects on."""
        effects = {**decision.scene.effects, **dict.fromkeys(self.turned_on, "on")}
        return replace(decision, scene=replace(decision.scene, effects=effects))


FIRST = EarlierRun()


def needed_effects(ledger: Json) -> dict[str, str]:
    """Return the automatic effects that a run without them showed to be needed, and why.

    What was switched off by name stays off, and what the scene has no data for cannot be switched on.
    """
    return {row["effect"]: f"{row['part']}: {row['reason']}".removeprefix(": ") for row in _wrong(ledger)}


def taken_over(ledger: Json, trail: Trail, states: StatesOf, system: System) -> StartValue | None:
    """Return where `system`, with the effects that are needed, can go on; None: only from the start.

    An effect that carried no force until then leaves what came before as it is, bit by bit: coast flanks
    until driving flanks part. Every other one acts from the start on.
    """
    wrong = _wrong(ledger)
    since = [float(row["since"]) for row in wrong if row.get("since") is not None]
    if not since or len(since) < len(wrong):
        return None
    at, rows = trail.before(min(since)), added_rows(trail.system, system)
    return None if at is None or rows is None else StartValue(at, rows, states)


def _wrong(ledger: Json) -> list[Json]:
    """Return the checks that do not hold and that an automatic effect mends."""
    able = {
        (entry["effect"], part)
        for entry in ledger["entries"]
        if entry["choice"] == "auto" and not entry["on"] and entry["possible"]
        for part in (entry["part"], ANY_PART)
    }
    return [row for row in ledger["checks"] if row["holds"] is False and (row["effect"], row["part"]) in able]
