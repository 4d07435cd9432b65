"""Forces of a contact solution at the nodes of the bodies."""

from __future__ import annotations

from typing import Protocol, TypeAlias

import numpy as np

from fe_contact.contact.face_patch import FaceGrid, face_loads
from fe_contact.contact.patch import Patches, load_vector
from fe_contact.contact.problem import Candidates, LoadedSlices
from fe_contact.types import FloatArray, IntArray

ByTooth = dict[int, FloatArray]
Side: TypeAlias = tuple[Patches, FloatArray, int]


class _ProfileNodes(Protocol):
    """The nodes of a flank in the plane, as a compliance or a unit-load stress has them."""

    @property
    def s(self) -> FloatArray:
        """Flank coordinates (k,), m."""


class _FaceNodes(_ProfileNodes, Protocol):
    """The nodes of a flank over the face width."""

    @property
    def z(self) -> FloatArray:
        """Ends of the layers, m."""

    @property
    def index(self) -> IntArray:
        """Degree of freedom by plane across the face and profile node; -1 at the centers of faces."""


def plane_flank_forces(
    candidates: Candidates,
    force: FloatArray,
    position: int,
    flanks: tuple[_ProfileNodes, _ProfileNodes],
) -> tuple[ByTooth, ByTooth]:
    """Return the forces on the loaded teeth of both gears of a plane model.

    Parameters
    ----------
    force : ndarray, shape (P, m)
        Forces of the candidates, N.
    position : int
        Index of the position.
    flanks : (ProfileNodes, ProfileNodes)
        Flank nodes of the driving and the driven gear.

    Returns
    -------
    dict, dict
        Inward nodal forces (k,) per unit face width by tooth number, N/m. A force at a tip edge acts along
        the mating flank's normal: it is multiplied by the arm of this normal over the base radius.
    """
    forces: list[ByTooth] = []
    slices, pressed, row = _pressed(candidates, force, position)
    for flank, (patches, lever, direction) in zip(flanks, _sides(slices), strict=True):
        by_tooth: ByTooth = {}
        for i in np.flatnonzero(pressed):
            unit_load = np.zeros(flank.s.size)
            center, half_width = patches.center[row, i], patches.half_width[row, i]
            # fills in the nodal forces of a unit load, of which `edge_share` is singular at the tip edge
            load_vector(flank.s, center, half_width, patches.edge_share[row, i], unit_load)
            share = pressed[i] * lever[row, i] / slices.width
            _add(by_tooth, int(direction * slices.pair[i]), share * unit_load)
        forces.append(by_tooth)
    return forces[0], forces[1]


def face_flank_forces(
    candidates: Candidates,
    force: FloatArray,
    position: int,
    flanks: tuple[_FaceNodes, _FaceNodes],
    axial_offset: float = 0.0,
) -> tuple[ByTooth, ByTooth]:
    """Return the forces on the loaded teeth of both gears over their face width.

    Parameters are those of `plane_flank_forces`, with the distance in m of the driven gear's mid-face from
    the driving gear's.

    Returns
    -------
    dict, dict
        Inward nodal forces (nf,) on the degrees of freedom of the compliance by tooth number, N.
    """
    forces: list[ByTooth] = []
    slices, pressed, row = _pressed(candidates, force, position)
    carrying = np.flatnonzero(pressed)
    sides = zip(flanks, _sides(slices), (0.0, axial_offset), strict=True)
    for flank, (patches, lever, direction), offset in sides:
        middle = slices.face_position[carrying] - offset
        low = np.maximum(middle - 0.5 * slices.slice_width, flank.z[0])
        high = np.minimum(middle + 0.5 * slices.slice_width, flank.z[-1])
        center, half_width, edge_share = patches.by_slice(row, carrying)
        grid = FaceGrid(flank.s, flank.z, flank.index)
        loads = face_loads(grid, center, half_width, edge_share, low, high)
        by_tooth: ByTooth = {}
        for k, i in enumerate(carrying):
            used = loads.used[k]
            nodal = np.zeros(int(flank.index.max()) + 1)
            nodal[loads.nodes[k, :used]] = loads.forces[k, :used]
            share = pressed[i] * lever[row, i]
            _add(by_tooth, int(direction * slices.pair[i]), share * nodal)
        forces.append(by_tooth)
    return forces[0], forces[1]


def _pressed(
    candidates: Candidates, force: FloatArray, position: int
) -> tuple[LoadedSlices, FloatArray, int]:
    """Return the slices, the forces (n,) on them in N, and the row of the position in their arrays."""
    slices = candidates.slices  # positions with the same phase share a row
    return slices, candidates.on_slices(force[position]), position % len(slices.present)


def _sides(slices: LoadedSlices) -> tuple[Side, Side]:
    """Return patches, arms over base radii and signs of tooth numbers: pair j is on tooth -j of gear 1."""
    touch = slices.touch
    return (slices.patch_1, touch.lever_1, -1), (slices.patch_2, touch.lever_2, 1)


def _add(by_tooth: ByTooth, tooth: int, forces: FloatArray) -> None:
    by_tooth[tooth] = by_tooth.get(tooth, 0.0) + forces
