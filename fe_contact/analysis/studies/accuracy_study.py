"""The accuracy study: ways to the transmission error from a closed form to fine finite elements."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

import model_studies
from fe_contact.analysis.database.compute_database import compute_database, software_versions
from fe_contact.analysis.pairs.pair_contact import OperatingPoints, operating_points
from fe_contact.analysis.pairs.slice_springs import (
    SliceLaw,
    SpringContact,
    mean_stiffness,
    parabolic_stiffness,
)
from fe_contact.analysis.pairs.tabulate import pair_facts, table_fields, table_support
from fe_contact.analysis.request.model_choice import decide
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import check_asked
from fe_contact.contact import ContactSolution
from fe_contact.errors import InputError
from fe_contact.options import Run
from fe_contact.planning.discretization import PLANE_REFINEMENT
from fe_contact.planning.plan import Plan, make_plan
from fe_contact.solver_version import SOLVER_VERSION
from fe_contact.stage_clock import StageClock
from fe_contact.ste import Metadata, SteDatabase
from fe_contact.ste.facts import SCHEMA_VERSION, content_hash
from fe_contact.types import FloatArray

# A fidelity of the accuracy study.


class Fidelity(model_studies.Fidelity[Checked], Protocol):
    """One way to a table of transmission error; those of one family differ by their mesh only.

    Attributes
    ----------
    element_size : float
        What a convergence is assessed by.
    """

    @property
    def element_size(self) -> float:
        """Size of the elements beside that of the other fidelities of the family; 0 without elements."""

    def as_computed(self, checked: Checked) -> Checked:
        """Return the request as this fidelity computes it: with its model and mesh.

        Raises
        ------
        InputError
            The fidelity is not valid for it.
        """

    def run(self, checked: Checked) -> SteDatabase:
        """Compute the table without a cache, with its time, memory and error in the receipt."""


# The fidelities without finite elements: tooth stiffness of ISO 6336-1 over contact lines, thin slices.
#
# Both take the stiffness of the series of ISO 6336-1, method B, which was fitted to external steel pairs.
#
# - **ISO 6336**: the mesh stiffness follows the length of the contact lines and has the standard's mean
#   value, k(x) = c_gamma_alpha b l(x)/mean(l). Nothing but the macro geometry enters.
# - **Thin slices**: uncoupled slices of the face between the true gaps, so that modifications, misalignment
#   and corner contact act. Measured gears are softer than the theory by C_M = 0.8; finite elements are not,
#   so c'/C_M is taken. Along the path of contact the stiffness falls from the middle by a parabola to both
#   ends, as deep as the standard's mean asks: c_gamma_alpha = c'(0.75 eps_alpha + 0.25) for eps_alpha pairs.

POSITIONS = 64

ISO_ERROR, SLICE_ERROR = 0.45, 0.6
"""Relative error of the mean stated for the fidelities: above the worst of docs/frontier.md."""


@dataclass(frozen=True)
class _ClosedFormFidelity:
    """A fidelity of uncoupled slices.

    Attributes
    ----------
    name, title : str
    law : SliceLaw
    relative_error : float
        Of the transmission error, stated with every point of its table.
    """

    name: str
    title: str
    law: SliceLaw
    relative_error: float

    element_size = 0.0

    @property
    def family(self) -> str:
        """A family of its own."""
        return self.name

    def refusal(self, checked: Checked) -> str | None:
        """Say why it is not valid: the series is for external pairs, and shafts couple the slices."""
        pair = checked.request.pair
        if pair.internal:
            return "the stiffness of ISO 6336-1 applies to external pairs only"
        if checked.model.compliances:
            return "flexible shafts couple the slices"
        return None

    def as_computed(self, checked: Checked) -> Checked:
        """Return the request as it is: there is no mesh to choose."""
        return checked

    def run(self, checked: Checked) -> SteDatabase:
        """Compute the table."""
        clock = StageClock()
        request = checked.request
        plan = make_plan(request.pair, request.load, request.options, checked.model)
        with clock.stage("contact"):
            nominal = SpringContact(request.pair, plan, law=self.law)
            points = operating_points(request.scene, request.choices, nominal)
            table = self._table(checked, plan, points)
        case = request.to_json() | {"rung": self.name}
        ledger = [entry.to_json() for entry in checked.ledger]
        receipt = clock.to_json() | {"plan": {"model": self.name, "positions": table.position.size}}
        name = content_hash(case, SOLVER_VERSION, SCHEMA_VERSION)
        return replace(table, metadata=Metadata(case, ledger, receipt, name, software_versions()))

    def _table(self, checked: Checked, plan: Plan, points: OperatingPoints) -> SteDatabase:
        """Solve all places at equally spaced positions."""
        request = checked.request
        count = plan.positions or POSITIONS
        position, pitches = np.arange(count) / count, np.arange(points.period)
        solved = [point.solve_pitches(position, plan.load, pitches) for point in points.places]
        support = [point.solve_pitches(position, plan.support, pitches) for point in points.places]
        error = [self._error(solution) for _, solution in solved]
        return SteDatabase(
            position=(pitches[:, None] + position).ravel(),
            force=plan.load,
            torque=request.torque,
            misalignment=request.misalignment,
            center_distance_change=request.center_distance_change,
            facts=pair_facts(request.pair),
            period=points.period,
            error_estimate=points.gathered(error),
            metadata=Metadata(),
            **table_fields(points, solved),
            **table_support(points, support),
        )

    def _error(self, solution: ContactSolution) -> FloatArray:
        """State the error (P, L) as a part of the elastic deflection, m."""
        return self.relative_error * np.abs(solution.deflection - solution.no_load[:, None])


ISO6336 = _ClosedFormFidelity(
    "iso6336", "ISO 6336 stiffness over contact lines", SliceLaw(mean_stiffness, with_gaps=False), ISO_ERROR
)
THIN_SLICES = _ClosedFormFidelity(
    "thin_slices", "thin slices", SliceLaw(parabolic_stiffness, with_gaps=True), SLICE_ERROR
)


# The fidelities of finite elements: `analyze` with a model and a mesh.

SECTOR_FLANK_SIZE = {"draft": 0.2, "standard": 0.15, "fine": 0.1}
"""Modules; of `SectorRecipe`."""


@dataclass(frozen=True)
class _FiniteElementFidelity:
    """A model and a mesh of `analyze`.

    Attributes
    ----------
    name, title : str
    model : str
        "plane_strain", "3d", or "auto" for the plane corrected for its finite width.
    level : str
        "draft", "standard" or "fine".
    slices : int, optional
        Of the face; default: those that usually go with the mesh.
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
        """Size of the elements beside that of the other fidelities of the family."""
        return SECTOR_FLANK_SIZE[self.level] if self.model == "3d" else 1.0 / PLANE_REFINEMENT[self.level]

    def refusal(self, checked: Checked) -> str | None:
        """Say why the fidelity is not valid: no plane holds what acts across the face."""
        try:
            self.as_computed(checked)
        except InputError as error:
            return f"{error.field} must be {error.bound}"
        return None

    def as_computed(self, checked: Checked) -> Checked:
        """Return the request with this model and mesh; explicit choices of other effects stay."""
        request = checked.request
        own = face, width = request.model_effects
        effects = {name: choice for name, choice in request.options.effects.items() if name not in own}
        if self.model == "auto":
            effects |= {face: "off", width: "on"}
        options = request.options.at_level(self.level)
        options = replace(options, model=self.model, effects=effects, receipt="full")
        return check_asked(replace(request, options=options))

    def run(self, checked: Checked) -> SteDatabase:
        """Compute the table."""
        computed = self.as_computed(checked)
        decided = decide(computed)
        if self.slices is not None:
            decided = decided.in_slices(self.slices)
        return compute_database(computed, computed.request.to_json(), Run(), decided)


FIDELITIES: tuple[Fidelity, ...] = (
    ISO6336,
    THIN_SLICES,
    _FiniteElementFidelity("plane_strain", "2-D plane strain", "plane_strain", "standard"),
    _FiniteElementFidelity("corrected_draft", "2-D corrected for the width, draft", "auto", "draft"),
    _FiniteElementFidelity("corrected", "2-D corrected for the width, standard", "auto", "standard"),
    _FiniteElementFidelity("corrected_fine", "2-D corrected for the width, fine", "auto", "fine"),
    _FiniteElementFidelity("3d_draft", "3-D, draft", "3d", "draft"),
    _FiniteElementFidelity("3d_standard", "3-D, standard", "3d", "standard"),
    _FiniteElementFidelity("3d_fine", "3-D, fine, 23 slices", "3d", "fine", 23),
)
