"""The force elements of bearings that are not linear: rolling contacts, curves of force by displacement."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dynamics.forces import RollingContact, SpringCurve
from dynamics.forces.element_laws import Law
from dynamics.forces.rolling_contact import RollingContactLaws, pack_rolling_contacts
from dynamics.forces.spring_curve import DIRECTIONS, SpringCurveLaws, pack_spring_curves
from dynamics.joints.bushing import SEAT
from dynamics.system.coupling_rows import section
from dynamics.system.elements import Element
from dynamics.system.rotor import Rotor
from dynamics.system.scene import Scene
from dynamics.types import FloatArray


@dataclass(frozen=True)
class BearingElement:
    """Where the forces of an element act.

    Attributes
    ----------
    support : int
        The bearing, among the supports.
    direction : tuple of int
        Of each row of the element: 0 to 4 for x, y, z, tilt_x, tilt_y.
    lever : float
        Row over displacement: 1, or a radius in m for a tilt.
    typical : float
        Stiffness at the typical load, N/m or N m/rad.
    """

    support: int
    direction: tuple[int, ...]
    lever: float
    typical: float

    @property
    def seat(self) -> FloatArray:
        """Typical stiffness as a matrix of the bearing, (5, 5)."""
        return np.diag([self.typical if kind in self.direction else 0.0 for kind in range(SEAT)])


def bearing_loads(scene: Scene, rotors: Sequence[Rotor], forces: FloatArray) -> dict[str, float]:
    """Return what each bushing typically carries, N: an equal share of its shaft's nominal mesh forces."""
    on_shaft = {shaft.name: 0.0 for shaft in scene.shafts}
    for mesh, force in zip(scene.meshes, forces, strict=True):
        for gear in (mesh.driver, mesh.driven):
            on_shaft[scene.gear(gear).shaft] += float(force)
    return {
        bushing.name: on_shaft[bushing.shaft] / len(rotor.supports)
        for rotor in rotors
        for bushing in rotor.bushings
    }


def nonlinear_worths(scene: Scene, loads: dict[str, float]) -> tuple[tuple[str, float], ...]:
    """Return for each law its shaft and what its tangent misses of the displacement under the load, m."""
    shaft = {bushing.name: bushing.shaft for bushing in scene.bushings}
    found = []
    for part in scene.rolling_contacts:
        load = part.typical_load(loads[part.bushing])
        found.append((shaft[part.bushing], part.displacement(load) - load / part.tangent(load)))
    for curve in scene.spring_curves:
        reach = max(abs(curve.displacement[0]), abs(curve.displacement[-1]))
        straight = np.interp(0.0, curve.displacement, curve.force) + curve.slope * np.array(
            curve.displacement
        )
        off = float(np.max(np.abs(np.array(curve.force) - straight))) / curve.slope
        found.append((shaft[curve.bushing], min(off, reach) if curve.direction[0] != "t" else 0.0))
    return tuple(found)


def bearing_places(
    scene: Scene, names: Sequence[str], loads: dict[str, float], radius: float
) -> tuple[BearingElement, ...]:
    """Return one place per rolling contact, then per curve; `names` are those of all supports."""
    place = {name: index for index, name in enumerate(names)}
    contacts = [
        BearingElement(place[part.bushing], (0, 1), 1.0, part.tangent(part.typical_load(loads[part.bushing])))
        for part in scene.rolling_contacts
    ]
    curves = []
    for curve in scene.spring_curves:
        lever = radius if curve.direction.startswith("tilt") else 1.0
        kind = DIRECTIONS.index(curve.direction)
        curves.append(BearingElement(place[curve.bushing], (kind,), lever, curve.slope))
    return (*contacts, *curves)


def bearing_elements(
    scene: Scene, rotors: Sequence[Rotor], places: Sequence[BearingElement], loads: dict[str, float]
) -> tuple[tuple[Element, ...], RollingContactLaws, SpringCurveLaws]:
    """Return the elements at `places`, and their laws."""
    found = {part.name: (i, part) for i, rotor in enumerate(rotors) for part in rotor.bushings}
    parts: list[RollingContact | SpringCurve] = [*scene.rolling_contacts, *scene.spring_curves]
    first_curve, elements = len(scene.rolling_contacts), []
    for index, (part, at) in enumerate(zip(parts, places, strict=True)):
        rotor, bushing = found[part.bushing]
        gradient = np.zeros((len(at.direction), 6 * len(rotors)))
        moves = section(rotors[rotor], rotors[rotor].shaft.origin[2] + bushing.position)
        gradient[:, 6 * rotor : 6 * rotor + 6] = at.lever * moves[list(at.direction)]
        rolling = index < first_curve
        law = Law.ROLLING_CONTACT if rolling else Law.SPRING_CURVE
        offset = np.zeros(len(at.direction))
        typical = np.full(offset.size, at.typical / at.lever**2)
        number = index if rolling else index - first_curve
        elements.append(Element(law, number, -1, gradient, offset, stiffness=typical))
    contacts = scene.rolling_contacts
    share = [_share(rotors[found[part.bushing][0]]) for part in contacts]
    lever = max((at.lever for at in places[first_curve:]), default=1.0)
    return (
        tuple(elements),
        pack_rolling_contacts(contacts, [loads[part.bushing] for part in contacts], share),
        pack_spring_curves(scene.spring_curves, lever),
    )


def _share(rotor: Rotor) -> float:
    """Mass per support, kg."""
    return rotor.inertia.mass / max(len(rotor.supports), 1)
