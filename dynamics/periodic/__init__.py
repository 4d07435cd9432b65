"""Periodic steady states at constant speed: shooting, Floquet stability, branches over speed."""

from dynamics.periodic.continuation import BranchStatus, follow_branch
from dynamics.periodic.period_map import PeriodicProblem, PeriodMap, periodic_problem
from dynamics.periodic.shooting import Instability, Orbit, OrbitStatus, find_orbit, settled
from dynamics.periodic.steady_states import SteadyStates, motion, spectrum, steady_states, sweep

__all__ = [
    "BranchStatus",
    "Instability",
    "Orbit",
    "OrbitStatus",
    "PeriodMap",
    "PeriodicProblem",
    "SteadyStates",
    "find_orbit",
    "follow_branch",
    "motion",
    "periodic_problem",
    "settled",
    "spectrum",
    "steady_states",
    "sweep",
]
