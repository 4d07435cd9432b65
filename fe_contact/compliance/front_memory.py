"""Memory of the fronts of one elimination, whose sizes follow from its tree.

All fronts share three arrays (factors, border block, updates), so that the system clears fresh memory once
and not again for every front. Within `shared_factors` the array of the factors serves one elimination after
the other: fresh memory has to be cleared, and a virtual machine first gets it from its host, at ten times the
cost.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import NamedTuple

import numpy as np

from fe_contact.compliance.elimination_tree import EliminationTree, Front
from fe_contact.compliance.front_assembly import pack
from fe_contact.types import FloatArray

_UNUSED = 3
"""References to a shared array of which no view is in use: its list, the local name, and the argument of
`sys.getrefcount`.
"""
_SPARE = 1.25
"""Size of a shared array over that of the first factors in it: the next may be a little larger. Memory that
nobody writes to is neither cleared nor counted.
"""
_shared: ContextVar[list[FloatArray] | None] = ContextVar("shared", default=None)
"""List of the one array for factors that eliminations of this context share; None: they share none."""


@contextmanager
def shared_factors() -> Iterator[None]:
    """Let each elimination within take the memory of the factors of the one before, once these are deleted.

    The memory is freed at the end. It is allocated once if none is much larger than the first.
    """
    token = _shared.set([])
    try:
        yield
    finally:
        _shared.reset(token)


def _factor_memory(size: int) -> FloatArray:
    """Return memory of `size` numbers, not initialized."""
    shared = _shared.get()
    if shared is None:
        return np.empty(size)
    for piece in shared:
        if piece.size >= size and sys.getrefcount(piece) <= _UNUSED:
            return piece[:size]
    shared.clear()
    shared.append(np.empty(round(_SPARE * size)))
    return shared[0][:size]


class FrontBlocks(NamedTuple):
    """Lower triangle of a front by blocks, flat and column by column; not initialized at first."""

    within: FloatArray
    """Block of the i inner freedoms of a front, i * i numbers."""
    below: FloatArray
    """Block of the b border freedoms by the inner ones, b * i numbers."""
    rest: FloatArray
    """Block of the border freedoms, b * b numbers: its Schur complement goes up to the parent front."""


class FrontMemory:
    """Memory for the fronts of a tree, each parent after its children.

    Factors lie behind each other and stay. All fronts use the same memory for what is left; from there its
    lower triangle goes on a stack of updates, where a parent finds those of its children on top. What is left
    of the root stays where it is.
    """

    def __init__(self, tree: EliminationTree) -> None:
        self._factors = _factor_memory(tree.factor_entries)
        self._factored = 0  # numbers of factors so far
        self._rest = np.empty(tree.largest_border**2)
        self._updates = np.empty(tree.waiting_entries)
        self._waiting = 0  # numbers of updates on the stack

    def blocks(self, front: Front) -> FrontBlocks:
        """Return the blocks of the next front."""
        inner, border = len(front.inner), len(front.border)
        begin, middle = self._factored, self._factored + inner * inner
        self._factored = middle + border * inner
        factors = self._factors[begin:middle], self._factors[middle : self._factored]
        return FrontBlocks(*factors, self._rest[: border**2])

    def put_update(self, front: Front, rest: FloatArray) -> FloatArray:
        """Put what is left of a front in the place of its children's updates; return its update."""
        self._waiting -= sum(child.update_entries for child in front.children)
        update = self._updates[self._waiting : self._waiting + front.update_entries]
        pack(rest, update)
        self._waiting += front.update_entries
        return update
