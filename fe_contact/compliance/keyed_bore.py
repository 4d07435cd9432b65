"""A gear that a single key holds: one update of low rank on a ring that nothing keeps from turning.

Without the key the bore rests radially and axially on its shaft and is free to turn; it is the same in every
sector, so the ring is solved by harmonics (`cyclic_ring`), the mean turn of its cuts restrained. With C that
compliance, theta the displacements of a unit turn, and U the foundation of the key, U U' = k integral N N' dA
over its area, the forces l = U'u of the key and the turn a follow from equilibrium about the axis:

    u = C f + theta a - C U l,    (theta'U) l = theta'f,    l = U'u,
    u = C f + Z' H^-1 Z f,    Z = [theta'; -U'C],    H = [[0, theta'U], [U'theta, -(1 + U'C U)]].

The restraint drops out. The compliance between two teeth then depends on where both stand beside the key.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from fe_contact.body import Key
from fe_contact.compliance.coarse_face import face_functions
from fe_contact.compliance.condensed_gear import CondensedGear
from fe_contact.geometry import Toothing
from fe_contact.mesh.element_stack import LOWER_FACE
from fe_contact.mesh.swept_sector import SweptSector, between_ends
from fe_contact.types import FloatArray, IntArray

POINTS = 3  # of Gauss each way on the part of a face that the key covers: exact along the bore
RANK_TOLERANCE = 1e-10  # least over largest singular value of what is kept of Z


class _KeyUpdate(NamedTuple):
    """The contribution of the key to the compliance of the ring."""

    rows: FloatArray
    """Rows of the update by tooth from -span to span. Shape (2 span + 1, r, nf)."""
    core: FloatArray
    """Core of the update, m/N. The compliance of tooth t under forces on tooth o grows by ``rows[t].T @ core
    @ rows[o]``. Shape (r, r).
    """


class _KeyPoints(NamedTuple):
    """Gauss points on the key: sector, number and share of each of the 8 freedoms, all (g, 8)."""

    sector: IntArray
    number: IntArray
    shares: FloatArray


def key_update(gear: Toothing, solved: CondensedGear, twist: float, span: int) -> _KeyUpdate:
    """Return the update of the compliance by the key of a right-hand gear.

    Parameters
    ----------
    gear : Gear
        Its seat has a key.
    solved : CondensedGear
        The gear without it, with the ring's answers to unit forces on the bore.
    twist : float
        Turn of the section per axial length, rad/m.
    span : int
        Teeth on either side of tooth 0.
    """
    points = _key_points(gear, solved.sector, twist)
    clamped, flank = solved.condensed, len(solved.sector.flank)
    sectors, number, foundation = _modes(points, len(solved.sector.key_bore) + len(solved.sector.key_cut))
    teeth, under = np.arange(-span, span + 1), np.unique(sectors)
    distances = np.unique((np.concatenate([teeth, under])[:, None] - under) % gear.teeth)
    motion = _unit_motion(solved, distances)
    between = np.searchsorted(distances, (sectors[:, None] - sectors) % gear.teeth)
    coupled = foundation.T @ motion[between, flank + number[:, None], number] @ foundation
    turned = clamped.transmitted[:, :flank].T @ np.tile(solved.ring.turn, 2)
    key_turn = gear.seat_radius * foundation.sum(axis=0)
    rows = np.empty((len(teeth), 1 + foundation.shape[1], flank))
    for i, tooth in enumerate(teeth):
        response = motion[np.searchsorted(distances, (tooth - sectors) % gear.teeth), :flank, number]
        rows[i, 0], rows[i, 1:] = turned, -foundation.T @ response
    matrix = np.zeros((rows.shape[1], rows.shape[1]))
    matrix[0, 1:] = matrix[1:, 0] = key_turn
    matrix[1:, 1:] = -(np.eye(len(coupled)) + 0.5 * (coupled + coupled.T))
    return _compressed_update(rows, matrix)


def _unit_motion(gear: CondensedGear, distances: IntArray) -> FloatArray:
    """Return the displacements of flank and bore of the sectors `distances` under unit forces on bore 0.

    (m, nf + p, p): flank, bore between the cuts, bore on the left cut; p loads on the latter two.
    """
    clamped, sector, left = gear.condensed, gear.sector, gear.ring.bore
    inner = len(sector.key_bore)
    both = np.concatenate([left[distances], left[distances - 1]], axis=1)
    inside = clamped.transmitted.T @ both
    inside[np.flatnonzero(distances == 0), :, :inner] += clamped.flank[:, len(sector.flank) :]
    return np.concatenate([inside, both[:, sector.key_cut]], axis=1)


def _key_points(gear: Toothing, sector: SweptSector, twist: float) -> _KeyPoints:
    """Place Gauss points on the bore under the key; shares hold the root of modulus times area."""
    key, modulus = gear.seat.key, gear.seat.key_modulus
    assert key is not None
    number = _numbers(sector)
    faces = np.flatnonzero(sector.grid_cell[: sector.bodies, 1] == -sector.grid.body_rows)
    z = _node_positions(sector)
    low, high = gear.seat.ends(gear.face_width)
    step = 2.0 * math.pi / gear.teeth / sector.grid.columns
    points: list[tuple[IntArray, IntArray, FloatArray]] = []
    for face in faces:
        nodes = sector.elements[face, LOWER_FACE]
        bottom, top = z[nodes[0]], z[nodes[2]]
        if not low < 0.5 * (bottom + top) < high:
            continue
        first = (sector.grid_cell[face, 0] - 0.5 * sector.grid.columns) * step
        for s, x, y, weight in _covered(gear, key, first, step, (bottom, top), twist):
            shares = face_functions(np.array([x]), np.array([y]))[0]
            scale = math.sqrt(modulus * weight)
            points.append(((number[nodes, 0] + s) % gear.teeth, number[nodes, 1], scale * shares))
    return _KeyPoints(*(np.array(part) for part in zip(*points, strict=True)))


def _covered(
    gear: Toothing, key: Key, first: float, step: float, ends: tuple[float, float], twist: float
) -> list[tuple[int, float, float, float]]:
    """Return sector, face coordinates and area of Gauss points where the key covers copies of a face.

    The face reaches from the angle `first` to `first + step` in its sector. Its coordinate along the bore
    runs from left to right, against the angle.
    """
    t, w = np.polynomial.legendre.leggauss(POINTS)
    half = 0.5 * key.width / gear.seat_radius
    pitch, length = 2.0 * math.pi / gear.teeth, ends[1] - ends[0]
    points: list[tuple[int, float, float, float]] = []
    for y, wy in zip(t, w, strict=True):
        begin = first + twist * (0.5 * (ends[0] + ends[1]) + 0.5 * length * y)
        for s in range(gear.teeth):
            for turn in (-1, 0, 1):
                middle = key.angle + 2.0 * math.pi * turn - s * pitch - begin
                low, high = max(0.0, middle - half), min(step, middle + half)
                if high <= low:
                    continue
                for x, wx in zip(t, w, strict=True):
                    at = 0.5 * (low + high) + 0.5 * (high - low) * x
                    area = 0.25 * gear.seat_radius * (high - low) * length * wx * wy
                    points.append((s, float(1.0 - 2.0 * at / step), float(y), float(area)))
    return points


def _numbers(sector: SweptSector) -> IntArray:
    """Return sector (0, or -1 on the right cut) and number of the tangential freedom of each node, (N, 2)."""
    number = np.zeros((len(sector.freedoms), 2), dtype=np.int64)
    of_freedom = np.full(sector.size, -1)
    of_freedom[sector.key_bore] = np.arange(len(sector.key_bore))
    cut = len(sector.key_bore) + np.arange(len(sector.key_cut))
    of_freedom[sector.left[sector.key_cut]] = cut
    of_freedom[sector.right[sector.key_cut]] = cut
    number[:, 1] = of_freedom[sector.freedoms[:, 1]]
    number[np.isin(sector.freedoms[:, 1], sector.right[sector.key_cut]), 0] = -1
    return number


def _node_positions(sector: SweptSector) -> FloatArray:
    """Return the axial position of each node, (N,)."""
    planes, columns = np.nonzero(sector.nodes >= 0)
    z = np.empty(len(sector.freedoms))
    z[sector.nodes[planes, columns]] = between_ends(sector.layers.ends)[planes]
    return z


def _modes(points: _KeyPoints, count: int) -> tuple[IntArray, IntArray, FloatArray]:
    """Return sector and number of the freedoms under the key (n,), and U (n, r)."""
    used, column = np.unique(points.sector * count + points.number, return_inverse=True)
    shares = np.zeros((len(points.shares), len(used)))
    np.add.at(shares, (np.arange(len(shares))[:, None], column.reshape(points.shares.shape)), points.shares)
    values, vectors = np.linalg.eigh(shares.T @ shares)
    significant = values > 1e-13 * values[-1]
    return used // count, used % count, vectors[:, significant] * np.sqrt(values[significant])


def _compressed_update(rows: FloatArray, matrix: FloatArray) -> _KeyUpdate:
    """Return Z' H^-1 Z with as few rows as it has directions."""
    teeth, _, flank = rows.shape
    flat = rows.transpose(1, 0, 2).reshape(rows.shape[1], -1)
    # The turn and the key's forces have units of their own.
    scale = np.linalg.norm(flat, axis=1)
    scale[1:] = scale[1:].max()
    left, values, right = np.linalg.svd(flat / scale[:, None], full_matrices=False)
    significant = values > RANK_TOLERANCE * values[0]
    left = left[:, significant] * values[significant] * scale[:, None]
    core = left.T @ np.linalg.solve(matrix, left)
    shaped = right[significant].reshape(-1, teeth, flank).transpose(1, 0, 2)
    return _KeyUpdate(np.ascontiguousarray(shaped), 0.5 * (core + core.T))
