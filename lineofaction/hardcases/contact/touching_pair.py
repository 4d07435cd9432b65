"""A tooth pair that just touches under load: on the border of the active set."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.optimize import brentq

from fe_contact.contact import ContactProblem, ContactSolution, solve_contact
from fe_contact.geometry import FlankModification, GearPair
from lineofaction.hardcases.contact.contact_case import ContactCase, contact_case, nominal_gear, nominal_pair
from lineofaction.hardcases.contact.laws import soundness
from lineofaction.hardcases.scene import Measured, Scenes

SCENES = Scenes("contact")

_POSITION = np.array([0.3])
"""Position in base pitches at which two pairs may carry."""

_LOADS = np.array([0.5, 1.0 - 1e-6, 1.0 + 1e-6, 1.0 + 1e-3])
"""Loads over the load at which the entering pair touches."""

_RELIEF_LENGTH = 2.5e-3
"""Length of the relief along the radius, m."""

_NUDGES = np.array([-1e-3, -1e-6, -1e-9, -1e-12, -1e-15, 0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3])
"""Relative changes of the relief; the middle one is zero."""


@SCENES.add(
    "handover_touching",
    "Tip relief equal to the deflection to the last digit: the entering pair touches without force, so that"
    " rounding decides whether it belongs to the active set.",
    "The gap is that of a straight ramp; STE rises with relief and never faster than it (the deflection is "
    "non-expansive in the gaps), and the pair carries a millionth above the load that brings it into touch; "
    "through nudges of 1e-15 to 1e-3; two solvers agree.",
)
def _relief_that_touches() -> Sequence[Measured]:
    """Find the tip relief with which the entering pair touches without force; solve around it."""
    case = contact_case(nominal_pair())
    exact = brentq(lambda relief: _reach(case, relief), 1e-6, 100e-6, xtol=1e-18, rtol=1e-15)
    reliefs = exact * (1.0 + _NUDGES)
    solved = [_solve(case, relief) for relief in reliefs]
    ste = np.array([solution.deflection[0, 0] for _, solution in solved])
    rise, widening = np.diff(ste), np.diff(reliefs)
    rounding = 1e-14 * ste.max()
    problem, touching = solved[_NUDGES.size // 2]
    raised = solve_contact(problem, touching.load[-1] * _LOADS)
    checks = [soundness(*solution) for solution in (*solved, (problem, raised))]
    # of two pairs that may carry, the entering one has the second largest force
    force = np.sort(touching.force[0, 0])
    entering = np.sort(raised.force[0], axis=1)[:, -2] / raised.load
    return (
        # the worst of each figure over all solutions
        *(max(figures, key=lambda figure: figure.value) for figures in zip(*checks, strict=True)),
        Measured("relief found, µm", 1e6 * exact),
        Measured("its gap off the closed form of a straight ramp", _off_the_ramp(case, exact), maximum=1e-3),
        Measured("share of the touching pair", force[-2] / force.sum(), maximum=1e-9),
        Measured("its share a millionth below the load at which it touches", entering[1], maximum=0.0),
        Measured("a millionth above it, raised to it", entering[2], maximum=1e-6, minimum=1e-9),
        Measured("least rise of STE with relief, m", (rise + rounding).min(), minimum=0.0),
        Measured("largest rise over the relief's", ((rise - rounding) / widening).max(), maximum=1.0),
    )


def _solve(case: ContactCase, relief: float) -> tuple[ContactProblem, ContactSolution]:
    """Solve with a linear relief of the driven tip, which enters the mesh."""
    modification = FlankModification(tip_relief=float(relief), tip_relief_length=_RELIEF_LENGTH)
    pair = GearPair(nominal_gear(), nominal_gear(modification=modification), case.pair.center_distance)
    relieved = contact_case(pair, case.pair.torque(case.plan.load), bodies=case.contact)
    return relieved.solve(_POSITION, case.plan.load)


def _reach(case: ContactCase, relief: float) -> float:
    """Return minus the load share of the weaker pair if it carries, else its least gap under load, um."""
    problem, solution = _solve(case, relief)
    force = solution.force[0, 0]
    weaker = int(np.argsort(force)[-2])
    if force[weaker] > 0.0:
        return -float(force[weaker] / force.sum())
    gap, arm = problem.candidates.gap[0], problem.candidates.motion_arm[0]
    # gap as a lag of gear 2 times its arm, plus what the bodies yield, less what the lag of gear 2 closes
    slack = gap * arm + problem.displacement(solution.force)[0, 0] - arm * solution.deflection[0, 0]
    return 1e6 * float(np.min(slack[force == 0.0]))


def _off_the_ramp(case: ContactCase, relief: float) -> float:
    """Return the relative deviation of the entering pair's gap from that of a straight ramp of relief.

    With c the relief at the point of contact, m its slope along the flank and R the radius of relative
    curvature, the gap along the normal is c - R m^2/2. Gear 2 closes it by a lag 1/(1 - s) times as large,
    where s is the slope of the relief over roll length.
    """
    problem, _ = _solve(case, relief)
    pair, gear = case.pair, case.pair.wheel
    start, tip = gear.roll_length(gear.tip_radius - _RELIEF_LENGTH), gear.tip_roll_length
    roll_1, roll_2 = pair.roll_lengths(_POSITION[:, None], problem.candidates.pair)
    entering = int(np.flatnonzero((roll_2[0] > start) & (roll_2[0] < tip))[0])
    first, second = float(roll_1[0, entering]), float(roll_2[0, entering])
    height = relief * (second - start) / (tip - start)
    roll_slope = relief / (tip - start)
    slope = roll_slope * gear.base_radius / second
    radius = 1.0 / (1.0 / first + 1.0 / second)
    lag = (height - 0.5 * radius * slope**2) / (1.0 - roll_slope)
    return abs(float(problem.candidates.gap[0, entering]) / lag - 1.0)
