"""The unit's gear case as a STEP file, in the frame of its scene: a casting of two halves, here one solid.

    python examples/two_stage/gear_case.py unit/before/scene.toml unit/gear_case.step

Bores are where the scene has its bearings, with the outer diameters of the REXS file. gmsh changes signal
handlers, so this runs as a process of its own.
"""

from __future__ import annotations

import argparse
import math
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lineofaction.gearbox.rexs.files import read_rexs

REXS = Path(__file__).parent / "two_stage.rexs"
RING_WIDTH = {"6206": 16.0, "30207": 15.0, "30212": 19.0}
"""Of the outer ring, mm, ISO 15 and ISO 355: the REXS file does not say it."""

WALL, END_WALL = 8.0, 12.0
"""Thickness of the walls along the shafts and across them, mm."""
INSIDE = 4.0, 166.0
"""Inner faces of the end walls, z in mm."""
OUTLINE = ((95.5, 149.0, 132.0), (-30.0, -65.0, 20.0), (205.0, -65.0, 20.0))
"""Circles x, y, radius in mm that the inner wall wraps, counter-clockwise: the large wheel, the bottom."""
BOSS, RIB_WIDTH, RIB_HEIGHT = 11.0, 10.0, 15.0
"""A boss is larger than its bore by this radius, and stands out of the end wall as high as the ribs; mm."""
OPENING = {"input, motor side": 38.0, "output, far side": 70.0}
"""Diameter of the openings for the shafts that leave the case, mm."""
FLANGE_WIDTH, FLANGE = 14.0, (78.0, 94.0)
"""Of both halves at the parting plane: how far it stands out, from z to z; mm."""
RIBS = {"input": (180.0,), "intermediate": (90.0, 270.0, 350.0), "output": (35.0, 90.0, 145.0, 210.0)}
"""Directions of the ribs from the bosses of a shaft to the edge, on both end walls, degrees from x."""
PAD, PAD_HEIGHT, PAD_OUT = 52.0, 8.0, 20.0
"""Feet: side of the square, height, and how far they stand out along the shafts; mm."""
RAIL = 14.0
"""Height of the two rails between bottom and feet, mm."""

Solids = list[tuple[int, int]]
Circle = tuple[float, float, float]


@dataclass(frozen=True)
class Seat:
    """A bearing's outer ring in the case, mm."""

    name: str
    """Of the bearing."""
    center: tuple[float, float, float]
    """Of the ring, in the frame of the scene. Shape (x, y, z)."""
    diameter: float
    width: float
    """`diameter`, `width`: Of the ring."""

    @property
    def motor_side(self) -> bool:
        """Whether it is in the end wall at low z."""
        return self.center[2] < sum(INSIDE) / 2.0

    @property
    def inner_end(self) -> float:
        """Where the ring ends towards the inside, z."""
        return self.center[2] + (0.5 if self.motor_side else -0.5) * self.width

    @property
    def outer_end(self) -> float:
        """Where the ring ends towards the outside, z."""
        return 2.0 * self.center[2] - self.inner_end


def seats_of(scene: dict[str, Any]) -> tuple[Seat, ...]:
    """Return the seats of a scene's rolling bearings; their rings are those of the REXS file."""
    rings = {part.name: part for _, part in read_rexs(REXS).model.all_components() if part.name}
    origins = {shaft["name"]: shaft["origin_mm"] for shaft in scene["shafts"]}

    def seat(bearing: dict[str, Any]) -> Seat:
        ring, (x, y, z) = rings[bearing["name"]], origins[bearing["shaft"]]
        diameter, line = (ring.attribute(name) for name in ("outer_diameter", "catalogue_designation"))
        assert diameter is not None and line is not None
        center = (x, y, z + bearing["position_mm"])
        return Seat(bearing["name"], center, float(str(diameter.value)), RING_WIDTH[str(line.value)])

    return tuple(seat(bearing) for bearing in scene["rolling_bearings"])


def bottom() -> float:
    """Return where the case stands, y in mm."""
    return min(y - radius for _, y, radius in OUTLINE) - WALL - RAIL - PAD_HEIGHT


def points() -> list[dict[str, Any]]:
    """Return the points of the case whose motion is of interest, as a housing of the scene has them."""
    top = max(y + radius for _, y, radius in OUTLINE) + WALL
    at = {
        "top": (95.5, top, 60.0),
        "motor side": (95.5, 75.0, INSIDE[0] - END_WALL - RIB_HEIGHT),
        "far side": (95.5, 75.0, INSIDE[1] + END_WALL + RIB_HEIGHT),
    }
    return [{"name": name, "position_mm": list(position)} for name, position in at.items()]


def tangent(first: Circle, second: Circle) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return where the line that has both circles on its left touches them, x and y."""
    (x1, y1, r1), (x2, y2, r2) = first, second
    direction = math.atan2(y2 - y1, x2 - x1) - math.acos((r1 - r2) / math.hypot(x2 - x1, y2 - y1))
    away = math.cos(direction), math.sin(direction)
    return (x1 + r1 * away[0], y1 + r1 * away[1]), (x2 + r2 * away[0], y2 + r2 * away[1])


class Casting:
    """Solids of gmsh's modeler; z is along the shafts, everything in mm."""

    def __init__(self, occ: Any) -> None:
        self.occ = occ

    def wrapped(self, offset: float, z: tuple[float, float]) -> Solids:
        """Return the body that wraps the outline at a distance, from z to z."""
        circles = [(x, y, radius + offset) for x, y, radius in OUTLINE]
        lines = [tangent(a, b) for a, b in zip(circles, circles[1:] + circles[:1], strict=True)]
        ends = [[self.occ.addPoint(*end, z[0]) for end in line] for line in lines]
        curves = []
        for k, circle in enumerate(circles):
            curves += [self.arc(circle, lines[k - 1][1], lines[k][0], (ends[k - 1][1], ends[k][0]), z[0])]
            curves += [self.occ.addLine(*ends[k])]
        face = self.occ.addPlaneSurface([self.occ.addCurveLoop(curves)])
        return [part for part in self.occ.extrude([(2, face)], 0, 0, z[1] - z[0]) if part[0] == 3]

    def arc(self, circle: Circle, start: Any, end: Any, points: tuple[int, int], z: float) -> int:
        """Return the arc of a circle from one point to another, counter-clockwise."""
        x, y, radius = circle
        first, last = (math.atan2(at[1] - y, at[0] - x) for at in (start, end))
        middle = first + ((last - first) % (2.0 * math.pi)) / 2.0
        through = self.occ.addPoint(x + radius * math.cos(middle), y + radius * math.sin(middle), z)
        return int(self.occ.addCircleArc(points[0], through, points[1], center=False))

    def disc(self, seat: Seat, diameter: float, z: tuple[float, float]) -> Solids:
        """Return a cylinder on a seat's axis, from z to z."""
        x, y, _ = seat.center
        return [(3, self.occ.addCylinder(x, y, z[0], 0, 0, z[1] - z[0], diameter / 2.0))]

    def rib(self, seat: Seat, angle: float, z: tuple[float, float]) -> Solids:
        """Return a rib from a seat's boss outwards."""
        x, y, _ = seat.center
        start = x + seat.diameter / 2.0  # inside the boss
        box = [(3, self.occ.addBox(start, y - RIB_WIDTH / 2.0, z[0], 400.0, RIB_WIDTH, z[1] - z[0]))]
        self.occ.rotate(box, x, y, z[0], 0, 0, 1, math.radians(angle))
        return box

    def fused(self, parts: Iterable[Solids]) -> Solids:
        """Return the union of solids."""
        first, *others = parts
        return list(self.occ.fuse(first, [solid for part in others for solid in part])[0])

    def cut(self, solid: Solids, away: Iterable[Solids]) -> Solids:
        """Return a solid without others."""
        return list(self.occ.cut(solid, [part for parts in away for part in parts])[0])


def outside(seat: Seat, beyond: float = 0.0) -> float:
    """Return the outer face of a seat's end wall, or what is beyond it; z."""
    return INSIDE[0] - END_WALL - beyond if seat.motor_side else INSIDE[1] + END_WALL + beyond


def span(a: float, b: float) -> tuple[float, float]:
    """Return two ends in order."""
    return min(a, b), max(a, b)


def ribs(casting: Casting, seats: tuple[Seat, ...]) -> Solids:
    """Return all ribs, ending at the outline of the case."""
    solids: Solids = []
    for seat in seats:
        z = span(outside(seat), outside(seat, RIB_HEIGHT))
        angles = RIBS[seat.name.split(",")[0]]
        solids += [solid for angle in angles for solid in casting.rib(seat, angle, z)]
    end = span(outside(seats[0], RIB_HEIGHT), outside(seats[1], RIB_HEIGHT))
    return list(casting.occ.intersect(solids, casting.wrapped(WALL, end))[0])


def feet(casting: Casting) -> Solids:
    """Return two rails along the shafts under the bottom, and a pad under each of their ends."""
    (_, _, _), (low, _, radius), (high, _, _) = OUTLINE
    front, back = INSIDE[0] - END_WALL - PAD_OUT, INSIDE[1] + END_WALL + PAD_OUT
    y, height = bottom() + PAD_HEIGHT, RAIL + WALL / 2.0
    sides = low - radius - WALL, high + radius + WALL - PAD
    rails = [casting.occ.addBox(x, y, front, PAD, height, back - front) for x in sides]
    pads = [
        casting.occ.addBox(x, bottom(), z, PAD, PAD_HEIGHT, PAD) for x in sides for z in (front, back - PAD)
    ]
    return [(3, part) for part in (*rails, *pads)]


def case(casting: Casting, seats: tuple[Seat, ...]) -> Solids:
    """Return the case: walls, flange, ribs, bosses and feet, then bores and openings."""
    ends = span(outside(seats[0]), outside(seats[1]))
    walls = casting.cut(casting.wrapped(WALL, ends), [casting.wrapped(0.0, INSIDE)])
    flange = casting.cut(casting.wrapped(WALL + FLANGE_WIDTH, FLANGE), [casting.wrapped(WALL / 2.0, FLANGE)])
    bosses = [
        casting.disc(seat, seat.diameter + 2.0 * BOSS, span(seat.inner_end, outside(seat, RIB_HEIGHT)))
        for seat in seats
    ]
    body = casting.fused([walls, flange, feet(casting), ribs(casting, seats), *bosses])
    bores = [casting.disc(seat, seat.diameter, span(seat.inner_end, seat.outer_end)) for seat in seats]
    openings = [
        casting.disc(seat, OPENING[seat.name], span(seat.center[2], outside(seat, 2.0 * RIB_HEIGHT)))
        for seat in seats
        if seat.name in OPENING
    ]
    return casting.cut(body, bores + openings)


def main() -> None:
    """Write the case and say its size."""
    import gmsh  # noqa: PLC0415 - the seats alone need none of it

    parser = argparse.ArgumentParser(description="Write the unit's gear case as a STEP file.")
    parser.add_argument("scene", type=Path, help="scene with the shafts and bearings")
    parser.add_argument("step", type=Path, help="STEP file to write")
    options = parser.parse_args()
    seats = seats_of(tomllib.loads(options.scene.read_text("utf-8")))
    gmsh.initialize(readConfigFiles=False)
    gmsh.option.setNumber("General.Terminal", 0)
    solids = case(Casting(gmsh.model.occ), seats)
    gmsh.model.occ.synchronize()
    assert len(solids) == 1, "the parts of the case hang together"
    gmsh.write(str(options.step))
    print(f"{options.step}: {gmsh.model.occ.getMass(*solids[0]) / 1000.0:.0f} cm^3 of iron")
    gmsh.finalize()


if __name__ == "__main__":
    main()
