"""A rotor: a shaft with the gears on it and the bushings under it, as one rigid body."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.bodies import Inertia, Shaft
from dynamics.joints import Bushing
from dynamics.system.scene import Scene
from dynamics.types import FloatArray


@dataclass(frozen=True)
class Rotor:
    """One rigid body.

    Attributes
    ----------
    shaft : Shaft
    inertia : Inertia
        Of shaft and gears about their common centre of mass.
    center : (3,) array
        That centre in the fixed frame, m: the point whose displacements are the freedoms.
    bushings : tuple of Bushing
        Its supports, with damping filled in.
    """

    shaft: Shaft
    inertia: Inertia
    center: FloatArray
    bushings: tuple[Bushing, ...]

    def lever(self, bushing: Bushing) -> float:
        """Axial distance of `bushing` from the centre of mass, m."""
        return float(self.shaft.origin[2] + bushing.position - self.center[2])

    @property
    def radial_stiffness(self) -> float:
        """Sum over the bushings, N/m."""
        return sum(bushing.radial_stiffness for bushing in self.bushings)

    @property
    def axial_stiffness(self) -> float:
        """Sum over the bushings, N/m."""
        return sum(bushing.axial_stiffness for bushing in self.bushings)

    @property
    def elastic_lever(self) -> float:
        """Axial distance from the centre of mass to where a radial force does not tilt the shaft, m."""
        moment = sum(bushing.radial_stiffness * self.lever(bushing) for bushing in self.bushings)
        return moment / self.radial_stiffness if self.radial_stiffness > 0.0 else 0.0

    @property
    def tilt_stiffness(self) -> float:
        """Moment per tilt about the elastic centre, N m/rad."""
        arms = [(b.radial_stiffness, self.lever(b) - self.elastic_lever) for b in self.bushings]
        return sum(stiffness * arm**2 for stiffness, arm in arms)


def build_rotor(scene: Scene, shaft: Shaft) -> Rotor:
    """Gather what belongs to `shaft`."""
    gears = [gear for gear in scene.gears if gear.shaft == shaft.name]
    parts = [(shaft.inertia, shaft.length / 2.0), *((gear.inertia, gear.position) for gear in gears)]
    mass = sum(part.mass for part, _ in parts)
    along = sum(part.mass * place for part, place in parts) / mass if mass > 0.0 else shaft.length / 2.0
    transverse = sum(part.transverse + part.mass * (place - along) ** 2 for part, place in parts)
    inertia = Inertia(mass, sum(part.polar for part, _ in parts), transverse)
    center = np.array(shaft.origin, dtype=float) + np.array([0.0, 0.0, along])
    supports = [bushing for bushing in scene.bushings if bushing.shaft == shaft.name]
    share = mass / max(len(supports), 1)
    return Rotor(shaft, inertia, center, tuple(_damped(bushing, share) for bushing in supports))


def _damped(bushing: Bushing, share: float) -> Bushing:
    """Fill in the damping that follows from the damping ratio and the bushing's share of the mass."""

    def damping(given: float | None, stiffness: float) -> float:
        return 2.0 * bushing.damping_ratio * float(np.sqrt(stiffness * share)) if given is None else given

    return Bushing(
        bushing.name,
        bushing.shaft,
        bushing.position,
        bushing.radial_stiffness,
        bushing.axial_stiffness,
        damping(bushing.radial_damping, bushing.radial_stiffness),
        damping(bushing.axial_damping, bushing.axial_stiffness),
        bushing.damping_ratio,
    )
