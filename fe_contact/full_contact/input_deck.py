"""Input deck of CalculiX for one loaded position of a pair; units mm, N, MPa.

Plane strain in six-node triangles, small displacements, surface-to-surface penalty contact without friction.
Gear 2's bore is held. Gear 1's is rigid and turns clockwise about its center by u / r_b1, where u is the
displacement of one node of its own, so that the force conjugate to the transmission error is F_bt.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from fe_contact.full_contact.condensation.placed_mesh import PlacedBody
from fe_contact.full_contact.placed_pair import PlacedPair, flank_sides
from fe_contact.material import Material
from fe_contact.types import FloatArray, IntArray

MM, MPA = 1e3, 1e-6
PER_LINE = 8
TURNING, HELD = "TURNING", "HELD"
"""Node sets that are printed: the turning of gear 1, and gear 2's bore."""


@dataclass(frozen=True)
class Loading:
    """The load of a placed pair.

    Attributes
    ----------
    materials : (Material, Material)
    base_radius : float
        Of gear 1, m.
    face_width : float
        m.
    transverse_force : float
        F_bt in N: the torque on gear 1 over its base radius.
    penalty : float
        Pressure over overlap in the contact, Pa/m.
    """

    materials: tuple[Material, Material]
    base_radius: float
    face_width: float
    transverse_force: float
    penalty: float


def input_deck(placed: PlacedPair, loading: Loading) -> str:
    """Return the deck of one position."""
    gears, bodies = placed.gears, numbered_bodies(placed.gears)
    turning = bodies[-1].last_node + 1
    lines = ["*HEADING", "full contact of a gear pair, mm N MPa", "*NODE, NSET=ALL"]
    for gear, body in zip(gears, bodies, strict=True):
        lines += _nodes(gear.points, body)
    lines += [f"{turning},0.,0.,0.", f"*NSET, NSET={TURNING}", f"{turning}"]
    lines += [f"*NSET, NSET={HELD}", *_list(bodies[1].first_node + gears[1].held)]
    for gear, body, material in zip(gears, bodies, loading.materials, strict=True):
        lines += _body(gear, body, material, loading.face_width)
    lines += _contact(placed, bodies, loading.penalty)
    lines += _rigid_bore(gears[0], bodies[0], turning, loading.base_radius)
    lines += ["*BOUNDARY", f"{HELD},1,2", f"{TURNING},2,3"]
    return "\n".join([*lines, *_step(loading.transverse_force), ""])


@dataclass(frozen=True)
class NumberedBody:
    """Numbers of one gear's nodes and elements in the deck."""

    name: str
    first_node: int
    first_element: int
    last_node: int


def numbered_bodies(gears: Sequence[PlacedBody]) -> tuple[NumberedBody, ...]:
    """Return the numbers of the gears, one after the other, from 1."""
    node, element, bodies = 1, 1, []
    for count, gear in enumerate(gears, start=1):
        bodies.append(NumberedBody(f"GEAR{count}", node, element, node + len(gear.points) - 1))
        node, element = node + len(gear.points), element + len(gear.triangles)
    return tuple(bodies)


def _nodes(points: FloatArray, body: NumberedBody) -> Iterable[str]:
    """One line for each node."""
    rows = (points * MM).tolist()
    return (f"{body.first_node + i},{_number(x)},{_number(y)},0." for i, (x, y) in enumerate(rows))


def _body(gear: PlacedBody, body: NumberedBody, material: Material, face_width: float) -> list[str]:
    rows = (gear.triangles + body.first_node).tolist()
    return [
        f"*ELEMENT, TYPE=CPE6, ELSET={body.name}",
        *(f"{body.first_element + i},{','.join(map(str, row))}" for i, row in enumerate(rows)),
        f"*MATERIAL, NAME={body.name}",
        "*ELASTIC",
        f"{_number(material.youngs_modulus * MPA)},{_number(material.poissons_ratio)}",
        f"*SOLID SECTION, ELSET={body.name}, MATERIAL={body.name}",
        _number(face_width * MM),
    ]


def _contact(placed: PlacedPair, bodies: Sequence[NumberedBody], penalty: float) -> list[str]:
    """Surfaces of the teeth that may touch, and what acts between them."""
    lines: list[str] = []
    for number, meeting in enumerate(placed.meetings):
        for gear, body, tooth in zip(placed.gears, bodies, meeting, strict=True):
            lines.append(f"*SURFACE, NAME={body.name}FLANK{number}, TYPE=ELEMENT")
            lines += [
                f"{body.first_element + e},S{side + 1}" for e, side in flank_sides(gear, tooth).tolist()
            ]
    lines += ["*SURFACE INTERACTION, NAME=FLANKS", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR"]
    lines.append(_number(penalty * MPA / MM))
    for number in range(len(placed.meetings)):
        lines.append("*CONTACT PAIR, INTERACTION=FLANKS, TYPE=SURFACE TO SURFACE")
        lines.append(f"{bodies[1].name}FLANK{number},{bodies[0].name}FLANK{number}")
    return lines


def _rigid_bore(gear: PlacedBody, body: NumberedBody, turning: int, base_radius: float) -> list[str]:
    """Tie the bore to the turning node: clockwise, u = (y, -x) theta, linear as displacements are small."""
    arms = ((gear.points[gear.held] - gear.center) / base_radius).tolist()
    lines = []
    for node, (x, y) in zip((gear.held + body.first_node).tolist(), arms, strict=True):
        lines += ["*EQUATION", "2", f"{node},1,1.,{turning},1,{_number(-y)}"]
        lines += ["*EQUATION", "2", f"{node},2,1.,{turning},1,{_number(x)}"]
    return lines


def _step(transverse_force: float) -> list[str]:
    """One static step, and what `result_file` reads."""
    load = ["*CLOAD", f"{TURNING},1,{_number(transverse_force)}"]
    prints = [f"*NODE PRINT, NSET={TURNING}", "U", f"*NODE PRINT, NSET={HELD}", "RF"]
    return ["*STEP, INC=100", "*STATIC", "1.,1.", *load, *prints, "*END STEP"]


def _list(numbers: IntArray) -> Iterable[str]:
    return (",".join(map(str, numbers[i : i + PER_LINE].tolist())) for i in range(0, len(numbers), PER_LINE))


def _number(value: float) -> str:
    """Write a number in the 20 characters that CalculiX reads of a field: it cuts off what is longer."""
    return f"{value:.12e}"
