"""Harmonic response of a system whose mesh stiffnesses vary over the cycle.

The leading law is the first drive or free rotation that turns. Harmonics are multiples of the frequency of
the common period, after which all meshes and loads are in phase again.
"""

from __future__ import annotations

import numpy as np

from dynamics.linearize.harmonic_response import HarmonicResponse, response_of
from dynamics.linearize.load_harmonics import load_multiples
from dynamics.linearize.steady_vibration import Excited, swept_vibration
from dynamics.linearize.strongest_lines import strongest_lines
from dynamics.linearize.varying_stiffness import varied
from dynamics.types import FloatArray, IntArray


def parametric_response(
    at: Excited,
    speed: FloatArray,
    rate: FloatArray,
    orders: int = 10,
    gyroscopic: bool = False,
    varying: bool = True,
) -> tuple[HarmonicResponse, FloatArray]:
    """Return the response of a system to its errors and loads, the stiffness varying with position: `varied`.

    And by how much the mean transmission errors differ from the mean static ones, (m, S), m.

    Parameters
    ----------
    speed, rate : (S,) arrays
        Speed of the leading law, rad/s, and its rate of change, rad/s^2.
    orders : int
        Harmonics of each mesh.
    gyroscopic : bool
        Whether gyroscopic and frame terms count.
    varying : bool
        False: with mean tangents, whose errors have the static means.
    """
    harmonics = _all_harmonics(at, orders, speed)
    steady = swept_vibration(at, speed, rate, harmonics, gyroscopic)
    if not varying:
        return response_of(at, speed, steady), np.zeros((len(at.cycles), speed.size))
    steady, shift = varied(at, steady)
    return response_of(at, speed, steady), shift


def _all_harmonics(at: Excited, orders: int, speed: FloatArray) -> IntArray:
    """Return the multiples of the common period's frequency at which meshes (to `orders`) or loads excite."""
    multiples = set(load_multiples(at.system, at.period, float(np.max(np.abs(speed))), at.time).tolist())
    for pitches, mesh in zip(at.period.pitches, at.system.scene.meshes, strict=True):
        period = mesh.table.period
        step = abs(pitches) // period
        multiples |= {step * k for k in range(1, orders * period + 1)} if step else set()
    return strongest_lines(at, np.array(sorted(multiples), dtype=np.int64), speed).harmonics
