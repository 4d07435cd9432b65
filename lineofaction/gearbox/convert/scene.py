"""Conversion of a scene file and its STE databases to the scene of dynamics."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from dynamics.effects.ledger import mechanism_of
from dynamics.joints import Housing
from dynamics.mechanism import with_planets
from dynamics.mechanism.base_pitches import PRINTED
from dynamics.mechanism.kinematics import at_steady_speeds
from dynamics.mechanism.motion_checks import check_motion
from dynamics.meshes import GearMesh, MeshTable
from dynamics.meshes.standard_sliding import StandardTeeth
from dynamics.meshes.stiffness_table import straight_table
from dynamics.scene import Scene
from fe_contact.ste import PairGeometry, SteDatabase
from lineofaction.gearbox.convert.boundary_errors import boundary_errors, named
from lineofaction.gearbox.convert.closed_form_meshes import _closed_forms
from lineofaction.gearbox.convert.complaint import complaint_of
from lineofaction.gearbox.convert.declared import in_si
from lineofaction.gearbox.convert.housings import (
    ANY_STIFFNESS,
    check_measured,
    housings_of,
    numbered_as_written,
    placeholder,
)
from lineofaction.gearbox.convert.scene_parts import GearTeeth, meshes_of, parts_of
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.units import DEGREE, MM, UM

if TYPE_CHECKING:
    from dynamics.housings import ReducedHousing

ANY_TEETH = StandardTeeth((20, 20), 0.04, 0.35, 0.0, 0.02)
"""Teeth of placeholders of tables: these have sliding data."""
_SAME = 1e-6  # relative difference within which lengths typed with a few digits are equal
NO_SOLIDS: Mapping[str, ReducedHousing] = {}


def _teeth_of(scene: SceneInput, geometry: Mapping[str, PairGeometry]) -> dict[str, GearTeeth]:
    """Teeth of every gear, by name; a gear in two meshes must be the same in both."""
    by_name: dict[str, GearTeeth] = {}
    for index, mesh in enumerate(scene.meshes):
        if mesh.wheel_drives and not geometry[mesh.name].internal:
            bound = "left out: the wheel of this case is no ring gear"
            remedy = "Give a case whose pinion is the gear that drives."
            raise BadInput.of(f"meshes[{index}].wheel_drives", True, bound, remedy)
        for side, role in enumerate(("driven", "driver") if mesh.wheel_drives else ("driver", "driven")):
            name, teeth = getattr(mesh, role), _side(geometry[mesh.name], side)
            known = by_name.setdefault(name, teeth)
            if known.teeth != teeth.teeth or not math.isclose(
                known.base_radius, teeth.base_radius, rel_tol=PRINTED
            ):
                bound = f"the gear of {known.teeth} teeth that its other mesh has ({teeth.teeth} teeth here)"
                raise BadInput.of(f"meshes[{index}].{role}", name, bound, "Check the cases of both meshes.")
    for index, gear in enumerate(scene.gears):
        if gear.name not in by_name:
            raise BadInput.of(
                f"gears[{index}].name", gear.name, "part of a mesh", "Add it to a mesh or remove it."
            )
    return by_name


def _side(geometry: PairGeometry, side: int) -> GearTeeth:
    """Return one gear of a pair; the hands are opposite for external gears, equal in a ring gear."""
    radius = geometry.base_radius[side]
    hand = geometry.helix_hand if side == 0 or geometry.internal else -geometry.helix_hand
    diameter = 2.0 * radius / math.cos(geometry.working_pressure_angle)
    helix, ring = hand * geometry.base_helix_angle, geometry.internal and side == 1
    thickness = None if geometry.base_tooth_thickness is None else geometry.base_tooth_thickness[side]
    return GearTeeth(geometry.teeth[side], radius, helix, diameter, geometry.face_width, ring, thickness)


def _check_center_distances(scene: SceneInput, geometry: Mapping[str, PairGeometry]) -> None:
    """Refuse axes of meshing gears at another distance than their database states."""
    origin = {shaft.name: shaft.origin_mm for shaft in scene.shafts}
    carrier = {gear.name: gear.shaft for gear in scene.gears}
    number = {shaft.name: index for index, shaft in enumerate(scene.shafts)}
    for mesh in scene.meshes:
        first, second = origin[carrier[mesh.driver]], origin[carrier[mesh.driven]]
        distance = math.hypot(second[0] - first[0], second[1] - first[1])
        expected = geometry[mesh.name].center_distance / MM
        if not math.isclose(distance, expected, rel_tol=_SAME):
            field = f"shafts[{number[carrier[mesh.driven]]}].origin_mm"
            bound = (
                f"{expected:.7g} mm across the axis from shaft {carrier[mesh.driver]}, not {distance:.7g} mm"
            )
            raise BadInput.of(field, list(second), bound, f"That is the center distance of mesh {mesh.name}.")


def _has_bent_shafts(database: SteDatabase) -> bool:
    ledger = database.metadata.effect_ledger
    entries = ledger if isinstance(ledger, list) else ledger.get("entries", [])
    return any(
        isinstance(e, Mapping) and e.get("name") == "shaft_deflection" and e.get("on") for e in entries
    )


@dataclass(frozen=True)
class TabledScene:
    """A scene with its tables."""

    inputs: SceneInput
    """Scene as its author wrote it, with the cases of its meshes written out."""
    databases: Mapping[str, SteDatabase]
    """STE databases by name of their mesh."""
    scene: Scene
    """Scene of dynamics that inputs and databases make, in SI."""
    housings: Mapping[str, ReducedHousing] = field(default_factory=dict)
    """Reduced housings by name, of housings with a solid or with a file of modes on the caller's disk."""
    seconds: float = 0.0
    """CPU seconds of tables and housings that were made for the scene."""

    @property
    def steady(self) -> TabledScene:
        """The same without the torque of a run-up's acceleration, as studies over speed take it."""
        return replace(self, scene=at_steady_speeds(self.scene))


def dynamic_scene(
    scene: SceneInput,
    databases: Mapping[str, SteDatabase],
    reduced: Mapping[str, ReducedHousing] = NO_SOLIDS,
) -> Scene:
    """Return the scene in SI.

    Parameters
    ----------
    databases : mapping of str to SteDatabase
        STE databases by name of the mesh, of all meshes that do not state their stiffness.
    reduced : mapping of str to ReducedHousing
        Reduced housings by name, of all housings that are given by their solids.

    Raises
    ------
    BadInput
        No such system; named by the scene file's fields, in its units.
    JobFailed
        A database has failed points.
    """
    geometry = {name: database.geometry for name, database in databases.items()}
    with boundary_errors():
        tables: dict[str, MeshTable] = {name: table.force_table() for name, table in databases.items()}
    housings = housings_of(tuple((part, reduced.get(part.name)) for part in scene.housings))
    bent = {name for name, database in databases.items() if _has_bent_shafts(database)}
    return _moving(scene, geometry, tables, housings, bent)


def check_scene(
    scene: SceneInput, geometry: Mapping[str, PairGeometry], tables: Mapping[str, MeshTable] | None = None
) -> Scene:
    """Return the scene on placeholders for its tables and for the matrices of solids.

    `geometry`, and `tables` that are closer than placeholders: by name of the mesh. Raises `BadInput`: no
    such system exists or moves, or nothing of it passes where it is complained of.
    """
    tables = tables or dict.fromkeys(geometry, straight_table(ANY_STIFFNESS, ANY_TEETH))
    check_measured(scene)
    housings = [placeholder(i, part) for i, part in enumerate(scene.housings) if not part.is_measured]
    moving = _moving(scene, geometry, tables, housings)
    if scene.complaint is not None:
        complaint_of(scene, moving)
    return moving


def _moving(
    scene: SceneInput,
    geometry: Mapping[str, PairGeometry],
    tables: Mapping[str, MeshTable],
    housings: Sequence[Housing],
    bent: Set[str] = frozenset(),
) -> Scene:
    """Return the scene with all its planets, its parts checked one by one, together, and in motion.

    Facts and tables are those of the meshes with a database, `bent` the names of those whose tables have the
    bending of their shafts in them.
    """
    closed = _closed_forms(scene.meshes)
    geometry = {**geometry, **{name: pair for name, (pair, _) in closed.items()}}
    tables = {**tables, **{name: table for name, (_, table) in closed.items()}}
    meshes = meshes_of(
        tuple((mesh, tables[mesh.name]) for mesh in scene.meshes),
        tuple(geometry[mesh.name].base_pitch for mesh in scene.meshes),
        tuple(mesh.name in bent for mesh in scene.meshes),
    )
    without_copies = _assembled_scene(scene, geometry, meshes, housings)
    with named(""):
        check_motion(without_copies)
    complete = _with_all_planets(scene, without_copies)
    with named(""):
        mechanism_of(complete)
    return complete


def _assembled_scene(
    scene: SceneInput,
    geometry: Mapping[str, PairGeometry],
    meshes: tuple[GearMesh, ...],
    housings: Sequence[Housing],
) -> Scene:
    teeth = _teeth_of(scene, geometry)
    _check_center_distances(scene, geometry)
    with named(""), numbered_as_written(scene.housings):
        return Scene(
            **in_si(Scene, scene, scene.run, scene.accuracy),
            level_tolerance=scene.accuracy.level_tolerance_db or None,
            **parts_of(scene, tuple(teeth[gear.name] for gear in scene.gears)),
            meshes=meshes,
            housings=tuple(housings),
        )


def _with_all_planets(inputs: SceneInput, scene: Scene) -> Scene:
    for index, planets in enumerate(inputs.planets):
        angles = None if planets.angles_deg is None else [angle * DEGREE for angle in planets.angles_deg]
        errors = None
        if planets.radial_errors_um is not None or planets.tangential_errors_um is not None:
            none = (0.0,) * planets.number
            away, across = planets.radial_errors_um or none, planets.tangential_errors_um or none
            errors = [(r * UM, t * UM) for r, t in zip(away, across, strict=True)]
        with named(f"planets[{index}]"):
            scene = with_planets(scene, planets.planet, planets.number, angles, errors)
    return scene
