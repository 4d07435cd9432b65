"""The outline of a gearbox from its scene."""

from __future__ import annotations

import numpy as np

from dynamics.effects.ledger import mechanism_of
from dynamics.scene import Scene
from dynamics.shafts import Shaft
from lineofaction.gearbox.studies.deflect.result import Outline

RIGID_DIAMETER = 0.08
"""Of a shaft without sections over its length: it is drawn as a line of some width."""


def outline_of(scene: Scene) -> Outline:
    """Return the outline of a scene; bearings are those to the ground and planet bearings."""
    index = {shaft.name: k for k, shaft in enumerate(scene.shafts)}
    supports = (*scene.ground_bearings, *scene.planet_bearings)
    pieces = [(k, *piece) for k, shaft in enumerate(scene.shafts) for piece in _pieces(shaft)]
    diameter = _pitch_diameters(scene)
    return Outline(
        tuple(shaft.name for shaft in scene.shafts),
        tuple(gear.name for gear in scene.gears),
        tuple(part.name for part in supports),
        np.array([shaft.origin for shaft in scene.shafts], dtype=float).reshape(-1, 3),
        np.array([shaft.length for shaft in scene.shafts]),
        np.array([piece[0] for piece in pieces], dtype=np.int64),
        np.array([piece[1:] for piece in pieces], dtype=float).reshape(-1, 4),
        np.array([index[gear.shaft] for gear in scene.gears], dtype=np.int64),
        np.array([(g.position, g.face_width, diameter[g.name]) for g in scene.gears]).reshape(-1, 3),
        np.array([index[part.shaft] for part in supports], dtype=np.int64),
        np.array([part.position for part in supports]),
    )


def _pieces(shaft: Shaft) -> list[tuple[float, float, float, float]]:
    """Return start, length and both diameters of the pieces of a shaft, m."""
    if not shaft.sections:
        return [(0.0, shaft.length, RIGID_DIAMETER * shaft.length, RIGID_DIAMETER * shaft.length)]
    pieces, start = [], 0.0
    for section in shaft.sections:
        end = section.end_outer_diameter or section.outer_diameter
        pieces.append((start, section.length, section.outer_diameter, end))
        start += section.length
    return pieces


def _pitch_diameters(scene: Scene) -> dict[str, float]:
    """Return the operating pitch diameter of every gear in its first mesh, m; of others that of the base."""
    diameter = {gear.name: 2.0 * gear.base_radius for gear in scene.gears}
    seen: set[str] = set()
    for mesh, line in zip(scene.meshes, mechanism_of(scene).lines, strict=True):
        for name in {mesh.driver, mesh.driven} - seen:
            diameter[name] = 2.0 * scene.gear(name).base_radius / float(np.cos(line.working_pressure_angle))
            seen.add(name)
    return diameter
