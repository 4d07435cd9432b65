"""The effect ledger: what is on, what is off, and why."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass

from dynamics.checks import one_of
from dynamics.system.effects.effect import Effect, SupportedRotor
from dynamics.system.effects.registry import EFFECTS, LEFT_OUT
from dynamics.types import Json

CHOICES = ("auto", "on", "off")


@dataclass(frozen=True)
class LedgerEntry:
    """One decision.

    Attributes
    ----------
    effect, shaft : str
        What, and for which shaft.
    choice : str
        What the scene asked for: ``"auto"``, ``"on"``, ``"off"``.
    on : bool
        What was done.
    reason : str
        Why.
    worth : float
        Static displacement along the line of action that the effect is worth at the nominal force, m.
    """

    effect: str
    shaft: str
    choice: str
    on: bool
    reason: str
    worth: float


@dataclass(frozen=True)
class EffectLedger:
    """All decisions, and what this model leaves out."""

    entries: tuple[LedgerEntry, ...]

    def freedoms(self, shaft: str) -> tuple[str, ...]:
        """Return the names of the freedoms that effects give `shaft`."""
        on = {entry.effect for entry in self.entries if entry.on and entry.shaft == shaft}
        return tuple(freedom for effect in EFFECTS if effect.name in on for freedom in effect.adds)

    def to_json(self) -> Json:
        """Return plain lists and dictionaries."""
        return {"entries": [asdict(entry) for entry in self.entries], "left_out": dict(LEFT_OUT)}


def keep_ledger(choices: Mapping[str, str], rotors: Sequence[SupportedRotor]) -> EffectLedger:
    """Decide every effect for every rotor.

    Raises
    ------
    InputError
        If `choices` names an unknown effect or choice.
    """
    names = [effect.name for effect in EFFECTS]
    for name, choice in choices.items():
        one_of("effects", name, names)
        one_of(f"effects.{name}", choice, CHOICES)
    return EffectLedger(
        tuple(
            _decide(effect, rotor, choices.get(effect.name, "auto")) for effect in EFFECTS for rotor in rotors
        )
    )


def _decide(effect: Effect, rotor: SupportedRotor, choice: str) -> LedgerEntry:
    """Obey an explicit choice as far as the supports allow, else follow the verdict."""
    verdict = effect.called_for(rotor)
    on, reason = verdict.on, verdict.reason
    if choice != "auto" and verdict.possible:
        on = choice == "on"
        if on != verdict.on:
            reason = f"asked for; else: {verdict.reason}" if on else f"switched off, though: {verdict.reason}"
    return LedgerEntry(effect.name, rotor.name, choice, on, reason, verdict.worth)
