"""The fidelities without finite elements: tooth stiffness of ISO 6336-1 over contact lines, thin slices.

Both take the stiffness of the series of ISO 6336-1, method B, which was fitted to external steel pairs.

- **ISO 6336**: the mesh stiffness follows the length of the contact lines and has the standard's mean
  value, k(x) = c_gamma_alpha b l(x)/mean(l). Nothing but the macro geometry enters.
- **Thin slices**: uncoupled slices of the face between the true gaps, so that modifications, misalignment
  and corner contact act. Measured gears are softer than the theory by C_M = 0.8; finite elements are not,
  so c'/C_M is taken. Along the path of contact the stiffness falls from the middle by a parabola to both
  ends, as deep as the standard's mean asks: c_gamma_alpha = c'(0.75 eps_alpha + 0.25) for eps_alpha pairs.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fe_contact.analysis.pairs.operating_points import OperatingPoints, operating_points
from fe_contact.analysis.pairs.slice_springs import SliceLaw, SpringContact
from fe_contact.analysis.pairs.slice_stiffness import mean_stiffness, parabolic_stiffness
from fe_contact.analysis.pairs.solved_contact import SolvedContact
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.table_fields import table_fields, table_support
from fe_contact.planning.plan import Plan
from fe_contact.solver_version import SOLVER_VERSION, software_versions
from fe_contact.ste import Metadata, PairGeometry, SteDatabase
from fe_contact.ste.metadata import SCHEMA_VERSION, content_hash
from model_studies.stage_clock import StageClock

POSITIONS = 64

ISO_ERROR, SLICE_ERROR = 0.45, 0.6
"""Relative error of the mean stated for the fidelities: above the worst of docs/accuracy.md."""


@dataclass(frozen=True)
class _ClosedFormFidelity:
    """A fidelity of uncoupled slices.

    `relative_error`: of the transmission error, stated with every point of its table.
    """

    name: str
    title: str
    law: SliceLaw
    relative_error: float

    element_size = 0.0

    @property
    def family(self) -> str:
        """Family of the fidelity, which has no other member."""
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
        plan = checked.plan()
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
        request = checked.request
        count = plan.positions or POSITIONS
        position, pitches = np.arange(count) / count, np.arange(points.period)
        table, support = (
            [
                SolvedContact.of(point.contact.pair, *point.solve_pitches(position, load, pitches))
                for point in points.places
            ]
            for load in (plan.load, plan.support)
        )
        solutions = [contact.solution for contact in table]
        elastic = [solution.deflection - solution.no_load[:, None] for solution in solutions]
        return SteDatabase(
            position=(pitches[:, None] + position).ravel(),
            force=plan.load,
            torque=request.torque,
            misalignment=request.misalignment,
            center_distance_change=request.center_distance_change,
            geometry=PairGeometry.of(request.pair),
            period=points.period,
            error_estimate=points.gathered([self.relative_error * np.abs(part) for part in elastic]),
            metadata=Metadata(),
            **table_fields(points, table),
            **table_support(points, support),
        )


ISO6336 = _ClosedFormFidelity(
    "iso6336", "ISO 6336 stiffness over contact lines", SliceLaw(mean_stiffness, with_gaps=False), ISO_ERROR
)

THIN_SLICES = _ClosedFormFidelity(
    "thin_slices", "thin slices", SliceLaw(parabolic_stiffness, with_gaps=True), SLICE_ERROR
)
