"""The bodies of a mechanism: rotors, each a shaft with all on it, and housings with mass by their modes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeVar, overload

import numpy as np
from scipy.linalg import eigh

from dynamics.bearings import Bushing, PlanetBearing
from dynamics.bearings.matrix import matrix_rows
from dynamics.bearings.seat import SEAT
from dynamics.identity_cache import identity_cached
from dynamics.joints import Housing
from dynamics.scene.scene import Scene, on_axis
from dynamics.shafts import ElasticShaft, Inertia, Shaft
from dynamics.shafts.shaft import nearest_on
from dynamics.types import FloatArray

# A rotor: a shaft with the gears and discs on it and the bushings under it, one body, rigid or elastic.


Support = TypeVar("Support", Bushing, PlanetBearing)
ROUNDING = 1e-9
"""Of the damping of two modes: what couples them by less is rounding."""
FREQUENCY = 2.0 * math.pi * 1000.0
"""Of the amplitudes of a resting housing, rad/s; no motion at rest depends on it."""


@dataclass(frozen=True)
class Rotor:
    """One body: six rigid freedoms, and the elastic coordinates of its shaft."""

    shaft: Shaft
    inertia: Inertia
    """Of shaft, gears and discs about their common center of mass."""
    center: FloatArray
    """That center in the fixed frame, m: the point whose displacements are the freedoms. Shape (3,)."""
    bushings: tuple[Bushing, ...]
    """Its supports on the ground, with damping filled in."""
    planet_bearings: tuple[PlanetBearing, ...]
    """Its supports on the carrier's pin, with damping filled in."""
    frame: int | None
    """Rotor of the carrier in whose rotating frame it is described."""
    carrier: int | None
    """The same for a planet: a rotor off the carrier's axis, which the carrier takes along."""
    curved: tuple[tuple[FloatArray, float], ...] = ()
    """Typical stiffness of what bearings do that is not linear, and of couplings that hold the rotor where no
    bearing does, with their levers. Tuple of ((5, 5) array, float).
    """
    elastic: ElasticShaft | None = None
    """How its shaft bends and twists; None: rigid."""

    @cached_property
    def supports(self) -> tuple[Bushing | PlanetBearing, ...]:
        """All supports."""
        return (*self.bushings, *self.planet_bearings)

    @cached_property
    def elastic_count(self) -> int:
        """Number of elastic coordinates."""
        return 0 if self.elastic is None else self.elastic.mass.size

    @property
    def rigid_kinds(self) -> tuple[str, ...]:
        """Rigid freedoms that bending needs: it is measured against them."""
        bends = self.elastic is not None and self.elastic.bends
        return ("x", "y", "tilt_x", "tilt_y") if bends else ()

    def on_shaft(self, position: float) -> float:
        """Return the position on the shaft nearest to `position`, m from its left end."""
        return nearest_on(position, self.shaft.length)

    def lever(self, support: Bushing | PlanetBearing) -> float:
        """Axial distance of `support` from the center of mass, m."""
        return float(self.shaft.origin[2] + support.position - self.center[2])

    @cached_property
    def radial_stiffness(self) -> float:
        """Sum over the supports, N/m."""
        plain = sum(support.radial_stiffness for support in self.supports)
        return plain + sum(0.5 * float(k[0, 0] + k[1, 1]) for k, _ in self._matrices)

    @cached_property
    def axial_stiffness(self) -> float:
        """Sum over the supports, N/m."""
        plain = sum(support.axial_stiffness for support in self.supports)
        return plain + sum(float(k[2, 2]) for k, _ in self._matrices)

    @cached_property
    def elastic_lever(self) -> float:
        """Axial distance from the center of mass to where a radial force does not tilt the shaft, m."""
        moment = sum(support.radial_stiffness * self.lever(support) for support in self.supports)
        for k, lever in self._matrices:
            moment += 0.5 * float((k[0, 0] + k[1, 1]) * lever + k[0, 4] - k[1, 3])
        return moment / self.radial_stiffness if self.radial_stiffness > 0.0 else 0.0

    @cached_property
    def tilt_stiffness(self) -> float:
        """Moment per tilt about the elastic center, N m/rad."""
        arms = [(b.radial_stiffness, self.lever(b) - self.elastic_lever) for b in self.supports]
        plain = sum(stiffness * arm**2 for stiffness, arm in arms)
        added = [(k, lever - self.elastic_lever) for k, lever in self._matrices]
        return plain + sum(
            0.5 * float((k[0, 0] + k[1, 1]) * a**2 + 2.0 * a * (k[0, 4] - k[1, 3]) + k[3, 3] + k[4, 4])
            for k, a in added
        )

    @cached_property
    def _matrices(self) -> list[tuple[FloatArray, float]]:
        """Stiffness on top of the isotropic one, with levers; means of x and y are used."""
        stated = [(b.added_stiffness, self.lever(b)) for b in self.supports if b.stiffness is not None]
        return [*stated, *self.curved]


def build_rotor(scene: Scene, shaft: Shaft) -> Rotor:
    """Gather what belongs to `shaft`."""
    parts = [*shaft.bodies, *((body.inertia, body.position) for body in scene.mounted(shaft.name))]
    mass = sum(part.mass for part, _ in parts)
    along = sum(part.mass * center for part, center in parts) / mass if mass > 0.0 else shaft.length / 2.0
    transverse = sum(part.transverse + part.mass * (center - along) ** 2 for part, center in parts)
    inertia = Inertia(mass, sum(part.polar for part, _ in parts), transverse)
    center = np.array(shaft.origin, dtype=float) + np.array([0.0, 0.0, along])
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
        bushings=tuple(_damped(bushing, share, tilting) for bushing in bushings),
        planet_bearings=tuple(_damped(bearing, share, tilting) for bearing in bearings),
        frame=frame,
        carrier=frame if planet else None,
    )


def _damped(support: Support, share: float, tilting: float) -> Support:
    """Fill in the damping that follows from the damping ratio; that of a matrix in proportion to it.

    `share` and `tilting` are the support's shares of mass and transverse inertia; the latter sets the time
    where the matrix holds tilt alone.
    """

    def damping(stated: float | None, stiffness: float) -> float:
        return 2.0 * support.damping_ratio * float(np.sqrt(stiffness * share)) if stated is None else stated

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


# The bodies of a scene that move: its rotors, and the housings with mass that carry them.


@dataclass(frozen=True)
class _ModalHousing:
    """M = 1, C and K over m modal amplitudes, and the motion of s seats by them.

    All modes of the matrices are kept, so that static motions are those of the matrices.
    """

    name: str
    bearings: tuple[str, ...]
    """That sit in it."""
    stiffness: FloatArray
    """Squares of the natural circular frequencies, rising, 1/s^2. Shape (m,)."""
    damping: FloatArray
    """1/s. Shape (m, m)."""
    shape: FloatArray
    """x, y, z (m), tilt_x, tilt_y (rad) of each seat per amplitude, of unit modal mass. Shape (s, 5, m)."""
    rows: FloatArray
    """The same of every row of the housing's matrices, modal coordinates among them. Shape (r, m)."""

    @property
    def kinds(self) -> tuple[str, ...]:
        """Names of the amplitudes: mode_1, ... (m kg^1/2)."""
        return tuple(f"mode_{number + 1}" for number in range(self.stiffness.size))

    @property
    def frequency(self) -> FloatArray:
        """Natural frequencies, Hz."""
        return np.asarray(np.sqrt(self.stiffness) / (2.0 * np.pi))

    def seat(self, bearing: str) -> FloatArray:
        """Return the motion of the seat of `bearing`, (5, m)."""
        return np.asarray(self.shape[self.bearings.index(bearing)])


@identity_cached
def modal_housing(housing: Housing) -> _ModalHousing:
    """Return the modes of a housing with mass.

    They are those of M x = theta K x, in which the shapes reproduce the compliance: sum theta x x^T = K^-1 to
    rounding, however stiff the highest modes are.
    """
    mass, stiffness = _symmetric(housing.mass), _symmetric(housing.stiffness)
    unit = 1.0 / np.sqrt(np.diag(stiffness))
    theta, shape = eigh(unit[:, None] * mass * unit, unit[:, None] * stiffness * unit)
    theta, shape = theta[::-1], (unit[:, None] * shape / np.sqrt(theta))[:, ::-1]
    square = 1.0 / theta
    damping = np.diag(2.0 * housing.damping_ratio * np.sqrt(square))
    if housing.damping is not None:
        damping = shape.T @ _symmetric(housing.damping) @ shape
        own = np.sqrt(np.maximum(np.diag(damping), 0.0))
        damping = np.where(np.abs(damping) > ROUNDING * np.outer(own, own), damping, 0.0)
    seats = np.zeros((SEAT * len(housing.bushings), square.size))
    seats[list(housing.columns)] = shape[list(housing.own_columns)]
    of_seats = seats.reshape(-1, SEAT, square.size)
    return _ModalHousing(housing.name, housing.bushings, square, damping, of_seats, shape)


def _symmetric(matrix: object) -> FloatArray:
    whole = np.array(matrix, dtype=float)
    return np.asarray(0.5 * (whole + whole.T))


@dataclass(frozen=True, eq=False)
class Bodies(Sequence[Rotor]):
    """A sequence of the rotors of a scene, one per shaft, with the housings whose modes are freedoms.

    `housings`: other housings have no mass: they are condensed into their bearings.
    """

    rotors: tuple[Rotor, ...]
    housings: tuple[_ModalHousing, ...] = ()

    @overload
    def __getitem__(self, index: int) -> Rotor: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Rotor, ...]: ...
    def __getitem__(self, index: int | slice) -> Rotor | tuple[Rotor, ...]:
        return self.rotors[index]

    def __len__(self) -> int:
        return len(self.rotors)

    @cached_property
    def first_of_housings(self) -> int:
        """Number of freedoms of the rotors: the amplitudes of the housings come behind them."""
        return 6 * len(self) + sum(rotor.elastic_count for rotor in self)

    @cached_property
    def freedoms(self) -> int:
        """Number of freedoms of all bodies."""
        return self.first_of_housings + sum(housing.stiffness.size for housing in self.housings)

    def housing_of(self, bearing: str) -> int | None:
        """Return the index of the housing that moves under `bearing`; None: nothing does."""
        return next((k for k, part in enumerate(self.housings) if bearing in part.bearings), None)


# Housings without mass under bearings that are not linear: their states of rest.


def under_laws(scene: Scene) -> tuple[Housing, ...]:
    """Return the housings without mass that carry bearings that are not linear."""
    lawful = {law.bushing for law in scene.bearing_laws}
    return tuple(
        part for part in scene.housings if part.mass is None and not lawful.isdisjoint(part.bushings)
    )


def resting_housings(scene: Scene) -> tuple[Housing, ...]:
    """Return the housings of `scene` for states of rest.

    A housing without mass under a bearing that is not linear gets the mass K / FREQUENCY^2: forces and
    motions at rest are those of its stiffness, whatever its mass.
    """
    without = under_laws(scene)
    return tuple(_with_mass(part) if part in without else part for part in scene.housings)


def _with_mass(housing: Housing) -> Housing:
    stiffness, damping = housing.matrices()
    return replace(
        housing,
        stiffness=matrix_rows(stiffness),
        damping=None if housing.damping is None else matrix_rows(damping),
        mass=matrix_rows(stiffness / FREQUENCY**2),
    )
