"""What a run tells about its own model, gathered from its series block by block."""

from __future__ import annotations

from typing import Any

from dynamics.results.axis_checks import AxisChecks
from dynamics.results.contact_check import ContactChecks
from dynamics.system.assemble import System
from dynamics.types import Json


class RunChecks:
    """All checks of a run."""

    def __init__(self, system: System) -> None:
        self._contact, self._axes = ContactChecks(system), AxisChecks(system)

    def see(self, series: dict[str, Any]) -> None:
        """Take a block of series."""
        names = ("position", "dynamic_transmission_error", "mesh_force")
        self._contact.see(*(series[name] for name in names))
        self._axes.see(series)

    def found(self) -> list[Json]:
        """Return the entries of all checks."""
        return [*self._contact.found(), *self._axes.found()]
