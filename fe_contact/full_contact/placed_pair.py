"""Both meshes of a pair put where the reference pair touches, in one frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from fe_contact.full_contact.meshing import FullContactMesh
from fe_contact.geometry import ParallelAxes, Toothing, tooth_profile
from fe_contact.mesh import GearMesh
from fe_contact.mesh.quadratic import SIDES, rotated
from fe_contact.types import FloatArray, IntArray

_DEPTH = 0.25
"""Modules below a flank to which its modification moves the nodes."""
ORIGIN = np.zeros(2)


@dataclass(frozen=True)
class PlacedGear:
    """One gear's mesh in the frame of the pair: gear 1's centre is the origin, gear 2's on +y.

    Attributes
    ----------
    points : (n, 2) array
        Nodes, m.
    triangles : (m, 6) int array
        Six-node triangles, corners counter-clockwise, then the middles of sides 0-1, 1-2, 2-0.
    bore_nodes : (b,) int array
    center : (2,) array
        m.
    flanks : mapping of int to (e, 2) int array
        By tooth that may touch: elements along its loaded flank, and which of their sides lies on it.
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
        Teeth of gear 1 and gear 2 that may touch.
    approach : float
        Part of the transmission error, in m, by which the driving gear is turned already.
    """

    gears: tuple[PlacedGear, PlacedGear]
    meetings: tuple[tuple[int, int], ...]
    approach: float


def placed_pair(
    pair: ParallelAxes, mesh: FullContactMesh, position: float, approach: float = 0.0
) -> PlacedPair:
    """Put both meshes into the conjugate position and the driving gear beyond it.

    Parameters
    ----------
    pair : GearPair
        External spur gears.
    mesh : FullContactMesh
    position : float
        Base pitches, from -0.5 to 0.5, by the driven gear: pair 0 touches there on the line of action.
    approach : float
        m, >= 0. Where it exceeds the gap, teeth overlap at the start, so that they hold each other.
    """
    angle = pair.working_pressure_angle
    along = np.array([np.cos(angle), np.sin(angle)])  # of the force on gear 2
    roll_1, roll_2 = (float(roll) for roll in pair.roll_lengths(position))
    turns = (
        _turn(pair.pinion, roll_1, along) - approach / pair.pinion.base_radius,
        _turn(pair.wheel, roll_2, -along),
    )
    driving = _placed(pair.pinion, mesh.gears[0], turns[0], mesh.reach)
    center = np.array([0.0, pair.center_distance])
    driven = _placed(pair.wheel, mesh.gears[1], turns[1], mesh.reach, center)
    # Teeth are numbered counter-clockwise; those ahead are clockwise on gear 1, counter-clockwise on gear 2.
    meetings = tuple((-ahead, ahead) for ahead in range(-mesh.reach, mesh.reach + 1))
    return PlacedPair((driving, driven), meetings, approach)


def no_load_gap(pair: ParallelAxes, reach: int, position: float) -> float:
    """Return the least modified gap of the pairs on the path of contact, m: beyond it teeth overlap."""
    path = pair.path_of_contact
    roll_1, roll_2 = pair.roll_lengths(position, np.arange(-reach, reach + 1))
    on_path = (roll_1 >= path.start) & (roll_1 <= path.end)
    gap = _removed_at(pair.pinion, roll_1) + _removed_at(pair.wheel, roll_2)
    return float(np.min(gap[on_path]))


def _turn(gear: Toothing, roll_length: float, outward: FloatArray) -> float:
    """Return the angle that points the flank's outward normal at a roll length along `outward`, rad."""
    normal = tooth_profile(gear).normal(np.array([roll_length**2 / (2.0 * gear.base_radius)]))[0]
    return float(np.arctan2(outward[1], outward[0]) - np.arctan2(normal[1], normal[0]))


def _placed(
    gear: Toothing, mesh: GearMesh, turn: float, reach: int, center: FloatArray = ORIGIN
) -> PlacedGear:
    """Remove the modification from the flanks, turn, move.

    What lies below a flank moves with it, less and less to a depth of `_DEPTH`: elements at the tip are no
    larger than a relief.
    """
    points = mesh.points.copy()
    for flank in mesh.flanks:
        removed = _removed_at(gear, np.sqrt(2.0 * gear.base_radius * np.maximum(flank.s, 0.0)))
        away, nearest = cKDTree(mesh.points[flank.nodes]).query(mesh.points)
        share = np.maximum(1.0 - away / (_DEPTH * gear.normal_module), 0.0)
        points -= (flank.normals * removed[:, None])[nearest] * share[:, None]
    touching = [flank for flank in mesh.flanks if abs(flank.tooth) <= reach]
    flanks = {flank.tooth: _sides(mesh.triangles, flank.nodes) for flank in touching}
    return PlacedGear(rotated(points, turn) + center, mesh.triangles, mesh.bore_nodes, center, flanks)


def _removed_at(gear: Toothing, roll: FloatArray) -> FloatArray:
    """Material removed at roll lengths, m; below the form point as much as there."""
    within = np.clip(roll, gear.form_roll_length, gear.tip_roll_length)
    return np.asarray(gear.modification.material_removed(gear, within, 0.0), dtype=float)


def _sides(triangles: IntArray, nodes: IntArray) -> IntArray:
    """Elements with a side on a line of nodes, and the number of that side, (e, 2)."""
    on_line = np.isin(triangles, nodes)
    found = []
    for number, (a, b) in enumerate(SIDES):
        elements = np.flatnonzero(on_line[:, a] & on_line[:, b] & on_line[:, 3 + number])
        found.append(np.column_stack([elements, np.full(len(elements), number)]))
    return np.concatenate(found)
