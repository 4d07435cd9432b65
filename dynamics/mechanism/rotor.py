"""A rotor: a shaft with its gears, discs and bushings, one body, rigid or elastic.

A planet is a rotor whose pin a carrier takes along. A frame is the rotating frame of a carrier, in which its
planets and all shafts on it are described. Stiffness matrices k of supports have rows x, y, z, tilt_x, tilt_y
(N/m, N/rad, N m/rad); a lever is the axial distance from the rotor's center of mass, m.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeVar

import numpy as np

from dynamics.bearings import Bushing, PlanetBearing
from dynamics.bearings.matrix import matrix_rows
from dynamics.scene.scene import Scene, on_axis
from dynamics.shafts import ElasticShaft, Inertia, Shaft
from dynamics.shafts.shaft import nearest_on
from dynamics.types import FloatArray

Support = TypeVar("Support", Bushing, PlanetBearing)


@dataclass(frozen=True)
class Rotor:
    """One body: six rigid freedoms, and the elastic coordinates of its shaft."""

    shaft: Shaft
    inertia: Inertia
    """Inertia of shaft, gears and discs about their common center of mass."""
    center: FloatArray
    """Common center of mass in the fixed frame, m: the point whose displacements are the freedoms. Shape
    (3,).
    """
    bushings: tuple[Bushing, ...]
    """Supports of the rotor on the ground, with damping filled in."""
    planet_bearings: tuple[PlanetBearing, ...]
    """Supports of the rotor on the carrier's pin, with damping filled in."""
    frame: int | None
    """Rotor of the carrier in whose rotating frame this rotor is described."""
    carrier: int | None
    """Rotor of the carrier that takes this rotor along, if it is a planet: a rotor off the carrier's axis."""
    typical_stiffness: tuple[tuple[FloatArray, float], ...] = ()
    """Stiffness matrices (5, 5) with their levers, m, of nonlinear bearing laws at their typical load, and of
    couplings that hold the rotor where no bearing does.
    """
    elastic: ElasticShaft | None = None
    """Elastic bending and twist of the shaft; None: rigid."""

    @cached_property
    def supports(self) -> tuple[Bushing | PlanetBearing, ...]:
        """All supports."""
        return (*self.bushings, *self.planet_bearings)

    @cached_property
    def elastic_count(self) -> int:
        """Number of elastic coordinates."""
        return 0 if self.elastic is None else self.elastic.mass.size

    @property
    def bending_freedoms(self) -> tuple[str, ...]:
        """Rigid freedoms that bending needs, since its elastic coordinates are relative to them."""
        bends = self.elastic is not None and self.elastic.bends
        return ("x", "y", "tilt_x", "tilt_y") if bends else ()

    def on_shaft(self, position: float) -> float:
        """Return the position on the shaft nearest to `position`, m from its left end."""
        return nearest_on(position, self.shaft.length)

    def lever(self, support: Bushing | PlanetBearing) -> float:
        """Return the axial distance of `support` from the center of mass, m."""
        return float(self.shaft.origin[2] + support.position - self.center[2])

    @cached_property
    def radial_stiffness(self) -> float:
        """Radial stiffness, the sum over the supports, N/m."""
        isotropic = sum(support.radial_stiffness for support in self.supports)
        return isotropic + sum(0.5 * float(k[0, 0] + k[1, 1]) for k, _ in self._matrices)

    @cached_property
    def axial_stiffness(self) -> float:
        """Axial stiffness, the sum over the supports, N/m."""
        isotropic = sum(support.axial_stiffness for support in self.supports)
        return isotropic + sum(float(k[2, 2]) for k, _ in self._matrices)

    @cached_property
    def elastic_lever(self) -> float:
        """Axial distance from the center of mass to the elastic center, m.

        A radial force at the elastic center does not tilt the shaft.
        """
        moment = sum(support.radial_stiffness * self.lever(support) for support in self.supports)
        for k, lever in self._matrices:
            # coupling of x with tilt_y and of y with tilt_x; a positive tilt_x moves positive z towards -y
            moment += 0.5 * float((k[0, 0] + k[1, 1]) * lever + k[0, 4] - k[1, 3])
        return moment / self.radial_stiffness if self.radial_stiffness > 0.0 else 0.0

    @cached_property
    def tilt_stiffness(self) -> float:
        """Moment per tilt about the elastic center, N m/rad."""
        arms = [(b.radial_stiffness, self.lever(b) - self.elastic_lever) for b in self.supports]
        isotropic = sum(stiffness * arm**2 for stiffness, arm in arms)
        matrices = [(k, lever - self.elastic_lever) for k, lever in self._matrices]
        return isotropic + sum(
            0.5 * float((k[0, 0] + k[1, 1]) * a**2 + 2.0 * a * (k[0, 4] - k[1, 3]) + k[3, 3] + k[4, 4])
            for k, a in matrices
        )

    @cached_property
    def _matrices(self) -> list[tuple[FloatArray, float]]:
        """Stiffness matrices (5, 5) that add to the isotropic stiffness of the supports, with levers.

        Sums over the supports take the means of x and y of these matrices.
        """
        matrices = [(b.added_stiffness, self.lever(b)) for b in self.supports if b.stiffness is not None]
        return [*matrices, *self.typical_stiffness]


def build_rotor(scene: Scene, shaft: Shaft) -> Rotor:
    """Return the rotor of a shaft with its gears, discs and bearings; damping ratios become damping.

    For this damping the supports share the mass and the transverse inertia of the rotor equally.
    """
    parts = [*shaft.bodies, *((body.inertia, body.position) for body in scene.mounted(shaft.name))]
    mass = sum(part.mass for part, _ in parts)
    mean = sum(part.mass * position for part, position in parts) / mass if mass > 0.0 else shaft.length / 2.0
    transverse = sum(part.transverse + part.mass * (position - mean) ** 2 for part, position in parts)
    inertia = Inertia(mass, sum(part.polar for part, _ in parts), transverse)
    center = np.array(shaft.origin, dtype=float) + np.array([0.0, 0.0, mean])
    bushings = [bushing for bushing in scene.ground_bearings if bushing.shaft == shaft.name]
    bearings = [bearing for bearing in scene.planet_bearings if bearing.shaft == shaft.name]
    supports = max(len(bushings) + len(bearings), 1)
    share, tilting = mass / supports, transverse / supports
    frame = scene.frame_index(scene.shaft_index(shaft.name))
    planet = frame is not None and not on_axis(shaft, scene.shafts[frame])
    return Rotor(
        shaft=shaft,
        inertia=inertia,
        center=center,
        bushings=tuple(_damped_support(bushing, share, tilting) for bushing in bushings),
        planet_bearings=tuple(_damped_support(bearing, share, tilting) for bearing in bearings),
        frame=frame,
        carrier=frame if planet else None,
    )


def _damped_support(support: Support, share: float, tilting: float) -> Support:
    """Fill in the damping by the damping ratio; the damping of a matrix is proportional to the matrix.

    `share` and `tilting` are the support's shares of mass, kg, and transverse inertia, kg m^2. The largest
    stiffness of a matrix along an axis, with the mass, gives the factor from stiffness to damping; a matrix
    that holds tilt alone gives it by its largest tilt stiffness and the inertia.
    """

    def damping(specified: float | None, stiffness: float) -> float:
        if specified is not None:
            return specified
        return 2.0 * support.damping_ratio * float(np.sqrt(stiffness * share))

    support = replace(
        support,
        radial_damping=damping(support.radial_damping, support.radial_stiffness),
        axial_damping=damping(support.axial_damping, support.axial_stiffness),
    )
    if support.stiffness is None or support.damping is not None:
        return support
    matrix = support.added_stiffness
    largest, inertia = float(np.max(np.diag(matrix)[:3])), share
    if largest == 0.0:
        largest, inertia = float(np.max(np.diag(matrix)[3:])), tilting
    time = 2.0 * support.damping_ratio * float(np.sqrt(inertia / largest)) if largest > 0.0 else 0.0
    return replace(support, damping=matrix_rows(time * matrix))
