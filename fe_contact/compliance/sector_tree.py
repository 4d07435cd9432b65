"""The elimination of one swept tooth sector down to its flank and its two cuts."""

from __future__ import annotations

import numpy as np

from fe_contact.compliance.elimination_tree import EliminationTree, elimination_tree
from fe_contact.mesh.swept_sector import SweptSector


def sector_tree(sector: SweptSector) -> EliminationTree:
    """Return the elimination that keeps loaded freedoms, left cut and right cut, in this order."""
    kept = np.concatenate([sector.loaded, sector.left, sector.right])
    free = sector.freedoms.max(axis=1) >= 0
    nodes = np.where(free[sector.elements], sector.elements, -1)
    return elimination_tree(nodes, sector.element_freedoms, sector.place, kept)
