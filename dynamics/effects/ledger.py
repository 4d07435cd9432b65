"""The effect ledger: what is on, what is off, and why."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from dynamics.checks import one_of
from dynamics.effects.effect import Effect, LoadedMesh, MeshEffect, SupportedRotor, Verdict
from dynamics.effects.registry import EFFECTS, LEFT_OUT, MESH_EFFECTS
from dynamics.types import Json

CHOICES = ("auto", "on", "off")


@dataclass(frozen=True)
class LedgerEntry:
    """One decision.

    Attributes
    ----------
    effect, part : str
        What, and for which shaft or mesh.
    choice : str
        What the scene requests: ``"auto"``, ``"on"``, ``"off"``.
    on : bool
        What was done.
    reason : str
        Why.
    influence : float
        Static displacement along the line of action that the effect adds at the nominal force, m.
    called_for, possible : bool
        What the scene calls for, and whether it has the freedom or the data at all.
    cost : str
        In words.
    """

    effect: str
    part: str
    choice: str
    on: bool
    reason: str
    influence: float
    called_for: bool
    possible: bool
    cost: str

    def to_json(self) -> Json:
        """Return plain JSON; the influence has the key ``worth``."""
        return {
            "effect": self.effect,
            "part": self.part,
            "choice": self.choice,
            "on": self.on,
            "reason": self.reason,
            "worth": self.influence,
            "called_for": self.called_for,
            "possible": self.possible,
            "cost": self.cost,
            "price": self.price,
        }

    @property
    def price(self) -> str:
        """What a choice against the scene costs; empty where it does not."""
        if self.on == self.called_for:
            return ""
        return self.cost if self.on else f"{1e6 * self.influence:.3g} um of static displacement left out"


@dataclass(frozen=True)
class EffectLedger:
    """All decisions, and what this model leaves out."""

    entries: tuple[LedgerEntry, ...]

    def freedoms(self, shaft: str) -> tuple[str, ...]:
        """Return the names of the freedoms that effects give `shaft`."""
        on = {entry.effect for entry in self.entries if entry.on and entry.part == shaft}
        return tuple(freedom for effect in EFFECTS if effect.name in on for freedom in effect.adds)

    def on(self, effect: str, mesh: str) -> bool:
        """Whether an effect of a mesh is on."""
        return any(entry.on and entry.part == mesh for entry in self.entries if entry.effect == effect)

    def to_json(self) -> Json:
        """Return plain lists and dictionaries."""
        entries = [entry.to_json() for entry in self.entries]
        return {"entries": entries, "left_out": dict(LEFT_OUT)}


def keep_ledger(choices: Mapping[str, str], rotors: Sequence[SupportedRotor]) -> EffectLedger:
    """Decide the effects of every rotor.

    Raises
    ------
    InputError
        If `choices` names an unknown effect or choice.
    """
    names = [*(effect.name for effect in EFFECTS), *(effect.name for effect in MESH_EFFECTS)]
    for name, choice in choices.items():
        one_of("effects", name, names)
        one_of(f"effects.{name}", choice, CHOICES)
    on_rotors = [
        _decide(effect, rotor.name, effect.called_for(rotor), choices)
        for effect in EFFECTS
        for rotor in rotors
    ]
    return EffectLedger(tuple(on_rotors))


def with_mesh_effects(
    ledger: EffectLedger, choices: Mapping[str, str], meshes: Sequence[LoadedMesh]
) -> EffectLedger:
    """Decide the effects of every mesh, which look at the freedoms that the rotors have."""
    on_meshes = [
        _decide(effect, mesh.name, effect.called_for(mesh), choices)
        for effect in MESH_EFFECTS
        for mesh in meshes
    ]
    return EffectLedger((*ledger.entries, *on_meshes))


def _decide(
    effect: Effect | MeshEffect, part: str, verdict: Verdict, choices: Mapping[str, str]
) -> LedgerEntry:
    """Obey an explicit choice as far as the scene allows, else follow the verdict."""
    choice = choices.get(effect.name, "auto")
    on, reason = verdict.on, verdict.reason
    if choice != "auto" and verdict.possible:
        on = choice == "on"
        if on != verdict.on:
            reason = f"requested; else: {verdict.reason}" if on else f"switched off, though: {verdict.reason}"
    decided = (effect.name, part, choice, on, reason, verdict.influence)
    return LedgerEntry(*decided, called_for=verdict.on, possible=verdict.possible, cost=effect.cost)
