"""Orders that the support of a ring puts beside the mesh frequency.

Orders count per revolution of the carrier, seen where it turns past a ring that stands. A planet that passes
a lug finds the ring stiffer there, so that the force of a lug under mesh order k, which varies with k z of z
teeth, has the orders k z + l of the harmonics l of the force over the angle of one planet. Equal planets at
equal angles cancel all orders that are not multiples of their number.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dynamics.elastic_ring.ring_compliance import HeldRing, Port
from dynamics.types import FloatArray

SAMPLES = 1024
"""Angles of a planet; the force of a lug has a corner where the planet passes it."""


class SideLines(NamedTuple):
    """Lines in the force of a lug, by order of the carrier's rotation."""

    order: np.ndarray
    """Orders, (lines,), rising."""
    amplitude: FloatArray
    """Amplitude of the force of the first lug per N of each planet's mesh force, (springs, lines), where
    the springs are the directions of a lug that are not free."""


def side_lines(held: HeldRing, mesh: Port, order: int, planets: int, reach: int) -> SideLines:
    """Return the lines beside one order of the carrier's rotation.

    Parameters
    ----------
    mesh : Port
        Direction of the force in a mesh; its angles do not count.
    order : int
        Order of the mesh frequency or a multiple of it: k times the teeth of the ring.
    planets : int
        Number of planets, alike and at equal angles.
    reach : int
        Largest distance of a line from `order`, less than half of `SAMPLES`.
    """
    angle = 2.0 * np.pi * np.arange(SAMPLES) / SAMPLES
    forces = held.reactions(mesh.at(angle)).reshape(-1, max(held.support.lugs, 1), angle.size)[:, 0]
    spectrum = np.fft.fft(forces, axis=1) / angle.size
    beside = np.arange(-reach, reach + 1)
    kept = (order + beside) % planets == 0
    return SideLines(order + beside[kept], planets * np.abs(spectrum[:, beside[kept]]))
