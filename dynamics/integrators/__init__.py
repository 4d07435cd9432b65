"""Compiled time integration with error control, and the static equilibrium a run starts from."""

from dynamics.integrators.integrate import Progress, Trajectory, integrate
from dynamics.integrators.static import StaticSolution, static_equilibrium

__all__ = ["Progress", "StaticSolution", "Trajectory", "integrate", "static_equilibrium"]
