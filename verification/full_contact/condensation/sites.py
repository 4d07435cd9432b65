"""Sites where tooth pairs may touch at one position, and the element sizes on their flanks.

The slave is the gear whose flank carries the pressure, the mate or master the other one. A strip is the
stretch of a flank on which pressure may act. Hertz' half-width decides element sizes and the length of the
strips, and nothing else.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fe_contact.geometry import CornerContact, ParallelAxes, Toothing, corner_contact, tooth_profile
from fe_contact.hertz import contact_modulus, half_width
from fe_contact.types import FloatArray
from verification.full_contact.condensation.modified_flank import material_removed
from verification.full_contact.condensation.resolution import Resolution

STRIP, MATE_STRIP = 2.0, 2.5
"""Half-lengths of the strips on slave and master, in Hertz half-widths of the whole load on one pair."""
TOUCHING, MARGINS = 1.6, (0.4, 0.9)
"""Strips on the path of contact, in half-widths of the whole load on one pair: half-width that closes the gap
at the ends of a strip, and margins added to the strips of slave and master.
"""
SEARCHED, SAMPLES, EVERY = 12.0, 1201, 8
"""Search of the closest point on the mate: half-widths on either side, number of samples, and step of the
samples that carry an element size.
"""
NEAR_EDGE, PER_DISTANCE = 2.5, 0.1
"""Half-widths from a tip edge within which its elements are fine, and their size over the distance to it."""


@dataclass(frozen=True)
class SizedStrip:
    """Strip of one gear's flank."""

    low: float
    high: float
    """`low`, `high`: Flank coordinates of the ends of the strip, m."""
    at: FloatArray
    size: FloatArray
    """`at`, `size`: Flank coordinates of samples, and the element sizes there, m. Shape (k,) each."""


@dataclass(frozen=True)
class ContactSite:
    """One tooth pair that may touch."""

    ahead: int
    """Index of the pair; 0 is the reference pair, +1 is ahead."""
    slave: int
    """Number of the gear whose flank carries the pressure, 0 or 1; the other gear has the nearer tip edge."""
    strips: tuple[SizedStrip, SizedStrip]
    """Strips on gear 1 and gear 2. Shape (SizedStrip, SizedStrip)."""


@dataclass(frozen=True)
class Range:
    """The range of loads that the sites of a position must hold."""

    line_loads: tuple[float, float]
    """Least and largest load of the pair, N/m."""
    lag: float
    """Largest lag of the driven gear, m."""
    longer: float = 1.0
    """Length of the strips over the usual length."""


@dataclass(frozen=True)
class _Widths:
    """Hertz half-widths of a pair, m: under its share of the least and the largest load, and of all of it."""

    minimum: float
    largest: float
    alone: float
    radius: float


def contact_sites(
    pair: ParallelAxes, position: float, load_range: Range, resolution: Resolution
) -> tuple[ContactSite, ...]:
    """Return the pairs that may touch, from behind to ahead.

    Parameters
    ----------
    position : float
        By the driving gear, base pitches, from -0.5 to 0.5.
    load_range : Range
        Loads, and the lag within which teeth off the path of contact come to touch.
    """
    path = pair.path_of_contact
    reach = math.ceil(path.length / pair.base_pitch) + 2
    ahead = np.arange(-reach, reach + 1)
    rolls = pair.roll_lengths(position, ahead)[0]
    inside = (rolls >= path.start) & (rolls <= path.end)
    sharing = max(1, int(np.count_nonzero(inside)))
    sites = []
    for index, roll, on_path in zip(ahead.tolist(), rolls.tolist(), inside, strict=True):
        if on_path:
            widths = _widths(pair, roll, load_range, sharing)
            sites.append(_on_path(pair, index, roll, widths, resolution))
        elif _corner_gap(pair, roll) < load_range.lag:
            end = min(max(roll, path.start), path.end)
            sites.append(_at_corner(pair, index, roll, _widths(pair, end, load_range, 1), resolution))
    return tuple(sites)


def least_omitted_gap(pair: ParallelAxes, position: float, sites: tuple[ContactSite, ...]) -> float:
    """Return the least gap of the rigid gears at a pair that is no site, m; infinite if there is none."""
    neighbors = np.array([sites[0].ahead - 1, sites[-1].ahead + 1])
    rolls = pair.roll_lengths(position, neighbors)[0]
    return min(_corner_gap(pair, float(roll)) for roll in rolls)


def _widths(pair: ParallelAxes, roll: float, load_range: Range, sharing: int) -> _Widths:
    """Return the half-widths at a roll length of gear 1."""
    modulus = contact_modulus(pair.pinion.material, pair.wheel.material)
    radius = 1.0 / float(pair.relative_curvature(roll))
    minimum, largest = half_width(np.array(load_range.line_loads) / sharing, radius, modulus).tolist()
    alone = load_range.longer * float(half_width(load_range.line_loads[1], radius, modulus))
    return _Widths(minimum, largest, alone, radius)


def _corner(pair: ParallelAxes, roll: float) -> CornerContact:
    path = pair.path_of_contact
    if roll < path.start:
        return corner_contact(pair, "approach", path.start - roll)
    return corner_contact(pair, "exit", max(roll - path.end, 0.0))


def _corner_gap(pair: ParallelAxes, roll: float) -> float:
    """Return the gap of a tip edge, infinite where it meets no involute, less excess material."""
    gap = float(_corner(pair, roll).gap)
    if not math.isfinite(gap):
        return math.inf
    return gap - sum(_added(gear) for gear in (pair.pinion, pair.wheel))


def _added(gear: Toothing) -> float:
    """Return the most material that a modification adds, m, >= 0."""
    profile = tooth_profile(gear)
    removed = material_removed(gear, np.linspace(profile.s_form, profile.s_tip, 101))
    return max(0.0, -float(removed.min()))


def _on_path(
    pair: ParallelAxes, ahead: int, roll: float, widths: _Widths, resolution: Resolution
) -> ContactSite:
    """Return a pair on the line of action: finest where the flanks come closest, towards the least load."""
    gears = (pair.pinion, pair.wheel)
    first, second = _arc(pair.pinion, roll), _arc(pair.wheel, float(pair.mating_roll_length(roll)))
    t = np.linspace(-SEARCHED, SEARCHED, SAMPLES) * widths.alone
    positions = (first + t, second - t)
    gap = 0.5 * t**2 / widths.radius
    for gear, s in zip(gears, positions, strict=True):
        gap = gap + np.where(s > tooth_profile(gear).s_tip, np.inf, material_removed(gear, s))
    reached = np.sqrt(2.0 * widths.radius * (gap - gap.min()))
    path = pair.path_of_contact
    slave = 0 if roll < 0.5 * (path.start + path.end) else 1
    size = np.clip(reached, widths.minimum, widths.largest) / resolution.per_half_width
    within = np.flatnonzero(reached < TOUCHING * widths.alone)
    to_edge = tooth_profile(gears[1 - slave]).s_tip - positions[1 - slave][np.argmin(gap)]
    strips = []
    for number, s in enumerate(positions):
        edge = tooth_profile(gears[number]).s_tip
        more = MARGINS[number != slave] * widths.alone  # past the mate's edge too: the flanks slide
        low, high = float(s[within].min()) - more, min(float(s[within].max()) + more, edge)
        at, sizes = s[within][::EVERY], size[within][::EVERY]
        if to_edge < NEAR_EDGE * widths.alone:
            faced = edge if number != slave else float(s[np.argmin(gap)]) - to_edge
            finest = max(resolution.edge_size(widths.minimum, widths.alone), PER_DISTANCE * to_edge)
            at, sizes = np.append(at, faced), np.append(sizes, finest)
        strips.append(SizedStrip(low, high, at, sizes))
    return ContactSite(ahead, slave, (strips[0], strips[1]))


def _arc(gear: Toothing, roll: float) -> float:
    return gear.sign * 0.5 * roll**2 / gear.base_radius


def _at_corner(
    pair: ParallelAxes, ahead: int, roll: float, widths: _Widths, resolution: Resolution
) -> ContactSite:
    """Return a pair off the line of action: finest where the tip edge of one gear meets the other's flank."""
    slave = 0 if roll < pair.path_of_contact.start else 1
    flank, mate = (pair.pinion, pair.wheel)[:: 1 - 2 * slave]
    at, tip = _arc(flank, float(_corner(pair, roll).flank_roll_length)), tooth_profile(mate).s_tip
    size = np.array([resolution.edge_size(widths.minimum, widths.alone)])
    half = STRIP * widths.alone
    on_flank = SizedStrip(at - half, min(at + half, tooth_profile(flank).s_tip), np.array([at]), size)
    on_edge = SizedStrip(tip - MATE_STRIP * widths.alone, tip, np.array([tip]), size)
    return ContactSite(ahead, slave, (on_flank, on_edge) if slave == 0 else (on_edge, on_flank))
