"""The bodies that a scene is drawn as: shafts by their sections, gears, bearings, housings."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict, replace

import numpy as np
from numpy.typing import NDArray

from bounds.types import IntArray, Json
from dynamics.bearings import CatalogLine
from dynamics.effects.ledger import mechanism_of
from dynamics.mechanism.bodies import modal_housing
from dynamics.shafts import Shaft
from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.convert.declared import in_si
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.reading import validated
from lineofaction.gearbox.studies.bodies import BEARING, PINION, SHAFT, WHEEL, Body, Hull, Ring

SLENDER = 8.0
"""Length over diameter of a shaft without sections."""
BUSHING = 1.7
"""Outer diameter over shaft diameter of a bearing for which no catalog states the outer diameter."""
WIDTH = 1.1
"""Width of a bearing over its height."""
ADDENDUM, DEDENDUM = 1.0, 1.25
"""Addendum and dedendum over the module, for gears without a case."""
_ROUNDING = 1e-12
"""Rounding of a sum of lengths, m."""

MAX_FACETS = 2_000
"""Most facets of a housing in a picture: 32 kB of the result."""


def bodies_of(subject: TabledScene) -> list[Json]:
    """Return the bodies of a scene as plain JSON for its results; copies of planets are bodies too."""
    shafts = (_body(SHAFT, shaft.name, shaft, *_sections(shaft)) for shaft in subject.scene.shafts)
    bodies: list[Json] = []
    for part in (*shafts, *_gears(subject), *_bearings(subject)):
        bodies.append({**asdict(part), "axis": list(part.axis), "rings": [*map(asdict, part.rings)]})
    return bodies + [hull.written for hull, _ in _hulls(subject)]


def _hulls(subject: TabledScene) -> Iterator[tuple[Hull, IntArray]]:
    """Yield the drawn surface of each housing that is reduced from a solid, and the indices of its points.

    The indices are those of points of `housing.surface`.
    """
    from dynamics.housings.drawn_surface import DrawnSurface  # noqa: PLC0415 (start-up time)

    for name, housing in subject.housings.items():
        surface = housing.surface
        if surface is not None:
            used, corners = np.unique(surface.triangles[:, :3], return_inverse=True)
            fine = DrawnSurface(surface.points[used], corners.reshape(-1, 3))
            drawn, node_index = fine.reduced(MAX_FACETS)
            yield Hull(name, drawn.points, drawn.facets), used[node_index]


def surface_motion(subject: TabledScene, freedom: Sequence[str]) -> NDArray[np.float32]:
    """Return the motion of all points of a scene's surfaces per freedom, (p, 3, n), 32 bits.

    `freedom` are the names of a system's freedoms. The array has no points if no freedom moves a housing.
    """
    from dynamics.housings import scene_axes  # noqa: PLC0415 (start-up time)

    number = {name: column for column, name in enumerate(freedom)}
    parts = {part.name: part for part in subject.scene.housings}
    motions = [np.zeros((0, 3, len(freedom)), dtype=np.float32)]
    for hull, nodes in _hulls(subject):
        body = subject.housings[hull.name]
        motion = np.zeros((len(nodes), 3, len(freedom)), dtype=np.float32)
        if f"{hull.name}.mode_1" in number and body.surface is not None:
            modal = modal_housing(parts[hull.name])
            columns = [number[f"{hull.name}.{kind}"] for kind in modal.kinds]
            motion[..., columns] = body.surface.motion[nodes] @ (scene_axes(body) @ modal.rows)
        motions.append(motion)
    all_motions = np.concatenate(motions)
    return all_motions if np.any(all_motions) else np.empty((0, 3, 0), dtype=np.float32)


def _body(kind: str, name: str, shaft: Shaft, *rings: Ring) -> Body:
    """Return a body on a shaft; the positions of `rings` count from the shaft's left end, m."""
    x, y, z = map(float, shaft.origin)
    at = (replace(ring, low=ring.low + z, high=ring.high + z) for ring in rings if ring.high > ring.low)
    return Body(kind, name, (x, y), tuple(at))


def _sections(shaft: Shaft) -> Iterator[Ring]:
    """Yield the sections of a shaft from its left end; a shaft without sections is one slender cylinder."""
    if not shaft.sections:
        radius = 0.5 * shaft.length / SLENDER
        yield Ring(0.0, shaft.length, 0.0, radius, radius)
    low = 0.0
    for section in shaft.sections:
        end = section.end_outer_diameter or section.outer_diameter
        radii = (0.5 * size for size in (section.bore_diameter, section.outer_diameter, end))
        yield Ring(low, low + section.length, *radii)
        low += section.length


def _radius(shaft: Shaft, position: float) -> float:
    """Return the radius of a shaft at a position along it, m."""
    rings = list(_sections(shaft))
    ring = next((ring for ring in rings if position <= ring.high + _ROUNDING), rings[-1])
    part = min(max((position - ring.low) / (ring.high - ring.low), 0.0), 1.0)
    return ring.outer + part * (ring.outer_high - ring.outer)


def _gears(subject: TabledScene) -> Iterator[Body]:
    """Yield gears as discs of their face width and tip diameter; ring gears as rings of two tooth heights."""
    scene = subject.scene
    radii = _gear_radii(subject)
    driven = {mesh.driven for mesh in scene.meshes} - {mesh.driver for mesh in scene.meshes}
    for gear in scene.gears:
        low = gear.position - 0.5 * gear.face_width
        high = gear.position + 0.5 * gear.face_width
        tip, root = radii[gear.name]
        inner, outer = (tip, 2.0 * root - tip) if gear.internal else (0.0, tip)
        kind = WHEEL if gear.name in driven else PINION
        yield _body(kind, gear.name, scene.shaft(gear.shaft), Ring(low, high, inner, outer, outer))


def _gear_radii(subject: TabledScene) -> dict[str, tuple[float, float]]:
    """Return the radii of tip and root of every gear, m: of its case, or else of its operating module."""
    scene, of_cases = subject.scene, _radii_of_cases(subject)
    lines = mechanism_of(scene).lines if scene.meshes else ()
    cosine: dict[str, float] = {}
    for mesh, line in zip(scene.meshes, lines, strict=True):
        cosine |= dict.fromkeys((mesh.driver, mesh.driven), float(np.cos(line.working_pressure_angle)))
    radii = {}
    for gear in scene.gears:
        pitch = gear.base_radius / cosine.get(gear.name, 1.0)
        module = 2.0 * pitch / gear.teeth
        sign = -1.0 if gear.internal else 1.0
        by_module = (pitch + sign * ADDENDUM * module, pitch - sign * DEDENDUM * module)
        radii[gear.name] = of_cases.get(gear.name, by_module)
    return radii


def _radii_of_cases(subject: TabledScene) -> dict[str, tuple[float, float]]:
    """Return the radii of the gears whose meshes have a case; copies of a planet share the table of one."""
    meshes, known = subject.scene.meshes, subject.databases
    written = {mesh.name: mesh for mesh in subject.inputs.meshes}
    tables = {id(mesh.table): mesh.name for mesh in meshes if mesh.name in known}
    radii: dict[str, tuple[float, float]] = {}
    for mesh in meshes:
        name = mesh.name if mesh.name in known else tables.get(id(mesh.table), "")
        if name not in known or not known[name].metadata.case:
            continue
        try:
            pair = gear_pair(validated(Case, known[name].metadata.case))
        except BadInput:  # a table of another version, or one that no case here made
            continue
        names = (mesh.driven, mesh.driver) if written[name].wheel_drives else (mesh.driver, mesh.driven)
        for gear, toothing in zip(names, (pair.pinion, pair.wheel), strict=True):
            radii[gear] = (toothing.tip_radius, toothing.root_radius)
    return radii


def _bearings(subject: TabledScene) -> Iterator[Body]:
    scene = subject.scene
    outside = {
        part.name: 0.5 * in_si(CatalogLine, part.catalog)["outside_diameter"]
        for part in subject.inputs.rolling_bearings
        if part.catalog is not None
    }
    for part in (*scene.ground_bearings, *scene.planet_bearings):
        shaft = scene.shaft(part.shaft)
        inner = _radius(shaft, part.position)
        outer = max(outside.get(part.name, BUSHING * inner), inner)
        half = 0.5 * WIDTH * (outer - inner)
        ring = Ring(part.position - half, part.position + half, inner, outer, outer)
        yield _body(BEARING, part.name, shaft, ring)
