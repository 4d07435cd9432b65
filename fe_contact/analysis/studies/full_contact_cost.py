"""Cost of full finite-element contact for the same work: a peer on the plot of error against time.

The cost is our own measurement of the 20/20 spur pair (normal module 4 mm, face 25 mm, 10 to 400 N m) in
plane strain on one core, on meshes that resolve the contact strip. Two independent codes agree to 0.06 % on
the line of action and to 0.02 % in corner contact: CalculiX 2.20 with surface-to-surface penalty contact, and
a mortar code without penalty. Errors are against the finest level. Three dimensions would cost far more.
"""

from __future__ import annotations

from dataclasses import dataclass

from fe_contact.geometry import Gear, ParallelAxes
from fe_contact.types import Json

ORIGIN = (
    "full finite-element contact: our own measurement on the 20/20 spur pair in plane strain, one core, with "
    "two independent codes, CalculiX 2.20 and a mortar code"
)

MEASURED_GEAR = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
"""Gear of the pair whose cost was measured. Both gears are alike; their center distance is 80 mm."""


@dataclass(frozen=True)
class FullContactLevel:
    """One mesh: unknowns, CPU seconds per position and load on one core, relative error of the mean."""

    unknowns: int
    seconds_per_solve: float
    relative_error: float

    def seconds(self, solves: int) -> float:
        """Return the CPU seconds of a table of `solves` positions times loads."""
        return self.seconds_per_solve * solves

    def to_json(self, solves: int) -> Json:
        """Return the cost of a table of `solves` positions times loads as plain JSON."""
        return {
            "unknowns": self.unknowns,
            "cpu_seconds": self.seconds(solves),
            "mean_error": self.relative_error,
        }


FULL_CONTACT = (
    FullContactLevel(70_000, 12.0, 6e-4),
    FullContactLevel(147_000, 30.0, 2e-4),
    FullContactLevel(379_000, 75.0, 2e-4),
)


def known_full_contact(pair: ParallelAxes) -> tuple[FullContactLevel, ...]:
    """Return the measured costs of full contact for the measured pair; nothing for any other pair."""
    measured = MEASURED_GEAR.macro_geometry()
    gears = [gear.macro_geometry() for gear in (pair.pinion, pair.wheel)]
    plain = all(gear.modification.neutral for gear in (pair.pinion, pair.wheel))
    is_measured = gears == [measured, measured] and abs(pair.center_distance - 0.08) < 1e-9
    return FULL_CONTACT if plain and is_measured else ()
