"""The mesh of one position as a contact problem of CalculiX: the driving gear turned towards its mate."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fe_contact.full_contact.condensation.placed_mesh import PlacedBody
from fe_contact.full_contact.condensation.sites import removed_at_roll
from fe_contact.geometry import ParallelAxes
from fe_contact.mesh.quadratic import SIDES, rotated
from fe_contact.types import IntArray


@dataclass(frozen=True)
class PlacedPair:
    """Two undeformed gears, the driving one `approach` beyond the conjugate position.

    Attributes
    ----------
    gears : (PlacedBody, PlacedBody)
        Driving and driven. The driving gear turns clockwise.
    meetings : tuple of (int, int)
        Flanks of gear 1 and gear 2 that may touch.
    approach : float
        Part of the transmission error, in m, by which the driving gear is turned already.
    """

    gears: tuple[PlacedBody, PlacedBody]
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


def _placed(body: PlacedBody, turn: float) -> PlacedBody:
    return replace(body, points=rotated(body.points - body.center, turn) + body.center)


def flank_sides(body: PlacedBody, ahead: int) -> IntArray:
    """Return the elements along a flank, and the number of their side that lies on it, (e, 2)."""
    triangles = body.triangles
    on_line = np.isin(triangles, body.strips[ahead].nodes)
    sides = []
    for number, (a, b) in enumerate(SIDES):
        elements = np.flatnonzero(on_line[:, a] & on_line[:, b] & on_line[:, 3 + number])
        sides.append(np.column_stack([elements, np.full(len(elements), number)]))
    return np.concatenate(sides)
