"""The beam of a shaft with gears on it, fine enough, apart into bending, extension and torsion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dynamics.bodies.beam_section import BeamSection
from dynamics.bodies.elastic_modes import free_frequencies, worst_error
from dynamics.bodies.inertia import Inertia
from dynamics.bodies.timoshenko_beam import PER_NODE, TimoshenkoBeam, timoshenko_beam
from dynamics.types import FloatArray, IntArray

MESH_ERROR = 1e-3
"""Estimated relative error of the frequencies of interest at which beam elements are short enough."""
FIRST_PARTS, LAST_PARTS = 8, 256  # elements per length of the shaft: where refining starts and ends
ACROSS, ALONG, TURN = (0, 4), 2, 5  # freedoms of a node: bending in the plane x z, extension, torsion


@dataclass(frozen=True)
class Disc:
    """A rigid body on a shaft: a gear. `position` of its center along the shaft, m."""

    position: float
    inertia: Inertia


@dataclass(frozen=True)
class PointOfApplication:
    """A point of application of forces on a shaft, and the motions of its section there.

    Attributes
    ----------
    position : float
        m from the left end.
    across, tilt, along, turn : bool
        Forces across the axis, moments across it, force along it, torque.
    """

    position: float
    across: bool = False
    tilt: bool = False
    along: bool = False
    turn: bool = False


@dataclass(frozen=True)
class Family:
    """Matrices of a family, its rigid motions, and the freedom that is held (-1: none)."""

    mass: FloatArray
    stiffness: FloatArray
    rigid: FloatArray
    held: int = -1


def families(
    beam: TimoshenkoBeam, discs: Sequence[Disc], held: float | None
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
    moved = np.stack([np.ones(nodes), np.zeros(nodes)], axis=1).ravel()
    turned = -1 if held is None else int(np.argmin(np.abs(beam.position - held)))

    def part(columns: IntArray, rigid: FloatArray, at: int = -1) -> Family:
        own = np.ix_(columns, columns)
        return Family(mass[own], beam.stiffness[own], rigid, at)

    return (
        part(bent, np.stack([moved, tilted], axis=1)),
        part(first + ALONG, ones),
        part(first + TURN, ones, turned),
    )


def fine_beam(
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
        error = 4.0 / 3.0 * max(worst_error(a, b, highest) for a, b in zip(coarse, exact, strict=True))
        parts *= 2
        if error <= MESH_ERROR or parts > LAST_PARTS:
            return beam, error
        beam, coarse = finer, exact


def _frequencies(beam: TimoshenkoBeam, discs: Sequence[Disc], held: float | None) -> list[FloatArray]:
    """Frequencies of the three families, Hz."""
    return [
        free_frequencies(part.mass, part.stiffness, part.rigid.shape[1], part.held)
        for part in families(beam, discs, held)
    ]
