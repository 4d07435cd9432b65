"""Natural modes of an elastic ring on its support, by harmonics of the angle."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dynamics.elastic_ring.annulus import Annulus
from dynamics.elastic_ring.ring_support import RingSupport
from dynamics.types import FloatArray
from host.optional_modules import linalg

RESOLVED = 4
"""Harmonics over the number of lugs, whose spacing they resolve."""
LEAST = 24
"""Least number of harmonics."""


class RingModes(NamedTuple):
    """Natural modes of a ring in its plane, by rising frequency."""

    frequency: FloatArray
    """Natural frequencies, (modes,), Hz; 0 of a motion as a rigid body that nothing holds."""
    harmonic: np.ndarray
    """Harmonic of the angle with the largest part of the kinetic energy, (modes,): 2 is the oval."""
    share: FloatArray
    """Part of the kinetic energy in that harmonic, (modes,): 1 on a support that is alike all around."""


def ring_modes(ring: Annulus, support: RingSupport, count: int) -> RingModes:
    """Return the lowest modes of a ring.

    Parameters
    ----------
    count : int
        Number of modes, at most as many as `LEAST` harmonics have.
    """
    highest = max(LEAST, RESOLVED * support.lugs)
    harmonics = np.arange(-highest, highest + 1)
    around, size = support.distributed(ring), harmonics.size
    stiffness = np.zeros((size, 3, size, 3), dtype=complex)
    mass = np.zeros((size, 3, size, 3))
    for place, harmonic in enumerate(harmonics):
        stiffness[place, :, place, :] = 2.0 * np.pi * (ring.stiffness(int(harmonic)) + around)
        mass[place, :, place, :] = 2.0 * np.pi * ring.mass
    springs = (1.0, 0.0, support.lug_radial), (0.0, 1.0, support.lug_tangential)
    waves = np.exp(1j * support.angles[:, None] * harmonics)
    for radial, tangential, spring in springs:
        motion = waves[:, :, None] * ring.motion(ring.outer_radius, radial, tangential)
        stiffness += spring * np.einsum("lni,lmj->nimj", motion.conj(), motion)
    matrices = (matrix.reshape(3 * size, 3 * size) for matrix in (stiffness, mass))
    square, shape = linalg.eigh(*matrices, subset_by_index=(0, count - 1))
    amplitude = shape.reshape(size, 3, -1)
    energy = 2.0 * np.pi * np.einsum("nim,ij,njm->nm", amplitude.conj(), ring.mass, amplitude).real
    both = energy[highest:].copy()
    both[1:] += energy[:highest][::-1]
    largest = both.argmax(axis=0)
    frequency = np.sqrt(np.maximum(square, 0.0)) / (2.0 * np.pi)
    return RingModes(frequency, largest, both.max(axis=0) / both.sum(axis=0))
