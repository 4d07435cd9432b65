"""Static condensation of one sector by dense Cholesky fronts on its elimination tree; nothing sparse.

A front is the dense matrix in which one node of the tree eliminates its inner freedoms. Its border are the
freedoms that stay and couple to the parent; the matrix that is left on the border is its update. A front has
three blocks, stored by columns: `within` (inner, inner), `below` (border, inner), `rest` (border, border).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from fe_contact.compliance.elimination_tree import EliminationTree, Front
from fe_contact.compliance.front_assembly import add_elements, add_updates
from fe_contact.compliance.front_memory import FrontBlocks, FrontMemory
from fe_contact.compliance.sector_stiffness import ElementStiffness
from fe_contact.errors import SolveError
from fe_contact.types import FloatArray, IntArray
from host.optional_modules import linalg
from model_studies.progress import Report, unreported

NOTHING, NO_ROWS = np.zeros(0), np.zeros(0, dtype=np.int64)
"""Update, and its rows, in place of a child where a front has fewer than two."""


@dataclass(frozen=True)
class _FrontFactor:
    """The factors that recover the freedoms that a front eliminated: u_inner = -L^-T coupling' u_border."""

    front: Front
    factor: FloatArray
    """Lower Cholesky factor L of the inner freedoms; its upper triangle is undefined. Shape (i, i)."""
    coupling: FloatArray
    """Stiffness between border and inner freedoms times L^-T. Shape (b, i)."""


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
        """Return m vectors of all freedoms (n, m) from the kept ones (k, m), no force on the others."""
        u = np.zeros((self.size, values.shape[1]))
        u[self.retained] = values
        for part in self.factors:
            right = np.asfortranarray(part.coupling.T @ u[part.front.border])
            u[part.front.inner] = -linalg.blas.dtrsm(1.0, part.factor, right, lower=1, trans_a=1)
        return u


def condense(
    tree: EliminationTree, freedoms: IntArray, stiffness: ElementStiffness, report: Report = unreported
) -> tuple[FloatArray, Condensation]:
    """Eliminate all freedoms except those that `tree` keeps.

    Raises `SolveError`: the stiffness is not positive definite.

    Parameters
    ----------
    freedoms : (e, 60) int array
        Numbers of the 60 freedoms (20 nodes) of e elements, -1 where a freedom is fixed.
    report : callable
        Called after each front with the fraction of the operations done.

    Returns
    -------
    (k, k) array, Condensation
        Stiffness condensed on the kept freedoms, N/m, of which the lower triangle alone is valid; and the
        factors that recover all freedoms.
    """
    factors: list[_FrontFactor] = []
    done, total = 0.0, tree.operations

    def eliminate(front: Front, blocks: FrontBlocks) -> None:
        nonlocal done
        factors.append(_front_factor(front, blocks))
        done += front.operations
        report(done / total)

    work = _Work(tree.order, freedoms, stiffness, FrontMemory(tree), eliminate)
    kept = len(tree.root.border)
    matrix = _by_columns(_reduced(tree.root, work), kept, kept)
    return matrix, Condensation(tuple(factors[::-1]), tree.root.border, len(tree.order))


class _Work(NamedTuple):
    """Arrays that the elimination of every front reads; parameters of `condense`."""

    order: IntArray
    freedoms: IntArray
    stiffness: ElementStiffness
    memory: FrontMemory
    eliminate: Callable[[Front, FrontBlocks], None]


def _reduced(front: Front, work: _Work) -> FloatArray:
    """Return the update of a front, after those of its children.

    It is no closure of `condense`: a closure that calls itself is a cycle, and would keep all factors alive.
    """
    updates = [work.memory.put_update(child, _reduced(child, work)) for child in front.children]
    blocks = work.memory.blocks(front)
    _gather(front, blocks, updates, work)
    if len(front.inner):
        work.eliminate(front, blocks)
    return blocks.rest


def _gather(front: Front, blocks: FrontBlocks, updates: list[FloatArray], work: _Work) -> None:
    """Add the updates of the children and the elements to the blocks of a front.

    A front and its children are numbered in the order of elimination, so lower triangles of the children stay
    lower triangles in the front.
    """
    order = work.order
    numbers, count = np.concatenate([order[front.inner], order[front.border]]), len(front.inner)
    rows = [np.searchsorted(numbers, order[child.border]) for child in front.children]
    absent = 2 - len(rows)  # children that the binary tree lacks here
    first, second = updates + absent * [NOTHING]
    first_rows, second_rows = rows + absent * [NO_ROWS]
    add_updates(*blocks, first, first_rows, second, second_rows, count)
    if len(front.elements):
        freedoms = work.freedoms[front.elements]
        positions = np.where(freedoms >= 0, np.searchsorted(numbers, order[freedoms]), -1)
        stiffness = work.stiffness
        add_elements(*blocks, stiffness.matrices, stiffness.of_element[front.elements], positions, count)


def _front_factor(front: Front, blocks: FrontBlocks) -> _FrontFactor:
    """Factorise the inner freedoms of a front in place; the update is then in the block `rest`."""
    inner, border = len(front.inner), len(front.border)
    # LAPACK leaves the upper triangle as it was: rubbish that every later call must be told to ignore.
    factor, info = linalg.lapack.dpotrf(
        _by_columns(blocks.within, inner, inner), lower=1, overwrite_a=1, clean=0
    )
    if info:
        raise SolveError(f"tooth sector: stiffness is not positive definite (pivot {info})")
    below = _by_columns(blocks.below, border, inner)
    rest = _by_columns(blocks.rest, border, border)
    coupling = linalg.blas.dtrsm(1.0, factor, below, side=1, lower=1, trans_a=1, overwrite_b=1)
    linalg.blas.dsyrk(-1.0, coupling, beta=1.0, c=rest, lower=1, overwrite_c=1)
    return _FrontFactor(front, factor, coupling)


def _by_columns(block: FloatArray, rows: int, columns: int) -> FloatArray:
    """Return flat memory as a matrix, column by column."""
    return block.reshape(rows, columns, order="F")
