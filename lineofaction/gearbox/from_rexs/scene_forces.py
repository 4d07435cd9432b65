"""Forces and moments on shafts from outside, across and along the shafts' axes, by load case."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bounds.types import FloatArray
from lineofaction.gearbox.from_rexs.gear_unit import Part, rounded
from lineofaction.gearbox.from_rexs.layout import Layout
from lineofaction.gearbox.from_rexs.operating_points import FORCES, OperatingPoint
from lineofaction.gearbox.from_rexs.part_names import Names
from lineofaction.gearbox.from_rexs.placed_shafts import SAME_POSITION, PlacedShaft
from lineofaction.gearbox.from_rexs.scene_shafts import SceneShafts
from lineofaction.gearbox.units import MM

ROUNDING = 1e-12
"""Share of a vector's largest component below which a component is rounding of the rotation of its axes."""


@dataclass(frozen=True)
class SceneForce:
    """A force and moment on a shaft of the scene, fixed in space."""

    name: str
    shaft: str
    """`name`, `shaft`: Its own and its shaft's name in the scene."""
    position_mm: float
    """Position of the force from the left end of that shaft."""
    load: int
    """Id of the external load of the file."""
    rotation: FloatArray
    """Rotation from components along u, v, w of the load's shaft to x, y, z. Shape (3, 3)."""
    lever: float
    """Distance along z from the force in the scene to the load in the file, m; 0 unless the load is beyond
    the shaft's end."""

    def entry(self, point: OperatingPoint) -> dict[str, Any]:
        """Return the entry of a load case's forces at an operating point.

        The moment about the axis is not in it: torques drive and load the train.
        """
        wrench = np.array(point.forces.get(self.load, (0.0,) * len(FORCES)))
        force, moment = self.rotation @ wrench[:3], self.rotation @ wrench[3:]
        moment[:2] += self.lever * np.array([-force[1], force[0]])
        moment[2] = 0.0
        return {"name": self.name, "force_n": _digits(force), "moment_n_m": _digits(moment)}

    def table(self, point: OperatingPoint) -> dict[str, Any]:
        """Return the table of the force in a scene that runs at an operating point."""
        return {**self.entry(point), "shaft": self.shaft, "position_mm": self.position_mm}


def scene_forces(
    layout: Layout, points: Sequence[OperatingPoint], shafts: SceneShafts
) -> Iterator[SceneForce]:
    """Yield the external loads that push or tilt a shaft at one of the operating points at least.

    The account says which loads are left out, and why.
    """
    names = Names()
    acting = {load for point in points for load, wrench in point.forces.items() if any(wrench)}
    for part in layout.unit.of_type("external_load"):
        if part.id not in acting:
            continue
        placed, reason = _placed(layout, part, shafts)
        if placed is None:
            _refuse(layout, part, reason)
            continue
        shaft, z = shafts.by_rotor[layout.rotor(placed.part.id)], layout.z_on(placed, part)
        position = shaft.position_mm(z)
        lever = z - shaft.begin - position * MM
        rotation = layout.axes.rotation(placed.placement)
        part.say("", "taken", f"acts on shaft {shaft.name}")
        if part.number("width_of_external_load", "width of a line load, mm"):
            text = "a line load is not spread: its force acts at u_coordinate_on_shaft"
            part.say("width_of_external_load", "ignored", text)
        if abs(lever) <= SAME_POSITION:
            lever = 0.0
        else:
            text = f"{abs(lever) / MM:.6g} mm beyond the end of its shaft"
            part.say("u_coordinate_on_shaft", "derived", f"{text}: the force is there, with its moment")
        yield SceneForce(names.of(part), shaft.name, position, part.id, rotation, lever)


def _placed(layout: Layout, load: Part, shafts: SceneShafts) -> tuple[PlacedShaft | None, str]:
    """Return the shaft that a load acts on, or why its force cannot be one of the scene."""
    shaft = load.shaft
    if shaft is None:
        return None, "acts on no shaft"
    if shaft.id not in layout.shafts or layout.rotor(shaft.id) not in shafts.by_rotor:
        return None, "acts on a shaft that the scene has not"
    if shaft.id in {planet.id for planets in layout.rotors.sets for planet in planets.planets}:
        return None, "acts on a planet, and a scene has one for all of its set"
    placed = layout.shafts[shaft.id]
    axis = MM * np.array(shafts.by_rotor[layout.rotor(shaft.id)].table["origin_mm"][:2])
    if not np.hypot(*(np.array(placed.origin[:2]) - axis)) <= 1e2 * SAME_POSITION:
        return None, "acts off the axis of the planet carrier that its shaft is part of"
    return placed, ""


def _refuse(layout: Layout, load: Part, reason: str) -> None:
    """State that a load's forces and moments are left out, also those of load cases."""
    cases = (part for case in layout.unit.load_cases() for part in case if part.id == load.id)
    for part in (load, *cases):
        for item in FORCES:
            if part.value(item):
                part.say(item, "refused", reason)


def _digits(vector: FloatArray) -> list[float]:
    minimum = ROUNDING * float(np.max(np.abs(vector)))
    return [0.0 if abs(value) <= minimum else rounded(value) for value in vector]
