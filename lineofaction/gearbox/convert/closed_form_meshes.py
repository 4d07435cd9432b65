"""Meshes whose stiffness is stated in closed form: geometry of their gears, and their tables."""

from __future__ import annotations

import math

from dynamics.identity_cache import identity_cached
from dynamics.meshes import GearMesh, MeshTable
from dynamics.meshes.standard_sliding import StandardTeeth
from dynamics.meshes.stiffness_table import PeriodicCurve, stiffness_table
from fe_contact.ste import PairGeometry
from lineofaction.gearbox.convert.boundary_errors import named
from lineofaction.gearbox.convert.declared import in_si
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.closed_form_meshes import PeriodicInput, StiffnessMeshInput
from lineofaction.gearbox.schemas.meshes import MeshInput
from lineofaction.gearbox.units import DEGREE, MM, UM


@identity_cached
def _closed_forms(meshes: tuple[MeshInput, ...]) -> dict[str, tuple[PairGeometry, MeshTable]]:
    """Return geometry and table of every mesh that states its stiffness, by name."""
    return {
        mesh.name: (_pair_geometry(f"meshes[{index}].stiffness", mesh.stiffness), _table(index, mesh))
        for index, mesh in enumerate(meshes)
        if mesh.stiffness is not None
    }


def _pair_geometry(field: str, mesh: StiffnessMeshInput) -> PairGeometry:
    """Return the geometry of the pair; its base radii have the ratio of the teeth."""
    pinion, wheel = mesh.teeth
    if mesh.internal and wheel <= pinion:
        raise BadInput.of(
            f"{field}.teeth", list(mesh.teeth), "more teeth of the ring gear than of its pinion"
        )
    radius = mesh.base_radius_mm * MM
    radii = (radius, radius * wheel / pinion)
    angle, helix = mesh.working_pressure_angle_deg * DEGREE, mesh.base_helix_angle_deg * DEGREE
    return PairGeometry(
        teeth=(pinion, wheel),
        base_radius=radii,
        base_pitch=2.0 * math.pi * radius / pinion,
        base_helix_angle=abs(helix),
        center_distance=(radii[1] + (-radius if mesh.internal else radius)) / math.cos(angle),
        working_pressure_angle=angle,
        face_width=mesh.face_width_mm * MM,
        helix_hand=(helix > 0.0) - (helix < 0.0),  # 1, 0 or -1
        internal=mesh.internal,
    )


def _table(index: int, mesh: MeshInput) -> MeshTable:
    """Return the table of a closed form; with friction, the sliding of standard teeth is in it."""
    assert mesh.stiffness is not None  # the caller asks for no other mesh
    stiffness, error = mesh.stiffness.stiffness_n_per_m, mesh.stiffness.transmission_error_um
    field = f"meshes[{index}].stiffness"
    with named(f"{field}.stiffness_n_per_m"):
        of_stiffness = _curve(stiffness, 1.0)
    with named(f"{field}.transmission_error_um"):
        of_error = None if error is None else _curve(error, UM)
    with named(f"{field}.stiffness_n_per_m"):
        return stiffness_table(of_stiffness, of_error, _standard_teeth(mesh))


def _standard_teeth(mesh: MeshInput) -> StandardTeeth | None:
    form = mesh.stiffness
    if form is None or in_si(GearMesh, mesh)["friction"] is None:
        return None
    return StandardTeeth(
        teeth=(form.teeth[0], form.teeth[1]),
        base_radius=form.base_radius_mm * MM,
        working_pressure_angle=form.working_pressure_angle_deg * DEGREE,
        base_helix_angle=form.base_helix_angle_deg * DEGREE,
        face_width=form.face_width_mm * MM,
        internal=form.internal,
    )


def _curve(law: PeriodicInput, unit: float) -> PeriodicCurve:
    value = [number * unit for number in law.value]
    if law.position is not None:
        return PeriodicCurve.tabulated(law.position, value)
    if law.amplitude is None:
        return PeriodicCurve.constant(value[0])
    phases = law.phase_deg or (0.0,) * len(law.amplitude)
    sizes = [number * unit for number in law.amplitude]
    return PeriodicCurve.harmonic(value[0], sizes, [phase * DEGREE for phase in phases])
