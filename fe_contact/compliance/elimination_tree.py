"""Elimination tree of a body: the order of its freedoms by nested bisection, and its cost.

A front is a group of freedoms that are eliminated together. Its border are the freedoms that the elimination
couples; they pass to the parent of the front.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from fe_contact.mesh.swept_sector import SweptSector
from fe_contact.types import BoolArray, FloatArray, IntArray

LEAF = 16  # elements gathered in one front: fewer cost more interpreter time, more cost more operations
OFF_CENTER = (
    8.0  # a cut costs its shared nodes times 1 + 8 d^2; d: share of the elements on one side less 0.5
)


@dataclass(frozen=True)
class Front:
    """One group of elements."""

    elements: IntArray
    """Elements gathered here; empty if there are children."""
    children: tuple[Front, ...]
    """The halves of the group."""
    inner: IntArray
    border: IntArray
    """`inner`, `border`: Freedoms that the front eliminates, and freedoms that it passes to its parent, both
    by increasing position in the elimination.
    """

    @property
    def operations(self) -> float:
        """Multiplications with additions of its dense Cholesky factorization, triangular solve and update."""
        i, b = float(len(self.inner)), float(len(self.border))
        return i**3 / 6.0 + 0.5 * i * i * b + 0.5 * i * b * b

    @property
    def update_entries(self) -> int:
        """Numbers of the symmetric matrix that goes up."""
        return len(self.border) * (len(self.border) + 1) // 2

    def fronts(self) -> Iterator[Front]:
        """Yield all fronts, children before their parent."""
        for child in self.children:
            yield from child.fronts()
        yield self


@dataclass(frozen=True)
class EliminationTree:
    """The order of an elimination."""

    root: Front
    """Root of the tree. Its border holds the kept freedoms."""
    order: IntArray
    """Position of each freedom in the elimination; kept freedoms are last, in the order they were requested.
    Shape (n,).
    """

    @property
    def operations(self) -> float:
        """Multiplications with additions of all fronts."""
        return sum(front.operations for front in self.root.fronts())

    @property
    def factor_entries(self) -> int:
        """Numbers held by the factors."""
        return sum(len(f.inner) * (len(f.inner) + len(f.border)) for f in self.root.fronts())

    @property
    def front_entries(self) -> int:
        """Numbers copied in gathering the fronts."""
        return sum((len(f.inner) + len(f.border)) ** 2 for f in self.root.fronts())

    @property
    def largest_border(self) -> int:
        """Most freedoms that go up from one front."""
        return max(len(front.border) for front in self.root.fronts())

    @property
    def waiting_entries(self) -> int:
        """Most numbers of updates that wait for their parents at a time."""
        return _waiting(self.root)

    def working_entries(self) -> int:
        """Largest number of entries in memory at one time: fronts and their results, without factors."""
        return _working(self.root)


def _working(front: Front) -> int:
    """Return the peak of one front: its children's results wait for it."""
    peak = borders = 0
    for child in front.children:
        peak = max(peak, borders + _working(child))
        borders += len(child.border) ** 2
    inner, border = len(front.inner), len(front.border)
    return max(peak, borders + inner * (inner + border) + border**2)


def _waiting(front: Front) -> int:
    """Return the most numbers of updates that wait below a front; its own then takes their place."""
    peak = waiting = 0
    for child in front.children:
        peak = max(peak, waiting + max(_waiting(child), child.update_entries))
        waiting += child.update_entries
    return peak


def bisected_tree(
    nodes: IntArray, freedoms: IntArray, position: FloatArray, retained: IntArray, leaf: int = LEAF
) -> EliminationTree:
    """Bisect the elements along grid lines and eliminate every freedom as soon as it is complete.

    Elements have `nodes` (e, p), -1 where nothing is free, `freedoms` (e, q) of 0 .. n - 1, -1 where
    held, and a `position` (e, d) on the logical grid. Freedoms `retained` are not eliminated; `leaf` is the
    most elements gathered in one front.
    """
    builder = _Builder(nodes, freedoms, position, retained, leaf)
    draft = builder.build(np.arange(len(nodes)))
    builder.order[retained] = builder.done + np.arange(len(retained))
    return EliminationTree(_sorted_front(draft, builder.order), builder.order)


@dataclass(frozen=True)
class _Draft:
    """A front before the whole order is known; `count` says in how many elements border freedoms occurred."""

    elements: IntArray
    children: tuple[_Draft, ...]
    inner: IntArray
    border: IntArray
    count: IntArray


def _sorted_front(draft: _Draft, order: IntArray) -> Front:
    border = draft.border[np.argsort(order[draft.border])]
    return Front(draft.elements, tuple(_sorted_front(c, order) for c in draft.children), draft.inner, border)


class _Builder:
    """Counts occurrences of freedoms while the tree grows."""

    def __init__(
        self, nodes: IntArray, freedoms: IntArray, position: FloatArray, retained: IntArray, leaf: int
    ) -> None:
        self.nodes, self.freedoms, self.leaf = nodes, freedoms, leaf
        self.occurrences = np.bincount(freedoms[freedoms >= 0])
        self.occurrences[retained] += 1  # never complete
        self.order = np.full(len(self.occurrences), -1)
        self.done = 0
        self._seen = np.zeros((2, nodes.max() + 2), dtype=bool)  # the last for -1
        self._lines = [np.unique(along, return_inverse=True)[1].ravel() for along in position.T]

    def build(self, group: IntArray) -> _Draft:
        """Return the front of a group of elements and number what it eliminates."""
        children = tuple(map(self.build, self._halves(group))) if len(group) > self.leaf else ()
        if children:
            freedoms, inverse = np.unique(np.concatenate([c.border for c in children]), return_inverse=True)
            count = np.bincount(inverse, np.concatenate([c.count for c in children])).astype(np.int64)
        else:
            in_group = self.freedoms[group]
            freedoms, count = np.unique(in_group[in_group >= 0], return_counts=True)
        complete = count == self.occurrences[freedoms]
        inner = freedoms[complete]
        self.order[inner] = self.done + np.arange(len(inner))
        self.done += len(inner)
        elements = group[:0] if children else group  # the elements of a group with children are theirs
        return _Draft(elements, children, inner, freedoms[~complete], count[~complete])

    def _halves(self, group: IntArray) -> tuple[IntArray, IntArray]:
        """Cut a group along the grid line that leaves few shared nodes and nearly equal halves."""
        cuts: list[tuple[float, int, BoolArray]] = []
        for lines in self._lines:
            line = lines[group]
            count = np.bincount(line)
            values = np.flatnonzero(count)
            if len(values) < 2:
                continue
            share = np.cumsum(count[values])[:-1] / len(group)
            i = int(np.argmin(np.abs(share - 0.5)))
            low = line <= values[i]
            shared = self._shared(group[low], group[~low])
            cuts.append((shared * (1.0 + OFF_CENTER * (share[i] - 0.5) ** 2), len(cuts), low))
        _, _, low = min(cuts, key=lambda cut: cut[:2])  # of equal costs the first
        return group[low], group[~low]

    def _shared(self, group: IntArray, other: IntArray) -> int:
        self._seen[:] = False
        in_group, in_other = self._seen
        in_group[self.nodes[group]] = in_other[self.nodes[other]] = True
        return int(np.count_nonzero(in_group[:-1] & in_other[:-1]))


def sector_tree(sector: SweptSector) -> EliminationTree:
    """Return the elimination that keeps loaded freedoms, left cut and right cut, in this order."""
    retained = np.concatenate([sector.loaded, sector.left, sector.right])
    free = sector.freedoms.max(axis=1) >= 0
    nodes = np.where(free[sector.elements], sector.elements, -1)
    return bisected_tree(nodes, sector.element_freedoms, sector.grid_cell, retained)
