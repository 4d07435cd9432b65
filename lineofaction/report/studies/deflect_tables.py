"""Tables of a deflection: meshes under the load cases, the worst first, and bearings."""

from __future__ import annotations

import numpy as np

from bounds.types import BoolArray, Json
from dynamics.deflection import CaseDeflection, MeshAlignment
from lineofaction.gearbox.studies.deflect.figures import facts, mesh_names
from lineofaction.gearbox.studies.deflect.result import GearboxDeflection, MeshFlanks
from lineofaction.gearbox.units import UM
from lineofaction.report.drawing.figure import Table, number

CAUSE_WORDS = ("of shafts", "bearings", "clearance", "housing", "couplings", "set")


def meshes_worst_first(result: GearboxDeflection) -> list[str]:
    """Return the meshes by their largest misalignment under any load case, the worst first."""
    largest = {
        name: max(abs(mesh_of(case, name).misalignment) for case in result.deflection.cases)
        for name in mesh_names(result)
    }
    return sorted(largest, key=lambda name: -largest[name])


def worst_case(result: GearboxDeflection, mesh: str) -> CaseDeflection:
    """Return the load case of the largest misalignment of a mesh."""
    return max(result.deflection.cases, key=lambda case: abs(mesh_of(case, mesh).misalignment))


def drawn_case(result: GearboxDeflection) -> CaseDeflection:
    """Return the load case that misaligns a mesh most; without meshes, that moves the axes most."""
    names = meshes_worst_first(result)
    return worst_case(result, names[0]) if names else max(result.deflection.cases, key=largest_motion)


def largest_motion(case: CaseDeflection) -> float:
    """Return the largest deflection of an axis in x or y, m."""
    return float(np.max(np.abs(case.shafts.motion[:, :2]), initial=0.0))


def mesh_of(case: CaseDeflection, name: str) -> MeshAlignment:
    """Return a mesh under a load case."""
    return next(mesh for mesh in case.meshes if mesh.name == name)


def mesh_table(result: GearboxDeflection) -> Table:
    """List every mesh under every load case, the worst mesh first; of the causes those that act."""
    acting = np.any([mesh.causes for case in result.deflection.cases for mesh in case.meshes], axis=0)
    flanks = {(own.mesh, own.case): own for own in result.flanks}
    head = (
        "mesh",
        "load case",
        "torque, N m",
        "misalignment, µm",
        *(words for words, acts in zip(CAUSE_WORDS, acting, strict=True) if acts),
        "K_Hbeta",
        "STE peak-to-peak, µm",
        "largest pressure, MPa",
    )
    rows = tuple(
        _row(name, case, flanks.get((name, case.name)), acting)
        for name in meshes_worst_first(result)
        for case in result.deflection.cases
    )
    return Table("Meshes under the load cases: misalignment over the face by cause", head, rows)


def force_table(result: GearboxDeflection) -> Table | None:
    """List the forces of the scene under the load cases; None without forces."""
    head = (
        "force",
        "shaft",
        "load case",
        "x, N",
        "y, N",
        "z, N",
        "about x, N m",
        "about y, N m",
        "about z, N m",
    )
    rows = tuple(
        (force.name, force.shaft, _titled(case), *map(_component, (*force.force, *force.moment)))
        for case in result.deflection.cases
        for force in case.forces
    )
    return (
        Table("Forces under the load cases, before the factor of their course", head, rows) if rows else None
    )


def _component(value: float) -> str:
    return "0" if value == 0.0 else number(float(value), 4)


def _row(name: str, case: CaseDeflection, flanks: MeshFlanks | None, acting: BoolArray) -> tuple[str, ...]:
    mesh = mesh_of(case, name)
    own = (name, _titled(case), number(case.torque), number(mesh.misalignment / UM, 3))
    parts = tuple("0" if part == 0.0 else number(float(part) / UM, 3) for part in mesh.causes[acting])
    if flanks is None:
        return (*own, *parts, "none", "none", "none")
    ripple = number(flanks.peak_to_peak / UM, 3)
    if np.isfinite(flanks.peak_to_peak_error):
        ripple += f" ± {number(flanks.peak_to_peak_error / UM, 1)}"
    return (
        *own,
        *parts,
        number(flanks.face_load_factor, 3),
        ripple,
        number(1e-6 * flanks.largest_pressure, 4),
    )


def _titled(case: CaseDeflection) -> str:
    """Name a load case; say if the other flanks carry or it was not found."""
    side = "" if case.direction == "drive" else f" ({case.direction})"
    return f"{case.name}{side}" + ("" if case.status == "converged" else f", {case.status.replace('_', ' ')}")


def bearing_table(result: GearboxDeflection) -> Table:
    """List the loads of the bearings."""
    head = (
        "bearing",
        "load case",
        "speed, rpm",
        "radial, N",
        "axial, N",
        "radial: elastic, µm",
        "clearance, µm",
        "seat, µm",
        "life, h",
    )
    cases = result.deflection.cases
    figures = [case["bearings"] for case in facts(result)["load_cases"]]
    rows = tuple(
        _bearing_row(figures[k][index], case)
        for index in range(len(result.outline.bearings))
        for k, case in enumerate(cases)
    )
    return Table("Bearings under the load cases, means over the mesh cycle", head, rows)


def _bearing_row(bearing: Json, case: CaseDeflection) -> tuple[str, ...]:
    moved = (float(np.hypot(*bearing[f"{part}_um"][:2])) for part in ("elastic", "clearance", "seat"))
    return (
        bearing["name"],
        _titled(case),
        number(bearing["speed_rpm"]),
        number(bearing["radial_force_n"]),
        number(bearing["axial_force_n"]),
        *(number(value, 3) for value in moved),
        _life_text(bearing),
    )


def _life_text(bearing: Json) -> str:
    hours = bearing["rating_life_hours"]
    return str(bearing["rating_life"]) if hours is None else number(float(f"{hours:.3g}"), 3)


def life_table(result: GearboxDeflection) -> Table:
    """List the rating lives over all load cases and the constant loads of the same life."""
    head = (
        "bearing",
        "mean speed, rpm",
        "life, h",
        "radial, ball, N",
        "radial, roller, N",
        "axial, ball, N",
        "axial, roller, N",
    )
    rows = tuple(
        (
            part["name"],
            number(part["mean_speed_rpm"]),
            _life_text(part),
            *(
                number(part[f"equivalent_{way}_force_n"][kind])
                for way in ("radial", "axial")
                for kind in ("ball", "roller")
            ),
        )
        for part in facts(result)["bearings"]
    )
    title = (
        "Basic reference rating life over all load cases (ISO/TS 16281), and loads of equal life (ISO 281)"
    )
    return Table(title, head, rows)
