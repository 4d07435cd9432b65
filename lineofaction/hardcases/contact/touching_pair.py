"""A tooth pair that just touches under load: on the border of the active set."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.optimize import brentq

from fe_contact.contact import ContactProblem, ContactSolution, solve_contact
from fe_contact.geometry import FlankModification, GearPair
from lineofaction.hardcases.contact.laws import soundness
from lineofaction.hardcases.contact.posed_pair import Posed, nominal_gear, nominal_pair, posed
from lineofaction.hardcases.scene import Measured, Scenes

SCENES = Scenes("contact")

_POSITION = np.array([0.3])

_LOADS = np.array([0.5, 1.0 - 1e-6, 1.0 + 1e-6, 1.0 + 1e-3])

_LENGTH = 2.5e-3
"""Length of the relief along the radius, m."""

_NUDGES = np.array([-1e-3, -1e-6, -1e-9, -1e-12, -1e-15, 0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3])


@SCENES.add(
    "handover_touching",
    "Tip relief equal to the deflection to the last digit: the entering pair touches without force, so that"
    " rounding decides whether it belongs to the active set.",
    "The gap is that of a straight ramp; STE rises with relief and never faster than it (the deflection is "
    "non-expansive in the gaps), and the pair carries a millionth above the load that brings it into touch; "
    "through nudges of 1e-15 to 1e-3; two solvers agree.",
)
def _relief_that_touches() -> Sequence[Measured]:
    """Find the tip relief with which the second pair carries nothing and gapes nowhere; nudge it."""
    case = posed(nominal_pair())
    exact = brentq(lambda relief: _reach(case, relief), 1e-6, 100e-6, xtol=1e-18, rtol=1e-15)
    reliefs = exact * (1.0 + _NUDGES)
    solved = [_solve(case, relief) for relief in reliefs]
    ste = np.array([solution.deflection[0, 0] for _, solution in solved])
    rise, widening = np.diff(ste), np.diff(reliefs)
    rounding = 1e-14 * ste.max()
    raised = _raised(*solved[_NUDGES.size // 2])
    checks = [soundness(*solution) for solution in (*solved, raised)]
    entering = np.sort(raised[1].force[0], axis=1)[:, -2] / raised[1].load
    return (
        *(max(column, key=lambda m: m.value) for column in zip(*checks, strict=True)),
        Measured("relief found, µm", 1e6 * exact),
        Measured("its gap off the closed form of a straight ramp", _off_the_ramp(case, exact), maximum=1e-3),
        Measured("share of the touching pair", float(_share(*solved[_NUDGES.size // 2])), maximum=1e-9),
        Measured("its share a millionth below the load at which it touches", float(entering[1]), maximum=0.0),
        Measured("a millionth above it, raised to it", float(entering[2]), maximum=1e-6, minimum=1e-9),
        Measured("least rise of STE with relief, m", float((rise + rounding).min()), minimum=0.0),
        Measured("largest rise over the relief's", float(((rise - rounding) / widening).max()), maximum=1.0),
    )


def _solve(case: Posed, relief: float) -> tuple[ContactProblem, ContactSolution]:
    """Solve with a linear relief of the driven tip, which enters the mesh."""
    modification = FlankModification(tip_relief=float(relief), tip_relief_length=_LENGTH)
    pair = GearPair(nominal_gear(), nominal_gear(modification=modification), case.pair.center_distance)
    relieved = posed(pair, case.pair.torque(case.plan.load), bodies=case.contact)
    return relieved.solve(_POSITION, case.plan.load)


def _raised(problem: ContactProblem, touching: ContactSolution) -> tuple[ContactProblem, ContactSolution]:
    """Raise the load through that at which the pair touches: it was out of contact at the load before."""
    return problem, solve_contact(problem, touching.load[-1] * _LOADS)


def _reach(case: Posed, relief: float) -> float:
    """Return the distance of the weaker pair from touch: < 0 it carries (share), > 0 it gapes (um)."""
    problem, solution = _solve(case, relief)
    force = solution.force[0, 0]
    weaker = int(np.argsort(force)[-2])
    if force[weaker] > 0.0:
        return -float(force[weaker] / force.sum())
    c = problem.candidates
    gap = c.gap[0] * c.motion_arm[0] + problem.displacement(solution.force)[0, 0]
    slack = gap - c.motion_arm[0] * solution.deflection[0, 0]
    return 1e6 * float(np.min(slack[force == 0.0]))


def _off_the_ramp(case: Posed, relief: float) -> float:
    """Return the deviation of the entering pair's gap from a ramp of height c and slope m along the flank.

    It is c - R m^2/2 along the normal, which gear 2 closes by a lag of 1/(1 - s) times that, s the slope over
    its roll length.
    """
    problem, _ = _solve(case, relief)
    pair, gear = case.pair, case.pair.wheel
    start, tip = gear.roll_length(gear.tip_radius - _LENGTH), gear.tip_roll_length
    roll_1, roll_2 = pair.roll_lengths(_POSITION[:, None], problem.candidates.pair)
    entering = int(np.flatnonzero((roll_2[0] > start) & (roll_2[0] < tip))[0])
    first, second = float(roll_1[0, entering]), float(roll_2[0, entering])
    height = relief * (second - start) / (tip - start)
    by_roll = relief / (tip - start)
    slope = by_roll * gear.base_radius / second
    radius = 1.0 / (1.0 / first + 1.0 / second)
    lag = (height - 0.5 * radius * slope**2) / (1.0 - by_roll)
    return abs(float(problem.candidates.gap[0, entering]) / lag - 1.0)


def _share(problem: ContactProblem, solution: ContactSolution) -> float:
    """Return the load share of the weakest pair that carries load."""
    force = np.sort(solution.force[0, 0])
    return float(force[-2] / force.sum())
