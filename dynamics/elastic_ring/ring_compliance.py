"""Static deflection of an elastic ring on its support under forces on its teeth.

The response of the ring to a force is a Fourier series over the angle, whose terms fall with the square of
the harmonic: the terms beyond `HARMONICS` are summed in closed form by their two leading powers. Lugs are
springs to which the ring gives way; the motions that the ring makes as a rigid body are unknowns where
spline or press fit leave them free.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dynamics.elastic_ring.annulus import Annulus
from dynamics.elastic_ring.ring_support import RingSupport
from dynamics.errors import InputError
from dynamics.types import FloatArray

HARMONICS = 512
"""Harmonics that are summed one by one."""
_RIGID = 1e-9
"""Least stiffness of a motion over the largest of its harmonic that is not a rigid body's."""
_HELD = 1e-12
"""Least stiffness of the support against a motion as a rigid body, over the largest."""


@dataclass(frozen=True)
class Port:
    """Points of a ring at one radius, each with a force or a displacement in one direction."""

    angle: FloatArray
    """Angles, (n,), rad."""
    radius: float
    """Radius, m."""
    radial: float
    """Component of the direction outwards."""
    tangential: float
    """Component of the direction along increasing angles."""

    def at(self, angle: FloatArray) -> Port:
        """Return the same directions at other angles."""
        return Port(np.asarray(angle), self.radius, self.radial, self.tangential)


@dataclass(frozen=True)
class RingSeries:
    """The response of a ring on spline or press fit, by harmonics, and the springs of its lugs."""

    ring: Annulus
    support: RingSupport

    @cached_property
    def springs(self) -> tuple[tuple[Port, float], ...]:
        """The lugs in each direction that is not free, and their stiffness."""
        if not self.support.lugs:
            return ()
        radius, angles = self.ring.outer_radius, self.support.angles
        both = (
            (Port(angles, radius, 1.0, 0.0), self.support.lug_radial),
            (Port(angles, radius, 0.0, 1.0), self.support.lug_tangential),
        )
        return tuple((port, stiffness) for port, stiffness in both if stiffness > 0.0)

    @cached_property
    def _inverses(self) -> FloatArray:
        """Inverse stiffness of the harmonics 0, 1, ..., (HARMONICS + 1, 3, 3), rigid motions left out."""
        around = self.support.distributed(self.ring)
        stiffness = np.array([self.ring.stiffness(n) + around for n in range(HARMONICS + 1)])
        perhaps_rigid = np.linalg.pinv(stiffness[:2], rcond=_RIGID, hermitian=True)
        return np.concatenate([perhaps_rigid, np.linalg.inv(stiffness[2:])])

    def _terms(self, moved: Port, loaded: Port) -> np.ndarray:
        """Return the terms of the series between two directions, (HARMONICS + 1,), complex, m/N."""
        seen = self.ring.motion(moved.radius, moved.radial, moved.tangential)
        pushed = self.ring.motion(loaded.radius, loaded.radial, loaded.tangential).conj()
        return np.asarray(np.einsum("i,nij,j->n", seen, self._inverses, pushed) / (2.0 * np.pi))

    def green(self, moved: Port, loaded: Port, *, beyond: int = -1) -> FloatArray:
        """Return displacements of one port under unit forces at another, without lugs, (n, m), m/N.

        `beyond`: the harmonics up to this one are left out; at most HARMONICS / 2.
        """
        terms = self._terms(moved, loaded)
        terms[: beyond + 1] = 0.0
        return _summed(terms, moved.angle[:, None] - loaded.angle[None, :])


@dataclass(frozen=True)
class RingHeldAllAround(RingSeries):
    """A ring whose outer surface does not move, as in a table of the mesh: its sections turn alone."""

    @cached_property
    def _inverses(self) -> FloatArray:
        """Inverse stiffness of the harmonics, (HARMONICS + 1, 3, 3), with the one motion that is free."""
        ring = self.ring
        turning = np.array([0.0, (ring.mean_radius - ring.outer_radius) / ring.mean_radius, 1.0])
        stiffness = [turning @ ring.stiffness(n) @ turning for n in range(HARMONICS + 1)]
        return np.asarray(np.outer(turning, turning) / np.array(stiffness)[:, None, None], dtype=float)


@dataclass(frozen=True)
class HeldRing(RingSeries):
    """An elastic ring on its support. Raises `InputError`: the support leaves it free to move."""

    def __post_init__(self) -> None:
        if self._rigid_motions and not self._is_held():
            raise InputError(
                "support",
                "free",
                "a support that holds the ring against rotation and displacement",
                "State tangential stiffnesses of lugs or of the fit; radial ones alone let it rotate.",
            )

    def _is_held(self) -> bool:
        rows = [
            np.sqrt(stiffness) * self._moved(port, self._rigid_motions) for port, stiffness in self.springs
        ]
        if not rows:
            return False
        motion = np.concatenate(rows)
        least, *_, largest = np.linalg.eigvalsh(np.atleast_2d(motion.T @ motion)).repeat(2)
        return bool(least > _HELD * largest)

    def added_compliance(self, mesh: Port) -> FloatArray:
        """Return the compliance less that of the same ring held all around, (n, n), m/N.

        A table of the mesh has the latter, so that the sum counts nothing twice.
        """
        held = RingHeldAllAround(self.ring, self.support)
        return self.compliance(mesh) - held.green(mesh, mesh)

    def compliance(self, mesh: Port) -> FloatArray:
        """Return the displacements under unit forces, both at the points of a port, (n, n), m/N."""
        between = self.green(mesh, mesh)
        if not self._unknowns:
            return between
        unknowns = self._solved(mesh)
        unknowns[self._lug_springs :] *= self._give
        return between + self._coupled(mesh) @ unknowns

    def reactions(self, mesh: Port) -> FloatArray:
        """Return the forces of the lugs on the ring under unit forces at the points of a port.

        Returns
        -------
        ndarray (springs, n), N/N
            Radial forces of all lugs, then tangential ones, of directions that are not free.
        """
        return self._solved(mesh)[: self._lug_springs]

    def remainder(self, mesh: Port) -> float:
        """Return how far the compliance at a point moves with twice the harmonics, over its size."""
        kind, point = self._terms(mesh, mesh), np.zeros(1)
        coarse, fine = (_summed(kind[: count + 1], point)[0] for count in (HARMONICS // 2, HARMONICS))
        return float(abs(coarse - fine) / abs(fine))

    @property
    def _lug_springs(self) -> int:
        return self.support.lugs * len(self.springs)

    @property
    def _unknowns(self) -> int:
        return self._lug_springs + sum(2 if harmonic else 1 for harmonic, _ in self._rigid_motions)

    @cached_property
    def _rigid_motions(self) -> tuple[tuple[int, FloatArray], ...]:
        """Harmonic and amplitudes of the motions that spline or press fit leave free."""
        around, found = self.support.distributed(self.ring), []
        for harmonic in (0, 1):
            stiffness, shapes = np.linalg.eigh(self.ring.stiffness(harmonic) + around)
            free = stiffness <= _RIGID * stiffness[-1]
            found += [(harmonic, shapes[:, column]) for column in np.flatnonzero(free)]
        return tuple(found)

    def _moved(self, port: Port, rigid: tuple[tuple[int, FloatArray], ...]) -> FloatArray:
        """Return the displacements of the points of a port under rigid motions, (n, motions)."""
        motion, columns = self.ring.motion(port.radius, port.radial, port.tangential), []
        for harmonic, shape in rigid:
            wave = (motion @ shape) * np.exp(1j * harmonic * port.angle)
            columns += [wave.real, wave.imag] if harmonic else [wave.imag]
        return np.stack(columns, axis=1) if columns else np.zeros((port.angle.size, 0))

    def _coupled(self, mesh: Port) -> FloatArray:
        """Return the displacements of a port under the unknowns, (n, unknowns)."""
        lugs = [self.green(mesh, port) for port, _ in self.springs]
        return np.concatenate([*lugs, self._moved(mesh, self._rigid_motions)], axis=1)

    def _solved(self, mesh: Port) -> FloatArray:
        """Return forces of the lugs, and rigid motions over `_give`, under unit forces, (unknowns, n)."""
        known = -self._coupled(mesh).T
        known[: self._lug_springs] /= self._give
        return np.asarray(np.linalg.solve(self._matrix, known), dtype=float)

    @cached_property
    def _give(self) -> float:
        """Mean compliance of the lugs, m/N, by which ways are divided: soft lugs cost no digits then."""
        return float(np.mean([1.0 / stiffness for _, stiffness in self.springs])) if self.springs else 1.0

    @cached_property
    def _matrix(self) -> FloatArray:
        """Matrix of the unknowns: lugs give way as much as the ring moves, and hold it in equilibrium."""
        count, lugs = self._unknowns, self._lug_springs
        matrix = np.zeros((count, count))
        if not lugs:
            return matrix
        moved = np.concatenate([self._coupled(port) for port, _ in self.springs])
        give = np.repeat([1.0 / stiffness for _, stiffness in self.springs], self.support.lugs)
        matrix[:lugs, :lugs] = (moved[:, :lugs] + np.diag(give)) / self._give
        matrix[:lugs, lugs:] = moved[:, lugs:]
        matrix[lugs:, :lugs] = moved[:, lugs:].T
        return matrix


def _summed(terms: np.ndarray, angle: FloatArray) -> FloatArray:
    """Return the sum of a series over positive and negative harmonics at angles, its tail in closed form.

    Real parts fall as ``a / n^2 + b / n^4``, imaginary ones as ``c / n^3 + d / n^5``.
    """
    last = terms.size - 1
    n = np.arange(1, last + 1)
    places = np.array([last // 2, last])
    even = _leading(places, terms[places].real, 2)
    odd = _leading(places, terms[places].imag, 3)
    real = terms[1:].real - even[0] / n**2.0 - even[1] / n**4.0
    imaginary = terms[1:].imag - odd[0] / n**3.0 - odd[1] / n**5.0
    x = np.mod(angle, 2.0 * np.pi)
    phase = x[..., None] * n
    series = terms[0].real + 2.0 * (np.cos(phase) @ real - np.sin(phase) @ imaginary)
    pi = np.pi
    squares = pi**2 / 6.0 - pi * x / 2.0 + x**2 / 4.0
    fourths = pi**4 / 90.0 - pi**2 * x**2 / 12.0 + pi * x**3 / 12.0 - x**4 / 48.0
    cubes = pi**2 * x / 6.0 - pi * x**2 / 4.0 + x**3 / 12.0
    fifths = pi**4 * x / 90.0 - pi**2 * x**3 / 36.0 + pi * x**4 / 48.0 - x**5 / 240.0
    tail = even[0] * squares + even[1] * fourths - odd[0] * cubes - odd[1] * fifths
    return np.asarray(series + 2.0 * tail)


def _leading(places: np.ndarray, terms: np.ndarray, power: int) -> FloatArray:
    """Return the factors of two powers, `power` and `power + 2`, that pass through two terms."""
    n = places.astype(float)
    return np.linalg.solve(np.stack([n ** -float(power), n ** -float(power + 2)], axis=1), terms)
