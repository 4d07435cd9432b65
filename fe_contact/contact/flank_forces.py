"""What a solution presses on the flanks: pressures at the contact, and forces at the nodes of the bodies."""

from __future__ import annotations

import math
from typing import Protocol, TypeAlias

import numpy as np

from fe_contact.contact.face_patch import FaceGrid, face_loads
from fe_contact.contact.patch import Patches, load_vector
from fe_contact.contact.problem import Candidates, ContactProblem, LoadedSlices
from fe_contact.contact.strip import Gap, gap_table, half_strip
from fe_contact.types import BoolArray, FloatArray, IntArray
from host.loops import njit

# Peak pressure of the contacts, from their loads and strips.


_EDGE = 0.08
"""Slope against the flank from which on a break is an edge: less than any chamfer's, more than a relief's."""


def contact_pressure(problem: ContactProblem, force: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Return the peak pressure of each contact in Pa, and whether its strip reaches an edge, (P, L, n).

    It is 2 p/(pi h), the peak of an elliptic pressure over the strip 2 h as it is: Hertz's on a plain flank.
    Where a relief begins the pressure of a sharp kink is infinite at a point; this is the mean over the
    strip, times 4/pi. At the edge of a tip or of its chamfer, which is never sharp, it is Hertz's as if the
    flank went on, which only indicates how hard the edge presses: there the pressure is singular. A rounded
    tip is what it is. `force`: normal forces, N.
    """
    candidates = problem.candidates
    loaded = np.nonzero(force.any(axis=1))
    here, none = candidates.gap_at(loaded), np.full(loaded[0].size, np.inf)
    line_load = np.moveaxis(force, 1, 2)[loaded] / candidates.width[loaded][:, None]
    at_edge = (here.low >= 0.0) | (here.high <= 0.0)
    endless = _unchamfered(here)._replace(low=-none, high=none)
    endless = endless._replace(slope=np.where(at_edge, 0.0, endless.slope))
    half = _strips(gap_table(endless), line_load, problem.modulus)
    chamfer = np.where(here.jump >= _EDGE, np.abs(here.place), np.inf).min(axis=-1, initial=np.inf)
    reach = np.minimum(np.minimum(-here.low, here.high), chamfer)[:, None]
    pressure, edge = np.zeros(force.shape), np.zeros(force.shape, dtype=np.bool_)
    row, contact = loaded
    pressure[row, :, contact] = np.divide(
        2.0 * line_load, math.pi * half, out=np.zeros(half.shape), where=half > 0.0
    )
    edge[row, :, contact] = half > reach
    return pressure, edge


def _unchamfered(about: Gap) -> Gap:
    """Return the gaps as if flanks went on over their chamfers.

    At an edge that holds the touching point slope and curvature are those to its left: a chamfer's, or else
    what the chamfer to the right of it is added to.
    """
    chamfer = about.jump >= _EDGE
    held = chamfer & (about.place == 0.0)
    to_the_left = held & (about.slope[..., None] < -0.5 * about.jump)
    return about._replace(
        slope=np.where(held.any(axis=-1), 0.0, about.slope),
        curvature=about.curvature + np.where(to_the_left, about.bend, 0.0).sum(axis=-1),
        jump=np.where(chamfer, 0.0, about.jump),
        bend=np.where(chamfer, 0.0, about.bend),
    )


@njit(cache=True)
def _strips(about: FloatArray, line_load: FloatArray, modulus: float) -> FloatArray:
    """Return half the strips of contacts (n,) under line loads (n, L) in N/m, zero where there is none, m."""
    half = np.zeros(line_load.shape)
    for i in range(line_load.shape[0]):
        for k in range(line_load.shape[1]):
            if line_load[i, k] > 0.0:
                half[i, k] = half_strip(about, i, line_load[i, k], modulus, 0.0, 0.0)[1]
    return half


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
        """Freedom at plane and profile node, -1 at the centers."""


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
        Of the candidates, N.
    position : int
        Index of the position.
    flanks : (ProfileNodes, ProfileNodes)
        Driving and driven gear: their flank nodes.

    Returns
    -------
    dict, dict
        Tooth number to inward nodal forces (k,) per unit face width, N/m. A force at a tip edge acts along
        the mating flank's normal, so it counts by its lever (see `contact_problem`).
    """
    forces: list[ByTooth] = []
    slices, pressed, row = _pressed(candidates, force, position)
    for flank, (patches, lever, direction) in zip(flanks, _sides(slices), strict=True):
        by_tooth: ByTooth = {}
        for i in np.flatnonzero(pressed):
            unit = np.zeros(flank.s.size)
            at = (patches.center[row, i], patches.half_width[row, i])
            load_vector(flank.s, *at, patches.edge_share[row, i], unit)
            share = pressed[i] * lever[row, i] / slices.width
            _add(by_tooth, int(direction * slices.pair[i]), share * unit)
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
        Tooth number to nodal forces (nf,) against the outward normal, in the freedoms of the compliance, N.
    """
    forces: list[ByTooth] = []
    slices, pressed, row = _pressed(candidates, force, position)
    carrying = np.flatnonzero(pressed)
    sides = zip(flanks, _sides(slices), (0.0, axial_offset), strict=True)
    for flank, (patches, lever, direction), offset in sides:
        along = slices.face_position[carrying] - offset
        loads = face_loads(
            FaceGrid(flank.s, flank.z, flank.index),
            *patches.by_slice(row, carrying),
            np.maximum(along - 0.5 * slices.slice_width, flank.z[0]),
            np.minimum(along + 0.5 * slices.slice_width, flank.z[-1]),
        )
        by_tooth: ByTooth = {}
        for k, i in enumerate(carrying):
            used = loads.used[k]
            nodal = np.zeros(int(flank.index.max()) + 1)
            nodal[loads.nodes[k, :used]] = loads.forces[k, :used]
            share = pressed[i] * lever[row, i]
            _add(by_tooth, int(direction * slices.pair[i]), -share * nodal)
        forces.append(by_tooth)
    return forces[0], forces[1]


def _pressed(
    candidates: Candidates, force: FloatArray, position: int
) -> tuple[LoadedSlices, FloatArray, int]:
    """Return the slices, the forces (n,) on them in N, and the row of the position in their arrays."""
    slices = candidates.slices
    return slices, candidates.on_slices(force[position]), position % len(slices.present)


def _sides(slices: LoadedSlices) -> tuple[Side, Side]:
    """Return patches, lever and direction of counting of both gears: pair j is tooth -j of gear 1."""
    touch = slices.touch
    return (slices.patch_1, touch.lever_1, -1), (slices.patch_2, touch.lever_2, 1)


def _add(by_tooth: ByTooth, tooth: int, forces: FloatArray) -> None:
    by_tooth[tooth] = by_tooth.get(tooth, 0.0) + forces
