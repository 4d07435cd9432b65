"""The figures of a deflection in the units of the boundary."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from bounds.types import Json
from dynamics.deflection import CAUSES, BearingLoad, CaseDeflection, MeshAlignment, equivalent_load
from service.studies.deflect.result import GearboxDeflection, MeshFlanks
from service.units import MM, MRAD, RPM, UM

MPA = 1e6


def facts(result: GearboxDeflection) -> Json:
    """Return all figures; lines of shafts and patterns are in the file."""
    flanks = {(own.case, own.mesh): own for own in result.flanks}
    return {
        "leading_shaft": result.deflection.leading_shaft,
        "agreement": {
            "agreed": result.agreed,
            "passes": result.passes,
            "relative_change": _known(result.change),
        },
        "load_cases": [_case(case, flanks) for case in result.deflection.cases],
        "meshes": [_over_cases(result, name) for name in mesh_names(result)],
        "bearings": [_bearing_over_cases(result, k) for k in range(len(result.outline.bearings))],
        "cpu_seconds": result.seconds,
    }


def mesh_names(result: GearboxDeflection) -> list[str]:
    """Return the meshes in their order."""
    return [mesh.name for mesh in result.deflection.cases[0].meshes]


def shares(result: GearboxDeflection) -> list[float]:
    """Return the shares of the load cases, which sum to 1."""
    own = [case.share for case in result.deflection.cases]
    return [share / sum(own) for share in own]


def _case(case: CaseDeflection, flanks: dict[tuple[str, str], MeshFlanks]) -> Json:
    """Return one load case."""
    return {
        "name": case.name,
        "direction": case.direction,
        "share": case.share,
        "torque_n_m": case.torque,
        "speed_rpm": case.speed / RPM,
        "status": case.status,
        "residual": _known(case.residual),
        "meshes": [_mesh(mesh, flanks.get((case.name, mesh.name))) for mesh in case.meshes],
        "bearings": [_bearing(load) for load in case.bearings],
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
        "face_centroid_mm": _known(mesh.face_centroid / MM),
        "in_table": mesh.in_table,
        "flanks": None if flanks is None else _flanks(flanks),
    }


def _flanks(flanks: MeshFlanks) -> Json:
    """Return what happens on the flanks."""
    return {
        "torque_n_m": flanks.torque,
        "k_h_beta": _known(flanks.face_load_factor),
        "largest_pressure_mpa": flanks.largest_pressure / MPA,
        "mean_um": flanks.mean / UM,
        "mean_error_um": _known(flanks.mean_error / UM),
        "peak_to_peak_um": flanks.peak_to_peak / UM,
        "peak_to_peak_error_um": _known(flanks.peak_to_peak_error / UM),
        "harmonics_um": [float(value) / UM for value in flanks.harmonics],
        "harmonics_error_um": [_known(float(value) / UM) for value in flanks.harmonics_error],
        "centroid_difference_mm": _known(flanks.centroid_difference / MM),
    }


def _bearing(load: BearingLoad) -> Json:
    """Return one bearing under one load case."""
    return {
        "name": load.name,
        "shaft": load.shaft,
        "speed_rpm": load.speed / RPM,
        "force_n": load.force[:3].tolist(),
        "moment_n_m": load.force[3:].tolist(),
        "radial_force_n": load.radial,
        "axial_force_n": load.axial,
        "largest_radial_force_n": load.largest_radial,
        "elastic_um": (load.elastic[:3] / UM).tolist(),
        "clearance_um": (load.clearance[:3] / UM).tolist(),
        "seat_um": (load.seat[:3] / UM).tolist(),
        "tilt_mrad": ((load.elastic + load.clearance)[3:] / MRAD).tolist(),
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
    return _known(float(np.dot(weights, values))) if len(values) == len(weights) else None


def _largest(values: Sequence[float]) -> float | None:
    """Return the largest value, None where there is none."""
    known = [value for value in values if math.isfinite(value)]
    return max(known) if known else None


def _bearing_over_cases(result: GearboxDeflection, index: int) -> Json:
    """Return the equivalent radial loads of a bearing over all load cases."""
    loads = [case.bearings[index] for case in result.deflection.cases]
    weights, speed = shares(result), [load.speed for load in loads]
    radial, axial = [load.radial for load in loads], [abs(load.axial) for load in loads]
    return {
        "name": loads[0].name,
        "mean_speed_rpm": float(np.dot(weights, speed)) / RPM,
        "largest_radial_force_n": max(load.largest_radial for load in loads),
        "equivalent_radial_force_n": {
            "ball": equivalent_load(radial, speed, weights, 3.0),
            "roller": equivalent_load(radial, speed, weights),
        },
        "equivalent_axial_force_n": {
            "ball": equivalent_load(axial, speed, weights, 3.0),
            "roller": equivalent_load(axial, speed, weights),
        },
    }


def _known(value: float) -> float | None:
    """Return a number, None if it is not known."""
    return float(value) if math.isfinite(value) else None
