"""Face load distribution: three dimensions instead of the transverse plane."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

from fe_contact.contact.model import ContactModel
from fe_contact.effects.effect import ContactScene, Effect, Verdict, across_face


@dataclass(frozen=True)
class FaceLoadDistribution(Effect):
    """Finite face width with free ends, contact in slices, load distributed among them."""

    name: ClassVar[str] = "face_load_distribution"
    brings: ClassVar[str] = "across_face"
    needs: ClassVar[tuple[str, ...]] = ("face position", "load")
    adds: ClassVar[tuple[str, ...]] = ("compliance", "candidates")
    cost: ClassVar[str] = "finite elements of whole sectors instead of sections; 90 candidates a pair"
    sources: ClassVar[tuple[str, ...]] = ("docs/effects.md#face_load_distribution",)
    valid_for: ClassVar[str] = "every pair"
    of_bodies: ClassVar[bool] = True

    def called_for(self, scene: ContactScene) -> Verdict:
        """Call for the effect where anything in the scene acts across the face."""
        reasons = across_face(scene)
        if reasons:
            return Verdict(True, "; ".join(reasons))
        return Verdict(False, "a spur pair with nothing acting across the face")

    def contribute(self, scene: ContactScene, model: ContactModel) -> ContactModel:
        """Ask for three dimensions."""
        return replace(model, across_face=True)

    def estimable(self, scene: ContactScene) -> bool:
        """Return False where the reference would be a plane without the parts that act across the face."""
        return not across_face(scene)
