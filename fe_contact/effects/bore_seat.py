"""Bore seat: the bore rests on its shaft elastically, over part of the face, or on a key."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

from fe_contact.contact.model import ContactModel
from fe_contact.effects.effect import ContactScene, Effect, Verdict
from fe_contact.errors import InputError
from fe_contact.geometry import CLAMPED


@dataclass(frozen=True)
class BoreSeatElasticity(Effect):
    """A bore that is not fixed all over lets the gear turn, shift and tilt."""

    name: ClassVar[str] = "bore_seat"
    needs: ClassVar[tuple[str, ...]] = ("bore seat",)
    adds: ClassVar[tuple[str, ...]] = ("compliance",)
    cost: ClassVar[str] = "none beside the three-dimensional model it calls for"
    sources: ClassVar[tuple[str, ...]] = ("docs/effects.md#bore_seat",)
    valid_for: ClassVar[str] = "external gears; a seat that carries tension and compression"
    of_bodies: ClassVar[bool] = True

    def called_for(self, scene: ContactScene) -> Verdict:
        """Call for the effect where either bore has a seat that is not fixed over its whole surface."""
        seated = [name for name, gear in scene.gears.items() if gear.seat != CLAMPED]
        if not seated:
            return Verdict(False, "both bores are fixed over their whole surface", neutral=True)
        return Verdict(True, f"{' and '.join(seated)} on a seat of the bore")

    def contribute(self, scene: ContactScene, model: ContactModel) -> ContactModel:
        """Ask for the seats."""
        return replace(model, parts=(*model.parts, "seat"))

    def across_face(self, scene: ContactScene) -> str | None:
        """Return the seat as a reason for a model over the face, None where both bores are fixed."""
        seated = any(gear.seat != CLAMPED for gear in scene.gears.values())
        return "a seat of the bore" if seated else None

    def estimable(self, scene: ContactScene) -> bool:
        """Return False for a seat on part of the face."""
        return all(gear.seat.width is None for gear in scene.gears.values())

    def refuse_plane(self, scene: ContactScene) -> None:
        """Refuse seats of bores: in the plane every bore is fixed."""
        for name, gear in scene.gears.items():
            if gear.seat != CLAMPED:
                remedy = "Use the 3-D model for it."
                raise InputError(f"{name}.seat", "given", "left out for a plane model", remedy)
