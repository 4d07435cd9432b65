"""Contact of a pair in the plane: from positions and loads to a solution, with the compliance at hand."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

from fe_contact.compliance import FlankCompliance, flank_compliances
from fe_contact.contact import (
    Candidates,
    ContactModel,
    ContactSolution,
    contact_problem,
    plane_candidates,
    solve_contact,
)
from fe_contact.geometry import GearPair
from fe_contact.mesh import MeshRecipe
from fe_contact.planning import Plan
from fe_contact.types import FloatArray


@dataclass(frozen=True)
class PlaneContact:
    """A pair whose flank compliances are known; every question about it is cheap.

    Attributes
    ----------
    pair : GearPair
    model : ContactModel
    plan : Plan
    compliances : (FlankCompliance, FlankCompliance)
    """

    pair: GearPair
    model: ContactModel
    plan: Plan
    compliances: tuple[FlankCompliance, FlankCompliance]

    @property
    def contact_modulus(self) -> float:
        """E* in Pa."""
        first, second = self.compliances
        return 1.0 / (1.0 / first.contact_modulus + 1.0 / second.contact_modulus)

    def candidates(self, position: FloatArray) -> Candidates:
        """Candidates at positions (P,)."""
        return plane_candidates(self.pair, self.model, position, self.plan.patch)

    def solve(self, position: FloatArray, load: FloatArray) -> tuple[Candidates, ContactSolution]:
        """Solve positions (P,) at normal forces (L,) in N."""
        candidates = self.candidates(position)
        problem = contact_problem(candidates, self.compliances, self.model.couple_teeth)
        return candidates, solve_contact(problem, load)


def plane_compliances(
    pair: GearPair, plan: Plan, recipes: tuple[MeshRecipe, MeshRecipe], cache: Path | None
) -> tuple[FlankCompliance, FlankCompliance]:
    """Compliance of both gears with all teeth that can touch; identical gears are computed once."""
    reach = 2 * math.ceil(pair.transverse_contact_ratio) + 1
    fits = min(pair.pinion.teeth, pair.wheel.teeth)
    teeth = min(reach, fits - 1 + fits % 2)
    first, second = flank_compliances(
        (pair.pinion, pair.wheel), recipes, plan.hypothesis, teeth=teeth, cache=cache
    )
    return first, second
