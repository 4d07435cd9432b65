"""The logical T-shaped grid of one tooth sector: a tooth standing in the middle of the body below it.

A sector is one pitch of the gear, from the middle of a tooth space to the middle of the next. The body lies
below the split point, at which the flank starts; the land is the part of the body's upper edge beside the
tooth. Column 0 is the right end, row 0 the bore (of a ring gear: the outside of its rim). An element spans
three rows and three columns of the grid of nodes. Axes of arrays: m elements, n nodes.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fe_contact.types import BoolArray, IntArray

# (row, column) in the grid of nodes of the eight nodes of an element, from its first row and column: corners
# 0 to 3, then the middles of the sides 0-1, 1-2, 2-3, 3-0. They run counter-clockwise, as the columns run
# from right to left.
OFFSETS = np.array([(0, 2), (0, 0), (2, 0), (2, 2), (0, 1), (1, 0), (2, 1), (1, 2)])
# The same for a ring gear, whose rows run towards the center. The side 0-1 is the one to the body, too.
INWARD_OFFSETS = np.array([(0, 0), (0, 2), (2, 2), (2, 0), (0, 1), (1, 2), (2, 1), (1, 0)])


@dataclass(frozen=True)
class SectorGrid:
    """Eight-node quadrilaterals on a T-shaped grid, from one mid space to the next."""

    body_rows: int
    tooth_rows: int
    """`body_rows`, `tooth_rows`: Rows of elements from the bore to the split point, and on to the tip."""
    land: int
    """Columns of elements of the land on each side of the tooth."""
    across: int
    """Columns of elements across the tooth."""
    inward: bool = False
    """Whether the tooth points to the gear's center: the rows then run from the rim's outside inwards."""
    web_rows: tuple[int, int] = (0, 0)
    """First row of the web, and first row of the rim above it, counted as in `cells`; equal: no web."""

    @property
    def columns(self) -> int:
        """Columns of elements of the body."""
        return self.across + 2 * self.land

    @cached_property
    def cells(self) -> IntArray:
        """Column and row of each element, (m, 2).

        Rows count from the split point: those of the body are negative, those of the tooth start at 0.
        """
        body = [(i, j) for j in range(-self.body_rows, 0) for i in range(self.columns)]
        tooth = [(self.land + i, j) for j in range(self.tooth_rows) for i in range(self.across)]
        return np.array(body + tooth)

    @property
    def web(self) -> BoolArray:
        """Whether an element belongs to the web, (m,)."""
        row = self.cells[:, 1]
        return np.asarray((row >= self.web_rows[0]) & (row < self.web_rows[1]))

    @cached_property
    def _grid_index(self) -> IntArray:
        """Index of each element's nodes in the flattened grid of nodes, (m, 8)."""
        # first column and row of the element: two per element, rows from the bore
        low = 2 * (self.cells + np.array([0, self.body_rows]))
        offsets = INWARD_OFFSETS if self.inward else OFFSETS
        row = low[:, 1, None] + offsets[:, 0]
        return np.asarray(row * (2 * self.columns + 1) + low[:, 0, None] + offsets[:, 1])

    @cached_property
    def number(self) -> IntArray:
        """Number of the node at each point of the grid of nodes, (2 rows + 1, 2 columns + 1); -1: no node."""
        number = np.full((2 * (self.body_rows + self.tooth_rows) + 1, 2 * self.columns + 1), -1)
        used = np.unique(self._grid_index)
        number.flat[used] = np.arange(len(used))
        return number

    @cached_property
    def quads(self) -> IntArray:
        """Nodes of each element, (m, 8): corners counter-clockwise, middles of sides 0-1, 1-2, 2-3, 3-0."""
        return np.asarray(self.number.ravel()[self._grid_index])

    @property
    def nodes(self) -> int:
        """Number of nodes."""
        return int(self.number.max()) + 1

    @cached_property
    def corner(self) -> BoolArray:
        """Whether a node is a corner of an element, not the middle of a side, (n,)."""
        corner = np.zeros(self.nodes, dtype=bool)
        corner[self.quads[:, :4]] = True
        return corner

    @property
    def right(self) -> IntArray:
        """Nodes of the right cut between two sectors, from the bore to the root."""
        return self.number[: 2 * self.body_rows + 1, 0]

    @property
    def left(self) -> IntArray:
        """Nodes of the left cut from the bore to the root: the right ones of the next sector."""
        return self.number[: 2 * self.body_rows + 1, -1]

    @property
    def bore(self) -> IntArray:
        """Nodes on the bore, or on the outside of a ring gear's rim."""
        return np.asarray(self.number[0])

    @property
    def flank(self) -> IntArray:
        """Nodes of the right flank from the split point to the tip."""
        return self.number[2 * self.body_rows :, 2 * self.land]
