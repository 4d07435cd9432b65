"""Dynamic misalignment: the table is read at the misalignment that the bodies' tilts make."""

from __future__ import annotations

from dataclasses import dataclass

from dynamics.effects.effect import LoadedMesh, Verdict


@dataclass(frozen=True)
class DynamicMisalignment:
    """One more local coordinate of the flank."""

    name: str = "dynamic_misalignment"
    cost: str = "a table look-up over one more axis, twice the numbers"

    def called_for(self, mesh: LoadedMesh) -> Verdict:
        """Call for it where the table has the axis and a shaft can tilt in the plane of action."""
        axes = mesh.axes
        if axes.misalignments == 1:
            return Verdict(False, False, "the table has one misalignment only", 0.0)
        if reason := axes.not_read():
            return Verdict(False, False, reason, 0.0)
        if not axes.tilts:
            return Verdict(False, False, "no shaft can tilt in the plane of action", 0.0)
        return Verdict(True, True, "shafts tilt in the plane of action, and the table knows", axes.misaligned)
