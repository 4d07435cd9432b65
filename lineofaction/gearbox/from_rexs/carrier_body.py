"""The rigid body of a planet carrier: the inertia of its shafts, pins and side plates together."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from dynamics.shafts import Inertia, hollow_cylinder
from lineofaction.gearbox.from_rexs.gear_unit import Part
from lineofaction.gearbox.from_rexs.layout import Layout
from lineofaction.gearbox.from_rexs.placed_shafts import PlacedShaft
from lineofaction.gearbox.from_rexs.placement import Placement
from lineofaction.gearbox.units import MM

DISC = 0.02
"""Length of a carrier without sizes, m."""

_SIZES = ("outer_diameter", "inner_diameter", "length")


@dataclass(frozen=True)
class _Piece:
    """A body of revolution at z (m), off the axis by `radius` (m), from `begin` to `end`."""

    inertia: Inertia
    z: float
    radius: float
    begin: float
    end: float


def carrier_body(layout: Layout, rotor: int) -> dict[str, Any]:
    """Return the body of a carrier.

    Its axis is that of the first shaft that is no pin. A piece off the axis adds m r^2 about it and,
    as the mean over pieces all around, m r^2 / 2 across it.
    """
    pins = {pin.id for planets in layout.rotors.sets for pin in planets.pins}
    shafts = [member for member in layout.rotors.members(rotor) if member in layout.shafts]
    axis = layout.shafts[next((member for member in shafts if member not in pins), shafts[0])]
    x, y = (float(value) for value in axis.origin[:2])
    members = (layout.unit.part(member) for member in layout.rotors.members(rotor))
    pieces = [piece for member in members for piece in _pieces(layout, member, (x, y))]
    if not pieces:
        return _disc(layout, axis, rotor)
    mass = sum(piece.inertia.mass for piece in pieces)
    center = sum(piece.inertia.mass * piece.z for piece in pieces) / mass
    polar = sum(p.inertia.polar + p.inertia.mass * p.radius**2 for p in pieces)
    across = sum(
        p.inertia.transverse + p.inertia.mass * (0.5 * p.radius**2 + (p.z - center) ** 2) for p in pieces
    )
    half = max(max(center - p.begin, p.end - center) for p in pieces)
    return rigid_section((x, y, center - half), 2.0 * half, Inertia(mass, polar, across))


def _disc(layout: Layout, axis: PlacedShaft, rotor: int) -> dict[str, Any]:
    """Return a steel disc as large as the circle of the planets' axes, where no part has a size."""
    planets = next(s.planets for s in layout.rotors.sets if layout.rotor(s.carrier[0].id) == rotor)
    placed = [layout.shafts[planet.id] for planet in planets if planet.id in layout.shafts]
    x, y, z = (float(value) for value in axis.origin)
    radius = max((math.hypot(p.origin[0] - x, p.origin[1] - y) for p in placed), default=0.0) or DISC
    text = f"no part has a size: a steel disc of {2e3 * radius:.6g} mm diameter, {DISC * 1e3:g} mm long"
    layout.unit.part(rotor).say("inertia", "defaulted", text)
    return rigid_section((x, y, z), DISC, hollow_cylinder(2.0 * radius, DISC))


def _pieces(layout: Layout, part: Part, axis: tuple[float, float]) -> Iterator[_Piece]:
    if part.id in layout.shafts:
        shaft = layout.shafts[part.id]
        radius = math.hypot(shaft.origin[0] - axis[0], shaft.origin[1] - axis[1])
        left = float(shaft.origin[2])
        for section in shaft.sections:
            inertia, z = section.body
            yield _Piece(inertia, left + z, radius, left, left + section.length)
            left += section.length
        return
    placement = Placement.of(part)
    outer, bore, length = (part.number(item, "size of the side plate, mm") for item in _SIZES)
    if placement is None or not outer or not length or (bore or 0.0) >= outer:
        part.say("", "refused", "a side plate needs its place, diameters and length; its mass is left out")
        return
    z = float(layout.axes.point(placement.origin)[2])
    begin, end = sorted((z, z + layout.axes.sense(placement) * length))
    part.say("", "derived", "inertia of the planet carrier")
    yield _Piece(hollow_cylinder(outer, length, bore or 0.0), 0.5 * (begin + end), 0.0, begin, end)


def rigid_line(origin: Sequence[float], length: float) -> dict[str, Any]:
    """Return the table of a line along z: its length and its left end, in mm."""
    return {"length_mm": length / MM, "origin_mm": [value / MM for value in origin]}


def rigid_section(origin: Sequence[float], length: float, inertia: Inertia) -> dict[str, Any]:
    """Return a rigid body along its axis; its center of mass is at mid-length."""
    return rigid_line(origin, length) | {"inertia": inertia_table(inertia)}


def inertia_table(inertia: Inertia) -> dict[str, float]:
    """Return the table of an inertia."""
    return {"mass_kg": inertia.mass, "polar_kg_m2": inertia.polar, "transverse_kg_m2": inertia.transverse}
