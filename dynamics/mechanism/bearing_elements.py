"""The force elements of bearings: of those that are not linear, and of linear ones in housings that move."""

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
    """The bearing and the directions in which the forces of an element act."""

    name: str
    """Of the bearing."""
    support: int
    """The bearing, among the supports."""
    way: FloatArray
    """The element's rows per strain of the bearing x, y, z, tilt_x, tilt_y: 1 along a displacement, a radius
    in m for a tilt. Shape (p, 5).
    """
    local_rows: FloatArray
    """The same per strain in the bearing's own axes. Shape (p, 5)."""
    typical: FloatArray
    """Stiffness of the rows at the typical load, N/m; of a linear bearing without cross terms. Shape (p,)."""

    @property
    def seat(self) -> FloatArray:
        """Typical stiffness as a matrix of the bearing, (5, 5)."""
        return np.asarray(self.way.T @ (self.typical[:, None] * self.way))

    @property
    def tilts(self) -> bool:
        """Whether it exerts a moment."""
        return bool(np.any(self.way[:, 3:] != 0.0))

    @property
    def holds_axis(self) -> bool:
        """Whether it exerts a force along the axis."""
        return bool(self.seat[2, 2] > 0.0)


def bearing_duties(scene: Scene, rotors: Sequence[Rotor], forces: FloatArray) -> dict[str, BearingDuty]:
    """Return the duty of every bearing under the nominal mesh `forces` (m,), N.

    It typically carries an equal share of those on its shaft.
    """
    lever, on_shaft = tilt_lever(scene), {shaft.name: 0.0 for shaft in scene.shafts}
    for mesh, force in zip(scene.meshes, forces, strict=True):
        for gear in (mesh.driver, mesh.driven):
            on_shaft[scene.gear(gear).shaft] += float(force)
    return {
        part.name: BearingDuty(
            on_shaft[part.shaft] / len(rotor.supports), rotor.inertia.mass / len(rotor.supports), lever
        )
        for rotor in rotors
        for part in rotor.supports
    }


def bearing_locations(
    scene: Scene, rotors: Sequence[Rotor], names: Sequence[str], duties: Mapping[str, BearingDuty]
) -> tuple[BearingElement, ...]:
    """Return where every law of a bearing acts; `names` are those of all supports.

    Laws of a planet bearing are along its own axes, away from the carrier's and along z x (away).
    """
    support_index = {name: index for index, name in enumerate(names)}
    axes = {name: seat_axes(rotors, *at) for name, at in supports_by_name(rotors).items()}
    locations = []
    for law in scene.bearing_laws:
        name, duty = law.bushing, duties[law.bushing]
        way = law.rows(duty)
        locations.append(BearingElement(name, support_index[name], way @ axes[name], way, law.typical(duty)))
    return tuple(locations)


def tilt_lever(scene: Scene) -> float:
    """Return the radius that makes lengths of tilts, m."""
    return max((gear.base_radius for gear in scene.gears), default=1.0)


def supports_by_name(rotors: Sequence[Rotor]) -> dict[str, tuple[int, Bushing | PlanetBearing]]:
    """Return the rotor and the bearing of every name."""
    return {part.name: (index, part) for index, rotor in enumerate(rotors) for part in rotor.supports}
