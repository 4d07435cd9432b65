"""Static condensation of one sector by dense Cholesky fronts on its elimination tree; nothing sparse."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.linalg import blas, lapack

from fe_contact.compliance.elimination_tree import EliminationTree, Front
from fe_contact.compliance.sector_stiffness import ElementStiffness
from fe_contact.errors import SolveError
from fe_contact.types import FloatArray, IntArray
from host.loops import njit
from model_studies.progress import Report, unreported


@dataclass(frozen=True)
class _FrontFactor:
    """The factors that recover the freedoms a front eliminated: u_inner = -L^-T coupling' u_border."""

    front: Front
    factor: FloatArray
    coupling: FloatArray


@dataclass(frozen=True)
class Condensation:
    """Static condensation of a sector: recovers all freedoms from the kept ones."""

    factors: tuple[_FrontFactor, ...]
    """Factors of the fronts from the root down: parents before their children."""
    retained: IntArray
    """Numbers of the kept freedoms. Shape (k,)."""
    size: int
    """Number of all freedoms."""

    def expand(self, values: FloatArray) -> FloatArray:
        """Return all freedoms (n, m) from the kept ones (k, m), no force on the others."""
        u = np.zeros((self.size, values.shape[1]))
        u[self.retained] = values
        for part in self.factors:
            right = np.asfortranarray(part.coupling.T @ u[part.front.border])
            u[part.front.inner] = -blas.dtrsm(1.0, part.factor, right, lower=1, trans_a=1)
        return u


def condense(
    tree: EliminationTree, freedoms: IntArray, stiffness: ElementStiffness, report: Report = unreported
) -> tuple[FloatArray, Condensation]:
    """Eliminate all freedoms except those that `tree` keeps.

    Raises `SolveError`: the stiffness is not positive definite.

    Parameters
    ----------
    freedoms : (e, 60) int array
        Freedoms of the elements, -1 where held.
    report : callable
        Called after each front with the fraction of the operations done.

    Returns
    -------
    (k, k) array, Condensation
        Stiffness condensed on the kept freedoms, N/m, whose lower triangle is valid, and how others follow.
    """
    factors: list[_FrontFactor] = []
    done, total = 0.0, tree.operations

    def eliminate(front: Front, gathered: _Gathered) -> None:
        nonlocal done
        factors.append(_FrontFactor(front, *_eliminated(gathered)))
        done += front.operations
        report(done / total)

    matrix = _reduced(tree.root, tree.order, freedoms, stiffness, eliminate)
    return matrix, Condensation(tuple(factors[::-1]), tree.root.border, len(tree.order))


def _reduced(
    front: Front,
    order: IntArray,
    freedoms: IntArray,
    stiffness: ElementStiffness,
    eliminate: Callable[[Front, _Gathered], None],
) -> FloatArray:
    """Return what a front passes up; no closure that calls itself, which would keep all factors alive."""
    parts = [_reduced(child, order, freedoms, stiffness, eliminate) for child in front.children]
    gathered = _gathered(front, parts, order, freedoms, stiffness)
    if len(front.inner):
        eliminate(front, gathered)
    return gathered.rest


class _Gathered(NamedTuple):
    """A front by blocks: inner freedoms (i, i), border by inner ones (b, i), rest (b, b), lower triangles.

    Each is an array of its own, so that BLAS works in its place.
    """

    inner: FloatArray
    below: FloatArray
    rest: FloatArray


def _gathered(
    front: Front, parts: list[FloatArray], order: IntArray, freedoms: IntArray, stiffness: ElementStiffness
) -> _Gathered:
    """Return a front; `parts` is emptied.

    Both are numbered as they are eliminated, so lower triangles stay lower on the way up.
    """
    numbers, count = np.concatenate([order[front.inner], order[front.border]]), len(front.inner)
    sizes = (count, count), (len(numbers) - count, count), (len(numbers) - count,) * 2
    blocks = _Gathered(*(np.zeros(size, order="F") for size in sizes))
    for child in front.children:
        _add_part(blocks, parts.pop(0), np.searchsorted(numbers, order[child.border]))
    if len(front.elements):
        numbers_of_elements = freedoms[front.elements]
        positions = np.where(
            numbers_of_elements >= 0, np.searchsorted(numbers, order[numbers_of_elements]), -1
        )
        _add_elements(blocks, stiffness.matrices, stiffness.of_element[front.elements], positions)
    return blocks


def _eliminated(front: _Gathered) -> tuple[FloatArray, FloatArray]:
    """Factorise the inner freedoms of a front; return factor and coupling. What is left is in its rest."""
    # LAPACK leaves the upper triangle as it was: rubbish that every later call must be told to ignore.
    factor, info = lapack.dpotrf(front.inner, lower=1, overwrite_a=1, clean=0)
    if info:
        raise SolveError(f"tooth sector: stiffness is not positive definite (pivot {info})")
    coupling = blas.dtrsm(1.0, factor, front.below, side=1, lower=1, trans_a=1, overwrite_b=1)
    blas.dsyrk(-1.0, coupling, beta=1.0, c=front.rest, lower=1, overwrite_c=1)
    return factor, coupling


@njit(cache=True)
def _add_part(front: _Gathered, part: FloatArray, rows: IntArray) -> None:
    count = len(front.inner)
    first = np.searchsorted(rows, count)
    for j in range(first):
        for i in range(j, first):
            front.inner[rows[i], rows[j]] += part[i, j]
        for i in range(first, len(rows)):
            front.below[rows[i] - count, rows[j]] += part[i, j]
    for j in range(first, len(rows)):
        for i in range(j, len(rows)):
            front.rest[rows[i] - count, rows[j] - count] += part[i, j]


@njit(cache=True)
def _add_elements(front: _Gathered, pool: FloatArray, of_element: IntArray, rows: IntArray) -> None:
    """Add element matrices at rows `rows` (e, 60), lower triangle only; -1 is held."""
    count = len(front.inner)
    for e in range(len(of_element)):
        local = pool[of_element[e]]
        for i in range(rows.shape[1]):
            for j in range(rows.shape[1]):
                row, column = rows[e, i], rows[e, j]
                if column < 0 or row < column:
                    continue
                if row < count:
                    front.inner[row, column] += local[i, j]
                elif column < count:
                    front.below[row - count, column] += local[i, j]
                else:
                    front.rest[row - count, column - count] += local[i, j]
