"""Axes of a table as they are requested: its loads, misalignments and changes of the center distance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from bounds import SiNote
from fe_contact.checks import increasing, integer, positive, within
from fe_contact.errors import InputError
from fe_contact.geometry import ParallelAxes
from fe_contact.types import FloatArray

LARGEST_DEVIATION = 0.01
"""m; larger values of an axis are micrometers given as meters."""
LARGEST_PERIOD = 1_000_000
Levels = Sequence[float] | FloatArray


@dataclass(frozen=True)
class TableAxes:
    """The axes of a table of transmission error.

    Attributes
    ----------
    torques, normal_forces : sequence of float
        Torques on the driving gear in N m, or normal forces F_bn in N: exactly one, increasing, > 0.
    misalignments, center_distance_changes : sequence of float
        m, increasing. Misalignment is the growth of the gap over the common face width in the plane of
        action, zero at its middle.
    pitches : int, optional
        Base pitches that the table covers if gears have pitch deviations; default: the full period. A smaller
        number closes the table on itself: at its seam teeth are adjacent that never mesh.

    Raises
    ------
    InputError
        A value that cannot be used, by field name.
    """

    torques: Levels | None = None
    normal_forces: Levels | None = None
    misalignments: Levels = (0.0,)
    center_distance_changes: Levels = (0.0,)
    pitches: int | None = None

    def __post_init__(self) -> None:
        if (self.torques is None) == (self.normal_forces is None):
            bound = "given, or normal_forces instead"
            raise InputError("torques", self.torques, bound, "Give exactly one of the two.")
        advice = "Loads start above zero; the no-load curve is always in the table."
        positive(f"{self.loads_as}[0]", float(self._levels[0]), advice)
        for name in ("misalignments", "center_distance_changes"):
            for i, value in enumerate(increasing(name, getattr(self, name))):
                ends = -LARGEST_DEVIATION, LARGEST_DEVIATION
                within(f"{name}[{i}]", float(value), *ends, SiNote("In m: 30 um is 3e-5."))
        if self.pitches is not None:
            integer("pitches", self.pitches, 1, LARGEST_PERIOD)

    @property
    def loads_as(self) -> str:
        """Kind of the load: "torques" or "normal_forces"."""
        return "normal_forces" if self.torques is None else "torques"

    @property
    def _levels(self) -> FloatArray:
        return increasing(self.loads_as, getattr(self, self.loads_as))

    @property
    def misalignment(self) -> FloatArray:
        """Misalignments (M,), m."""
        return increasing("misalignments", self.misalignments)

    @property
    def center_distance_change(self) -> FloatArray:
        """Changes of the center distance (D,), m."""
        return increasing("center_distance_changes", self.center_distance_changes)

    def load(self, pair: ParallelAxes) -> FloatArray:
        """Return the load levels as normal forces F_bn of a pair (F,), N."""
        return self._levels if self.torques is None else pair.normal_force(self._levels)
