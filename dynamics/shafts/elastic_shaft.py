"""Elastic coordinates of a shaft with gears on it, beside its rigid motion: bending, torsion, stretching."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from dynamics.shafts.beam_section import BeamSection
from dynamics.shafts.bodies import Inertia
from dynamics.shafts.craig_bampton import ElasticModes, Family, elastic_modes, free_frequencies, worst_error
from dynamics.shafts.timoshenko_beam import PER_NODE, TimoshenkoBeam, timoshenko_beam
from dynamics.types import BoolArray, FloatArray, IntArray

MESH_ERROR = 1e-3
"""Estimated relative error of the frequencies of interest at which beam elements are short enough."""
FIRST_PARTS, LAST_PARTS = 8, 256  # elements per length of the shaft: where refining starts and ends
ACROSS, ALONG, TURN = (0, 4), 2, 5  # freedoms of a node: bending in the plane x z, extension, torsion


@dataclass(frozen=True)
class Disc:
    """A rigid body on a shaft: a gear."""

    position: float
    """Position of its center along the shaft, m."""
    inertia: Inertia


@dataclass(frozen=True)
class PointOfApplication:
    """A point of application of forces on a shaft, and the motions of the section at it."""

    position: float
    """Distance from the left end, m."""
    across: bool = False
    tilt: bool = False
    along: bool = False
    turn: bool = False
    """`across`, `tilt`, `along`, `turn`: Forces across the axis, moments across it, force along it, torque.
    """


def _families(
    beam: TimoshenkoBeam, discs: Sequence[Disc], imposed: float | None
) -> tuple[Family, Family, Family]:
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
    rigid_motion = np.stack([np.ones(nodes), np.zeros(nodes)], axis=1).ravel()
    turned = -1 if imposed is None else int(np.argmin(np.abs(beam.position - imposed)))

    def part(columns: IntArray, rigid: FloatArray, at: int = -1) -> Family:
        block = np.ix_(columns, columns)
        return Family(mass[block], beam.stiffness[block], rigid, at)

    return (
        part(bent, np.stack([rigid_motion, tilted], axis=1)),
        part(first + ALONG, ones),
        part(first + TURN, ones, turned),
    )


def _fine_beam(
    sections: Sequence[BeamSection],
    discs: Sequence[Disc],
    points: Sequence[PointOfApplication],
    highest: float,
    imposed: float | None,
) -> tuple[TimoshenkoBeam, float]:
    """Return a beam and the estimated error of its frequencies; errors fall with the length squared."""
    stations = [*(disc.position for disc in discs), *(point.position for point in points)]
    length, parts = sum(section.length for section in sections), FIRST_PARTS
    beam = timoshenko_beam(sections, stations, length / parts)
    coarse = _frequencies(beam, discs, imposed)
    while True:
        finer = timoshenko_beam(sections, stations, 0.5 * float(np.max(np.diff(beam.position))))
        exact = _frequencies(finer, discs, imposed)
        error = 4.0 / 3.0 * max(worst_error(a, b, highest) for a, b in zip(coarse, exact, strict=True))
        parts *= 2
        if error <= MESH_ERROR or parts > LAST_PARTS:
            return beam, error
        beam, coarse = finer, exact


def _frequencies(beam: TimoshenkoBeam, discs: Sequence[Disc], imposed: float | None) -> list[FloatArray]:
    return [free_frequencies(part) for part in _families(beam, discs, imposed)]


@dataclass(frozen=True)
class ElasticShaft:
    """Elastic coordinates of a shaft: bending in x z, bending alike in y z, extension, torsion.

    They are relative to the motion of the shaft as a rigid body about its center of mass, with which they
    share no kinetic energy. If the rotation is imposed, torsion is relative to the rotation there.
    """

    position: FloatArray
    """Nodes along the shaft, m. Shape (N,)."""
    bending: ElasticModes
    extension: ElasticModes
    torsion: ElasticModes
    """`bending`, `extension`, `torsion`: Shapes (2 N, b): displacement and slope du_x/dz of each node, (N, s)
    and (N, t).
    """
    polar: FloatArray
    """Moments of inertia about the axis as the nodes' rotations have them, kg m^2. Shape (N, N)."""
    highest: float
    """Frequency of interest, Hz."""
    damping_ratio: float
    """Damping ratio of every elastic coordinate."""
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
        return self._joined("mass")

    @cached_property
    def stiffness(self) -> FloatArray:
        """Modal stiffness per coordinate, N/m or N m/rad."""
        return self._joined("stiffness")

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
        """Whether the shaft bends."""
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

    def _joined(self, name: str) -> FloatArray:
        parts = (self.bending, self.bending, self.extension, self.torsion)
        return np.concatenate([np.asarray(getattr(part, name), dtype=float) for part in parts])


@lru_cache(maxsize=64)
def elastic_shaft(
    sections: tuple[BeamSection, ...],
    discs: tuple[Disc, ...],
    points: tuple[PointOfApplication, ...],
    highest: float,
    damping_ratio: float,
    imposed: float | None = None,
) -> ElasticShaft:
    """Return the elastic coordinates of a shaft of `sections` with `discs` on it, held by nothing.

    Timoshenko beam elements lie between sections, discs and `points`; they are halved until the frequencies
    of interest are within 0.1 %. They are reduced after Craig and Bampton to the motions of the points and to
    as many modes with these held as keep the frequencies of interest within 1 %. Deflections under forces at
    the points are exact.

    Parameters
    ----------
    sections : tuple of BeamSection
        Sections from the left end.
    highest : float
        Highest frequency of interest, Hz: for modes of the free shaft; the first of each family always is.
    imposed : float or None
        Position at which the rotation is imposed, m: one of the points of application.
    """
    beam, error = _fine_beam(sections, discs, points, highest, imposed)
    across, along, turn = _families(beam, discs, imposed)
    nodes = [int(np.argmin(np.abs(beam.position - point.position))) for point in points]
    pairs = list(zip(nodes, points, strict=True))
    bent = [2 * k for k, g in pairs if g.across] + [2 * k + 1 for k, g in pairs if g.tilt]
    return ElasticShaft(
        position=beam.position,
        bending=elastic_modes(across, bent, highest),
        extension=elastic_modes(along, [k for k, g in pairs if g.along], highest),
        torsion=elastic_modes(turn, [k for k, g in pairs if g.turn], highest),
        polar=turn.mass,
        highest=highest,
        damping_ratio=damping_ratio,
        mesh_error=error,
    )
