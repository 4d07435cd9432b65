"""One family of elastic motions of a shaft (bending in a plane, torsion, extension), reduced."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from dynamics.checks import positive
from dynamics.errors import InputError
from dynamics.types import FloatArray, IntArray

# Reduction of an elastic body to its interface and a few modes: Craig and Bampton.


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


CUT_OFFS = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0)
"""Up to which multiple of the frequency of interest modes with the interface held may be kept."""
TRUNCATION = 0.01
"""Relative error of the frequencies of interest at which enough of them are kept."""


@dataclass(frozen=True)
class ElasticModes:
    """Coordinates e_j of b uncoupled elastic motions: m_j e_j'' + k_j e_j = what forces do on their shapes.

    Attributes
    ----------
    shape : (n, b) array
        Freedoms of the family per coordinate; the largest displacement (rotation) is 1.
    mass, stiffness : (b,) arrays
        Modal: kg and N/m, of torsion kg m^2 and N m/rad.
    inertial : (b, k) array
        Coupling in the mass matrix with the k rigid motions: zero unless the rigid motion is that of a
        held freedom.
    fixed : int
        Number of modes with the interface held among what they are made of.
    limit : float
        The frequency up to which these were kept, Hz.
    truncation : float
        Estimate of the largest relative error of frequencies up to the one of interest: that of the free
        body against the whole beam. Attached to others it may have somewhat more.
    """

    shape: FloatArray
    mass: FloatArray
    stiffness: FloatArray
    inertial: FloatArray
    fixed: int
    limit: float
    truncation: float

    @property
    def frequency(self) -> FloatArray:
        """Of the free body, or of that with its held freedom at rest, Hz."""
        return _hertz(self.stiffness / self.mass)


def elastic_modes(
    mass: FloatArray,
    stiffness: FloatArray,
    rigid: FloatArray,
    interface: IntArray,
    highest: float,
    held: int = -1,
) -> ElasticModes:
    """Reduce a family and split it into its rigid motions and elastic coordinates.

    A Craig-Bampton reduction to the freedoms `interface`, diagonalized: its motions that are orthogonal in
    mass to the rigid ones, so that rigid motions stay those of the center of mass. With a freedom `held`,
    whose motion is imposed, the motions that leave it at rest.

    Parameters
    ----------
    mass, stiffness : (n, n) arrays
    rigid : (n, k) array
        Motions without strain.
    interface : (a,) int array
        Freedoms where forces act.
    highest : float
        Frequency of interest, Hz.
    held : int
        One of the interface, or -1.
    """
    whole = free_frequencies(mass, stiffness, rigid.shape[1], held)
    for cut_off in CUT_OFFS:
        reduced = craig_bampton(mass, stiffness, interface, cut_off * highest)
        square, vectors = _of_reduced(reduced, rigid, interface, held)
        truncation = worst_error(_hertz(square), whole, highest)
        if truncation <= TRUNCATION:
            break
    shape = reduced.motion @ vectors
    shape = shape / _largest(shape)
    modal = np.einsum("ij,ik,kj->j", shape, mass, shape)
    return ElasticModes(
        shape,
        modal,
        modal * square,
        shape.T @ mass @ rigid if held >= 0 else np.zeros((square.size, rigid.shape[1])),
        reduced.frequency.size,
        cut_off * highest,
        truncation,
    )


def free_frequencies(mass: FloatArray, stiffness: FloatArray, rigid: int, held: int = -1) -> FloatArray:
    """Return the elastic natural frequencies of a whole family of `rigid` motions without strain, Hz."""
    from scipy.linalg import eigh  # noqa: PLC0415 (start-up time)

    kept = np.delete(np.arange(mass.shape[0]), held) if held >= 0 else np.arange(mass.shape[0])
    own = np.ix_(kept, kept)
    square = eigh(stiffness[own], mass[own], eigvals_only=True)
    return _hertz(square if held >= 0 else square[rigid:])


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


def _of_reduced(
    reduced: ReducedBody, rigid: FloatArray, interface: IntArray, held: int
) -> tuple[FloatArray, FloatArray]:
    """Squared circular frequencies and shapes of a reduced body: rigid motions are those of its interface."""
    none = np.zeros((reduced.frequency.size, rigid.shape[1]))
    held_index = int(np.flatnonzero(interface == held)[0]) if held >= 0 else -1
    return _split(reduced.mass, reduced.stiffness, np.concatenate([rigid[interface], none]), held_index)


def _split(
    mass: FloatArray, stiffness: FloatArray, rigid: FloatArray, held: int
) -> tuple[FloatArray, FloatArray]:
    """Squared circular frequencies and shapes of unit modal mass of the elastic motions."""
    from scipy.linalg import eigh, null_space  # noqa: PLC0415 (start-up time)

    basis = np.delete(np.eye(mass.shape[0]), held, axis=1) if held >= 0 else null_space(rigid.T @ mass)
    if basis.shape[1] == 0:
        return np.zeros(0), basis
    square, vectors = eigh(basis.T @ stiffness @ basis, basis.T @ mass @ basis)
    return square, np.asarray(basis @ vectors)


def _largest(shape: FloatArray) -> FloatArray:
    """Return the entry of largest size of each column, with its sign."""
    if shape.shape[1] == 0:
        return np.ones(0)
    return np.asarray(np.take_along_axis(shape, np.argmax(np.abs(shape), axis=0)[None], axis=0)[0])


def _hertz(square: FloatArray) -> FloatArray:
    return np.asarray(np.sqrt(square) / (2.0 * math.pi))
