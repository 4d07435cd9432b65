"""Thin rim: gear bodies have the rim and web of their blank instead of being solid."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

from fe_contact.contact.model import ContactModel
from fe_contact.effects.effect import ContactScene, Effect, Verdict
from fe_contact.errors import InputError


@dataclass(frozen=True)
class ThinRim(Effect):
    """Compliance of a rim on a web, in place of a solid body."""

    name: ClassVar[str] = "thin_rim"
    needs: ClassVar[tuple[str, ...]] = ("gear blank",)
    adds: ClassVar[tuple[str, ...]] = ("compliance",)
    cost: ClassVar[str] = "none beside the three-dimensional model it calls for"
    sources: ClassVar[tuple[str, ...]] = ("docs/effects.md#thin_rim", "ISO 6336-1: gear blank factor C_R")
    valid_for: ClassVar[str] = "external gears; rim and hub as wide as the face, web a plain disc"
    of_bodies: ClassVar[bool] = True

    def called_for(self, scene: ContactScene) -> Verdict:
        """Call for the effect where either gear has a web."""
        with_web = [name for name, gear in scene.gears.items() if gear.web is not None]
        if not with_web:
            return Verdict(False, "both bodies are solid", neutral=True)
        return Verdict(True, f"{' and '.join(with_web)} with rim and web")

    def contribute(self, scene: ContactScene, model: ContactModel) -> ContactModel:
        """Ask for the bodies as drawn."""
        return replace(model, parts=(*model.parts, "blank"))

    def across_face(self, scene: ContactScene) -> str | None:
        """Return the web as a reason for a model over the face; None where both bodies are solid."""
        return "a web narrower than the face" if scene.pair.pinion.web or scene.pair.wheel.web else None

    def refuse_plane(self, scene: ContactScene) -> None:
        """Refuse a web that tilts its gear: the plane has no tilt."""
        for name, gear in scene.gears.items():
            if gear.web is not None and gear.web.low + gear.web.high != 0.0:
                offset, remedy = 0.5 * (gear.web.low + gear.web.high), "Use the 3-D model for it."
                raise InputError(f"{name}.blank.web_offset", offset, "0 for a plane model", remedy)
