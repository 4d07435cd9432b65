"""Contact of a pair whose compliance is at hand: from positions and loads to a solution."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path

from fe_contact.compliance import FlankCompliance, flank_compliances
from fe_contact.contact import (
    Candidates,
    ContactModel,
    ContactProblem,
    ContactSolution,
    Slices,
    contact_candidates,
    contact_problem,
    solve_contact,
    with_gaps,
)
from fe_contact.geometry import GearPair
from fe_contact.mesh import MeshRecipe
from fe_contact.planning import Plan
from fe_contact.types import FloatArray


@dataclass(frozen=True)
class PairContact:
    """A pair whose flank compliances are known; every question about it is cheap.

    Attributes
    ----------
    pair : GearPair
    plan : Plan
    compliances : (FlankCompliance, FlankCompliance)
    """

    pair: GearPair
    plan: Plan
    compliances: tuple[FlankCompliance, FlankCompliance]
    _problems: dict[tuple[bytes, bool, bool], ContactProblem] = field(default_factory=dict, repr=False)

    @property
    def contact_modulus(self) -> float:
        """E* in Pa."""
        first, second = self.compliances
        return 1.0 / (1.0 / first.contact_modulus + 1.0 / second.contact_modulus)

    def solve(
        self, model: ContactModel, position: FloatArray, load: FloatArray
    ) -> tuple[Candidates, ContactSolution]:
        """Solve positions (P,) at normal forces (L,) in N."""
        problem = self._problem(model, position)
        candidates = with_gaps(self.pair, problem.candidates, model)
        return candidates, solve_contact(problem.touching(candidates), load)

    def _problem(self, model: ContactModel, position: FloatArray) -> ContactProblem:
        """Return the problem of plain involutes, kept: gaps and loads do not change its compliance."""
        key = (position.tobytes(), model.corner_contact, model.couple_teeth)
        if key not in self._problems:
            slices = Slices.of_pair(self.pair, 1)
            candidates = contact_candidates(self.pair, model, position, self.plan.patch, slices)
            self._problems[key] = contact_problem(candidates, self.compliances, model.couple_teeth)
        return self._problems[key]


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
