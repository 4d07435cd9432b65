"""Elastic coordinates of a shaft with gears on it, beside its rigid motion: bending, torsion, stretching."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from dynamics.checks import positive
from dynamics.errors import InputError
from dynamics.shafts.beam_section import BeamSection
from dynamics.shafts.bodies import Inertia
from dynamics.shafts.timoshenko_beam import PER_NODE, TimoshenkoBeam, timoshenko_beam
from dynamics.types import BoolArray, FloatArray, IntArray

# Reduction of an elastic body to its interface and a few modes: Craig and Bampton.

CUT_OFFS = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0)
"""Up to which multiple of the frequency of interest modes with the interface held may be kept."""
TRUNCATION = 0.01
"""Relative error of the frequencies of interest at which enough of them are kept."""
MESH_ERROR = 1e-3
"""Estimated relative error of the frequencies of interest at which beam elements are short enough."""
FIRST_PARTS, LAST_PARTS = 8, 256  # elements per length of the shaft: where refining starts and ends
ACROSS, ALONG, TURN = (0, 4), 2, 5  # freedoms of a node: bending in the plane x z, extension, torsion


@dataclass(frozen=True)
class _ReducedBody:
    """Interface freedoms first, then amplitudes of b modes of unit modal mass with the interface held.

    `motion` (n, a + b) is that of the body's freedoms per reduced one; `frequency` (b,) is in Hz.
    """

    motion: FloatArray
    mass: FloatArray
    stiffness: FloatArray
    frequency: FloatArray


def craig_bampton(
    mass: FloatArray, stiffness: FloatArray, interface: IntArray, highest: float
) -> _ReducedBody:
    """Reduce a body (Craig and Bampton, AIAA Journal 6 (1968) 1313-1319).

    The motion inside is what the interface imposes statically plus the modes with the interface held, up to a
    frequency. Static motion under forces on the interface is exact, and so are rigid motions; natural
    frequencies are bounded from below by the exact ones and fall to them as modes are added. Raises
    `InputError`: the interface repeats freedoms or does not hold the body, or `highest` is not above zero.

    Parameters
    ----------
    mass, stiffness : (n, n) arrays
        Symmetric.
    interface : (a,) int array
        Freedoms where forces act; without repeats, enough to hold the body.
    highest : float
        Hz; modes up to it are kept.
    """
    from scipy.linalg import eigh  # noqa: PLC0415 (start-up time)

    held = np.asarray(interface, dtype=np.int64)
    if np.unique(held).size != held.size:
        raise InputError("interface", held.tolist(), "without repeats")
    limit = math.inf if highest == math.inf else positive("highest", highest)
    inside = np.setdiff1d(np.arange(mass.shape[0]), held)
    own, at = np.ix_(inside, inside), np.ix_(inside, held)
    try:
        square, shape = eigh(stiffness[own], mass[own]) if inside.size else (np.zeros(0), np.zeros((0, 0)))
    except np.linalg.LinAlgError as error:
        raise InputError("mass", "singular", "positive definite inside the interface") from error
    if square.size and square[0] <= 1e-12 * square[-1]:
        suggestion = "Add freedoms: inside, nothing may move as a rigid body."
        raise InputError("interface", held.tolist(), "one that holds the body", suggestion)
    frequency = np.sqrt(square) / (2.0 * math.pi)
    kept = frequency <= limit
    motion = np.zeros((mass.shape[0], held.size + int(np.count_nonzero(kept))))
    motion[held, np.arange(held.size)] = 1.0
    if inside.size:
        motion[inside, : held.size] = -shape @ ((shape.T @ stiffness[at]) / square[:, None])
        motion[inside, held.size :] = shape[:, kept]
    return _ReducedBody(motion, motion.T @ mass @ motion, motion.T @ stiffness @ motion, frequency[kept])


@dataclass(frozen=True)
class _ElasticModes:
    """Coordinates e_j of b uncoupled elastic motions: m_j e_j'' + k_j e_j = work of forces on shapes."""

    shape: FloatArray
    """Freedoms of the family per coordinate; the largest displacement (rotation) is 1. Shape (n, b)."""
    mass: FloatArray
    stiffness: FloatArray
    """`mass`, `stiffness`: Modal: kg and N/m, of torsion kg m^2 and N m/rad. Shape (b,) each."""
    inertial: FloatArray
    """Coupling in the mass matrix with the k rigid motions: zero unless the rigid motion is that of a held
    freedom. Shape (b, k).
    """
    fixed: int
    """Number of modes with the interface held among what they are made of."""
    limit: float
    """The frequency up to which these were kept, Hz."""
    truncation: float
    """Estimate of the largest relative error of frequencies up to the one of interest: that of the free body
    against the whole beam. Attached to others it may have somewhat more.
    """

    @property
    def frequency(self) -> FloatArray:
        """Of the free body, or of that with its held freedom at rest, Hz."""
        return _hertz(self.stiffness / self.mass)


@dataclass(frozen=True)
class _Family:
    """Matrices (n, n) of a family, its k motions without strain (n, k), and what is held (-1: nothing)."""

    mass: FloatArray
    stiffness: FloatArray
    rigid: FloatArray
    held: int = -1


def _elastic_modes(family: _Family, acting: Sequence[int], highest: float) -> _ElasticModes:
    """Reduce a family and split it into its rigid motions and elastic coordinates; none where nothing acts.

    A Craig-Bampton reduction to the freedoms on which forces are `acting`, diagonalized: its motions that are
    orthogonal in mass to the rigid ones, so that rigid motions stay those of the center of mass. With a
    freedom held, whose motion is imposed, the motions that leave it at rest. `highest` is the frequency of
    interest, Hz.
    """
    mass, stiffness, rigid, held = family.mass, family.stiffness, family.rigid, family.held
    interface = np.array(sorted(set(acting)), dtype=np.int64)
    if interface.size == 0:
        n, k = rigid.shape
        return _ElasticModes(np.zeros((n, 0)), np.zeros(0), np.zeros(0), np.zeros((0, k)), 0, highest, 0.0)
    whole = _free_frequencies(family)
    for cut_off in CUT_OFFS:
        reduced = craig_bampton(mass, stiffness, interface, cut_off * highest)
        none = np.zeros((reduced.frequency.size, rigid.shape[1]))  # rigid motions are of the interface alone
        moved, at = np.concatenate([rigid[interface], none]), np.flatnonzero(interface == held)
        square, vectors = _split(reduced.mass, reduced.stiffness, moved, int(at[0]) if held >= 0 else -1)
        truncation = _worst_error(_hertz(square), whole, highest)
        if truncation <= TRUNCATION:
            break
    shape = reduced.motion @ vectors
    shape = shape / np.take_along_axis(shape, np.argmax(np.abs(shape), axis=0)[None], axis=0)[0]
    modal = np.einsum("ij,ik,kj->j", shape, mass, shape)
    return _ElasticModes(
        shape,
        modal,
        modal * square,
        shape.T @ mass @ rigid if held >= 0 else np.zeros((square.size, rigid.shape[1])),
        reduced.frequency.size,
        cut_off * highest,
        truncation,
    )


def _free_frequencies(family: _Family) -> FloatArray:
    """Return the elastic natural frequencies of a whole family, Hz."""
    from scipy.linalg import eigh  # noqa: PLC0415 (start-up time)

    mass, held = family.mass, family.held
    kept = np.delete(np.arange(mass.shape[0]), held) if held >= 0 else np.arange(mass.shape[0])
    own = np.ix_(kept, kept)
    square = eigh(family.stiffness[own], mass[own], eigvals_only=True)
    return _hertz(square if held >= 0 else square[family.rigid.shape[1] :])


def _worst_error(coarse: FloatArray, exact: FloatArray, highest: float) -> float:
    """Return the largest relative error of the rising frequencies `coarse` up to `highest`.

    The next one counts too, by the square of how far it is above: errors rise at least so with frequency,
    and on its bearings a shaft has other frequencies than free.
    """
    count = min(int(np.searchsorted(exact, highest, side="right")) + 1, coarse.size)
    if count == 0:
        return 0.0
    error = np.abs(coarse[:count] / exact[:count] - 1.0)
    return float(np.max(error * np.minimum(highest / exact[:count], 1.0) ** 2))


def _split(
    mass: FloatArray, stiffness: FloatArray, rigid: FloatArray, held: int
) -> tuple[FloatArray, FloatArray]:
    """Squared circular frequencies and shapes of unit modal mass of the elastic motions."""
    from scipy.linalg import eigh, null_space  # noqa: PLC0415 (start-up time)

    basis = np.delete(np.eye(mass.shape[0]), held, axis=1) if held >= 0 else null_space(rigid.T @ mass)
    if basis.shape[1] == 0:
        return np.zeros(0), basis
    square, vectors = eigh(basis.T @ stiffness @ basis, basis.T @ mass @ basis)
    return square, np.asarray(basis @ vectors)


def _hertz(square: FloatArray) -> FloatArray:
    return np.asarray(np.sqrt(square) / (2.0 * math.pi))


# The beam of a shaft with gears on it, fine enough, apart into bending, extension and torsion.


@dataclass(frozen=True)
class Disc:
    """A rigid body on a shaft: a gear. `position` of its center along the shaft, m."""

    position: float
    inertia: Inertia


@dataclass(frozen=True)
class PointOfApplication:
    """A point of application of forces on a shaft, and the motions of its section there."""

    position: float
    """m from the left end."""
    across: bool = False
    tilt: bool = False
    along: bool = False
    turn: bool = False
    """`across`, `tilt`, `along`, `turn`: Forces across the axis, moments across it, force along it, torque.
    """


def _families(
    beam: TimoshenkoBeam, discs: Sequence[Disc], held: float | None
) -> tuple[_Family, _Family, _Family]:
    """Return bending in x z, extension and torsion with the discs' inertia."""
    mass, nodes = beam.mass.copy(), beam.position.size
    for disc in discs:
        i = disc.inertia
        columns = beam.freedoms(disc.position)
        mass[columns, columns] += (i.mass, i.mass, i.mass, i.transverse, i.transverse, i.polar)
    first = PER_NODE * np.arange(nodes)
    bent = (first[:, None] + np.array(ACROSS)).ravel()
    ones = np.ones((nodes, 1))
    tilted = np.stack([beam.position - beam.position.mean(), np.ones(nodes)], axis=1).ravel()
    moved = np.stack([np.ones(nodes), np.zeros(nodes)], axis=1).ravel()
    turned = -1 if held is None else int(np.argmin(np.abs(beam.position - held)))

    def part(columns: IntArray, rigid: FloatArray, at: int = -1) -> _Family:
        own = np.ix_(columns, columns)
        return _Family(mass[own], beam.stiffness[own], rigid, at)

    return (
        part(bent, np.stack([moved, tilted], axis=1)),
        part(first + ALONG, ones),
        part(first + TURN, ones, turned),
    )


def _fine_beam(
    sections: Sequence[BeamSection],
    discs: Sequence[Disc],
    points: Sequence[PointOfApplication],
    highest: float,
    held: float | None,
) -> tuple[TimoshenkoBeam, float]:
    """Return a beam and the estimated error of its frequencies; errors fall with the length squared."""
    stations = [*(disc.position for disc in discs), *(point.position for point in points)]
    length, parts = sum(section.length for section in sections), FIRST_PARTS
    beam = timoshenko_beam(sections, stations, length / parts)
    coarse = _frequencies(beam, discs, held)
    while True:
        finer = timoshenko_beam(sections, stations, 0.5 * float(np.max(np.diff(beam.position))))
        exact = _frequencies(finer, discs, held)
        error = 4.0 / 3.0 * max(_worst_error(a, b, highest) for a, b in zip(coarse, exact, strict=True))
        parts *= 2
        if error <= MESH_ERROR or parts > LAST_PARTS:
            return beam, error
        beam, coarse = finer, exact


def _frequencies(beam: TimoshenkoBeam, discs: Sequence[Disc], held: float | None) -> list[FloatArray]:
    return [_free_frequencies(part) for part in _families(beam, discs, held)]


@dataclass(frozen=True)
class ElasticShaft:
    """Elastic coordinates of a shaft: bending in x z, bending alike in y z, extension, torsion.

    They are measured against the motion of the shaft as a rigid body about its center of mass with which they
    share no kinetic energy; torsion against the rotation at `held` where that is imposed.
    """

    position: FloatArray
    """Nodes along the shaft, m. Shape (N,)."""
    bending: _ElasticModes
    extension: _ElasticModes
    torsion: _ElasticModes
    """`bending`, `extension`, `torsion`: Shapes (2 N, b): displacement and slope du_x/dz of each node, (N, s)
    and (N, t).
    """
    polar: FloatArray
    """Moments of inertia about the axis as the nodes' rotations have them, kg m^2. Shape (N, N)."""
    highest: float
    """Frequency of interest, Hz."""
    damping_ratio: float
    """Of every elastic coordinate."""
    mesh_error: float
    """Estimated relative error of the frequencies of interest by the lengths of the elements."""

    @property
    def kinds(self) -> tuple[str, ...]:
        """Names: bending_x_1, ..., bending_y_1, ..., stretch_1, ... (m), twist_1, ... (rad)."""
        across = [("bending_x", self.bending), ("bending_y", self.bending)]
        families = [*across, ("stretch", self.extension), ("twist", self.torsion)]
        return tuple(f"{name}_{j + 1}" for name, modes in families for j in range(modes.mass.size))

    @cached_property
    def mass(self) -> FloatArray:
        """Modal mass per coordinate, kg or kg m^2."""
        return self._each("mass")

    @cached_property
    def stiffness(self) -> FloatArray:
        """Modal stiffness per coordinate, N/m or N m/rad."""
        return self._each("stiffness")

    @property
    def damping(self) -> FloatArray:
        """Modal damping per coordinate, N s/m or N m s/rad."""
        return np.asarray(2.0 * self.damping_ratio * np.sqrt(self.mass * self.stiffness))

    @property
    def twists(self) -> BoolArray:
        """Whether each coordinate is one of torsion, (m,)."""
        return np.array([kind.startswith("twist") for kind in self.kinds], dtype=bool)

    @property
    def turned(self) -> FloatArray:
        """Coupling of each coordinate in the mass matrix with the rotation of the shaft, kg m^2."""
        coupling = np.zeros(self.mass.size)
        coupling[self.twists] = self.torsion.inertial[:, 0]
        return coupling

    @property
    def bends(self) -> bool:
        """Whether it bends."""
        return self.bending.mass.size > 0

    @property
    def truncation(self) -> float:
        """Largest relative error of the frequencies of interest by the reduction."""
        return max(part.truncation for part in (self.bending, self.extension, self.torsion))

    def motion(self, position: float) -> FloatArray:
        """Return x, y, z, tilt_x, tilt_y, rotation of the section at a node per coordinate, (6, m)."""
        k = int(np.argmin(np.abs(self.position - position)))
        u, slope = self.bending.shape[2 * k], self.bending.shape[2 * k + 1]
        b, s = u.size, self.extension.mass.size
        rows = np.zeros((PER_NODE, self.mass.size))
        rows[0, :b], rows[4, :b] = u, slope
        rows[1, b : 2 * b], rows[3, b : 2 * b] = u, -slope
        rows[2, 2 * b : 2 * b + s] = self.extension.shape[k]
        rows[5, 2 * b + s :] = self.torsion.shape[k]
        return rows

    def _each(self, name: str) -> FloatArray:
        parts = (self.bending, self.bending, self.extension, self.torsion)
        return np.concatenate([np.asarray(getattr(part, name), dtype=float) for part in parts])


@lru_cache(maxsize=64)
def elastic_shaft(
    sections: tuple[BeamSection, ...],
    discs: tuple[Disc, ...],
    points: tuple[PointOfApplication, ...],
    highest: float,
    damping_ratio: float,
    held: float | None = None,
) -> ElasticShaft:
    """Return the elastic coordinates of a shaft of `sections` with `discs` on it, held by nothing.

    Timoshenko beam elements between sections, discs and `points`, halved until the frequencies of interest
    are within 0.1 %; reduced after Craig and Bampton to what `points` act on and to as many modes with these
    held as keep the frequencies of interest within 1 %. Deflections under forces at these points are exact.

    Parameters
    ----------
    sections : tuple of BeamSection
        From the left end.
    highest : float
        Hz; modes of the free shaft up to it, and the first of each family anyway, are of interest.
    held : float or None
        Where along the shaft its rotation is imposed, m: one of the points of application.
    """
    beam, error = _fine_beam(sections, discs, points, highest, held)
    across, along, turn = _families(beam, discs, held)
    nodes = [int(np.argmin(np.abs(beam.position - point.position))) for point in points]
    pairs = list(zip(nodes, points, strict=True))
    bent = [2 * k for k, g in pairs if g.across] + [2 * k + 1 for k, g in pairs if g.tilt]
    return ElasticShaft(
        beam.position,
        _elastic_modes(across, bent, highest),
        _elastic_modes(along, [k for k, g in pairs if g.along], highest),
        _elastic_modes(turn, [k for k, g in pairs if g.turn], highest),
        turn.mass,
        highest,
        damping_ratio,
        error,
    )
