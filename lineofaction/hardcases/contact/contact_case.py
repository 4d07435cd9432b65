"""Pairs ready to be solved at any position and load."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from fe_contact.analysis.pairs.operating_points import operating_points
from fe_contact.analysis.pairs.pair_contact import PairContact, pair_contact
from fe_contact.analysis.request.request_check import check_request
from fe_contact.contact import ContactModel, ContactProblem, ContactSolution
from fe_contact.geometry import Gear, GearPair, ParallelAxes
from fe_contact.options import AnalysisOptions, TableAxes
from fe_contact.planning.plan import Plan
from fe_contact.types import FloatArray, IntArray

NOMINAL_TORQUE = 100.0
"""Torque on the driving gear of the nominal pair, N m: 0.5 GPa of Hertz pressure."""

CYCLIC = 2e-5
"""Relative difference of the STE from tooth to tooth in the plane: the mesh of the body differs between
teeth."""


@dataclass(frozen=True)
class ContactCase:
    """A pair at one misalignment, its plan and the model its effects compose."""

    contact: PairContact
    model: ContactModel

    @property
    def plan(self) -> Plan:
        """The discretization."""
        return self.contact.plan

    @property
    def pair(self) -> ParallelAxes:
        """The pair."""
        return self.contact.pair

    def solve(
        self, position: FloatArray, load: FloatArray | None = None, pitch: IntArray | None = None
    ) -> tuple[ContactProblem, ContactSolution]:
        """Solve positions (P,) in base pitches at normal forces (L,) in N; None: the forces of the plan."""
        return self.contact.solve(self.model, position, self.plan.load if load is None else load, pitch)

    def ste(self, position: FloatArray) -> FloatArray:
        """Return the STE (P, L) in m at the loads of the plan."""
        return self.solve(position)[1].deflection

    def with_model(self, **changes: object) -> ContactCase:
        """Return the same bodies with another contact model."""
        return replace(self, model=replace(self.model, **changes))  # type: ignore[arg-type]


def nominal_gear(**changes: object) -> Gear:
    """Return a gear of 20 teeth, module 4 mm, 25 mm wide, on a bore of 40 mm."""
    plain: dict[str, object] = {
        "teeth": 20,
        "normal_module": 4e-3,
        "face_width": 25e-3,
        "bore_diameter": 40e-3,
    }
    return Gear(**(plain | changes))  # type: ignore[arg-type]


def nominal_pair(**changes: object) -> GearPair:
    """Return the pair of two nominal gears at a center distance of 80 mm."""
    gear = nominal_gear(**changes)
    return GearPair(gear, gear, 80e-3)


def contact_case(
    pair: ParallelAxes,
    torques: Sequence[float] | FloatArray = (NOMINAL_TORQUE,),
    *,
    model: str = "plane_strain",
    level: str = "draft",
    misalignment: float = 0.0,
    pitches: int | None = None,
    effects: dict[str, str] | None = None,
    bodies: PairContact | None = None,
) -> ContactCase:
    """Plan a pair for torques in N m as `analyze` does.

    Its compliances are computed afresh, or taken from `bodies` of the same macro geometry.
    """
    axes = TableAxes(torques, misalignments=[misalignment], pitches=pitches)
    checked = check_request(pair, axes, AnalysisOptions(level=level, model=model, effects=effects or {}))
    request = checked.request
    plan = checked.plan()
    # without the problems of the other pair, which a contact keeps
    reused = None if bodies is None else replace(bodies, pair=pair, plan=plan, _problems={})
    contact = reused or pair_contact(pair, plan, None)
    (point,) = operating_points(request.scene, request.choices, contact).places
    return ContactCase(point.contact, point.model)


def even_positions(count: int) -> FloatArray:
    """Return positions spread evenly over one base pitch."""
    return np.arange(count) / count


def max_relative(values: FloatArray, expected: FloatArray) -> float:
    """Return the largest relative difference."""
    return float(np.abs(values / expected - 1.0).max())


def mean_relative(values: FloatArray, expected: FloatArray) -> float:
    """Return the relative difference of the means."""
    return abs(float(values.mean() / expected.mean()) - 1.0)


def range_off(values: FloatArray, expected: FloatArray) -> float:
    """Return the relative difference of the ranges."""
    return abs(float(np.ptp(values) / np.ptp(expected)) - 1.0)
