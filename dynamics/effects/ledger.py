"""The ledger of the effects of a scene, and the mechanism with what they may add.

A verdict says whether a part of the scene calls for an effect. The decision also takes the choice of the
scene: "auto", "on" or "off".
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from bounds import engineering
from dynamics.checks import one_of
from dynamics.effects.effect import Effect, MeshEffect, RotorEffect, Verdict
from dynamics.effects.registry import EFFECTS, NEGLECTED
from dynamics.identity_cache import cached_by
from dynamics.mechanism.additions import Additions
from dynamics.mechanism.mechanism import Mechanism, gather_mechanism
from dynamics.scene.scene import Scene
from dynamics.types import Json

CHOICES = ("auto", "on", "off")
UNSHARED = ("outputs", "quantity")


@dataclass(frozen=True)
class _Verdicts:
    """Verdicts of all parts of a scene, made when first read."""

    make: Callable[[], Sequence[Verdict]]

    @cached_property
    def made(self) -> Sequence[Verdict]:
        return self.make()


@dataclass(frozen=True)
class _LedgerEntry:
    """One decision."""

    decision: Effect
    part: str
    """The shaft or the mesh that it is decided for."""
    choice: str
    """Choice of the scene: ``"auto"``, ``"on"``, ``"off"``."""
    verdicts: _Verdicts
    """Verdicts of all parts; the one of this part has the number `index`."""
    index: int

    @property
    def verdict(self) -> Verdict:
        """Verdict of this part."""
        return self.verdicts.made[self.index]

    @property
    def effect(self) -> str:
        """Name of the effect."""
        return self.decision.name

    @property
    def on(self) -> bool:
        """The decision: an explicit choice is obeyed as far as the scene allows, else the verdict."""
        if self.choice == "off" and not self.decision.compulsory:
            return False
        obeyed = self.choice != "auto" and self.possible
        return self.choice == "on" if obeyed else self.verdict.on

    @property
    def reason(self) -> str:
        """The reason of the decision."""
        if self.on == self.verdict.on:
            return self.verdict.reason
        reason = self.verdict.reason
        return f"requested; else: {reason}" if self.on else f"off by request, although: {reason}"

    @property
    def possible(self) -> bool:
        """Whether the scene has the freedom or the data at all."""
        return self.verdict.possible

    @property
    def influence(self) -> float:
        """Static displacement along the line of action that the effect adds at the nominal force, m."""
        return self.verdict.influence

    @property
    def price(self) -> str:
        """The price of a choice against the scene, in words; empty where there is none."""
        if self.on == self.verdict.on:
            return ""
        neglected = f"{engineering(1e6 * self.influence)} µm of static displacement neglected"
        return self.decision.cost if self.on else neglected

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {
            "effect": self.effect,
            "part": self.part,
            "choice": self.choice,
            "on": self.on,
            "reason": self.reason,
            "influence_m": self.influence,
            "called_for": self.verdict.on,
            "possible": self.possible,
            "cost": self.decision.cost,
            "price": self.price,
        }


@dataclass(frozen=True)
class EffectLedger:
    """All decisions on effects, and the effects that the model leaves out."""

    entries: tuple[_LedgerEntry, ...] = ()

    def decide(
        self, effect: Effect, choice: str, parts: Sequence[str], verdicts: Callable[[], Sequence[Verdict]]
    ) -> EffectLedger:
        """Return the ledger with the decisions on one more effect; `verdicts` gives those of its `parts`."""
        later = _Verdicts(verdicts)
        made = (_LedgerEntry(effect, part, choice, later, index) for index, part in enumerate(parts))
        return EffectLedger((*self.entries, *made))

    def with_entries_of(self, other: EffectLedger, addition: str) -> EffectLedger:
        """Return the ledger with the decisions of `other` on the effect that adds `addition`."""
        entries = (entry for entry in self.entries if addition not in entry.decision.adds)
        return EffectLedger((*entries, *other.adding(addition)))

    def without(self, additions: frozenset[str], reason: str, choices: Mapping[str, str]) -> EffectLedger:
        """Return the ledger in which no effect that adds one of `additions` is possible."""

        def impossible(entry: _LedgerEntry) -> _LedgerEntry:
            verdict = replace(entry.verdict, on=False, possible=False, reason=reason)
            choice = choices.get(entry.effect, "auto")
            return replace(entry, choice=choice, verdicts=_Verdicts(lambda: (verdict,)), index=0)

        return EffectLedger(
            tuple(
                entry if additions.isdisjoint(entry.decision.adds) else impossible(entry)
                for entry in self.entries
            )
        )

    def on_rotor(self, shaft: str) -> list[RotorEffect]:
        """Return the effects of rotors that are on for `shaft`."""
        effects = [entry.decision for entry in self.entries if entry.on and entry.part == shaft]
        return [effect for effect in effects if isinstance(effect, RotorEffect)]

    def on_mesh(self, mesh: str) -> list[MeshEffect]:
        """Return the effects of meshes that are on for `mesh`."""
        effects = [entry.decision for entry in self.entries if entry.on and entry.part == mesh]
        return [effect for effect in effects if isinstance(effect, MeshEffect)]

    def of(self, effect: str) -> list[_LedgerEntry]:
        """Return the decisions on one effect, one per part."""
        return [entry for entry in self.entries if entry.effect == effect]

    def on(self, effect: str, part: str) -> bool:
        """Whether an effect is on for a part."""
        return any(entry.on and entry.part == part for entry in self.of(effect))

    def adding(self, addition: str) -> list[_LedgerEntry]:
        """Return the decisions on the effect that adds `addition`, one per part."""
        return self._by_addition.get(addition, [])

    @cached_property
    def _by_addition(self) -> dict[str, list[_LedgerEntry]]:
        rows: dict[str, list[_LedgerEntry]] = {}
        for entry in self.entries:
            for addition in entry.decision.adds:
                rows.setdefault(addition, []).append(entry)
        return rows

    def adds(self, addition: str, part: str | None = None) -> bool:
        """Whether `addition` is in the model of a part; None: of any."""
        return any(entry.on and part in (None, entry.part) for entry in self.adding(addition))

    def effect_adding(self, addition: str) -> str:
        """Return the name of the effect that adds `addition`; empty where there is none."""
        return next((entry.effect for entry in self.adding(addition)), "")

    def to_json(self) -> Json:
        """Return plain lists and dictionaries."""
        entries = [entry.to_json() for entry in self.entries]
        return {"entries": entries, "left_out": dict(NEGLECTED)}


def mechanism_of(scene: Scene, registry: tuple[Effect, ...] = EFFECTS) -> Mechanism:
    """Gather the mechanism of `scene`; every effect that is not switched off checks it.

    Scenes that differ alone by their outputs and what they are computed for share it.

    Raises
    ------
    InputError
        If a choice is unknown, parts do not fit each other, or an effect cannot do without a part.
    """
    mechanism = _shared_mechanism(scene, registry)
    unshared = {name: getattr(scene, name) for name in UNSHARED}
    if all(getattr(mechanism.scene, name) is part for name, part in unshared.items()):
        return mechanism
    return replace(mechanism, scene=replace(mechanism.scene, **unshared))


def _shared_parts(scene: Scene) -> tuple[object, ...]:
    return tuple(part for name, part in vars(scene).items() if name not in UNSHARED)


@cached_by(_shared_parts)
def _shared_mechanism(scene: Scene, registry: tuple[Effect, ...]) -> Mechanism:
    names = [effect.name for effect in registry]
    for name, choice in scene.effects.items():
        one_of("effects", name, names)
        one_of(f"effects.{name}", choice, CHOICES)
    allowed = [effect for effect in registry if scene.effects.get(effect.name) != "off"]
    requested = [effect for effect in registry if scene.effects.get(effect.name) == "on"]
    for effect in registry:
        scene = effect.prepared(scene) if effect in allowed else effect.neglected(scene)
    mechanism = gather_mechanism(scene, Additions(_added(allowed), _added(requested)))
    for effect in allowed:
        effect.check(mechanism)
    return mechanism


def _added(effects: Sequence[Effect]) -> frozenset[str]:
    return frozenset(part for effect in effects for part in effect.adds)
