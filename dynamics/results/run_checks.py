"""What a run tells about its own model, gathered from its series block by block."""

from __future__ import annotations

from typing import Any

from dynamics.results.axis_checks import AxisChecks
from dynamics.results.bearing_load_check import BearingLoadChecks
from dynamics.results.contact_check import ContactChecks
from dynamics.results.force_check import ForceChecks
from dynamics.system.assemble import System
from dynamics.types import Json


class RunChecks:
    """All checks of a run."""

    def __init__(self, system: System) -> None:
        self._contact, self._axes = ContactChecks(system), AxisChecks(system)
        self._force, self._bearings = ForceChecks(system), BearingLoadChecks(system)

    def see(self, series: dict[str, Any]) -> None:
        """Take a block of series."""
        names = ("position", "dynamic_transmission_error", "mesh_force")
        self._contact.see(*(series[name] for name in names))
        self._axes.see(series)
        self._force.see(series["mesh_force"])
        self._bearings.see(series["bearing_force"])

    def found(self) -> list[Json]:
        """Return the entries of all checks."""
        contact, axes = self._contact.found(), self._axes.found()
        return [*contact, *axes, *self._force.found(), *self._bearings.found()]
