"""Natural modes of an elastic ring on its support, by harmonics of the angle."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dynamics.elastic_ring.annulus import Annulus
from dynamics.elastic_ring.ring_compliance import Port, RingSeries
from dynamics.elastic_ring.ring_support import RingSupport
from dynamics.types import FloatArray
from host.optional_modules import linalg

RESOLVED = 2
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
    if (series := RingSeries(ring, support)).springs:
        motion = np.concatenate([_motion(ring, port, harmonics) for port, _ in series.springs])
        springs = np.linalg.inv(_lug_compliance(series, highest))
        stiffness += np.einsum("kni,kl,lmj->nimj", motion.conj(), springs, motion)
    matrices = (matrix.reshape(3 * size, 3 * size) for matrix in (stiffness, mass))
    square, shape = linalg.eigh(*matrices, subset_by_index=(0, count - 1))
    amplitude = shape.reshape(size, 3, -1)
    energy = 2.0 * np.pi * np.einsum("nim,ij,njm->nm", amplitude.conj(), ring.mass, amplitude).real
    both = energy[highest:].copy()
    both[1:] += energy[:highest][::-1]
    largest = both.argmax(axis=0)
    frequency = np.sqrt(np.maximum(square, 0.0)) / (2.0 * np.pi)
    return RingModes(frequency, largest, both.max(axis=0) / both.sum(axis=0))


def _motion(ring: Annulus, port: Port, harmonics: np.ndarray) -> np.ndarray:
    """Return the motion of points by the amplitudes of harmonics, (n, harmonics, 3), complex."""
    waves = np.exp(1j * port.angle[:, None] * harmonics)
    return np.asarray(waves[:, :, None] * ring.motion(port.radius, port.radial, port.tangential))


def _lug_compliance(series: RingSeries, highest: int) -> FloatArray:
    """Return the compliance of the lugs, and of the harmonics beyond `highest`, which follow statically."""
    ports = [port for port, _ in series.springs]
    rows = [
        np.concatenate([series.green(moved, loaded, beyond=highest) for loaded in ports], axis=1)
        for moved in ports
    ]
    give = np.repeat([1.0 / stiffness for _, stiffness in series.springs], series.support.lugs)
    return np.asarray(np.concatenate(rows) + np.diag(give), dtype=float)
