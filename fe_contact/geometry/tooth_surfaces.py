"""Flanks of all single teeth of a gear as arrays, for loops over many points of many teeth."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fe_contact.flank.extent import Extent
from fe_contact.types import FloatArray, IntArray

if TYPE_CHECKING:
    from fe_contact.flank.flank_grid import FlankGrid
    from fe_contact.flank.tooth import Tooth

_IN_CELL = 4
"""Parts into which a cell between the nodes of a surface, and a wave between crest and trough, is divided."""


class PackedGrids(NamedTuple):
    """Surfaces of several teeth one after the other."""

    of_tooth: IntArray
    """Index of the surface of each tooth; -1: none. Shape (T,)."""
    sizes: IntArray
    """Nodes of each surface along the profile, along the face, and in all. Shape (G, 3)."""
    starts: IntArray
    """Index of the first entry of each surface in `roll`, in `face`, and along `nodes`. Shape (G, 3)."""
    roll: FloatArray
    face: FloatArray
    """`roll`, `face`: Axes of all surfaces, m."""
    nodes: FloatArray
    """Value, slopes and mixed slope at the nodes of all surfaces; see `FlankGrid`. Shape (4, N)."""

    @classmethod
    def of(cls, grids: Sequence[FlankGrid | None]) -> PackedGrids:
        """Pack the surfaces of teeth in the order of meshing; None where a tooth has none."""
        measured = [grid for grid in grids if grid is not None]
        has_grid = np.array([grid is not None for grid in grids], dtype=bool)
        shapes = [(len(grid.roll_length), len(grid.face_position)) for grid in measured]
        sizes = np.array([(m, n, m * n) for m, n in shapes], dtype=np.int64).reshape(-1, 3)
        no_nodes = np.zeros((4, 0))  # where no tooth has a surface
        return cls(
            of_tooth=np.where(has_grid, np.cumsum(has_grid) - 1, -1).astype(np.int64),
            sizes=sizes,
            starts=np.cumsum(sizes, axis=0) - sizes,
            roll=np.array([roll for grid in measured for roll in grid.roll_length]),
            face=np.array([face for grid in measured for face in grid.face_position]),
            nodes=np.concatenate([no_nodes, *(grid.nodes.reshape(4, -1) for grid in measured)], axis=1),
        )


@dataclass(frozen=True)
class ToothSurfaces:
    """Flanks of single teeth of a gear."""

    ends: tuple[float, float]
    """Roll lengths at the form circle and at the tip, m."""
    face_width: float
    """Face width of the gear, m."""
    amounts: FloatArray
    """Slope and form of the profile, m, waves of the form, and the same along the face. Shape (T, 6)."""
    grids: PackedGrids
    extents: Extent
    """Extents of the gaps by these flanks, arrays (T,): material missing, less material in excess."""
    nodes: tuple[FloatArray, ...]
    """Roll lengths of each tooth, m. Between two neighbors the profile turns back at most once."""

    @classmethod
    def of(cls, gear: Tooth, amounts: FloatArray, grids: Sequence[FlankGrid | None]) -> ToothSurfaces:
        """Lay out the `amounts` and the surfaces of the first teeth of a gear; others are as designed."""
        ends = gear.form_roll_length, gear.tip_roll_length
        waves = amounts[:, 2]
        return cls(
            ends=ends,
            face_width=gear.face_width,
            amounts=amounts,
            grids=PackedGrids.of(grids),
            extents=_extents(ends, amounts, grids),
            nodes=tuple(profile_nodes(ends, count, grid) for count, grid in zip(waves, grids, strict=True)),
        )

    def excess(self, tooth: IntArray, roll_length: FloatArray, face: FloatArray) -> FloatArray:
        """Return how far the flanks of teeth stand towards the mate, m.

        Parameters
        ----------
        tooth : ndarray of int
            Teeth in the order of meshing, the first is 0.
        roll_length, face : ndarray
            Points of these flanks, m; `face` from mid-face. All arrays broadcast.
        """
        from fe_contact.geometry.tooth_surface_loops import surfaces_excess  # noqa: PLC0415 (loads the compiler)

        shape = np.broadcast_shapes(tooth.shape, roll_length.shape, face.shape)
        roll, along = (np.broadcast_to(values, shape).ravel() for values in (roll_length, face))
        teeth = np.broadcast_to(tooth, shape).ravel().astype(np.int64, copy=False)
        excess = surfaces_excess(teeth, roll, along, self.ends, self.face_width, self.amounts, self.grids)
        return np.asarray(excess.reshape(shape))


def profile_nodes(ends: tuple[float, float], waves: float, grid: FlankGrid | None) -> FloatArray:
    """Return roll lengths in m between two of which a profile turns back once at most.

    `ends` are those of the usable profile in m, `waves` those of its form deviation.
    """
    low, high = min(ends), max(ends)
    parts = [np.linspace(low, high, _IN_CELL * max(int(waves), 1) + 1)]
    if grid is not None:
        axis = np.array(grid.roll_length)
        cells = np.arange(_IN_CELL * (axis.size - 1) + 1) / _IN_CELL
        parts.append(np.clip(np.interp(cells, np.arange(axis.size), axis), low, high))
    return np.unique(np.concatenate(parts))


def _extents(ends: tuple[float, float], amounts: FloatArray, grids: Sequence[FlankGrid | None]) -> Extent:
    """Return the extents (T,) of the gaps of teeth by their `amounts` (T, 6) and surfaces."""
    surfaces = [Extent() if grid is None else grid.extent(ends) for grid in grids]
    parts = (np.array([getattr(surface, field.name) for surface in surfaces]) for field in fields(Extent))
    slope, form, waves = np.abs(amounts[:, :3]).T
    helix = np.abs(amounts[:, 3])
    tilted = 0.5 * (slope + helix)
    profile, across = _form_ends(*amounts[:, 1:3].T), _form_ends(*amounts[:, 4:6].T)
    # the profile runs over 2: its form is steepest at the ends, or at a zero of its waves
    steep, phase = 2.0 / abs(ends[1] - ends[0]), math.pi * waves
    per_part = 0.5 * slope + form * np.where(waves > 0.0, 0.5 * phase, 2.0)
    bend = np.where(waves > 0.0, 0.5 * form * np.maximum(phase, 2.0) ** 2, 2.0 * form)
    return Extent(
        low=profile[0] + across[0] - tilted,
        high=profile[1] + across[1] + tilted,
        slope=per_part * steep,
        spread=slope + form,
        bend=bend * steep**2,
    ) + Extent(*parts)


def _form_ends(height: FloatArray, waves: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the bounds of gaps by form deviations.

    A form without waves is (1/3 - u^2) `height` over -1 <= u <= 1, one with waves a cosine of half `height`.
    """
    ends = np.where(waves > 0.0, [-0.5 * height, 0.5 * height], [-height / 3.0, 2.0 * height / 3.0])
    return ends.min(axis=0), ends.max(axis=0)
