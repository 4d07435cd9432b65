"""Reduction of an elastic body to its interface and a few modes: Craig and Bampton."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dynamics.checks import positive
from dynamics.errors import InputError
from dynamics.types import FloatArray, IntArray

CUT_OFFS = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0)
"""Multiples of the frequency of interest, up to which modes with the interface held may count."""


TRUNCATION = 0.01
"""Relative error of the frequencies of interest, below which the modes that count are enough."""


@dataclass(frozen=True)
class _ReducedBody:
    """Interface freedoms first, then amplitudes of b modes of unit modal mass with the interface held.

    `motion` (n, a + b) is that of the body's freedoms per reduced one; `frequency` (b,) is in Hz.
    """

    motion: FloatArray
    mass: FloatArray
    stiffness: FloatArray
    frequency: FloatArray


def craig_bampton(
    mass: FloatArray, stiffness: FloatArray, interface: IntArray, highest: float
) -> _ReducedBody:
    """Reduce a body (Craig and Bampton, AIAA Journal 6 (1968) 1313-1319).

    The motion inside is what the interface imposes statically plus the modes with the interface held, up to a
    frequency. Static motion under forces on the interface is exact, and so are rigid motions; natural
    frequencies are bounded from below by the exact ones and fall to them as modes are added. Raises
    `InputError`: the interface repeats freedoms or does not hold the body, or `highest` is not above zero.

    Parameters
    ----------
    mass, stiffness : (n, n) arrays
        Symmetric.
    interface : (a,) int array
        Freedoms where forces act; without repeats, enough to hold the body.
    highest : float
        Highest frequency of the modes that are kept, Hz.
    """
    from scipy.linalg import eigh  # noqa: PLC0415 (start-up time)

    fixed = np.asarray(interface, dtype=np.int64)
    if np.unique(fixed).size != fixed.size:
        raise InputError("interface", fixed.tolist(), "without repeats")
    limit = math.inf if highest == math.inf else positive("highest", highest)
    inside = np.setdiff1d(np.arange(mass.shape[0]), fixed)
    block, at = np.ix_(inside, inside), np.ix_(inside, fixed)
    try:
        square, shape = (
            eigh(stiffness[block], mass[block]) if inside.size else (np.zeros(0), np.zeros((0, 0)))
        )
    except np.linalg.LinAlgError as error:
        raise InputError("mass", "singular", "positive definite inside the interface") from error
    if square.size and square[0] <= 1e-12 * square[-1]:
        suggestion = "Add freedoms: inside, nothing may move as a rigid body."
        raise InputError("interface", fixed.tolist(), "one that holds the body", suggestion)
    frequency = np.sqrt(square) / (2.0 * math.pi)
    low = frequency <= limit
    motion = np.zeros((mass.shape[0], fixed.size + int(np.count_nonzero(low))))
    motion[fixed, np.arange(fixed.size)] = 1.0
    if inside.size:
        motion[inside, : fixed.size] = -shape @ ((shape.T @ stiffness[at]) / square[:, None])
        motion[inside, fixed.size :] = shape[:, low]
    return _ReducedBody(motion, motion.T @ mass @ motion, motion.T @ stiffness @ motion, frequency[low])


@dataclass(frozen=True)
class ElasticModes:
    """Coordinates e_j of b uncoupled elastic motions: m_j e_j'' + k_j e_j = work of forces on shapes."""

    shape: FloatArray
    """Freedoms of the family per coordinate; the largest displacement (rotation) is 1. Shape (n, b)."""
    mass: FloatArray
    stiffness: FloatArray
    """`mass`, `stiffness`: Modal: kg and N/m, of torsion kg m^2 and N m/rad. Shape (b,) each."""
    inertial: FloatArray
    """Coupling in the mass matrix with the k rigid motions: zero unless the rigid motion is that of a held
    freedom. Shape (b, k).
    """
    fixed: int
    """Number of modes with the interface held from which the coordinates are made."""
    limit: float
    """The frequency up to which these were kept, Hz."""
    truncation: float
    """Estimate of the largest relative error of frequencies up to the one of interest: that of the free body
    against the whole beam. Attached to others it may have somewhat more.
    """

    @property
    def frequency(self) -> FloatArray:
        """Natural frequencies of the free body, or of the body with its held freedom at rest, Hz."""
        return _hertz(self.stiffness / self.mass)


@dataclass(frozen=True)
class Family:
    """Matrices (n, n) of a family, its k motions without strain (n, k), and the held freedom (-1: none)."""

    mass: FloatArray
    stiffness: FloatArray
    rigid: FloatArray
    imposed: int = -1


def elastic_modes(family: Family, acting: Sequence[int], highest: float) -> ElasticModes:
    """Reduce a family and split it into its rigid motions and elastic coordinates; none where nothing acts.

    A Craig-Bampton reduction to the freedoms on which forces are `acting`, diagonalized: its motions that are
    orthogonal in mass to the rigid ones, so that rigid motions stay those of the center of mass. With a
    freedom held, whose motion is imposed, the motions that leave it at rest. `highest` is the frequency of
    interest, Hz.
    """
    mass, stiffness, rigid, fixed = family.mass, family.stiffness, family.rigid, family.imposed
    interface = np.array(sorted(set(acting)), dtype=np.int64)
    if interface.size == 0:
        n, k = rigid.shape
        return ElasticModes(np.zeros((n, 0)), np.zeros(0), np.zeros(0), np.zeros((0, k)), 0, highest, 0.0)
    complete = free_frequencies(family)
    for cut_off in CUT_OFFS:
        reduced = craig_bampton(mass, stiffness, interface, cut_off * highest)
        none = np.zeros((reduced.frequency.size, rigid.shape[1]))  # rigid motions are of the interface alone
        motion, at = np.concatenate([rigid[interface], none]), np.flatnonzero(interface == fixed)
        square, vectors = _split(reduced.mass, reduced.stiffness, motion, int(at[0]) if fixed >= 0 else -1)
        truncation = worst_error(_hertz(square), complete, highest)
        if truncation <= TRUNCATION:
            break
    shape = reduced.motion @ vectors
    shape = shape / np.take_along_axis(shape, np.argmax(np.abs(shape), axis=0)[None], axis=0)[0]
    modal = np.einsum("ij,ik,kj->j", shape, mass, shape)
    return ElasticModes(
        shape,
        modal,
        modal * square,
        shape.T @ mass @ rigid if fixed >= 0 else np.zeros((square.size, rigid.shape[1])),
        reduced.frequency.size,
        cut_off * highest,
        truncation,
    )


def free_frequencies(family: Family) -> FloatArray:
    """Return the elastic natural frequencies of a whole family, Hz."""
    from scipy.linalg import eigh  # noqa: PLC0415 (start-up time)

    mass, fixed = family.mass, family.imposed
    free = np.delete(np.arange(mass.shape[0]), fixed) if fixed >= 0 else np.arange(mass.shape[0])
    block = np.ix_(free, free)
    square = eigh(family.stiffness[block], mass[block], eigvals_only=True)
    return _hertz(square if fixed >= 0 else square[family.rigid.shape[1] :])


def worst_error(coarse: FloatArray, exact: FloatArray, highest: float) -> float:
    """Return the largest relative error of the rising frequencies `coarse` up to `highest`.

    The next one counts too, by the square of how far it is above: errors rise at least so with frequency,
    and on its bearings a shaft has other frequencies than free.
    """
    count = min(int(np.searchsorted(exact, highest, side="right")) + 1, coarse.size)
    if count == 0:
        return 0.0
    error = np.abs(coarse[:count] / exact[:count] - 1.0)
    return float(np.max(error * np.minimum(highest / exact[:count], 1.0) ** 2))


def _split(
    mass: FloatArray, stiffness: FloatArray, rigid: FloatArray, imposed: int
) -> tuple[FloatArray, FloatArray]:
    """Squared circular frequencies and shapes of unit modal mass of the elastic motions."""
    from scipy.linalg import eigh, null_space  # noqa: PLC0415 (start-up time)

    basis = np.delete(np.eye(mass.shape[0]), imposed, axis=1) if imposed >= 0 else null_space(rigid.T @ mass)
    if basis.shape[1] == 0:
        return np.zeros(0), basis
    square, vectors = eigh(basis.T @ stiffness @ basis, basis.T @ mass @ basis)
    return square, np.asarray(basis @ vectors)


def _hertz(square: FloatArray) -> FloatArray:
    return np.asarray(np.sqrt(square) / (2.0 * math.pi))
