"""Meshes of a scene: the gears that they describe, their axes, and tables in closed form."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from dynamics.mechanism.base_pitches import PRINTED
from dynamics.meshes import MeshTable
from dynamics.meshes.stiffness_table import PeriodicCurve, stiffness_table
from fe_contact.ste import PairFacts
from lineofaction.gearbox.convert.errors import named
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.meshes import PeriodicInput, StiffnessMeshInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.units import DEGREE, MM, UM

_SAME = 1e-6  # relative; lengths that are typed with a few digits agree to this


@dataclass(frozen=True)
class Teeth:
    """One gear as its mesh describes it; SI units, the helix angle with the hand's sign."""

    teeth: int
    base_radius: float
    base_helix_angle: float
    pitch_diameter: float
    face_width: float
    internal: bool = False


def teeth_of(scene: SceneInput, facts: Mapping[str, PairFacts]) -> dict[str, Teeth]:
    """Teeth of every gear, by name; a gear in two meshes must be the same in both."""
    by_name: dict[str, Teeth] = {}
    for index, mesh in enumerate(scene.meshes):
        if mesh.wheel_drives and not facts[mesh.name].internal:
            bound = "left out: the wheel of this case is no ring gear"
            advice = "Give a case whose pinion is the gear that drives."
            raise BadInput.of(f"meshes[{index}].wheel_drives", True, bound, advice)
        for side, role in enumerate(("driven", "driver") if mesh.wheel_drives else ("driver", "driven")):
            name, teeth = getattr(mesh, role), _side(facts[mesh.name], side)
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


def _side(facts: PairFacts, side: int) -> Teeth:
    """Return one gear of a pair; the hands of external gears are opposite, those in a ring gear the same."""
    radius = facts.base_radius[side]
    hand = facts.helix_hand if side == 0 or facts.internal else -facts.helix_hand
    diameter = 2.0 * radius / math.cos(facts.working_pressure_angle)
    helix, ring = hand * facts.base_helix_angle, facts.internal and side == 1
    return Teeth(facts.teeth[side], radius, helix, diameter, facts.face_width, ring)


def check_center_distances(scene: SceneInput, facts: Mapping[str, PairFacts]) -> None:
    """Refuse axes of meshing gears that are not as far apart as their database says."""
    origin = {shaft.name: shaft.origin_mm for shaft in scene.shafts}
    carrier = {gear.name: gear.shaft for gear in scene.gears}
    number = {shaft.name: index for index, shaft in enumerate(scene.shafts)}
    for mesh in scene.meshes:
        first, second = origin[carrier[mesh.driver]], origin[carrier[mesh.driven]]
        distance = math.hypot(second[0] - first[0], second[1] - first[1])
        expected = facts[mesh.name].center_distance / MM
        if not math.isclose(distance, expected, rel_tol=_SAME):
            field = f"shafts[{number[carrier[mesh.driven]]}].origin_mm"
            bound = (
                f"{expected:.7g} mm across the axis from shaft {carrier[mesh.driver]}, not {distance:.7g} mm"
            )
            raise BadInput.of(field, list(second), bound, f"That is the center distance of mesh {mesh.name}.")


# Meshes in closed form: the facts of their gears and their tables.


def closed_forms(scene: SceneInput) -> dict[str, tuple[PairFacts, MeshTable]]:
    """Return facts and table of every mesh that states its stiffness, by name.

    Raises
    ------
    BadInput
        Named by the field of the scene.
    """
    return {
        mesh.name: (_facts(f"meshes[{index}].stiffness", mesh.stiffness), _table(index, mesh.stiffness))
        for index, mesh in enumerate(scene.meshes)
        if mesh.stiffness is not None
    }


def _facts(field: str, mesh: StiffnessMeshInput) -> PairFacts:
    """Return the facts of the pair: base radii in the ratio of the teeth, the center distance from them."""
    pinion, wheel = mesh.teeth
    if mesh.internal and wheel <= pinion:
        raise BadInput.of(
            f"{field}.teeth", list(mesh.teeth), "more teeth of the ring gear than of its pinion"
        )
    radius = mesh.base_radius_mm * MM
    radii = (radius, radius * wheel / pinion)
    angle, helix = mesh.working_pressure_angle_deg * DEGREE, mesh.base_helix_angle_deg * DEGREE
    return PairFacts(
        teeth=(pinion, wheel),
        base_radius=radii,
        base_pitch=2.0 * math.pi * radius / pinion,
        base_helix_angle=abs(helix),
        center_distance=(radii[1] + (-radius if mesh.internal else radius)) / math.cos(angle),
        working_pressure_angle=angle,
        face_width=mesh.face_width_mm * MM,
        helix_hand=(helix > 0.0) - (helix < 0.0),
        internal=mesh.internal,
    )


def _table(index: int, mesh: StiffnessMeshInput) -> MeshTable:
    stiffness, error = mesh.stiffness_n_per_m, mesh.transmission_error_um
    where = f"meshes[{index}].stiffness"
    with named(f"{where}.stiffness_n_per_m"):
        of_stiffness = _curve(stiffness, 1.0)
    with named(f"{where}.transmission_error_um"):
        of_error = None if error is None else _curve(error, UM)
    with named(f"{where}.stiffness_n_per_m"):
        return stiffness_table(of_stiffness, of_error)


def _curve(law: PeriodicInput, unit: float) -> PeriodicCurve:
    value = [number * unit for number in law.value]
    if law.position is not None:
        return PeriodicCurve.tabulated(law.position, value)
    if law.amplitude is None:
        return PeriodicCurve.constant(value[0])
    phases = law.phase_deg or (0.0,) * len(law.amplitude)
    sizes = [number * unit for number in law.amplitude]
    return PeriodicCurve.harmonic(value[0], sizes, [phase * DEGREE for phase in phases])
