"""Moving point of application: the mesh force acts at the centroid of the load along the face."""

from __future__ import annotations

from dataclasses import dataclass

from dynamics.effects.effect import LoadedMesh, Verdict

CENTERED = 1e-9  # of the face width


@dataclass(frozen=True)
class MovingApplicationPoint:
    """A moment of the mesh force in the plane of action."""

    name: str = "moving_application_point"
    cost: str = "one more row per flank and four numbers more per look-up"

    def called_for(self, mesh: LoadedMesh) -> Verdict:
        """Call for it where the load's centroid leaves mid-face and a shaft can tilt."""
        lever, influence = mesh.axes.lever, mesh.axes.moment
        if lever is None or influence is None:
            return Verdict(False, False, "the table does not say where along the face the load acts", 0.0)
        if not mesh.axes.tilts:
            return Verdict(False, False, "no shaft can tilt in the plane of action", 0.0)
        if lever <= CENTERED:
            return Verdict(False, True, "the load stays centered on the face", 0.0)
        reason = f"the load's centroid leaves mid-face by up to {100.0 * lever:.3g} % of the face"
        return Verdict(True, True, reason, influence)
