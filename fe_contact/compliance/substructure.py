"""Static condensation of one sector by dense Cholesky fronts on its elimination tree; nothing sparse."""

from __future__ import annotations

from dataclasses import dataclass

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
    """A sector seen from its kept freedoms.

    Attributes
    ----------
    matrix : (k, k) array
        Stiffness condensed on the kept freedoms, N/m, in Fortran order; the lower triangle is valid.
    factors : tuple of FrontFactor
        From the root down: parents before their children.
    kept : (k,) int array
        The kept freedoms.
    size : int
        Number of all freedoms.
    """

    matrix: FloatArray
    factors: tuple[_FrontFactor, ...]
    kept: IntArray
    size: int

    def expand(self, values: FloatArray) -> FloatArray:
        """Return all freedoms (n, m) from the kept ones (k, m), no force on the others."""
        u = np.zeros((self.size, values.shape[1]))
        u[self.kept] = values
        for part in self.factors:
            right = np.asfortranarray(part.coupling.T @ u[part.front.border])
            u[part.front.inner] = -blas.dtrsm(1.0, part.factor, right, lower=1, trans_a=1)
        return u


def condense(
    tree: EliminationTree, freedoms: IntArray, stiffness: ElementStiffness, report: Report = unreported
) -> Condensation:
    """Eliminate all freedoms but those `tree` keeps.

    Parameters
    ----------
    freedoms : (e, 60) int array
        Freedoms of the elements, -1 where held.
    report : callable
        Called after each front with the fraction of the operations done.

    Raises
    ------
    SolveError
        The stiffness is not positive definite.
    """
    factors: list[_FrontFactor] = []
    done, whole = 0.0, tree.operations

    def run(front: Front) -> FloatArray:
        nonlocal done
        parts = [run(child) for child in front.children]
        gathered = _gathered(front, parts, tree.order, freedoms, stiffness)
        if not len(front.inner):
            return gathered
        factor, coupling, rest = _eliminated(gathered, len(front.inner))
        factors.append(_FrontFactor(front, factor, coupling))
        done += front.operations
        report(done / whole)
        return rest

    matrix = run(tree.root)
    return Condensation(matrix, tuple(factors[::-1]), tree.root.border, len(tree.order))


def _gathered(
    front: Front, parts: list[FloatArray], order: IntArray, freedoms: IntArray, stiffness: ElementStiffness
) -> FloatArray:
    """Return the lower triangle of a front: inner freedoms first; `parts` is emptied.

    Both are numbered as they are eliminated, so lower triangles stay lower on the way up.
    """
    numbers = np.concatenate([order[front.inner], order[front.border]])
    matrix = np.zeros((len(numbers), len(numbers)), order="F")
    for child in front.children:
        _add_part(matrix, parts.pop(0), np.searchsorted(numbers, order[child.border]))
    if len(front.elements):
        own = freedoms[front.elements]
        positions = np.where(own >= 0, np.searchsorted(numbers, order[own]), -1)
        _add_elements(matrix, stiffness.matrices, stiffness.of_element[front.elements], positions)
    return matrix


def _eliminated(matrix: FloatArray, count: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Factorise the first `count` freedoms; return factor, coupling and what is left on the others."""
    # LAPACK leaves the upper triangle as it was: rubbish that every later call must be told to ignore.
    factor, info = lapack.dpotrf(np.asfortranarray(matrix[:count, :count]), lower=1, overwrite_a=1, clean=0)
    if info:
        raise SolveError(f"tooth sector: stiffness is not positive definite (pivot {info})")
    below = np.asfortranarray(matrix[count:, :count])
    coupling = blas.dtrsm(1.0, factor, below, side=1, lower=1, trans_a=1, overwrite_b=1)
    right = np.asfortranarray(matrix[count:, count:])
    return factor, coupling, blas.dsyrk(-1.0, coupling, beta=1.0, c=right, lower=1, overwrite_c=1)


@njit(cache=True)
def _add_part(matrix: FloatArray, part: FloatArray, rows: IntArray) -> None:
    for j in range(len(rows)):
        for i in range(j, len(rows)):
            matrix[rows[i], rows[j]] += part[i, j]


@njit(cache=True)
def _add_elements(matrix: FloatArray, pool: FloatArray, of_element: IntArray, rows: IntArray) -> None:
    """Add element matrices at rows `rows` (e, 60), lower triangle only; -1 is held."""
    for e in range(len(of_element)):
        local = pool[of_element[e]]
        for i in range(rows.shape[1]):
            for j in range(rows.shape[1]):
                if rows[e, j] >= 0 and rows[e, i] >= rows[e, j]:
                    matrix[rows[e, i], rows[e, j]] += local[i, j]
