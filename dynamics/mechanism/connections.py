"""The linear springs and dampers of a scene, laid out on all rotors: supports, seats, couplings."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.bearings.seat import SEAT
from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.columns import elastic_terms
from dynamics.mechanism.coupling_rows import CouplingRows, gather_couplings
from dynamics.mechanism.freedoms import Freedoms
from dynamics.mechanism.seats import Seats, gather_seats, seated
from dynamics.mechanism.supports import Supports, gather_supports
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray


@dataclass(frozen=True)
class Connections:
    """What joins rotors to the ground and to each other linearly.

    Attributes
    ----------
    supports : Supports
        Bushings, then planet bearings.
    seats : Seats
        The bearings that are more than three springs to rigid ground or pin.
    couplings : CouplingRows
    """

    supports: Supports
    seats: Seats
    couplings: CouplingRows


def gather_connections(scene: Scene, rotors: Bodies) -> Connections:
    """Lay out what joins the rotors of `scene`."""
    supports = gather_supports(rotors, seated(scene, rotors))
    couplings = gather_couplings(scene, rotors)
    return Connections(supports, gather_seats(scene, rotors, supports.name), couplings)


def linear_matrices(
    connections: Connections, freedoms: Freedoms
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return stiffness and damping (n, n), and the constant force (n,) of pin errors and preload.

    Bearings in housings that move are force elements instead; their preload is in the constant force.
    """
    supports, seats, couplings = connections.supports, connections.seats, connections.couplings
    moves, held = freedoms.keep(supports.motion), ~supports.carried
    stiffness = supports.matrix(supports.stiffness * held[:, None], moves, moves)
    damping = supports.matrix(supports.damping * held[:, None], moves, moves)
    if couplings.name:
        strains = freedoms.keep(couplings.motion)
        stiffness += couplings.matrix(couplings.stiffness, strains, strains)
        damping += couplings.matrix(couplings.damping, strains, strains)
    constant = np.einsum("bki,bk,bk->i", moves, supports.stiffness, supports.error)
    if seats.name:
        strains, held = freedoms.keep(seats.motion), np.repeat(held[seats.support], SEAT)
        stiffness += strains.T @ (seats.stiffness * held) @ strains
        damping += strains.T @ (seats.damping * held) @ strains
        constant += seats.preload @ strains
    return stiffness, damping, constant


def elastic_matrices(rotors: Bodies, freedoms: Freedoms) -> tuple[FloatArray, FloatArray]:
    """Return stiffness and damping (n, n) of shafts and housings themselves."""
    springs, dampers = elastic_terms(rotors)
    motion = freedoms.motion
    return motion.T @ (springs[:, None] * motion), motion.T @ (dampers @ motion)


def forces_on_ground(
    connections: Connections, freedoms: Freedoms, tilted: bool
) -> tuple[FloatArray, FloatArray]:
    """Return the force on the ground at each support per freedom and per its rate, (b, 3, n) each.

    With moments (`tilted`) both, (b, 6, n). Bearings in housings that move are force elements: 0 here.
    """
    supports, seats = connections.supports, connections.seats
    held = (~supports.carried)[:, None]
    rows = np.repeat(held[seats.support, 0], SEAT)
    return (
        _on_ground(connections, freedoms, supports.stiffness * held, seats.stiffness * rows, tilted),
        _on_ground(connections, freedoms, supports.damping * held, seats.damping * rows, tilted),
    )


def _on_ground(
    connections: Connections, freedoms: Freedoms, springs: FloatArray, matrix: FloatArray, tilted: bool
) -> FloatArray:
    """Force on the ground of the plain `springs` (b, 3) and of the seats' `matrix` (5 s, 5 s)."""
    supports, seats = connections.supports, connections.seats
    plain = springs[:, :, None] * freedoms.keep(supports.motion)
    if not tilted:
        return plain
    full = np.concatenate([plain, np.zeros_like(plain)], axis=1)
    full[seats.support, :SEAT] += (matrix @ freedoms.keep(seats.motion)).reshape(-1, SEAT, plain.shape[2])
    return full
