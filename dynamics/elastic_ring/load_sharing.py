"""Loads of the planets of a stage whose pins are off their places, on an elastic ring gear.

Each planet transmits one force through both of its meshes. The way from the sun to the ring along the lines
of action gives way by the meshes and the pin of the planet, and by the ring under all planets.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dynamics.types import FloatArray


class LoadShares(NamedTuple):
    """Loads of the planets of a stage."""

    share: FloatArray
    """Forces over their mean, (planets,); 0: the teeth of this planet do not touch."""
    residual: float
    """Largest way that is not closed, over the largest deflection."""


def load_shares(
    stiffness: FloatArray,
    ring: FloatArray,
    error: FloatArray,
    force: float,
    angle: FloatArray,
    *,
    floats: bool,
) -> LoadShares:
    """Return the forces of the planets at one position of the carrier.

    Parameters
    ----------
    stiffness : ndarray (planets,)
        Stiffness of both meshes and the pin in series along the line of action, N/m.
    ring : ndarray (planets, planets)
        Displacements of the ring in its meshes under unit forces there, m/N.
    error : ndarray (planets,)
        Way by which each planet is late: > 0 unloads it, m.
    force : float
        Sum of the forces of all planets along the lines of action, N, > 0.
    angle : ndarray (planets,)
        Angles of the lines of action at the sun, rad.
    floats : bool
        Whether the sun is free in its plane; else it turns about a fixed axis.
    """
    directions = np.stack([np.ones(angle.size), np.cos(angle), np.sin(angle)], axis=1)
    moves = directions if floats else directions[:, :1]
    flexibility = np.diag(1.0 / stiffness) + ring
    touching = np.ones(angle.size, dtype=bool)
    for _ in range(2 * angle.size):
        carried, motion = _carried(flexibility, moves, error, force, touching)
        way = flexibility @ carried + error - moves @ motion
        further = np.where(touching, carried > 0.0, way < 0.0)  # a way below zero: flanks penetrate
        if np.array_equal(further, touching):
            break
        touching = further
    residual = np.abs(way[touching]).max() / max(np.abs(moves @ motion).max(), 1e-300)
    return LoadShares(carried / carried.mean(), float(residual))


def _carried(
    flexibility: FloatArray, moves: FloatArray, error: FloatArray, force: float, touching: np.ndarray
) -> tuple[FloatArray, FloatArray]:
    """Return the forces of the planets, and the motion of the sun, with the planets that touch."""
    count, freedoms = int(touching.sum()), moves.shape[1]
    scale = 1.0 / flexibility[0, 0]  # ways become forces, so that all rows are of one size
    matrix = np.zeros((count + freedoms, count + freedoms))
    matrix[:count, :count] = scale * flexibility[np.ix_(touching, touching)]
    matrix[:count, count:] = -moves[touching]
    matrix[count:, :count] = moves[touching].T
    known = np.concatenate([-scale * error[touching], [force], np.zeros(freedoms - 1)])
    solved = np.linalg.lstsq(matrix, known, rcond=None)[0]  # two planets leave the sun free across them
    carried = np.zeros(touching.size)
    carried[touching] = solved[:count]
    return carried, solved[count:] / scale
