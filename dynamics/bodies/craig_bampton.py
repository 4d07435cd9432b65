"""Reduction of an elastic body to its interface and a few modes: Craig and Bampton."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from dynamics.checks import positive
from dynamics.errors import InputError
from dynamics.types import FloatArray, IntArray


@dataclass(frozen=True)
class ReducedBody:
    """Interface freedoms first, then amplitudes of modes of unit modal mass with the interface held.

    Attributes
    ----------
    motion : (n, a + b) array
        Freedoms of the body per reduced freedom.
    mass, stiffness : (a + b, a + b) arrays
    frequency : (b,) array
        Of the modes kept, Hz.
    """

    motion: FloatArray
    mass: FloatArray
    stiffness: FloatArray
    frequency: FloatArray


def craig_bampton(
    mass: FloatArray, stiffness: FloatArray, interface: IntArray, highest: float
) -> ReducedBody:
    """Reduce a body (Craig and Bampton, AIAA Journal 6 (1968) 1313-1319).

    The motion inside is what the interface imposes statically plus the modes with the interface held, up to
    a frequency. Static motion under forces on the interface is exact, and so are rigid motions; natural
    frequencies are bounded from below by the exact ones and fall to them as modes are added.

    Parameters
    ----------
    mass, stiffness : (n, n) arrays
        Symmetric.
    interface : (a,) int array
        Freedoms where forces act; without repeats, enough to hold the body.
    highest : float
        Hz; modes up to it are kept.

    Raises
    ------
    InputError
        If the interface repeats freedoms or does not hold the body, or `highest` is not above zero.
    """
    from scipy.linalg import eigh  # noqa: PLC0415 (start-up time)

    held = np.asarray(interface, dtype=np.int64)
    if np.unique(held).size != held.size:
        raise InputError("interface", held.tolist(), "without repeats")
    limit = math.inf if highest == math.inf else positive("highest", highest)
    inside = np.setdiff1d(np.arange(mass.shape[0]), held)
    own, at = np.ix_(inside, inside), np.ix_(inside, held)
    try:
        square, shape = eigh(stiffness[own], mass[own]) if inside.size else (np.zeros(0), np.zeros((0, 0)))
    except np.linalg.LinAlgError as error:
        raise InputError("mass", "singular", "positive definite inside the interface") from error
    if square.size and square[0] <= 1e-12 * square[-1]:
        suggestion = "Add freedoms: inside, nothing may move as a rigid body."
        raise InputError("interface", held.tolist(), "one that holds the body", suggestion)
    frequency = np.sqrt(square) / (2.0 * math.pi)
    kept = frequency <= limit
    motion = np.zeros((mass.shape[0], held.size + int(np.count_nonzero(kept))))
    motion[held, np.arange(held.size)] = 1.0
    if inside.size:
        motion[inside, : held.size] = -shape @ ((shape.T @ stiffness[at]) / square[:, None])
        motion[inside, held.size :] = shape[:, kept]
    return ReducedBody(motion, motion.T @ mass @ motion, motion.T @ stiffness @ motion, frequency[kept])
