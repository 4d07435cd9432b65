"""Pairs ready to be solved at any position and load, and the laws that every one of them obeys."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from fe_contact.analysis.pairs.operating_points import operating_points
from fe_contact.analysis.pairs.pair_contact import PairContact, pair_contact
from fe_contact.analysis.request.request_check import check_request
from fe_contact.contact import ContactModel, ContactProblem, ContactSolution
from fe_contact.contact.point_problem import motions, point_problems, pressed_state, problem_at
from fe_contact.contact.tilted_bodies import fill_yielding, move
from fe_contact.geometry import Gear, GearPair, ParallelAxes
from fe_contact.options import AnalysisOptions, TableAxes
from fe_contact.planning.plan import Plan
from fe_contact.types import FloatArray, IntArray
from lineofaction.hardcases.contact.interior_point import GapAbout, Problem, solve
from lineofaction.hardcases.scene import Measured

NOMINAL_TORQUE = 100.0
"""N m on the driving gear of the nominal pair: 0.5 GPa of Hertz pressure."""

CYCLIC = 2e-5
"""How much STE may differ from tooth to tooth in the plane: the mesh of the body is not the same for all."""


@dataclass(frozen=True)
class Posed:
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
        """Solve positions (P,) in base pitches at normal forces (L,) in N; None: those of the plan."""
        return self.contact.solve(self.model, position, self.plan.load if load is None else load, pitch)

    def ste(self, position: FloatArray) -> FloatArray:
        """Return the STE (P, L) in m at the loads of the plan."""
        return self.solve(position)[1].deflection

    def with_model(self, **changes: object) -> Posed:
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
    """Return the pair of two such gears at 80 mm."""
    gear = nominal_gear(**changes)
    return GearPair(gear, gear, 80e-3)


def posed(
    pair: ParallelAxes,
    torques: Sequence[float] | FloatArray = (NOMINAL_TORQUE,),
    *,
    model: str = "plane_strain",
    level: str = "draft",
    misalignment: float = 0.0,
    pitches: int | None = None,
    effects: dict[str, str] | None = None,
    bodies: PairContact | None = None,
) -> Posed:
    """Plan a pair for torques in N m as `analyze` does.

    Its compliances are computed afresh, or taken from `bodies` of the same macro geometry.
    """
    axes = TableAxes(torques, misalignments=[misalignment], pitches=pitches)
    checked = check_request(pair, axes, AnalysisOptions(level=level, model=model, effects=effects or {}))
    request = checked.request
    plan = checked.plan()
    known = None if bodies is None else replace(bodies, pair=pair, plan=plan, _problems={})
    contact = known or pair_contact(pair, plan, None)
    (point,) = operating_points(request.scene, request.choices, contact).places
    return Posed(point.contact, point.model)


def even_positions(count: int) -> FloatArray:
    """Return positions spread evenly over one base pitch."""
    return np.arange(count) / count


def off(values: FloatArray, expected: FloatArray) -> float:
    """Return the largest relative difference."""
    return float(np.abs(values / expected - 1.0).max())


def mean_off(values: FloatArray, expected: FloatArray) -> float:
    """Return the relative difference of the means."""
    return abs(float(values.mean() / expected.mean()) - 1.0)


def range_off(values: FloatArray, expected: FloatArray) -> float:
    """Return the relative difference of the ranges."""
    return abs(float(np.ptp(values) / np.ptp(expected)) - 1.0)


# Laws of every contact scene: the conditions of contact, and a second solver that agrees.


LARGEST_RESIDUAL = 1e-9
MOST_ITERATIONS = 40
LARGEST_DISAGREEMENT = 1e-8
COMPARED = 12
"""Points that the second solver solves too: it is ten thousand times as slow."""


def soundness(
    problem: ContactProblem, solution: ContactSolution, compared: int = COMPARED
) -> tuple[Measured, ...]:
    """Return failed points, worst residual, most iterations, and the disagreement of two solvers.

    The second one (`interior_point`) shares no line with the first, not even the local law. `compared`
    points are spread evenly over positions and loads.
    """
    total = solution.status.size
    chosen = np.unique(np.linspace(0, total - 1, min(compared, total)).astype(int))
    points = [tuple(map(int, np.unravel_index(i, solution.status.shape))) for i in chosen]
    apart = [_disagreement(problem, solution, position, load) for position, load in points]
    return (
        Measured("failed points", float(np.count_nonzero(solution.status)), most=0.0),
        Measured("largest residual", float(solution.residuals.max()), most=LARGEST_RESIDUAL),
        Measured("most iterations", float(solution.iterations.max()), most=MOST_ITERATIONS),
        Measured("two solvers apart", max(apart), most=LARGEST_DISAGREEMENT),
    )


def _disagreement(problem: ContactProblem, solution: ContactSolution, position: int, load: int) -> float:
    """Return the difference of both solvers' deflection over the elastic deflection."""
    answer = solve(_plain(problem, position, solution.force[position, load]), float(solution.load[load]))
    here = float(solution.deflection[position, load])
    return abs(answer.deflection - here) / (here - float(solution.no_load[position]))


def _plain(problem: ContactProblem, position: int, force: FloatArray) -> Problem:
    """Write one position as the second solver takes it; candidates that are none are left out.

    Bodies that tilt yield as they do under the `force` that is to be confirmed.
    """
    c = problem.candidates
    point, here = problem_at(point_problems(problem), position)
    state = pressed_state(point, force[here])
    move(point, state)
    fill_yielding(point, state)
    blend = np.array([motions(point, one) for one in np.eye(len(point.bodies))]).T
    real = np.isin(np.arange(c.pair.size), here)
    motion = c.motion_arm[position, real]
    row = position % len(problem.compliance)
    return Problem(
        compliance=blend @ state.yielding @ blend.T,
        gap=c.gap[position, real] * motion + blend @ (state.moved - state.yielding @ state.held),
        motion_arm=motion,
        torque_arm=c.torque_share[position, real],
        gap_about=GapAbout(*(part[position, real] for part in c.gap_about)),
        width=c.width[position, real],
        length=c.slices.law_length,
        modulus=2.0 / (np.pi * sum(k[row, real] for k in problem.half_planes)),
    )
