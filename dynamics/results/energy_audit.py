"""Whether the energy audit of a run closes, and whether every loss in it only grew."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from bounds import engineering
from dynamics.results.checks import Check
from dynamics.types import FloatArray, Json

UNACCOUNTED = 0.01
"""Largest unaccounted energy over the turnover: more of it means that the steps are too long."""
FALLEN = 1e-3
"""Largest fall of a loss over the turnover. A loss that falls by more has supplied energy; a smaller fall is
the error of the quadrature over a step.
"""


@dataclass(frozen=True)
class EnergyAudit:
    """Energies in J over the whole run."""

    drive: float
    load: float
    """`drive`, `load`: Work supplied by the drive and by the load torques (negative: they resist)."""
    position: float
    """Work supplied by the change of the mesh tables with position. Their force derives from a potential
    V(x, d) in the direction of d only; the imposed motion of x supplies dV/dx.
    """
    bushings: float
    meshes: float
    """`bushings`, `meshes`: Energy dissipated in bushings and meshes, >= 0."""
    axes: float
    """Work supplied by the change of the mesh tables with misalignment and center distance, less the work of
    the moments of forces off mid-face: zero where the load's arm belongs to the same table.
    """
    friction: float
    """Energy dissipated by sliding flanks."""
    kinetic: float
    stored_bushings: float
    stored_meshes: float
    """`kinetic`, `stored_bushings`, `stored_meshes`: Energy gained from start to end: kinetic, in bushings
    and in meshes.
    """
    held: float = 0.0
    """Elastic energy of meshes and bearings in the equilibrium that the run starts from, >= 0."""
    fallen: float = 0.0
    """Largest fall of the loss in bushings, in meshes or by friction below its highest value before, >= 0:
    dissipated energy does not come back.
    """

    @property
    def residual(self) -> float:
        """The residual of the balance, J; 0 for an exact integration."""
        gained = self.kinetic + self.stored_bushings + self.stored_meshes
        lost = self.bushings + self.meshes + self.friction
        return self.drive + self.load + self.position + self.axes - lost - gained

    @property
    def turnover(self) -> float:
        """The energy turned over by vibration, J.

        It is the energy lost, supplied by the tables, or gained in springs, and the energy that springs hold
        from the start, which is the reference for a run without losses. The work of drive and load is not in
        it: that is thousands of times more, and would hide any error.
        """
        lost = self.bushings + self.meshes + abs(self.friction)
        supplied = abs(self.position) + abs(self.axes)
        return lost + supplied + abs(self.stored_bushings) + abs(self.stored_meshes) + self.held

    @property
    def relative(self) -> float:
        """Residual over the turnover."""
        return abs(self.residual) / self.turnover if self.turnover > 0.0 else 0.0

    @property
    def relative_to_throughput(self) -> float:
        """Residual over the larger of the works of drive and load."""
        through = max(abs(self.drive), abs(self.load))
        return abs(self.residual) / through if through > 0.0 else 0.0

    def to_json(self) -> Json:
        """Return all figures, the balance included."""
        derived = ("residual", "turnover", "relative", "relative_to_throughput")
        return {**asdict(self), **{name: getattr(self, name) for name in derived}}

    @classmethod
    def from_json(cls, data: Json) -> EnergyAudit:
        """Read what `to_json` wrote; a term that an older result does not know is 0."""
        return cls(**{name: data.get(name, 0.0) for name in cls.__dataclass_fields__})

    @classmethod
    def from_arrays(cls, work: FloatArray, stored: FloatArray, fallen: float = 0.0) -> EnergyAudit:
        """Return the audit of works (7,) in the order of the first seven fields, and of energies (2, 3).

        Rows of `stored`: start and end of the run; columns: kinetic energy, bushings, meshes.
        """
        gained, largest_stored = stored[1] - stored[0], np.sum(np.abs(stored[0, 1:]))
        return cls(*(float(value) for value in (*work, *gained, largest_stored, fallen)))

    def check(self) -> Check:
        """Return the check of the balance: residual over the turnover, and largest fall of a loss, J."""
        supplies = self.fallen > FALLEN * self.turnover  # a loss that supplies energy
        missing = self.relative > UNACCOUNTED
        reason = f"{engineering(100.0 * self.relative, 2)} % of {self.turnover:.3g} J is not accounted for"
        if missing:
            reason = f"{reason}: shorten the fixed step, or lower the tolerance of the step control"
        if supplies:
            reason = f"{reason}; a loss fell by {self.fallen:.3g} J, so it supplied energy"
        figures = {"unaccounted": self.relative, "fallen": self.fallen}
        holds = not (supplies or missing)
        assumption = "work is balanced and losses only grow"
        # the check is of no part of the scene: ""
        return Check("", assumption, "energy audit", holds, reason, figures, valid=holds)
