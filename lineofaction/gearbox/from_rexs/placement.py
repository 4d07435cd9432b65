"""Where shafts and their parts stand, in the frame of the file and of the scene."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import accumulate

import numpy as np

from bounds.types import FloatArray
from dynamics.shafts import BeamSection
from lineofaction.gearbox.from_rexs.gear_unit import Part

# Where components stand: points and axes u, v, w, composed over the components they refer to.


PARALLEL = 1e-6
"""Sine of the angle up to which two directions are the same."""
_MOST_REFERENCES = 100
_REFERENCE = "reference_component_for_position"


@dataclass(frozen=True)
class Placement:
    """A place in the model's own frame."""

    origin: FloatArray
    """m. Shape (3,)."""
    axes: FloatArray
    """Unit vectors u, v, w by rows, a right-handed system. Shape (3, 3)."""

    @property
    def u(self) -> FloatArray:
        """Direction of the axis of rotation."""
        return np.asarray(self.axes[0])

    def along(self, point: FloatArray) -> float:
        """Return u of a point, m."""
        return float(self.u @ (point - self.origin))

    def within(self, outer: Placement) -> Placement:
        """Return the place of what is stated in the frame of `outer`."""
        return Placement(outer.origin + self.origin @ outer.axes, self.axes @ outer.axes)

    @staticmethod
    def of(part: Part, inner: tuple[int, ...] = ()) -> Placement | None:
        """Return where a component stands, None where the file does not say; `inner` as of `frame_of`."""
        origin = _vector(part, "support_vector", "place")
        return None if origin is None else _in_reference(part, origin, inner)


FIXED = Placement(np.zeros(3), np.eye(3))


def frame_of(part: Part, inner: tuple[int, ...] = ()) -> Placement:
    """Return where a component stands: as the file says, else by what carries it.

    On a shaft it stands at its u coordinate, along the shaft's axes; without one it has the origin of the
    component that its place refers to.
    `inner` are the components whose places refer to this one, the innermost first. Raises `BadInput` as
    `Placement.of`.
    """
    if part.id in inner or len(inner) > _MOST_REFERENCES:
        bound = "a component that is not placed by this one itself"
        raise part.refusal(_REFERENCE, inner[-1], bound, "Refer to the gear unit.")
    stated, shaft = Placement.of(part, inner), part.shaft
    if stated is not None:
        return stated
    if shaft is None or shaft.id == part.id:
        return _in_reference(part, np.zeros(3), inner)
    base = frame_of(shaft, (*inner, part.id))
    along = part.number("u_coordinate_on_shaft", "place along the shaft") or 0.0
    return Placement(base.origin + along * base.u, base.axes)


def u_on_shaft(part: Part) -> float | None:
    """Return u of a component on its shaft, m: by the places of both, else by its coordinate.

    One writer gives the begin of a gear as its coordinate: its place, that of its middle, counts.
    """
    shaft, place = part.shaft, Placement.of(part)
    base = None if shaft is None else Placement.of(shaft)
    stated = part.number("u_coordinate_on_shaft", "place along the shaft")
    return stated if place is None or base is None else base.along(place.origin)


def _in_reference(part: Part, origin: FloatArray, inner: tuple[int, ...]) -> Placement:
    u = _unit(part, "u_axis_vector", np.array([1.0, 0.0, 0.0]))
    axis = _unit(part, "w_axis_vector", np.eye(3)[2 if abs(u[2]) < 0.9 else 1])
    across = axis - (axis @ u) * u
    length = float(np.linalg.norm(across))
    if length < PARALLEL:
        raise part.refusal("w_axis_vector", list(map(float, axis)), "not along u_axis_vector")
    w = np.asarray(across / length)
    own, outer = Placement(origin, np.array([u, np.cross(w, u), w])), _reference(part)
    return own if outer is None else own.within(frame_of(outer, (*inner, part.id)))


def _reference(part: Part) -> Part | None:
    """Return the component that a place refers to, None for one that is placed by itself: the root."""
    attribute = part.attribute(_REFERENCE)
    if attribute is None or attribute.kind != "reference_component" or not isinstance(attribute.value, int):
        return None
    part.say(_REFERENCE, "taken", f"its place refers to component {attribute.value}")
    return None if attribute.value == part.id else part.unit.part(attribute.value)


def _unit(part: Part, item: str, usual: FloatArray) -> FloatArray:
    vector = _vector(part, item, "axis")
    if vector is None:
        if part.value(item) is None:
            part.say(item, "defaulted", f"{usual.tolist()}")
        return usual
    length = math.hypot(*vector)
    if length == 0.0:
        raise part.refusal(item, vector.tolist(), "a vector that has a direction")
    return np.asarray(vector / length)


def _vector(part: Part, item: str, words: str) -> FloatArray | None:
    numbers = part.vector(item, words)
    if numbers is None:
        return None
    if len(numbers) != 3 or not np.all(np.isfinite(numbers)):
        raise part.refusal(item, list(numbers), "three finite numbers")
    return np.array(numbers, dtype=float)


# The axes of the scene: z along the shafts, x and y along v and w of the gear unit.


@dataclass(frozen=True)
class SceneAxes:
    """The frame of the scene.

    `rows` (3, 3): unit vectors x, y, z of the scene in the frame of the model.
    """

    rows: FloatArray

    @classmethod
    def of(cls, root: Placement | None, shafts: Iterable[Placement]) -> SceneAxes:
        """Return the axes for shafts that are parallel to the first of them.

        u of the gear unit, whose place is `root`, is z if the first shaft is parallel to it, in either sense;
        else that of the first shaft.
        """
        unit = root or FIXED
        first = next(iter(shafts), unit)
        parallel = float(np.linalg.norm(np.cross(unit.axes[0], first.axes[0]))) <= PARALLEL
        u, v, w = unit.axes if parallel else first.axes
        return cls(np.array([v, w, u]))

    def point(self, origin: FloatArray) -> FloatArray:
        """Return a point of the model in x, y, z, m."""
        return np.asarray(self.rows @ origin)

    def sense(self, place: Placement) -> int:
        """Return +1 where u of a place is along z, -1 where it is against it, 0 where it is neither."""
        along = float(self.rows[2] @ place.axes[0])
        across = float(np.linalg.norm(np.cross(self.rows[2], place.axes[0])))
        return 0 if across > PARALLEL else (1 if along > 0.0 else -1)

    def turn(self, place: Placement) -> FloatArray:
        """Return the matrix that takes u, v, w of a place to x, y, z."""
        return np.asarray(self.rows @ place.axes.T)


# Shafts of a REXS model: where they stand along the scene's z axis, and their sections.


SAME_PLACE = 1e-6
"""m; file and sum of lengths agree to rounding."""
_LENGTHS = ("length", "outer_diameter_begin", "outer_diameter_end")


@dataclass(frozen=True)
class PlacedShaft:
    """A shaft along the z axis of the scene."""

    part: Part
    place: Placement
    """In the frame of the model; its origin is u = 0."""
    start: FloatArray
    """Of u = 0 in the scene, m. Shape (3,)."""
    sense: int
    """+1 where u is along z, -1 where it is against it."""
    begin: float
    end: float
    """`begin`, `end`: u of both ends, m."""
    sections: tuple[BeamSection, ...] = ()
    """From the left end, the lower z; none where the file has none."""

    @classmethod
    def of(cls, part: Part, place: Placement, axes: SceneAxes) -> PlacedShaft:
        """Return a shaft with its sections."""
        rows = tuple(_rows(part))
        sense = axes.sense(place)
        begin = rows[0][0] if rows else 0.0
        sections = tuple(section if sense > 0 else _turned(section) for _, section in rows)
        end = begin + sum(section.length for section in sections)
        along_z = sections if sense > 0 else sections[::-1]
        return cls(part, place, axes.point(place.origin), sense, begin, end, along_z)

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
        return float(np.linalg.norm(np.cross(self.place.axes[0], point - self.place.origin)))

    def outer_diameter(self, u: float) -> float:
        """Return the outer diameter at a u, m; 0 without sections."""
        position, left = self.position(u), 0.0
        for section in self.sections:
            if left - SAME_PLACE <= position <= left + section.length + SAME_PLACE:
                share = min(1.0, max(0.0, (position - left) / section.length))
                first, last = section.outer_diameters
                return first + share * (last - first)
            left += section.length
        return 0.0


def _rows(shaft: Part) -> Iterator[tuple[float, BeamSection]]:
    """Yield u of the left end and the section of each piece, one after the other; state other places."""
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
        stated = part.number(item, "left end of the section, mm")
        derived = f"{at * 1e3:.6g} mm, the sum of the lengths before it"
        if stated is None:
            part.say(item, "derived", derived)
        elif abs(stated - at) > SAME_PLACE:
            part.say(item, "refused", f"{stated * 1e3:.6g} mm leaves a gap or overlaps; taken: {derived}")
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
    if value is None or not 0.0 < value <= 100.0:
        written = None if value is None else value * 1e3
        raise part.refusal(item, written, "above 0 mm and at most 100000 mm")
    return value


def _material(shaft: Part) -> dict[str, float]:
    names = {"elastic_modulus": "youngs_modulus", "poisson_ratio": "poissons_ratio", "density": "density"}
    for part in shaft.referenced:
        if part.type == "material":
            values = {own: part.number(item, f"{own} of the shaft") for item, own in names.items()}
            return {own: value for own, value in values.items() if value}
    return {}


def _turned(section: BeamSection) -> BeamSection:
    """Return a section seen from its other end."""
    if section.end_outer_diameter is None:
        return section
    outer, bore = section.outer_diameters, section.bore_diameters
    material = section.youngs_modulus, section.poissons_ratio, section.density
    return BeamSection(section.length, outer[1], bore[1], *material, outer[0], bore[0])
