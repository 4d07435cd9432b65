"""Points of action of the laws of bearings, and the expected load and mass of every bearing.

A law of a bearing adds forces of p rows to the bearing's linear springs; a row is a direction in which such a
force acts. Strains are the five displacements x, y, z, tilt_x, tilt_y of a shaft's section against what
holds it. A support is a bearing of a rotor: a bushing, or a planet's bearing on its pin.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from dynamics.bearings import Bushing, PlanetBearing
from dynamics.bearings.bearing_law import BearingDuty
from dynamics.mechanism.rotor import Rotor
from dynamics.mechanism.supports import seat_axes
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray


@dataclass(frozen=True)
class BearingElement:
    """The bearing of a force element and the directions in which its forces act."""

    name: str
    """Name of the bearing."""
    support: int
    """Index of the bearing among the supports of all rotors."""
    directions: FloatArray
    """The rows of the element over the strains x, y, z, tilt_x, tilt_y along the axes of the scene: 1 for a
    displacement, a radius in m for a tilt. Shape (p, 5).
    """
    local_rows: FloatArray
    """The rows of the element over the strains along the bearing's own axes. Shape (p, 5)."""
    row_stiffness: FloatArray
    """Stiffness of the rows at the typical load, N/m; cross terms of a linear bearing are left out. Shape
    (p,).
    """

    @property
    def seat(self) -> FloatArray:
        """Stiffness at the typical load over the five strains, (5, 5), in N/m, N and N m."""
        return np.asarray(self.directions.T @ (self.row_stiffness[:, None] * self.directions))

    @property
    def tilts(self) -> bool:
        """Whether the element exerts a moment."""
        return bool(np.any(self.directions[:, 3:] != 0.0))

    @property
    def holds_axis(self) -> bool:
        """Whether the element exerts a force along the axis."""
        return bool(self.seat[2, 2] > 0.0)


def bearing_duties(scene: Scene, rotors: Sequence[Rotor], forces: FloatArray) -> dict[str, BearingDuty]:
    """Return the duty of every bearing under the nominal `forces` of the meshes, in N, in their order.

    The typical load of a bearing is an equal share of the sum of the mesh forces on its shaft; its mass is an
    equal share of the mass of the shaft with its gears.
    """
    lever = tilt_lever(scene)
    shaft_force = {shaft.name: 0.0 for shaft in scene.shafts}
    for mesh, force in zip(scene.meshes, forces, strict=True):
        for gear in (mesh.driver, mesh.driven):
            shaft_force[scene.gear(gear).shaft] += float(force)
    return {
        bearing.name: BearingDuty(
            load=shaft_force[bearing.shaft] / len(rotor.supports),
            mass=rotor.inertia.mass / len(rotor.supports),
            lever=lever,
        )
        for rotor in rotors
        for bearing in rotor.supports
    }


def bearing_locations(
    scene: Scene, rotors: Sequence[Rotor], names: Sequence[str], duties: Mapping[str, BearingDuty]
) -> tuple[BearingElement, ...]:
    """Return where every law of a bearing in the scene acts; `names` are the names of all supports.

    The own axes of a planet bearing are x away from the carrier's axis, y along z x (away), and z; those of a
    bushing are the axes of the scene.
    """
    support_index = {name: index for index, name in enumerate(names)}
    supports = supports_by_name(rotors)
    elements = []
    for law in scene.bearing_laws:
        duty = duties[law.bushing]
        rotor, bearing = supports[law.bushing]
        local_rows = law.rows(duty)
        element = BearingElement(
            name=law.bushing,
            support=support_index[law.bushing],
            directions=local_rows @ seat_axes(rotors, rotor, bearing),
            local_rows=local_rows,
            row_stiffness=law.row_stiffness(duty),
        )
        elements.append(element)
    return tuple(elements)


def tilt_lever(scene: Scene) -> float:
    """Return the radius in m that turns tilts into lengths: the largest base radius, 1 without gears."""
    return max((gear.base_radius for gear in scene.gears), default=1.0)


def supports_by_name(rotors: Sequence[Rotor]) -> dict[str, tuple[int, Bushing | PlanetBearing]]:
    """Return by the name of every bearing the index of its rotor, and the bearing."""
    return {
        bearing.name: (index, bearing) for index, rotor in enumerate(rotors) for bearing in rotor.supports
    }
