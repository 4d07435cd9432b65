"""The free-form flank of a case: modifications that have no field, at the nodes of a grid.

A modification is a law of the removed material over the roll length and the face coordinate of the REXS file,
which counts from its datum face. Its *kinks* are the roll lengths and face coordinates at which its slope
jumps. A case has face positions from the middle of the face.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fe_contact.geometry import FlankGrid
from fe_contact.types import FloatArray
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.from_rexs.flank_modification import Modification, PlainFlank
from lineofaction.gearbox.from_rexs.gear_unit import rounded
from lineofaction.gearbox.units import MM, UM

COUNTS = (17, 33, 65, 129)
"""Lines of a grid in either direction: the first one whose error is below `ALLOWED_DIFFERENCE` is taken."""

ALLOWED_DIFFERENCE = 0.05e-6  # error of a grid, m: a tenth of the resolution of a gear measuring machine

_FLAT = 1e-3  # variation over the allowed difference below which the sum does not vary in a direction

_SAMPLE = 65  # points each way at which the sum is sampled for its variation

_BETWEEN = 4  # parts of an interval between two nodes, at whose ends the difference is taken


@dataclass(frozen=True)
class Raster:
    """A free-form flank, its lines, and the largest difference (m) on a grid four times as fine."""

    table: dict[str, Any]
    difference: float
    counts: tuple[int, int]


def raster_of(flank: PlainFlank, modifications: Sequence[Modification], count: int) -> Raster:
    """Return the raster with `count` lines in each direction in which the sum of the modifications varies."""
    rolls, faces = _axes(flank, modifications, count)
    removed = _removed(flank, modifications, rolls, faces)
    with boundary_errors("flank_grid"):
        grid = FlankGrid(tuple(rolls), tuple(faces), tuple(map(tuple, removed.tolist())))
    table = {
        "roll_length_mm": [rounded(value / MM) for value in rolls],
        "face_position_mm": [rounded(value / MM) for value in faces],
        "removed_um": [[rounded(value / UM) for value in row] for row in removed],
    }
    return Raster(table, _difference(flank, modifications, grid), (len(rolls), len(faces)))


def _axes(
    flank: PlainFlank, modifications: Sequence[Modification], count: int
) -> tuple[FloatArray, FloatArray]:
    """Return roll lengths and face positions of the grid, m; only two where the sum does not vary."""
    low, high = sorted((flank.root, flank.tip))
    half = 0.5 * flank.width
    sample = _removed(
        flank, modifications, np.linspace(low, high, _SAMPLE), np.linspace(-half, half, _SAMPLE)
    )
    varies = [np.ptp(sample, axis=axis).max() > _FLAT * ALLOWED_DIFFERENCE for axis in (0, 1)]
    counts = [count if varied else 2 for varied in varies]
    rolls = [kink for entry in modifications for kink in entry.rolls]
    faces = [flank.loaded.datum * (half - kink) for entry in modifications for kink in entry.faces]
    return (
        _through(np.linspace(low, high, counts[0]), rolls),
        _through(np.linspace(-half, half, counts[1]), faces),
    )


def _through(axis: FloatArray, kinks: Sequence[float]) -> FloatArray:
    """Return an axis whose inner nodes next to kinks are moved to them."""
    shifted = axis.copy()
    for kink in kinks:
        nearest = int(np.argmin(np.abs(axis - kink)))
        if 0 < nearest < len(axis) - 1:
            shifted[nearest] = kink
    return shifted


def _difference(flank: PlainFlank, modifications: Sequence[Modification], grid: FlankGrid) -> float:
    """Return the largest difference between a grid and the modifications that it represents, m."""
    axes = [_finer(np.array(axis)) for axis in (grid.roll_length, grid.face_position)]
    expected = _removed(flank, modifications, *axes)
    rolls, faces = np.meshgrid(*axes, indexing="ij")
    return float(np.abs(grid.material_removed(rolls, faces) - expected).max())


def _finer(axis: FloatArray) -> FloatArray:
    """Return an axis with `_BETWEEN` times as many intervals."""
    fractions = np.arange(_BETWEEN * (len(axis) - 1) + 1) / _BETWEEN
    return np.interp(fractions, np.arange(len(axis)), axis)


def _removed(
    flank: PlainFlank, modifications: Sequence[Modification], rolls: FloatArray, faces: FloatArray
) -> FloatArray:
    """Return the sum of the modifications at roll lengths (m) and face positions (n) of the case, (m, n)."""
    coordinates = 0.5 * flank.width - flank.loaded.datum * faces
    roll, face = np.meshgrid(rolls, coordinates, indexing="ij")
    return np.asarray(sum(entry.removed(roll, face) for entry in modifications))
