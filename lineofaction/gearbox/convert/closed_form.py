"""Meshes in closed form: the facts of their gears and their tables."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from dynamics.meshes import MeshTable, PeriodicCurve, stiffness_table
from fe_contact.ste import PairFacts
from lineofaction.gearbox.convert.errors import named
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.scene_meshes import PeriodicInput, StiffnessMeshInput
from lineofaction.gearbox.units import DEGREE, MM, UM

if TYPE_CHECKING:
    from lineofaction.gearbox.schemas.scene import SceneInput


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
