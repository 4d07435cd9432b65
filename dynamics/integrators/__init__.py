"""Compiled time integration with error control, and the static equilibrium a run starts from."""

from dynamics.integrators.integrate import Trajectory, integrate
from dynamics.integrators.march import Cancel, Progress
from dynamics.integrators.static import StaticSolution, static_equilibrium

__all__ = ["Cancel", "Progress", "StaticSolution", "Trajectory", "integrate", "static_equilibrium"]
