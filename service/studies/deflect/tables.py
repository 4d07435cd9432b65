"""Tables of a deflection: meshes under the load cases, the worst first, and bearings."""

from __future__ import annotations

import numpy as np

from dynamics.deflection import CaseDeflection, MeshAlignment
from service.drawing.figure import Table, number
from service.studies.deflect.figures import facts, mesh_names
from service.studies.deflect.result import GearboxDeflection, MeshFlanks
from service.units import RPM, UM

ROUNDING = 1e-9
"""Of the radial force of a bearing: a smaller axial force is none."""


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


def mesh_of(case: CaseDeflection, name: str) -> MeshAlignment:
    """Return a mesh under a load case."""
    return next(mesh for mesh in case.meshes if mesh.name == name)


def mesh_table(result: GearboxDeflection) -> Table:
    """List every mesh under every load case, the worst mesh first."""
    flanks = {(own.mesh, own.case): own for own in result.flanks}
    head = (
        "mesh",
        "load case",
        "torque, N m",
        "misalignment, µm",
        "of shafts",
        "bearings",
        "clearance",
        "housing",
        "couplings",
        "set",
        "K_Hbeta",
        "STE peak-to-peak, µm",
        "largest pressure, MPa",
    )
    rows = tuple(
        _row(name, case, flanks.get((name, case.name)))
        for name in meshes_worst_first(result)
        for case in result.deflection.cases
    )
    return Table("Meshes under the load cases: misalignment over the face by cause", head, rows)


def _row(name: str, case: CaseDeflection, flanks: MeshFlanks | None) -> tuple[str, ...]:
    """One mesh under one load case."""
    mesh = mesh_of(case, name)
    own = (name, _titled(case), number(case.torque), number(mesh.misalignment / UM, 3))
    parts = tuple("0" if part == 0.0 else number(float(part) / UM, 3) for part in mesh.causes)
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
        "elastic, µm",
        "clearance, µm",
        "seat, µm",
    )
    rows = []
    for index in range(len(result.outline.bearings)):
        for case in result.deflection.cases:
            load = case.bearings[index]
            moved = [np.hypot(*part[:2]) / UM for part in (load.elastic, load.clearance, load.seat)]
            rows.append(
                (
                    load.name,
                    _titled(case),
                    number(load.speed / RPM),
                    number(load.radial),
                    number(load.axial if abs(load.axial) > ROUNDING * load.radial else 0.0),
                    *(number(float(value), 3) for value in moved),
                )
            )
    return Table("Bearings under the load cases, means over the mesh cycle", head, tuple(rows))


def life_table(result: GearboxDeflection) -> Table:
    """List the constant loads of the same life."""
    head = (
        "bearing",
        "mean speed, rpm",
        "radial, ball, N",
        "radial, roller, N",
        "axial, ball, N",
        "axial, roller, N",
    )
    rows = tuple(
        (
            part["name"],
            number(part["mean_speed_rpm"]),
            *(
                number(part[f"equivalent_{way}_force_n"][kind])
                for way in ("radial", "axial")
                for kind in ("ball", "roller")
            ),
        )
        for part in facts(result)["bearings"]
    )
    return Table("Loads of equal life over all load cases (ISO 281, exponents 3 and 10/3)", head, rows)
