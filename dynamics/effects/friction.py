"""Sliding friction: the mesh force leaves the line of action, and work is lost."""

from __future__ import annotations

from dataclasses import dataclass

from dynamics.effects.effect import LoadedMesh, Verdict


@dataclass(frozen=True)
class Friction:
    """Two more local coordinates of a flank; their rates are its sliding."""

    name: str = "friction"
    cost: str = "two more rows per flank and eight numbers more per look-up"

    def called_for(self, mesh: LoadedMesh) -> Verdict:
        """Call for it where a coefficient is given."""
        axes = mesh.axes
        if axes.friction is None:
            return Verdict(False, False, "no coefficient of friction given", 0.0)
        if not axes.slides:
            return Verdict(False, False, "the table does not say where along the path the load slides", 0.0)
        return Verdict(True, True, f"a coefficient of {axes.friction:g} is given", axes.slowed)
