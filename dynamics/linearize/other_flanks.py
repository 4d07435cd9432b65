"""Other flanks of one mesh of an assembled scene: their excitation, and its change with their table.

The scene is assembled once. Another table moves the equilibrium, from which the rest follows; which effects
act is not decided anew.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.assembly.varied import with_flank, with_flanks
from dynamics.errors import SolveError
from dynamics.integrators.static import RestsBeside, StaticSolution, equilibrium_near
from dynamics.linearize.flank_cycles import flank_cycles, resting
from dynamics.linearize.steady_vibration import Excited, excited
from dynamics.linearize.transfer import FlankExcitation, FlankTransfer, excitation_of
from dynamics.meshes import MeshTable
from dynamics.types import IntArray


@dataclass(frozen=True)
class OtherFlanks:
    """A scene about its loaded equilibrium, and the mesh that gets other flanks."""

    at: Excited
    mesh: int
    """Index of the mesh in the scene."""
    orders: int
    harmonics: IntArray
    """Multiples of the common period's frequency. Shape (H,)."""

    @classmethod
    def of(cls, system: System, mesh: int, transfer: FlankTransfer) -> OtherFlanks:
        """Take an assembled scene about its equilibrium; raises as `excited`."""
        at = excited(system, transfer.time, transfer.orders)
        return cls(at, mesh, transfer.orders, transfer.harmonics)

    def with_table(self, table: MeshTable) -> OtherFlanks:
        """Return the scene about its equilibrium with another table of the mesh, as `with_flank` has it.

        Raises
        ------
        InputError
            As `with_flank`.
        SolveError
            There is no static equilibrium.
        """
        system = with_flank(self.at.system, self.mesh, table)
        rest = equilibrium_near(system, self.at.linear.equilibrium.displacement, self.at.time)
        if not rest.status.usable:
            raise SolveError(f"no static equilibrium: {rest.status.name.lower()}, {rest.residual:.3g} N left")
        return self._resting(system, rest)

    def _resting(self, system: System, rest: StaticSolution) -> OtherFlanks:
        linear = replace(self.at.linear, equilibrium=rest)
        at_rest = resting(system, linear, self.at.time)
        cycles = flank_cycles(system, linear, at_rest, self.orders)
        at = replace(self.at, system=system, linear=linear, at_rest=at_rest, cycles=cycles)
        return replace(self, at=at)

    @property
    def excitation(self) -> FlankExcitation:
        """Excitation by the flanks."""
        return excitation_of(self.at, self.harmonics)

    def changes(self, tables: Sequence[MeshTable]) -> list[FlankExcitation]:
        """Return the excitation with each of the `tables` less that of this scene, to first order.

        The tables differ a little from that of the scene, and have the same positions and number of levels.
        """
        reference, system = self.excitation, self.at.system
        linearized = RestsBeside.of(system, self.at.linear.equilibrium.displacement, self.at.time)
        rests = (
            self._resting(other, linearized.rest(other)) for other in with_flanks(system, self.mesh, tables)
        )
        return [_difference(other.excitation, reference) for other in rests]


def _difference(first: FlankExcitation, second: FlankExcitation) -> FlankExcitation:
    return FlankExcitation(*(np.asarray(a - b) for a, b in zip(first, second, strict=True)))
