"""The shafts of a REXS model: where they stand along the scene's z axis, and their sections."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import accumulate

import numpy as np

from bounds.types import FloatArray
from dynamics.shafts import BeamSection
from lineofaction.gearbox.from_rexs.gear_unit import Part
from lineofaction.gearbox.from_rexs.placement import Placement
from lineofaction.gearbox.from_rexs.scene_axes import SceneAxes

SAME_POSITION = 1e-6
"""Length in m up to which the length in the file and the sum of the sections are equal."""

_LENGTHS = ("length", "outer_diameter_begin", "outer_diameter_end")
_LARGEST = 100.0  # largest length or diameter of a section, m


@dataclass(frozen=True)
class PlacedShaft:
    """A shaft along the z axis of the scene."""

    part: Part
    placement: Placement
    """Placement in the frame of the model; the origin is at u = 0."""
    start: FloatArray
    """Point of u = 0 in the scene, m. Shape (3,)."""
    sense: int
    """+1 where u is along z, -1 where it is against it."""
    begin: float
    end: float
    """`begin`, `end`: u of both ends, m."""
    sections: tuple[BeamSection, ...] = ()
    """Sections from the left end, the end of lower z; empty if the file has none."""

    @classmethod
    def of(cls, part: Part, placement: Placement, axes: SceneAxes) -> PlacedShaft:
        """Return a shaft with its sections."""
        rows = tuple(_rows(part))
        sense = axes.sense(placement)
        begin = rows[0][0] if rows else 0.0
        sections = tuple(section if sense > 0 else _turned_section(section) for _, section in rows)
        end = begin + sum(section.length for section in sections)
        along_z = sections if sense > 0 else sections[::-1]
        return cls(part, placement, axes.point(placement.origin), sense, begin, end, along_z)

    @property
    def length(self) -> float:
        """Length, m."""
        return self.end - self.begin

    @property
    def origin(self) -> FloatArray:
        """Left end of the axis in the scene, m."""
        left = self.begin if self.sense > 0 else -self.end
        return np.asarray(self.start + np.array([0.0, 0.0, left]))

    def position(self, u: float) -> float:
        """Return the position of a u from the left end, m."""
        return u - self.begin if self.sense > 0 else self.end - u

    def off_axis(self, point: FloatArray) -> float:
        """Return the distance of a point of the model from the axis, m."""
        return float(np.linalg.norm(np.cross(self.placement.axes[0], point - self.placement.origin)))

    def outer_diameter(self, u: float) -> float:
        """Return the outer diameter at a u, m; 0 without sections."""
        position, left = self.position(u), 0.0
        for section in self.sections:
            if left - SAME_POSITION <= position <= left + section.length + SAME_POSITION:
                share = min(1.0, max(0.0, (position - left) / section.length))
                first, last = section.outer_diameters
                return first + share * (last - first)
            left += section.length
        return 0.0


def _rows(shaft: Part) -> Iterator[tuple[float, BeamSection]]:
    """Yield u of the left end and the section of each piece; the account has the places that do not fit."""
    pieces = [
        (part.number("u_coordinate_on_shaft", "left end of the section, mm"), part)
        for part in shaft.children("shaft_section")
    ]
    if all(u is not None for u, _ in pieces):
        pieces.sort(key=lambda piece: piece[0] or 0.0)
    first = (pieces[0][0] or 0.0) if pieces else 0.0
    sections = [_section(shaft, part) for _, part in pieces]
    summed = list(accumulate((section.length for section in sections), initial=first))[:-1]
    for (_, part), at, section in zip(pieces, summed, sections, strict=True):
        item = "u_coordinate_on_shaft"
        start = part.number(item, "left end of the section, mm")
        derived = f"{at * 1e3:.6g} mm, the sum of the lengths before it"
        if start is None:
            part.say(item, "derived", derived)
        elif abs(start - at) > SAME_POSITION:
            part.say(item, "refused", f"{start * 1e3:.6g} mm leaves a gap or overlaps; taken: {derived}")
        yield at, section


def _section(shaft: Part, part: Part) -> BeamSection:
    length, begin, end = (_size(part, name) for name in _LENGTHS)
    bore = part.number("inner_diameter_begin", "bore of the section, mm") or 0.0
    end_bore = part.number("inner_diameter_end", "bore at the end of the section, mm")
    tapers = end != begin or end_bore not in (None, bore)
    if bore >= begin or (end_bore or 0.0) >= end:
        bound = f"smaller than the outer diameter, {begin * 1e3:g} mm"
        raise part.refusal("inner_diameter_begin", bore * 1e3, bound)
    return BeamSection(
        length,
        begin,
        bore,
        **_material(shaft),
        end_outer_diameter=end if tapers else None,
        end_bore_diameter=(bore if end_bore is None else end_bore) if tapers else None,
    )


def _size(part: Part, item: str) -> float:
    value = part.number(item, f"{item} of the section, mm")
    if value is None and item == "outer_diameter_end":
        value = part.number("outer_diameter_begin", "outer diameter of the section, mm")
        part.say(item, "derived", "as at the begin")
    if value is None or not 0.0 < value <= _LARGEST:
        written = None if value is None else value * 1e3
        raise part.refusal(item, written, f"above 0 mm and at most {1e3 * _LARGEST:.0f} mm")
    return value


def _material(shaft: Part) -> dict[str, float]:
    names = {"elastic_modulus": "youngs_modulus", "poisson_ratio": "poissons_ratio", "density": "density"}
    for part in shaft.referenced:
        if part.type == "material":
            values = {field: part.number(item, f"{field} of the shaft") for item, field in names.items()}
            return {field: value for field, value in values.items() if value}
    return {}


def _turned_section(section: BeamSection) -> BeamSection:
    """Return a section seen from its other end."""
    if section.end_outer_diameter is None:
        return section
    outer, bore = section.outer_diameters, section.bore_diameters
    return replace(
        section,
        outer_diameter=outer[1],
        bore_diameter=bore[1],
        end_outer_diameter=outer[0],
        end_bore_diameter=bore[0],
    )
