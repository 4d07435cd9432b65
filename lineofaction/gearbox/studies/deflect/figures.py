"""The figures of a deflection in the units of the boundary."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bounds.types import FloatArray, Json
from dynamics.deflection import (
    CAUSES,
    BearingLoad,
    CaseDeflection,
    MeshAlignment,
    equivalent_load,
    life_duration,
)
from lineofaction.gearbox.studies.deflect import DeflectionFigures
from lineofaction.gearbox.studies.deflect.result import GearboxDeflection, MeshFlanks
from lineofaction.gearbox.studies.figures import figures_of
from lineofaction.gearbox.units import RPM, UM

# Figures of bearings under load cases: loads, displacements and rating life.


HOUR = 3600.0  # s
ROUNDING, ROUNDING_OF_ALL = 1e-9, 1e-12
"""Parts of the largest force of a bearing, and of all bearings: smaller ones are zero. Moments: times 1 m.
Displacements as forces of all bearings."""


def _loads_by_case(cases: Sequence[CaseDeflection]) -> list[list[BearingLoad]]:
    """Return the loads of all bearings in every case, forces and displacements within rounding zero."""
    largest = [
        max(float(np.max(np.abs(load.force[:3]))) for load in loads)
        for loads in zip(*(case.bearings for case in cases), strict=True)
    ]
    of_all = ROUNDING_OF_ALL * max(largest, default=0.0)
    least = [max(ROUNDING * own, of_all) for own in largest]
    loads = [load for case in cases for load in case.bearings]
    moved = max((_largest_part(load) for load in loads), default=0.0)
    return [
        [
            _without_rounding(load, each, ROUNDING_OF_ALL * moved)
            for load, each in zip(case.bearings, least, strict=True)
        ]
        for case in cases
    ]


def _largest_part(load: BearingLoad) -> float:
    """Return the largest displacement in x, y, z, m."""
    return max(float(np.max(np.abs(part[:3]))) for part in (load.elastic, load.clearance, load.seat))


def _without_rounding(load: BearingLoad, least: float, moved: float) -> BearingLoad:
    """Return a load whose forces below `least`, N, and displacements below `moved`, m and rad, are zero."""
    return replace(
        load,
        force=_at_least(load.force, least),
        largest_radial=load.largest_radial if load.largest_radial >= least else 0.0,
        elastic=_at_least(load.elastic, moved),
        clearance=_at_least(load.clearance, moved),
        seat=_at_least(load.seat, moved),
    )


def _at_least(values: FloatArray, least: float) -> FloatArray:
    """Return values, zero where they are smaller than `least`."""
    return np.asarray(np.where(np.abs(values) < least, 0.0, values))


def _over_cases(loads: Sequence[BearingLoad], weights: Sequence[float]) -> Json:
    """Return a bearing over the load cases by their shares."""
    speed = [load.speed for load in loads]
    radial, axial = [load.radial for load in loads], [abs(load.axial) for load in loads]
    return {
        "name": loads[0].name,
        "mean_speed_rpm": float(np.dot(weights, speed)) / RPM,
        "largest_radial_force": max(load.largest_radial for load in loads),
        **{
            f"equivalent_{direction}_force": {
                "ball": equivalent_load(size, speed, weights, 3.0),
                "roller": equivalent_load(size, speed, weights),
            }
            for direction, size in (("radial", radial), ("axial", axial))
        },
        **_life(loads, weights),
    }


def _life(loads: Sequence[BearingLoad], weights: Sequence[float]) -> Json:
    """Return the life over load cases in h, and why there is no number."""
    revolutions = [load.rating_life for load in loads]
    seconds = life_duration(revolutions, [load.speed for load in loads], weights)
    if math.isnan(seconds):
        status = "none: no capacity"
    else:
        status = "limited" if math.isfinite(seconds) else "unlimited"
    return {"rating_life_hours": seconds / HOUR, "rating_life": status}


def facts(result: GearboxDeflection) -> Json:
    """Return all figures; lines of shafts and patterns are in the file."""
    flanks = {(own.case, own.mesh): own for own in result.flanks}
    cases = result.deflection.cases
    by_case = _loads_by_case(cases)
    weights = shares(result)
    return figures_of(
        DeflectionFigures,
        result,
        load_cases=[_case(case, flanks, loads) for case, loads in zip(cases, by_case, strict=True)],
        meshes=[_mesh_over_cases(result, name) for name in mesh_names(result)],
        bearings=[_over_cases(loads, weights) for loads in zip(*by_case, strict=True)],
    )


def mesh_names(result: GearboxDeflection) -> list[str]:
    """Return the meshes in their order."""
    return [mesh.name for mesh in result.deflection.cases[0].meshes]


def shares(result: GearboxDeflection) -> list[float]:
    """Return the shares of the load cases, which sum to 1."""
    own = [case.share for case in result.deflection.cases]
    return [share / sum(own) for share in own]


def _case(
    case: CaseDeflection, flanks: dict[tuple[str, str], MeshFlanks], loads: Sequence[BearingLoad]
) -> tuple[CaseDeflection, Json]:
    return case, {
        "meshes": [_mesh(mesh, flanks.get((case.name, mesh.name))) for mesh in case.meshes],
        "bearings": [(load, _life([load], [1.0])) for load in loads],
    }


def _mesh(mesh: MeshAlignment, flanks: MeshFlanks | None) -> tuple[MeshAlignment, Json]:
    return mesh, {"causes": dict(zip(CAUSES, mesh.causes, strict=True)), "flanks": flanks}


def _mesh_over_cases(result: GearboxDeflection, name: str) -> Json:
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
    return float(np.dot(weights, values)) if len(values) == len(weights) else None


def _largest(values: Sequence[float]) -> float | None:
    """Return the largest value, None where there is none."""
    known = [value for value in values if math.isfinite(value)]
    return max(known) if known else None
