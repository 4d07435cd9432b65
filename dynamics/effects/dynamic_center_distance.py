"""Dynamic center distance: the table is read at the center distance that the bodies' displacements make."""

from __future__ import annotations

from dataclasses import dataclass

from dynamics.effects.effect import LoadedMesh, Verdict


@dataclass(frozen=True)
class DynamicCenterDistance:
    """One more local coordinate of the flank."""

    name: str = "dynamic_center_distance"
    cost: str = "a table look-up over one more axis, twice the numbers"

    def called_for(self, mesh: LoadedMesh) -> Verdict:
        """Call for it where the table has the axis and a shaft can move along the line of centers."""
        axes = mesh.axes
        if axes.center_distances == 1:
            return Verdict(False, False, "the table has one center distance only", 0.0)
        if reason := axes.not_read():
            return Verdict(False, False, reason, 0.0)
        if not axes.moves_apart:
            return Verdict(False, False, "no shaft can move along the line of centers", 0.0)
        return Verdict(True, True, "shafts move along the line of centers, and the table knows", axes.apart)
