"""Supports of the bore of a gear."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from fe_contact.body import CLAMPED, ROUNDING, BoreSeat
from fe_contact.geometry import Toothing
from fe_contact.mesh.sector_grid import SectorGrid
from fe_contact.types import BoolArray, FloatArray


class BoreSupport(Protocol):
    """Support of the bore: the fixed freedoms and the seat of a sector, the same in all sectors."""

    @property
    def name(self) -> str:
        """Name for cache keys and the receipt."""

    @property
    def seat(self) -> BoreSeat:
        """Seat of the bore.

        Where its stiffness is finite, elements lie on the bore. Groups of layers end at the ends of the seat.
        """

    def constrained(self, grid: SectorGrid, z: FloatArray) -> BoolArray:
        """Return which components (radial, tangential, axial) are fixed, (planes, n, 3); `z` (planes,), m."""


@dataclass(frozen=True)
class ClampedBore:
    """The whole bore is fixed."""

    name: str = "clamped bore"
    seat: BoreSeat = CLAMPED

    def constrained(self, grid: SectorGrid, z: FloatArray) -> BoolArray:
        """Hold all components on the bore."""
        fixed = np.zeros((len(z), grid.nodes, 3), dtype=bool)
        fixed[:, grid.bore] = True
        return fixed


@dataclass(frozen=True)
class PlaneStrain:
    """The whole bore is fixed, and no point of the gear moves along the axis; for spur gears."""

    name: str = "clamped bore, plane strain"
    seat: BoreSeat = CLAMPED

    def constrained(self, grid: SectorGrid, z: FloatArray) -> BoolArray:
        """Hold all components on the bore and the axial one everywhere."""
        fixed = ClampedBore().constrained(grid, z)
        fixed[..., 2] = True
        return fixed


@dataclass(frozen=True)
class _SeatedBore:
    """The bore is fixed over the length of its seat, where the seat is rigid; `face_width` in m."""

    seat: BoreSeat
    face_width: float

    @property
    def name(self) -> str:
        """Text of all fields of the seat, for cache keys."""
        return f"seat {json.dumps(self.seat.content(), sort_keys=True)}"

    def constrained(self, grid: SectorGrid, z: FloatArray) -> BoolArray:
        """Hold the rigid directions on the planes from one end of the seat to the other."""
        low, high = self.seat.ends(self.face_width)
        rounding = ROUNDING * self.face_width
        planes = np.flatnonzero((z > low - rounding) & (z < high + rounding))
        fixed = np.zeros((len(z), grid.nodes, 3), dtype=bool)
        fixed[planes[:, None], grid.bore] = np.isinf(self.seat.stiffness)
        return fixed


def bore_support(gear: Toothing) -> BoreSupport:
    """Return the support of the bore of a gear: clamped, or by its seat."""
    return ClampedBore() if gear.seat == CLAMPED else _SeatedBore(gear.seat, gear.face_width)
