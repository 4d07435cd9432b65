"""Checks of a run on its own model, gathered from its series block by block."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

from dynamics.assembly.assemble import System
from dynamics.motion.sampled_states import States
from dynamics.results.axis_checks import AxisChecks
from dynamics.results.bearing_load_check import BearingLoadChecks
from dynamics.results.contact_check import ContactChecks
from dynamics.results.force_check import ForceChecks
from dynamics.results.held_operating_point_check import HeldOperatingPointChecks
from dynamics.types import Json


class SeriesCheck(Protocol):
    """A check of series."""

    def see(self, series: dict[str, Any]) -> None:
        """Take a block of series."""

    def found(self) -> list[Json]:
        """Return its entries."""


class RunChecks:
    """All checks of a run; `further` ones look at its series too."""

    def __init__(self, system: System, further: Sequence[SeriesCheck] = ()) -> None:
        self._further, self._operating_points = tuple(further), HeldOperatingPointChecks(system)
        self._contact, self._axes = ContactChecks(system), AxisChecks(system)
        self._force, self._bearings = ForceChecks(system), BearingLoadChecks(system)

    def see(self, series: dict[str, Any], states: States) -> None:
        """Take a block of unfiltered series, and the states they are of."""
        self._operating_points.see(states.q)
        for check in self._further:
            check.see(series)
        names = ("position", "dynamic_transmission_error", "mesh_force", "least_mesh_force")
        self._contact.see(*(series[name] for name in names))
        self._axes.see(series)
        self._force.see(series["largest_mesh_force"], series["coast_force"])
        self._bearings.see(series["bearing_force"])

    def found(self) -> list[Json]:
        """Return the entries of all checks."""
        contact, axes = self._contact.found(), self._axes.found()
        further = [entry for check in self._further for entry in check.found()]
        rest = (*self._force.found(), *self._bearings.found(), *self._operating_points.found(), *further)
        return [*contact, *axes, *rest]
