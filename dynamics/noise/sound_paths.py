"""Paths of sound from the panels of a hull to a microphone in the air: a delay and a gain each.

Every panel is an elemental radiator: the sound pressure is the sum of rho/(Omega r) S a_n(t - r/c), the
volume acceleration S a_n of the panel a travel time ago, into the solid angle Omega [1]_.

References
----------
.. [1] Pierce, A. D.: Acoustics, 3rd ed. Springer 2019, section 4.3.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from bounds import at_least
from dynamics.acoustics import Air, ElementalRadiators, Hull
from dynamics.acoustics.hull import ComplexArray
from dynamics.errors import InputError
from dynamics.types import FloatArray

NEAREST = 2.0
"""Least distance of a microphone over the longest edge of a panel: nearer it is no point source."""
HALF_LENGTH, KAISER = 12, 8.0
"""Of the interpolation between samples: up to a quarter of their rate delays are exact within 1e-4."""
BLOCK = 4_000_000  # phases that are held at a time


@dataclass(frozen=True)
class SoundPaths:
    """Paths from T panels to a microphone.

    Attributes
    ----------
    delay : (T,) array
        Travel time r/c, s.
    gain : (T, r) array
        Sound pressure per acceleration of each coordinate, Pa s^2/m (per m/s^2 of a coordinate in m).
    """

    delay: FloatArray
    gain: FloatArray

    def transfer(self, frequency: FloatArray) -> ComplexArray:
        """Return the sound pressure per acceleration of each coordinate, (N, r), at (N,) in Hz."""
        omega = 2.0 * np.pi * np.asarray(frequency, dtype=float)
        pressure = np.empty((omega.size, self.gain.shape[1]), dtype=complex)
        step = max(BLOCK // self.delay.size, 1)
        for first in range(0, omega.size, step):
            part = slice(first, first + step)
            pressure[part] = np.exp(-1j * np.outer(omega[part], self.delay)) @ self.gain
        return pressure

    def impulse_response(self, rate: float) -> tuple[FloatArray, int]:
        """Return the sound pressure after an acceleration of one sample, (L, r), and its first sample.

        Each delay is spread over samples by a windowed sinc. The response is finite: it ends with the longest
        path. `rate` in Hz.
        """
        at = self.delay * rate
        nearest = np.floor(at).astype(int) + np.arange(1 - HALF_LENGTH, HALF_LENGTH + 1)[:, None]
        off = (nearest - at) / HALF_LENGTH
        window = np.i0(KAISER * np.sqrt(np.maximum(1.0 - off**2, 0.0))) / np.i0(KAISER)
        weight = window * np.sinc(nearest - at)
        first, last = int(nearest.min()), int(nearest.max())
        panel = np.broadcast_to(np.arange(at.size), nearest.shape)
        entries = weight.ravel(), ((nearest - first).ravel(), panel.ravel())
        spread = sparse.csr_array(entries, shape=(last - first + 1, at.size))
        return np.asarray(spread @ self.gain), first


def sound_paths(
    hull: Hull, shapes: FloatArray, microphone: FloatArray, model: ElementalRadiators, air: Air
) -> SoundPaths:
    """Return the paths from a hull that moves in shapes to a microphone.

    Parameters
    ----------
    hull : Hull
    shapes : (T, r) array
        Mean outward displacement of the panels per coordinate.
    microphone : (3,) array
        m, in the frame of the hull.

    Raises
    ------
    InputError
        The microphone is no point of the air: inside a closed hull, or too near to a panel.
    """
    at = np.asarray(microphone, dtype=float)
    if at.shape != (3,) or not np.all(np.isfinite(at)):
        raise InputError("microphone", np.shape(microphone), "three finite coordinates")
    distance = np.linalg.norm(hull.centers - at, axis=1)
    _require_in_air(hull, at, float(distance.min()))
    volume = air.density / model.solid_angle * hull.areas / distance
    return SoundPaths(distance / air.sound_speed, volume[:, None] * shapes)


def _require_in_air(hull: Hull, microphone: FloatArray, distance: float) -> None:
    """Refuse a microphone inside of the hull or near to a panel."""
    if hull.closed and _solid_angle(hull, microphone) > 2.0 * np.pi:
        raise InputError("microphone", microphone.tolist(), "a point outside of the housing")
    least = NEAREST * hull.longest_edge
    if distance < least:
        bound = at_least(least, "m", note=" from the surface, two of its longest edges")
        raise InputError("microphone", distance, bound, "Move it away, or use smaller elements.")


def _solid_angle(hull: Hull, point: FloatArray) -> float:
    """Return the solid angle under which a closed hull is seen, sr: 4 pi from inside, 0 from outside.

    A. van Oosterom, J. Strackee, IEEE Transactions on Biomedical Engineering 30 (1983) 125-126.
    """
    a, b, c = np.moveaxis(hull.corners - point, 1, 0)
    la, lb, lc = (np.linalg.norm(corner, axis=1) for corner in (a, b, c))
    volume = np.sum(a * np.cross(b, c), axis=1)
    cosines = la * lb * lc + np.sum(a * b, 1) * lc + np.sum(a * c, 1) * lb + np.sum(b * c, 1) * la
    return float(2.0 * np.arctan2(volume, cosines).sum())
