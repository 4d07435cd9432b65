"""The fidelities of finite elements: `analyze` with a model and a mesh."""

from __future__ import annotations

from dataclasses import dataclass, replace

from fe_contact.analysis.database.compute_database import compute_database
from fe_contact.analysis.request.model_choice import Decision, decide
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import checked_request
from fe_contact.errors import InputError
from fe_contact.options import Run
from fe_contact.planning.discretization import PLANE_REFINEMENT
from fe_contact.ste import SteDatabase

SECTOR_FLANK_SIZE = {"draft": 0.2, "standard": 0.15, "fine": 0.1}
"""Sizes of elements on the flank in modules, those of `SectorRecipe`."""


@dataclass(frozen=True)
class FiniteElementFidelity:
    """A model and a mesh of `analyze`.

    The model is "plane_strain", "3d", or "auto" for the plane corrected for its finite width; without
    `slices` it has those that usually go with the mesh.
    """

    name: str
    title: str
    model: str
    level: str
    slices: int | None = None

    @property
    def family(self) -> str:
        """Fidelities of one family differ by their mesh only."""
        return self.model

    @property
    def element_size(self) -> float:
        """Size of the elements relative to the other fidelities of the family."""
        return SECTOR_FLANK_SIZE[self.level] if self.model == "3d" else 1.0 / PLANE_REFINEMENT[self.level]

    def refusal(self, checked: Checked) -> str | None:
        """Return why the fidelity is not valid: a plane holds nothing that acts across the face."""
        try:
            self.as_computed(checked)
        except InputError as error:
            return f"{error.field} must be {error.bound}"
        return None

    def as_computed(self, checked: Checked) -> Checked:
        """Return the request with this model and mesh; explicit choices of other effects stay."""
        request = checked.request
        model_effects = request.model_effects
        face, width = model_effects
        effects = {
            name: choice for name, choice in request.options.effects.items() if name not in model_effects
        }
        if self.model == "auto":
            effects |= {face: "off", width: "on"}
        options = request.options.at_level(self.level)
        options = replace(options, model=self.model, effects=effects, receipt="full")
        return checked_request(replace(request, options=options))

    def run(self, checked: Checked) -> SteDatabase:
        """Compute the table."""
        computed = self.as_computed(checked)
        return compute_database(computed, computed.request.to_json(), Run(), self.decision(computed))

    def decision(self, computed: Checked) -> Decision:
        """Return the request as it is computed with its plan."""
        choice = decide(computed)
        return choice if self.slices is None else choice.in_slices(self.slices)
