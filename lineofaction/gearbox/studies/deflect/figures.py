"""The figures of a deflection in the units of the boundary."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from bounds.types import Json
from dynamics.deflection import CAUSES, BearingLoad, CaseDeflection, ForceUnderCase, MeshAlignment
from lineofaction.gearbox.studies.deflect.bearing_figures import (
    bearing_in_case,
    bearing_over_cases,
    known,
    loads_by_case,
)
from lineofaction.gearbox.studies.deflect.result import GearboxDeflection, MeshFlanks
from lineofaction.gearbox.units import MM, RPM, UM

MPA = 1e6


def facts(result: GearboxDeflection) -> Json:
    """Return all figures; lines of shafts and patterns are in the file."""
    flanks = {(own.case, own.mesh): own for own in result.flanks}
    cases = result.deflection.cases
    by_case = loads_by_case(cases)
    weights = shares(result)
    return {
        "leading_shaft": result.deflection.leading_shaft,
        "agreement": {
            "agreed": result.agreed,
            "passes": result.passes,
            "relative_change": known(result.change),
        },
        "load_cases": [_case(case, flanks, loads) for case, loads in zip(cases, by_case, strict=True)],
        "meshes": [_over_cases(result, name) for name in mesh_names(result)],
        "bearings": [bearing_over_cases(loads, weights) for loads in zip(*by_case, strict=True)],
        "cpu_seconds": result.seconds,
    }


def mesh_names(result: GearboxDeflection) -> list[str]:
    """Return the meshes in their order."""
    return [mesh.name for mesh in result.deflection.cases[0].meshes]


def shares(result: GearboxDeflection) -> list[float]:
    """Return the shares of the load cases, which sum to 1."""
    own = [case.share for case in result.deflection.cases]
    return [share / sum(own) for share in own]


def _case(
    case: CaseDeflection, flanks: dict[tuple[str, str], MeshFlanks], loads: Sequence[BearingLoad]
) -> Json:
    """Return one load case."""
    return {
        "name": case.name,
        "direction": case.direction,
        "share": case.share,
        "torque_n_m": case.torque,
        "speed_rpm": case.speed / RPM,
        "status": case.status,
        "residual": known(case.residual),
        "forces": [_force(force) for force in case.forces],
        "meshes": [_mesh(mesh, flanks.get((case.name, mesh.name))) for mesh in case.meshes],
        "bearings": [bearing_in_case(load) for load in loads],
    }


def _force(force: ForceUnderCase) -> Json:
    """Return one force of the scene under one load case."""
    return {
        "name": force.name,
        "shaft": force.shaft,
        "force_n": force.force.tolist(),
        "moment_n_m": force.moment.tolist(),
    }


def _mesh(mesh: MeshAlignment, flanks: MeshFlanks | None) -> Json:
    """Return one mesh under one load case."""
    return {
        "name": mesh.name,
        "force_n": mesh.force,
        "misalignment_um": mesh.misalignment / UM,
        "misalignment_over_cycle_um": [mesh.least / UM, mesh.largest / UM],
        "causes_um": {cause: float(part) / UM for cause, part in zip(CAUSES, mesh.causes, strict=True)},
        "center_distance_change_um": mesh.center_distance_change / UM,
        "lead_torsion_um": mesh.lead_torsion / UM,
        "face_centroid_mm": known(mesh.face_centroid / MM),
        "in_table": mesh.in_table,
        "flanks": None if flanks is None else _flanks(flanks),
    }


def _flanks(flanks: MeshFlanks) -> Json:
    """Return what happens on the flanks."""
    return {
        "torque_n_m": flanks.torque,
        "k_h_beta": known(flanks.face_load_factor),
        "largest_pressure_mpa": flanks.largest_pressure / MPA,
        "mean_um": flanks.mean / UM,
        "mean_error_um": known(flanks.mean_error / UM),
        "peak_to_peak_um": flanks.peak_to_peak / UM,
        "peak_to_peak_error_um": known(flanks.peak_to_peak_error / UM),
        "harmonics_um": [float(value) / UM for value in flanks.harmonics],
        "harmonics_error_um": [known(float(value) / UM) for value in flanks.harmonics_error],
        "centroid_difference_mm": known(flanks.centroid_difference / MM),
    }


def _over_cases(result: GearboxDeflection, name: str) -> Json:
    """Return the means of a mesh over the load cases by their shares, and its worst case."""
    weights, cases = shares(result), result.deflection.cases
    own = [next(mesh for mesh in case.meshes if mesh.name == name) for case in cases]
    worst = int(np.argmax([abs(mesh.misalignment) for mesh in own]))
    flanks = [part for part in result.flanks if part.mesh == name]
    return {
        "name": name,
        "mean_misalignment_um": float(np.dot(weights, [mesh.misalignment for mesh in own])) / UM,
        "largest_misalignment_um": own[worst].misalignment / UM,
        "largest_in": cases[worst].name,
        "mean_peak_to_peak_um": _mean(weights, [part.peak_to_peak / UM for part in flanks]),
        "largest_k_h_beta": _largest([part.face_load_factor for part in flanks]),
    }


def _mean(weights: Sequence[float], values: Sequence[float]) -> float | None:
    """Return the weighted mean, None where a value is missing."""
    return known(float(np.dot(weights, values))) if len(values) == len(weights) else None


def _largest(values: Sequence[float]) -> float | None:
    """Return the largest value, None where there is none."""
    known = [value for value in values if math.isfinite(value)]
    return max(known) if known else None
