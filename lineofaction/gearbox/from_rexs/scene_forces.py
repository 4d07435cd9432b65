"""Forces of the scene: what acts on shafts from outside across and along their axes, by load case."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bounds.types import FloatArray
from lineofaction.gearbox.from_rexs.layout import Layout
from lineofaction.gearbox.from_rexs.load_case import DIGITS
from lineofaction.gearbox.from_rexs.names import Names
from lineofaction.gearbox.from_rexs.operating_points import FORCES, OperatingPoint
from lineofaction.gearbox.from_rexs.part import Part
from lineofaction.gearbox.from_rexs.scene_shafts import SceneShaft, SceneShafts
from lineofaction.gearbox.from_rexs.shafts import SAME_PLACE, PlacedShaft
from lineofaction.gearbox.units import MM

ROUNDING = 1e-12
"""Of the largest component of a vector: less is that of the turn of its axes."""


@dataclass(frozen=True)
class SceneForce:
    """A force and moment on a shaft of the scene, fixed in space.

    Attributes
    ----------
    name, shaft : str
        Its own and its shaft's name in the scene.
    position_mm : float
        Where it acts, from the left end of that shaft.
    load : int
        The external load that it is.
    turn : (3, 3) array
        Takes components along u, v, w of the load's shaft to x, y, z.
    lever : float
        Along z from where it acts in the scene to the load's place, m; 0 but beyond the end of its shaft.
    """

    name: str
    shaft: str
    position_mm: float
    load: int
    turn: FloatArray
    lever: float

    def stated(self, point: OperatingPoint) -> dict[str, Any]:
        """Return what an entry of a load case's forces says at an operating point.

        The moment about the axis is not in it: torques drive and load the train.
        """
        wrench = np.array(point.forces.get(self.load, (0.0,) * len(FORCES)))
        force, moment = self.turn @ wrench[:3], self.turn @ wrench[3:]
        moment[:2] += self.lever * np.array([-force[1], force[0]])
        moment[2] = 0.0
        return {"name": self.name, "force_n": _digits(force), "moment_n_m": _digits(moment)}

    def table(self, point: OperatingPoint) -> dict[str, Any]:
        """Return its table in a scene that runs at an operating point."""
        return {**self.stated(point), "shaft": self.shaft, "position_mm": self.position_mm}


def scene_forces(
    layout: Layout, points: Sequence[OperatingPoint], shafts: SceneShafts
) -> tuple[SceneForce, ...]:
    """Return the external loads that push or tilt a shaft at any of some operating points.

    The account says which are left out, and why.
    """
    acting = {load for point in points for load, wrench in point.forces.items() if any(wrench)}
    return tuple(_forces(layout, [p for p in layout.unit.of_type("external_load") if p.id in acting], shafts))


def _forces(layout: Layout, loads: Sequence[Part], shafts: SceneShafts) -> Iterator[SceneForce]:
    """Yield the forces of external loads on shafts of the scene."""
    names = Names()
    for part in loads:
        placed, reason = _placed(layout, part, shafts)
        if placed is None:
            _refuse(layout, part, reason)
            continue
        shaft, z = shafts.by_rotor[layout.rotor(placed.part.id)], layout.z_on(placed, part)
        position = shaft.position_mm(z)
        lever = z - shaft.begin - position * MM
        turn = layout.axes.turn(placed.place)
        part.say("", "taken", f"acts on shaft {shaft.name}")
        if part.number("width_of_external_load", "width of a line load, mm"):
            words = "a line load is not spread: its force acts at u_coordinate_on_shaft"
            part.say("width_of_external_load", "ignored", words)
        yield SceneForce(names.of(part), shaft.name, position, part.id, turn, _beyond(part, lever))


def _placed(layout: Layout, load: Part, shafts: SceneShafts) -> tuple[PlacedShaft | None, str]:
    """Return the shaft that a load acts on, or why its force cannot be one of the scene."""
    shaft = layout.unit.owner(load, "shaft")
    if shaft is None:
        return None, "acts on no shaft"
    if shaft.id not in layout.shafts or layout.rotor(shaft.id) not in shafts.by_rotor:
        return None, "acts on a shaft that the scene has not"
    if shaft.id in {planet.id for planets in layout.rotors.sets for planet in planets.planets}:
        return None, "acts on a planet, and a scene has one for all of its set"
    placed = layout.shafts[shaft.id]
    if not _coaxial(placed, shafts.by_rotor[layout.rotor(shaft.id)]):
        return None, "acts off the axis of the planet carrier that its shaft is part of"
    return placed, ""


def _coaxial(placed: PlacedShaft, shaft: SceneShaft) -> bool:
    """Return whether a shaft of the file is on the axis of the scene's shaft that it is part of."""
    apart = np.array(placed.origin[:2]) - MM * np.array(shaft.table["origin_mm"][:2])
    return bool(np.hypot(*apart) <= 1e2 * SAME_PLACE)


def _refuse(layout: Layout, load: Part, reason: str) -> None:
    """State of a load's forces and moments, its own and those of load cases, that they are left out."""
    cases = (part for case in layout.unit.load_cases() for part in case if part.id == load.id)
    for part in (load, *cases):
        for item in FORCES:
            attribute = part.attribute(item)
            if attribute is not None and attribute.value:
                part.say(item, "refused", reason)


def _beyond(load: Part, lever: float) -> float:
    """Return the distance of a load from the end of its shaft, m, and state it."""
    if abs(lever) <= SAME_PLACE:
        return 0.0
    words = f"{abs(lever) / MM:.6g} mm beyond the end of its shaft: the force is there, with its moment"
    load.say("u_coordinate_on_shaft", "derived", words)
    return lever


def _digits(vector: FloatArray) -> list[float]:
    """Return a vector without the rounding of its computation."""
    least = ROUNDING * float(np.max(np.abs(vector)))
    return [0.0 if abs(value) <= least else float(f"{value:.{DIGITS}g}") for value in vector]
