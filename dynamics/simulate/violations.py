"""What to do where a run shows that something it took for granted is wrong."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from dynamics.types import Json
from dynamics.worth import Decided


@dataclass(frozen=True)
class EarlierRun:
    """A run that is repeated.

    Attributes
    ----------
    turned_on : mapping of str to str
        Automatic effects that it showed to be needed, and why.
    seconds : float
        What it took, s of wall time.
    """

    turned_on: Mapping[str, str] = field(default_factory=dict)
    seconds: float = 0.0

    @property
    def reasons(self) -> dict[str, str]:
        """Why the effects are on, for the ledger."""
        return {name: f"on after a run without it: {reason}" for name, reason in self.turned_on.items()}

    def to_json(self) -> Json:
        """Return what the receipt of the repetition says; nothing for a first run."""
        if not self.turned_on:
            return {}
        return {"repeated": {"turned_on": dict(self.turned_on), "seconds": self.seconds}}

    def of(self, decided: Decided) -> Decided:
        """Return the scene with these effects on."""
        effects = {**decided.scene.effects, **dict.fromkeys(self.turned_on, "on")}
        return replace(decided, scene=replace(decided.scene, effects=effects))


FIRST = EarlierRun()


def needed_effects(ledger: Json) -> dict[str, str]:
    """Return the automatic effects that a run without them showed to be needed, and why.

    What was switched off by name stays off, and what the scene has no data for cannot be switched on.
    """
    able = {
        (entry["effect"], entry["part"])
        for entry in ledger["entries"]
        if entry["choice"] == "auto" and not entry["on"] and entry["possible"]
    }
    wrong = [
        one for one in ledger["checks"] if one["holds"] is False and (one["effect"], one["part"]) in able
    ]
    return {one["effect"]: f"{one['part']}: {one['reason']}" for one in wrong}


def said(ledger: Json) -> str:
    """Say which assumptions do not hold; empty if all do."""
    wrong = [one for one in ledger["checks"] if one["holds"] is False]
    return "; ".join(f"{one['assumption']} ({one['part']}): {one['reason']}" for one in wrong)
