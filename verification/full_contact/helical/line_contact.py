"""The contact lines of all pairs of teeth at one position as one contact system.

Pressure has linear hats across a line, which follow it, and linear hats along it, between stations over the
face. Gaps, levers and loads are integrated section by section.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp

from fe_contact.geometry import ParallelAxes
from fe_contact.types import BoolArray, FloatArray, IntArray
from verification.full_contact.condensation.active_set import ContactSystem
from verification.full_contact.condensation.placed_mesh import AHEAD
from verification.full_contact.helical.contact_lines import FacingFlanks, hats
from verification.full_contact.helical.flank_bodies import HelicalGear

FARTHEST = 60e-6
"""Gap of the rigid flanks beyond which a section is left out, m."""
MIN_WEIGHT = 1e-4
"""Hats with less than this part of the largest area carry no pressure."""
_SEARCHED = 201
_GAUSS, _WEIGHTS = np.polynomial.legendre.leggauss(3)


@dataclass(frozen=True)
class Stations:
    """Places along the face, m, between which the pressure of a pair is linear; `across` hats each."""

    face: FloatArray
    across: int

    @property
    def hats(self) -> int:
        """Number of hats of a pair of teeth."""
        return len(self.face) * self.across

    @cached_property
    def quadrature(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Face positions (q,) and weights (q,) in m, three between stations, and the hats along (q, j)."""
        middle, half = 0.5 * (self.face[1:] + self.face[:-1]), 0.5 * np.diff(self.face)
        z = (middle[:, None] + half[:, None] * _GAUSS).ravel()
        over = np.stack([np.interp(z, self.face, hat) for hat in np.eye(len(self.face))], axis=-1)
        return z, (half[:, None] * _WEIGHTS).ravel(), over


@dataclass(frozen=True)
class LoadedSection:
    """Points of one section: flank coordinates of both gears (q,), m, and hats times weights (q, i).

    `integrals` (5, i) are those of the gap, of one, of both arms, and of one where pressure is cut off. Axes
    that tilt open the gap by `tilt_arm`, m.
    """

    number: int
    tilt_arm: float
    s: tuple[FloatArray, FloatArray]
    weighted: FloatArray
    integrals: FloatArray


def _loaded_sections(
    pair: ParallelAxes, roll: float, lead: float, half: float, stations: Stations
) -> Iterator[LoadedSection]:
    """Give the sections of a pair of teeth that may touch; at mid-face `roll` is that of gear 1, m."""
    for number, face in enumerate(stations.quadrature[0].tolist()):
        flanks = FacingFlanks(pair, roll - lead * face, face)
        if not flanks.closest[1] < FARTHEST:
            continue
        hat_values = hats(flanks, half, stations.across)
        facing = flanks.facing(hat_values.rolls)
        weighted = hat_values.values * hat_values.weights[:, None]
        arms = flanks.arms(facing)
        rolls = (hat_values.rolls, facing.mate) if flanks.slave == 0 else (facing.mate, hat_values.rolls)
        gears = (pair.pinion, pair.wheel)
        first, second = (
            0.5 * roll_lengths**2 / gear.base_radius for roll_lengths, gear in zip(rolls, gears, strict=True)
        )
        integrals = np.stack([facing.gap, np.ones(len(facing.gap)), arms[1], arms[0]]) @ weighted
        integrals = np.vstack([integrals, hat_values.cut * integrals[1]])
        tilt_arm = float(pair.tilt_arm(roll - lead * face, face))
        yield LoadedSection(number, tilt_arm, (first, second), weighted, integrals)


@dataclass(frozen=True)
class _Pair:
    """One pair of teeth: its teeth on both gears, where its hats stand, and its sections."""

    teeth: tuple[int, int]
    stations: Stations
    sections: list[LoadedSection]

    def integrals(self, tilt: float) -> FloatArray:
        """Return the integrals of all hats (5, i j); `tilt` of the axes in the plane of action, rad."""
        _, dz, over = self.stations.quadrature
        total = np.zeros((5, self.stations.across, len(self.stations.face)))
        for one in self.sections:
            tilted = one.integrals.copy()
            tilted[0] += tilt * one.tilt_arm * one.integrals[1]
            total += dz[one.number] * tilted[:, :, None] * over[one.number]
        return total.reshape(5, -1)


@dataclass(frozen=True)
class LineContact:
    """All pairs at one position; its torque is in N m."""

    system: ContactSystem
    ahead: IntArray
    """Pair index of each hat. Shape (h,)."""
    face: FloatArray
    """Station along the face of each hat, m. Shape (h,)."""
    at_side: BoolArray
    """Hats at a side of their strip that is no tip edge: pressure there is cut off. Shape (h,)."""


def line_contact(
    pair: ParallelAxes,
    gears: tuple[HelicalGear, HelicalGear],
    position: float,
    across: int,
    along: int,
    half: float,
    misalignment: float,
) -> LineContact:
    """Integrate all pairs of teeth.

    Parameters
    ----------
    position : float
        By the driving gear, base pitches, from -0.5 to 0.5.
    across, along : int
        Hats across a line, and along one that runs over the whole face.
    half : float
        Of the strips, m.
    misalignment : float
        Tilt of the axes in the plane of action as growth of the gap over the face, m.
    """
    pairs = list(_pairs(pair, gears, position, across, along, half))
    integrals = np.concatenate(
        [teeth_pair.integrals(misalignment / pair.face_width) for teeth_pair in pairs], axis=1
    )
    gap, weight, closing, lever, cut = integrals
    wide = np.flatnonzero(weight > MIN_WEIGHT * weight.max())
    index = np.full(len(weight), -1)
    index[wide] = np.arange(len(wide))
    compliance = np.zeros((len(wide), len(wide)))
    for number, gear in enumerate(gears):
        blocks = [_face_loads(gear, teeth_pair, number) for teeth_pair in pairs]
        loads = sp.csr_array(sp.vstack(blocks, format="csr"))[wide]
        compliance += loads @ (loads @ gear.body.compliance).T
        start = 0
        for teeth_pair in pairs:
            for hat, more in _lacking(gear, teeth_pair, number):
                rows = index[start + hat]
                used = rows >= 0
                compliance[np.ix_(rows[used], rows[used])] += more[np.ix_(used, used)]
            start += teeth_pair.stations.hats
    system = ContactSystem(
        gap[wide],
        0.5 * (compliance + compliance.T),
        closing[wide],
        pair.pinion.base_radius * lever[wide],
        weight[wide],
    )
    ahead = np.concatenate([np.full(teeth_pair.stations.hats, teeth_pair.teeth[1]) for teeth_pair in pairs])
    face = np.concatenate(
        [np.tile(teeth_pair.stations.face, teeth_pair.stations.across) for teeth_pair in pairs]
    )
    return LineContact(system, ahead[wide], face[wide], cut[wide] > 0.5 * weight[wide])


def _pairs(
    pair: ParallelAxes,
    gears: tuple[HelicalGear, HelicalGear],
    position: float,
    across: int,
    along: int,
    half: float,
) -> Iterator[_Pair]:
    """Give the pairs of teeth that may touch, with stations where they may."""
    searched = np.linspace(-0.5, 0.5, _SEARCHED) * pair.face_width
    for ahead in sorted(gears[1].body.starts):
        roll = float(pair.roll_lengths(position, np.array([ahead]))[0][0])
        gaps = [
            FacingFlanks(pair, roll - gears[0].lead * face, face).closest[1] for face in searched.tolist()
        ]
        near = searched[np.array(gaps) < FARTHEST]
        if len(near) < 2:
            continue
        part = float(near[-1] - near[0]) / pair.face_width
        stations = Stations(np.linspace(near[0], near[-1], max(3, 1 + round(part * (along - 1)))), across)
        sections = list(_loaded_sections(pair, roll, gears[0].lead, half, stations))
        yield _Pair((AHEAD[0] * ahead, AHEAD[1] * ahead), stations, sections)


def _face_loads(gear: HelicalGear, teeth_pair: _Pair, number: int) -> sp.csr_array:
    """Return the loads of all hats of a pair on the freedoms of a gear (i j, m)."""
    z, dz, over = teeth_pair.stations.quadrature
    s = np.concatenate([one.s[number] for one in teeth_pair.sections])
    face = np.concatenate([np.full(len(one.weighted), z[one.number]) for one in teeth_pair.sections])
    rows = [
        dz[one.number] * (one.weighted[:, :, None] * over[one.number]).reshape(len(one.weighted), -1)
        for one in teeth_pair.sections
    ]
    shapes = gear.body.shapes(teeth_pair.teeth[number], s, face)
    return sp.csr_array(sp.csr_array(np.concatenate(rows)).T @ shapes)


def _lacking(gear: HelicalGear, teeth_pair: _Pair, number: int) -> Iterator[tuple[IntArray, FloatArray]]:
    """Yield the hats of a pair, and the compliance that the body over the face lacks against a section."""
    _, dz, over = teeth_pair.stations.quadrature
    for one in teeth_pair.sections:
        between = one.number // 3
        along = over[one.number, between : between + 2]
        hat = np.arange(teeth_pair.stations.across) * len(teeth_pair.stations.face) + between
        local = gear.lacking(teeth_pair.teeth[number], one.s[number], one.weighted)
        yield np.concatenate([hat, hat + 1]), dz[one.number] * np.kron(np.outer(along, along), local)
