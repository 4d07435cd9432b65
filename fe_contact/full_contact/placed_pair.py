"""The mesh of one position as a contact problem of CalculiX: the driving gear turned towards its mate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.full_contact.condensation.modified_flank import removed_at_roll
from fe_contact.full_contact.condensation.placed_mesh import PlacedBody
from fe_contact.geometry import ParallelAxes
from fe_contact.mesh.quadratic import SIDES, rotated
from fe_contact.types import FloatArray, IntArray


@dataclass(frozen=True)
class PlacedGear:
    """One gear's mesh in the frame of the pair: gear 1's centre is the origin, the teeth meet on +y.

    Attributes
    ----------
    points : (n, 2) array
        Nodes, m.
    triangles : (m, 6) int array
        Six-node triangles, corners counter-clockwise, then the middles of sides 0-1, 1-2, 2-0.
    bore_nodes : (b,) int array
        Nodes of the bore, or of the outside of a ring gear's rim.
    center : (2,) array
        m.
    flanks : mapping of int to (e, 2) int array
        By pair: elements along the flank, and which of their sides lies on it.
    """

    points: FloatArray
    triangles: IntArray
    bore_nodes: IntArray
    center: FloatArray
    flanks: dict[int, IntArray]


@dataclass(frozen=True)
class PlacedPair:
    """Two undeformed gears, the driving one `approach` beyond the conjugate position.

    Attributes
    ----------
    gears : (PlacedGear, PlacedGear)
        Driving and driven. The driving gear turns clockwise.
    meetings : tuple of (int, int)
        Flanks of gear 1 and gear 2 that may touch.
    approach : float
        Part of the transmission error, in m, by which the driving gear is turned already.
    """

    gears: tuple[PlacedGear, PlacedGear]
    meetings: tuple[tuple[int, int], ...]
    approach: float


def placed_pair(pair: ParallelAxes, bodies: tuple[PlacedBody, PlacedBody], approach: float) -> PlacedPair:
    """Turn the driving gear beyond the conjugate position.

    Parameters
    ----------
    pair : GearPair or InternalGearPair
    bodies : (PlacedBody, PlacedBody)
        In the conjugate position.
    approach : float
        m, >= 0. Where it exceeds the gap, teeth overlap at the start, so that they hold each other.
    """
    turns = (-approach / pair.pinion.base_radius, 0.0)
    first, second = (_placed(body, turn) for body, turn in zip(bodies, turns, strict=True))
    return PlacedPair((first, second), tuple((ahead, ahead) for ahead in bodies[0].strips), approach)


def no_load_gap(pair: ParallelAxes, position: float) -> float:
    """Return the least modified gap of the pairs on the path of contact, m: beyond it teeth overlap."""
    path = pair.path_of_contact
    reach = int(np.ceil(path.length / pair.base_pitch)) + 1
    roll_1, roll_2 = pair.roll_lengths(position, np.arange(-reach, reach + 1))
    on_path = (roll_1 >= path.start) & (roll_1 <= path.end)
    gap = removed_at_roll(pair.pinion, roll_1) + removed_at_roll(pair.wheel, roll_2)
    return float(np.min(gap[on_path]))


def _placed(body: PlacedBody, turn: float) -> PlacedGear:
    """Turn a body about its centre."""
    points = rotated(body.points - body.center, turn) + body.center
    flanks = {ahead: _sides(body.triangles, strip.nodes) for ahead, strip in body.strips.items()}
    return PlacedGear(points, body.triangles, body.held, body.center, flanks)


def _sides(triangles: IntArray, nodes: IntArray) -> IntArray:
    """Elements with a side on a line of nodes, and the number of that side, (e, 2)."""
    on_line = np.isin(triangles, nodes)
    found = []
    for number, (a, b) in enumerate(SIDES):
        elements = np.flatnonzero(on_line[:, a] & on_line[:, b] & on_line[:, 3 + number])
        found.append(np.column_stack([elements, np.full(len(elements), number)]))
    return np.concatenate(found)
