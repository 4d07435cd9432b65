"""Periodic steady states at constant speed: shooting, Floquet stability, branches over speed."""

from dynamics.periodic.continuation import Bifurcation, Branch, BranchStatus, follow_branch
from dynamics.periodic.floquet import Instability, floquet_multipliers
from dynamics.periodic.motion import PeriodicMotion, motion, spectrum
from dynamics.periodic.period_map import PeriodicProblem, PeriodMap, periodic_problem
from dynamics.periodic.shooting import Orbit, OrbitStatus, find_orbit
from dynamics.periodic.steady_states import SteadyStates, settled, steady_states, sweep

__all__ = [
    "Bifurcation",
    "Branch",
    "BranchStatus",
    "Instability",
    "Orbit",
    "OrbitStatus",
    "PeriodMap",
    "PeriodicMotion",
    "PeriodicProblem",
    "SteadyStates",
    "find_orbit",
    "floquet_multipliers",
    "follow_branch",
    "motion",
    "periodic_problem",
    "settled",
    "spectrum",
    "steady_states",
    "sweep",
]
