"""Composition of the contact model from the effects that a scene calls for, and the ledger of all effects."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from fe_contact.contact.model import ContactModel
from fe_contact.effects.effect import ContactScene, Effect, Verdict, named
from fe_contact.errors import InputError
from fe_contact.types import Json

CHOICES = ("on", "off", "auto")


def flipped(registry: Sequence[Effect], present: Mapping[str, str], name: str, choice: str) -> dict[str, str]:
    """Return the choices of all effects after `name` was turned on or off.

    Two effects exclude each other: the effect across the face, with which a model has three dimensions, and
    the correction of a plane model for the finite face width. Turning one on turns the other off. Without
    the effect across the face, the scene decides on the correction.

    Parameters
    ----------
    present : mapping of str to str
        Every effect "on" or "off".
    """
    choices = {**present, name: choice}
    face, correction = named(registry, "across_face"), named(registry, "finite_width")
    if name == face:
        choices[correction] = "auto" if choice == "off" else "off"
    if name == correction and choice == "on":
        choices[face] = "off"
    return choices


@dataclass(frozen=True)
class LedgerEntry:
    """One effect in one run."""

    name: str
    on: bool
    """Whether it was simulated."""
    choice: str
    """"on", "off" or "auto", as requested."""
    verdict: Verdict
    """Verdict of the effect on the scene. Its reason stands even when the caller decided otherwise."""
    cost: str
    override: str = ""
    """Reason why the effect differs from its verdict though the choice is "auto"; empty if it does not
    differ.
    """

    @property
    def decision(self) -> str:
        """The reason it is on or off, in words."""
        if self.override:
            return self.override
        called = "the scene calls for it" if self.verdict.on else "the scene does not call for it"
        if self.choice == "auto":
            return called
        if self.on == self.verdict.on:
            return f"as requested; {called}"
        return f"as requested, although {called}"

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {
            "name": self.name,
            "on": self.on,
            "choice": self.choice,
            "cost": self.cost,
            "called_for": self.verdict.on,
            "reason": self.verdict.reason,
            "decision": self.decision,
        }


def compose(scene: ContactScene, choices: Mapping[str, str]) -> tuple[ContactModel, tuple[LedgerEntry, ...]]:
    """Apply every effect of the scene's registry that is on.

    Parameters
    ----------
    choices : mapping of str to str
        Effect name to "on", "off" or "auto"; names left out are "auto".

    Raises
    ------
    InputError
        Unknown effect or choice.
    """
    _check_choices(choices, scene.registry)
    ledger = []
    for effect in scene.registry:
        choice = choices.get(effect.name, "auto")
        verdict = effect.called_for(scene)
        on = verdict.on if choice == "auto" else choice == "on"
        ledger.append(LedgerEntry(effect.name, on, choice, verdict, effect.cost))
    return contributed(scene, acting(ledger)), tuple(ledger)


def acting(ledger: Sequence[LedgerEntry]) -> tuple[str, ...]:
    """Return the names of the effects that are on."""
    return tuple(entry.name for entry in ledger if entry.on)


def contributed(scene: ContactScene, names: Sequence[str]) -> ContactModel:
    """Return the contact model of a scene with the effects of these names alone."""
    model = ContactModel()
    for effect in scene.registry:
        if effect.name in names:
            model = effect.contribute(scene, model)
    # a fixed order of the sums, so that the order of the registry changes no bit
    gaps = tuple(sorted(model.gaps, key=repr))
    tooth_gaps = tuple(sorted(model.tooth_gaps, key=repr))
    compliances = tuple(sorted(model.compliances, key=repr))
    parts = tuple(sorted(model.parts))
    return replace(model, gaps=gaps, tooth_gaps=tooth_gaps, compliances=compliances, parts=parts)


def _check_choices(choices: Mapping[str, str], registry: Sequence[Effect]) -> None:
    names = [effect.name for effect in registry]
    for name, choice in choices.items():
        if name not in names:
            raise InputError(f"effects.{name}", choice, f"one of the effects {', '.join(names)}")
        if choice not in CHOICES:
            raise InputError(f"effects.{name}", choice, '"on", "off" or "auto"')
