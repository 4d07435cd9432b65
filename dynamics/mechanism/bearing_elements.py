"""The force elements of bearings that are not linear: rolling contacts, curves of force by displacement."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dynamics.arrays.elements import Element
from dynamics.forces import RollingContact, SpringCurve
from dynamics.forces.element_laws import Law
from dynamics.forces.rolling_contact import RollingContactLaws, pack_rolling_contacts
from dynamics.forces.spring_curve import DIRECTIONS, SpringCurveLaws, pack_spring_curves
from dynamics.joints import Bushing, PlanetBearing
from dynamics.joints.seat import SEAT
from dynamics.mechanism.rotor import Rotor
from dynamics.mechanism.seat_motion import seat_axes, seat_error, seat_motion
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray


@dataclass(frozen=True)
class BearingElement:
    """The bearing and the directions in which the forces of an element act.

    Attributes
    ----------
    support : int
        The bearing, among the supports.
    way : (p, 5) array
        The element's rows per strain of the bearing x, y, z, tilt_x, tilt_y: 1 along a displacement, a radius
        in m for a tilt.
    own : (p, 5) array
        The same per strain in the bearing's own axes.
    typical : float
        Stiffness of the rows at the typical load, N/m.
    """

    support: int
    way: FloatArray
    own: FloatArray
    typical: float

    @property
    def seat(self) -> FloatArray:
        """Typical stiffness as a matrix of the bearing, (5, 5)."""
        return np.asarray(self.typical * self.way.T @ self.way)

    @property
    def tilts(self) -> bool:
        """Whether it exerts a moment."""
        return bool(np.any(self.way[:, 3:] != 0.0))


def bearing_loads(scene: Scene, rotors: Sequence[Rotor], forces: FloatArray) -> dict[str, float]:
    """Return what each bearing typically carries, N: an equal share of its shaft's nominal mesh forces."""
    on_shaft = {shaft.name: 0.0 for shaft in scene.shafts}
    for mesh, force in zip(scene.meshes, forces, strict=True):
        for gear in (mesh.driver, mesh.driven):
            on_shaft[scene.gear(gear).shaft] += float(force)
    return {
        part.name: on_shaft[part.shaft] / len(rotor.supports) for rotor in rotors for part in rotor.supports
    }


def nonlinear_influences(scene: Scene, loads: dict[str, float]) -> tuple[tuple[str, float], ...]:
    """Return for each law its shaft and what its tangent misses of the displacement under the load, m."""
    shaft = {part.name: part.shaft for part in (*scene.bushings, *scene.planet_bearings)}
    influences = []
    for part in scene.rolling_contacts:
        load = part.typical_load(loads[part.bushing])
        influences.append((shaft[part.bushing], part.displacement(load) - load / part.tangent(load)))
    for curve in scene.spring_curves:
        reach = max(abs(curve.displacement[0]), abs(curve.displacement[-1]))
        straight = np.interp(0.0, curve.displacement, curve.force) + curve.slope * np.array(
            curve.displacement
        )
        off = float(np.max(np.abs(np.array(curve.force) - straight))) / curve.slope
        influences.append((shaft[curve.bushing], min(off, reach) if curve.direction[0] != "t" else 0.0))
    return tuple(influences)


def bearing_locations(
    scene: Scene, rotors: Sequence[Rotor], names: Sequence[str], loads: dict[str, float]
) -> tuple[BearingElement, ...]:
    """Return one location per rolling contact, then per curve; `names` are those of all supports.

    A curve on a planet bearing is along its own axes, away from the carrier's and along z x (away).
    """
    radius = tilt_lever(scene)
    support_index = {name: index for index, name in enumerate(names)}
    axes = {name: seat_axes(rotors, *at) for name, at in supports_by_name(rotors).items()}
    contacts, curves = [], []
    for part in scene.rolling_contacts:
        across = np.eye(SEAT)[:2]
        typical = part.tangent(part.typical_load(loads[part.bushing]))
        contacts.append(
            BearingElement(support_index[part.bushing], across, across @ axes[part.bushing].T, typical)
        )
    for curve in scene.spring_curves:
        lever = radius if curve.direction.startswith("tilt") else 1.0
        own = lever * np.eye(SEAT)[[DIRECTIONS.index(curve.direction)]]
        way = own @ axes[curve.bushing]
        curves.append(BearingElement(support_index[curve.bushing], way, own, curve.slope / lever**2))
    return (*contacts, *curves)


def bearing_elements(
    scene: Scene, rotors: Sequence[Rotor], bearings: Sequence[BearingElement], loads: dict[str, float]
) -> tuple[tuple[Element, ...], RollingContactLaws, SpringCurveLaws]:
    """Return the elements at `bearings`, and their laws."""
    supports = supports_by_name(rotors)
    parts: list[RollingContact | SpringCurve] = [*scene.rolling_contacts, *scene.spring_curves]
    first_curve, elements = len(scene.rolling_contacts), []
    for index, (part, at) in enumerate(zip(parts, bearings, strict=True)):
        rotor, support = supports[part.bushing]
        rolling = index < first_curve
        law = Law.ROLLING_CONTACT if rolling else Law.SPRING_CURVE
        gradient = at.way @ seat_motion(rotors, rotor, support)
        offset = -at.way @ seat_error(rotors, rotor, support)
        typical = np.full(offset.size, at.typical)
        number = index if rolling else index - first_curve
        elements.append(Element(law, number, -1, gradient, offset, stiffness=typical))
    contacts = scene.rolling_contacts
    share = [_share(rotors[supports[part.bushing][0]]) for part in contacts]
    return (
        tuple(elements),
        pack_rolling_contacts(contacts, [loads[part.bushing] for part in contacts], share),
        pack_spring_curves(scene.spring_curves, tilt_lever(scene)),
    )


def tilt_lever(scene: Scene) -> float:
    """Return the radius that makes lengths of tilts, m."""
    return max((gear.base_radius for gear in scene.gears), default=1.0)


def supports_by_name(rotors: Sequence[Rotor]) -> dict[str, tuple[int, Bushing | PlanetBearing]]:
    """Return the rotor and the bearing of every name."""
    return {part.name: (index, part) for index, rotor in enumerate(rotors) for part in rotor.supports}


def _share(rotor: Rotor) -> float:
    """Mass per support, kg."""
    return rotor.inertia.mass / max(len(rotor.supports), 1)
