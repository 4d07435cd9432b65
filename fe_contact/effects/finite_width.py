"""Finite width: the plane model of a spur gear is corrected for the free ends of its face."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

from fe_contact.contact.model import ContactModel
from fe_contact.effects.effect import ContactScene, Effect, Verdict, across_face


@dataclass(frozen=True)
class FiniteWidth(Effect):
    """Compliance of the free ends under even loads, from a coarse solid, added to that of plane strain."""

    name: ClassVar[str] = "finite_width"
    brings: ClassVar[str] = "finite_width"
    needs: ClassVar[tuple[str, ...]] = ("position",)
    adds: ClassVar[tuple[str, ...]] = ("compliance",)
    cost: ClassVar[str] = "finite elements of both faces' ends; no more candidates"
    sources: ClassVar[tuple[str, ...]] = ("docs/effects.md#finite_width",)
    valid_for: ClassVar[str] = "spur pairs with nothing acting across the face"
    of_bodies: ClassVar[bool] = True

    def called_for(self, scene: ContactScene) -> Verdict:
        """Call for the effect where the plane can replace the model in three dimensions."""
        reasons = across_face(scene)
        if reasons:
            return Verdict(
                False, "the three-dimensional model contains it: " + "; ".join(reasons), neutral=True
            )
        modules = scene.pair.face_width / scene.pair.pinion.normal_module
        return Verdict(True, f"face of {modules:.3g} modules with free ends, uniformly loaded")

    def contribute(self, scene: ContactScene, model: ContactModel) -> ContactModel:
        """Ask for the correction."""
        return replace(model, finite_width=True)

    def without(self, scene: ContactScene) -> ContactScene:
        """Return the scene itself: nothing in it stands for the effect alone."""
        return scene
