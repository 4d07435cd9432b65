"""Reduction of an elastic body to its interface and a few modes: Craig and Bampton.

The *interface* are the a freedoms on which forces act. *Fixed-interface modes* are the natural modes with the
interface at rest. A *family* is a set of freedoms of a shaft that is uncoupled from the others: bending in
one plane, torsion, or tension. Its *imposed* freedom, if it has one, follows a given motion.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dynamics.checks import positive
from dynamics.errors import InputError
from dynamics.types import FloatArray, IntArray

CUT_OFFS = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0)
"""Multiples of the highest frequency of interest up to which fixed-interface modes are kept: the first one
that meets `TRUNCATION` is taken."""
TRUNCATION = 0.01
"""Largest relative error of the frequencies of interest."""
SINGULAR = 1e-12
"""Least eigenvalue over the largest one at which the interface holds the body."""


@dataclass(frozen=True)
class _ReducedBody:
    """A body in a + b freedoms: the interface, then amplitudes of b fixed-interface modes of unit mass."""

    motion: FloatArray
    """Motion of the n freedoms of the body per reduced freedom. Shape (n, a + b)."""
    mass: FloatArray
    stiffness: FloatArray
    """`mass`, `stiffness`: Reduced matrices. Shape (a + b, a + b) each."""
    frequency: FloatArray
    """Frequencies of the fixed-interface modes, Hz. Shape (b,)."""


def craig_bampton(
    mass: FloatArray, stiffness: FloatArray, interface: IntArray, highest: float
) -> _ReducedBody:
    """Reduce a body (Craig and Bampton, AIAA Journal 6 (1968) 1313-1319).

    The motion inside is the static motion by the interface plus the fixed-interface modes up to a frequency.
    Static motion under forces on the interface is exact, and so are rigid motions. Natural frequencies are
    never below the exact ones and approach them as modes are added. Raises `InputError`: the interface
    repeats freedoms or does not hold the body, or `highest` is not above zero.

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
    if square.size and square[0] <= SINGULAR * square[-1]:
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
    """Coordinates e_j of b uncoupled elastic motions: m_j e_j'' + k_j e_j = forces times shape j."""

    shape: FloatArray
    """Motion of the family's freedoms per coordinate; its largest entry is 1. Shape (n, b)."""
    mass: FloatArray
    stiffness: FloatArray
    """`mass`, `stiffness`: Modal: kg and N/m, of torsion kg m^2 and N m/rad. Shape (b,) each."""
    inertial: FloatArray
    """Coupling in the mass matrix with the k rigid motions: zero without an imposed freedom. Shape (b, k)."""
    fixed: int
    """Number of fixed-interface modes from which the coordinates are made."""
    limit: float
    """The frequency up to which fixed-interface modes were kept, Hz."""
    truncation: float
    """Estimate of the largest relative error of the frequencies of interest, of the free body against the
    whole beam. In a mechanism the error may be somewhat larger.
    """

    @property
    def frequency(self) -> FloatArray:
        """Natural frequencies of the free body, or of the body with its imposed freedom at rest, Hz."""
        return _hertz(self.stiffness / self.mass)


@dataclass(frozen=True)
class Family:
    """Matrices and rigid motions of a family of n freedoms."""

    mass: FloatArray
    stiffness: FloatArray
    """`mass`, `stiffness`: Symmetric. Shape (n, n) each."""
    rigid: FloatArray
    """The k motions without strain. Shape (n, k)."""
    imposed: int = -1
    """Index of the imposed freedom; -1: none."""


def elastic_modes(family: Family, acting: Sequence[int], highest: float) -> ElasticModes:
    """Return the elastic coordinates of a family besides its rigid motions; none where no force acts.

    The family is reduced (Craig-Bampton) to the freedoms on which forces are `acting`, and diagonalized. The
    coordinates are orthogonal in mass to the rigid motions, which stay those of the center of mass. With an
    imposed freedom the coordinates leave it at rest. `highest` is the highest frequency of interest, Hz.
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
    # each column over its largest entry
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

    The first frequency above counts too, times (highest / frequency)^2: errors grow at least with the square
    of the frequency, and on its bearings a shaft has other frequencies than the free one.
    """
    count = min(int(np.searchsorted(exact, highest, side="right")) + 1, coarse.size)
    if count == 0:
        return 0.0
    error = np.abs(coarse[:count] / exact[:count] - 1.0)
    return float(np.max(error * np.minimum(highest / exact[:count], 1.0) ** 2))


def _split(
    mass: FloatArray, stiffness: FloatArray, rigid: FloatArray, imposed: int
) -> tuple[FloatArray, FloatArray]:
    """Return squared circular frequencies and shapes of unit modal mass of the elastic motions."""
    from scipy.linalg import eigh, null_space  # noqa: PLC0415 (start-up time)

    basis = np.delete(np.eye(mass.shape[0]), imposed, axis=1) if imposed >= 0 else null_space(rigid.T @ mass)
    if basis.shape[1] == 0:
        return np.zeros(0), basis
    square, vectors = eigh(basis.T @ stiffness @ basis, basis.T @ mass @ basis)
    return square, np.asarray(basis @ vectors)


def _hertz(square: FloatArray) -> FloatArray:
    return np.asarray(np.sqrt(square) / (2.0 * math.pi))
