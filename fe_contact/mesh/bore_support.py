"""How the bore of a gear is held: choices as objects."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from fe_contact.mesh.sector_grid import SectorGrid
from fe_contact.types import BoolArray


class BoreSupport(Protocol):
    """Decides which freedoms of a tooth sector are held; the same in every sector.

    A bore that is seated over part of its width holds fewer planes. An elastic seat would hold nothing here
    and add its stiffness to the freedoms of `SectorGrid.bore` where the sector is assembled. A single key is
    not the same in every sector: it needs all harmonics of the ring at once.
    """

    @property
    def name(self) -> str:
        """Name for cache keys and the receipt."""

    def held(self, grid: SectorGrid, planes: int) -> BoolArray:
        """Return which components (radial, tangential, axial) are held, (planes, n, 3)."""


@dataclass(frozen=True)
class ClampedBore:
    """The whole bore is fixed."""

    name: str = "clamped bore"

    def held(self, grid: SectorGrid, planes: int) -> BoolArray:
        """Hold all components on the bore."""
        held = np.zeros((planes, grid.nodes, 3), dtype=bool)
        held[:, grid.bore] = True
        return held


@dataclass(frozen=True)
class PlaneStrain:
    """The whole bore is fixed, and no point of the gear moves along the axis; for spur gears."""

    name: str = "clamped bore, plane strain"

    def held(self, grid: SectorGrid, planes: int) -> BoolArray:
        """Hold all components on the bore and the axial one everywhere."""
        held = ClampedBore().held(grid, planes)
        held[..., 2] = True
        return held
