"""The force elements of bearings that are not linear, whatever their laws are."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from dynamics.arrays.elements import Element
from dynamics.bearings import Bushing, PlanetBearing
from dynamics.bearings.bearing_law import BearingDuty, BearingLaw
from dynamics.bearings.rolling_contact import pack_rolling_contacts
from dynamics.bearings.row_law import pack_ball_laws, pack_roller_laws
from dynamics.bearings.spring_curve import pack_spring_curves
from dynamics.kernels.law import Law
from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.rotor import Rotor
from dynamics.mechanism.seat_motion import seat_axes, seat_error, seat_motion
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray

PACKED: Mapping[Law, Callable[..., Any]] = {
    Law.ROLLING_CONTACT: pack_rolling_contacts,
    Law.SPRING_CURVE: pack_spring_curves,
    Law.BALLS: pack_ball_laws,
    Law.ROLLERS: pack_roller_laws,
}
"""Kinds of laws of bearings, and what lays out those of a kind for compiled functions."""


@dataclass(frozen=True)
class BearingElement:
    """The bearing and the directions in which the forces of an element act.

    Attributes
    ----------
    name : str
        Of the bearing.
    support : int
        The bearing, among the supports.
    way : (p, 5) array
        The element's rows per strain of the bearing x, y, z, tilt_x, tilt_y: 1 along a displacement, a radius
        in m for a tilt.
    own : (p, 5) array
        The same per strain in the bearing's own axes.
    typical : (p,) array
        Stiffness of the rows at the typical load, N/m; of a linear bearing without cross terms.
    """

    name: str
    support: int
    way: FloatArray
    own: FloatArray
    typical: FloatArray

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


def bearing_loads(scene: Scene, rotors: Sequence[Rotor], forces: FloatArray) -> dict[str, float]:
    """Return what each bearing typically carries, N: an equal share of its shaft's nominal mesh forces."""
    on_shaft = {shaft.name: 0.0 for shaft in scene.shafts}
    for mesh, force in zip(scene.meshes, forces, strict=True):
        for gear in (mesh.driver, mesh.driven):
            on_shaft[scene.gear(gear).shaft] += float(force)
    return {
        part.name: on_shaft[part.shaft] / len(rotor.supports) for rotor in rotors for part in rotor.supports
    }


def bearing_duties(
    scene: Scene, rotors: Sequence[Rotor], loads: Mapping[str, float]
) -> dict[str, BearingDuty]:
    """Return the duty of every bearing, which typically carries `loads` (N)."""
    lever = tilt_lever(scene)
    return {
        part.name: BearingDuty(loads[part.name], rotor.inertia.mass / len(rotor.supports), lever)
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
        own = law.rows(duty)
        locations.append(BearingElement(name, support_index[name], own @ axes[name], own, law.typical(duty)))
    return tuple(locations)


def bearing_elements(
    laws: Sequence[BearingLaw],
    rotors: Bodies,
    bearings: Sequence[BearingElement],
    duties: Mapping[str, BearingDuty],
    phases: Mapping[str, int],
) -> tuple[tuple[Element, ...], dict[str, Any]]:
    """Return the elements of `laws` at `bearings`, and their laws by the fields of `ElementLaws`.

    `phases` are the positions that the cages of some bearings are among.
    """
    supports, elements = supports_by_name(rotors), []
    entries: dict[Law, list[Any]] = {law: [] for law in PACKED}
    for part, at in zip(laws, bearings, strict=True):
        rotor, support = supports[at.name]
        gradient = at.way @ seat_motion(rotors, rotor, support)
        offset = -at.way @ seat_error(rotors, rotor, support)
        number = len(entries[part.law])
        elements.append(
            Element(part.law, number, phases.get(at.name, -1), gradient, offset, stiffness=at.typical)
        )
        entries[part.law].append((part, duties[at.name]))
    return tuple(elements), {law.name.lower(): PACKED[law](own) for law, own in entries.items()}


def tilt_lever(scene: Scene) -> float:
    """Return the radius that makes lengths of tilts, m."""
    return max((gear.base_radius for gear in scene.gears), default=1.0)


def supports_by_name(rotors: Sequence[Rotor]) -> dict[str, tuple[int, Bushing | PlanetBearing]]:
    """Return the rotor and the bearing of every name."""
    return {part.name: (index, part) for index, rotor in enumerate(rotors) for part in rotor.supports}
