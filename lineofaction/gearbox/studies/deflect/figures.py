"""The figures of a deflection in the units of the boundary."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from bounds.types import FloatArray, Json
from dynamics.deflection import CAUSES, BearingLoad, CaseDeflection, equivalent_load, life_duration
from dynamics.settings.load_case import COAST
from lineofaction.gearbox.schemas.toml import toml_text
from lineofaction.gearbox.studies.deflect import DeflectFigures, RatingLife
from lineofaction.gearbox.studies.deflect.result import GearboxDeflection, MeshFlanks
from lineofaction.gearbox.units import RPM, UM

HOUR = 3600.0  # an hour in s
ROUNDING, ROUNDING_OF_ALL = 1e-9, 1e-12
"""Shares of the largest force of a bearing, and of the largest force of all bearings, below which a force is
zero. Moments are compared times 1/m. Displacements are compared as forces of all bearings."""

DIGITS = 3
"""Number of decimals of a misalignment in um."""

BALL_EXPONENT = 3.0
"""Exponent of the equivalent load of ball bearings (ISO 281)."""


def _loads_by_case(cases: Sequence[CaseDeflection]) -> list[list[BearingLoad]]:
    """Return the loads of all bearings in every case; forces and displacements of rounding are zero."""
    by_bearing = zip(*(case.bearings for case in cases), strict=True)
    largest = [max(float(np.max(np.abs(load.force[:3]))) for load in loads) for loads in by_bearing]
    of_all = ROUNDING_OF_ALL * max(largest, default=0.0)
    minimum = [max(ROUNDING * force, of_all) for force in largest]
    loads = [load for case in cases for load in case.bearings]
    displacements = (part[:3] for load in loads for part in (load.elastic, load.clearance, load.seat))
    floor = ROUNDING_OF_ALL * max((float(np.max(np.abs(part))) for part in displacements), default=0.0)
    by_case = []
    for case in cases:
        limited = zip(case.bearings, minimum, strict=True)
        by_case.append([_without_rounding(load, limit, floor) for load, limit in limited])
    return by_case


def _without_rounding(load: BearingLoad, minimum: float, floor: float) -> BearingLoad:
    """Return a load whose forces below `minimum`, N, and displacements below `floor`, m and rad, are zero."""
    return replace(
        load,
        force=_at_least(load.force, minimum),
        largest_radial=load.largest_radial if load.largest_radial >= minimum else 0.0,
        elastic=_at_least(load.elastic, floor),
        clearance=_at_least(load.clearance, floor),
        seat=_at_least(load.seat, floor),
    )


def _at_least(values: FloatArray, minimum: float) -> FloatArray:
    return np.asarray(np.where(np.abs(values) < minimum, 0.0, values))


def _over_cases(loads: Sequence[BearingLoad], weights: Sequence[float]) -> DeflectFigures.BearingOverCases:
    """Return a bearing over the load cases by their shares."""
    speed = [load.speed for load in loads]

    def equivalent(sizes: Sequence[float]) -> dict[str, float]:
        return {
            "ball": equivalent_load(sizes, speed, weights, BALL_EXPONENT),
            "roller": equivalent_load(sizes, speed, weights),
        }

    life = _Life.of(loads, weights)
    return DeflectFigures.BearingOverCases(
        name=loads[0].name,
        mean_speed_rpm=float(np.dot(weights, speed)) / RPM,
        largest_radial_force_n=max(load.largest_radial for load in loads),
        equivalent_radial_force_n=equivalent([load.radial for load in loads]),
        equivalent_axial_force_n=equivalent([abs(load.axial) for load in loads]),
        rating_life_hours=life.rating_life_hours,
        rating_life=life.rating_life,
    )


class _Life(NamedTuple):
    """Life of a bearing over load cases in h; without a number `rating_life` has the reason."""

    rating_life_hours: float
    rating_life: RatingLife

    @classmethod
    def of(cls, loads: Sequence[BearingLoad], weights: Sequence[float]) -> _Life:
        revolutions = [load.rating_life for load in loads]
        seconds = life_duration(revolutions, [load.speed for load in loads], weights)
        if math.isnan(seconds):
            return cls(math.nan, "none: no capacity")
        return cls(seconds / HOUR, "limited" if math.isfinite(seconds) else "unlimited")


def figures_by_case(result: GearboxDeflection) -> Json:
    """Return the figures by load case, by mesh, by bearing; lines of shafts and patterns are in the file."""
    flanks = {(part.case, part.mesh): part for part in result.flanks}
    cases = result.deflection.cases
    by_case = _loads_by_case(cases)
    weights = _shares(result)
    return {
        "load_cases": [_case(case, flanks, loads) for case, loads in zip(cases, by_case, strict=True)],
        "meshes": [_mesh_over_cases(result, name) for name in mesh_names(result)],
        "bearings": [_over_cases(loads, weights) for loads in zip(*by_case, strict=True)],
    }


def mesh_names(result: GearboxDeflection) -> list[str]:
    """Return the meshes in their order."""
    return [mesh.name for mesh in result.deflection.cases[0].meshes]


def _shares(result: GearboxDeflection) -> list[float]:
    """Return the shares of the load cases, which sum to 1."""
    shares = [case.share for case in result.deflection.cases]
    return [share / sum(shares) for share in shares]


def _case(
    case: CaseDeflection, flanks: dict[tuple[str, str], MeshFlanks], loads: Sequence[BearingLoad]
) -> tuple[CaseDeflection, Json]:
    meshes: list[Any] = []
    for mesh in case.meshes:
        causes = dict(zip(CAUSES, mesh.causes, strict=True))
        meshes.append((mesh, {"causes": causes, "flanks": flanks.get((case.name, mesh.name))}))
    return case, {"meshes": meshes, "bearings": [(load, _Life.of([load], [1.0])._asdict()) for load in loads]}


def _mesh_over_cases(result: GearboxDeflection, name: str) -> DeflectFigures.MeshOverCases:
    """Return the means of a mesh over the load cases by their shares, and its worst case."""
    weights = _shares(result)
    cases = result.deflection.cases
    alignments = [next(mesh for mesh in case.meshes if mesh.name == name) for case in cases]
    worst = int(np.argmax([abs(mesh.misalignment) for mesh in alignments]))
    flanks = [part for part in result.flanks if part.mesh == name]
    ripple = [part.peak_to_peak / UM for part in flanks]
    factors = [part.face_load_factor for part in flanks if math.isfinite(part.face_load_factor)]
    return DeflectFigures.MeshOverCases(
        name=name,
        mean_misalignment_um=float(np.dot(weights, [mesh.misalignment for mesh in alignments])) / UM,
        largest_misalignment_um=alignments[worst].misalignment / UM,
        largest_in=cases[worst].name,
        mean_peak_to_peak_um=float(np.dot(weights, ripple)) if len(ripple) == len(weights) else None,
        largest_k_h_beta=max(factors, default=None),
    )


def optimization_inputs(result: GearboxDeflection, mesh: str) -> Json:
    """Return the loads of a mesh over the spectrum: torques, their misalignments, their shares as weights.

    Load cases of equal torque and misalignment, to the digits of the file, are one load; those of equal
    torque at different misalignments are several. Load cases on the coast side load the other flanks: they
    count only if no case drives. A plane model has no misalignment: there the inputs have none.
    """
    in_plane = all(np.isnan(flanks.face_load_factor) for flanks in result.flanks if flanks.mesh == mesh)
    shares: dict[tuple[float, float], float] = {}
    for torque, share, misalignment in _points(result, mesh):
        load = _digits(torque), 0.0 if in_plane else round(misalignment / UM, DIGITS) + 0.0  # -0.0 is 0.0
        shares[load] = shares.get(load, 0.0) + share
    torques, misalignments = zip(*sorted(shares), strict=True)
    weights = [_digits(shares[load]) for load in sorted(shares)]
    return {
        "torque_n_m": list(torques),
        **({} if in_plane else {"misalignment_um": list(misalignments)}),
        "objective": {"kind": "weighted_mean", "weights": weights},
    }


def _points(result: GearboxDeflection, mesh: str) -> list[tuple[float, float, float]]:
    """Return torque on the pinion, share and misalignment of driving load cases, else of coast ones."""
    torque = {flanks.case: flanks.torque for flanks in result.flanks if flanks.mesh == mesh}
    driving: list[tuple[float, float, float]] = []
    coast: list[tuple[float, float, float]] = []
    for case in result.deflection.cases:
        alignment = next(part for part in case.meshes if part.name == mesh)
        points = coast if case.direction == COAST else driving
        points.append((torque[case.name], case.share, alignment.misalignment))
    return driving or coast


def write_spectrum(result: GearboxDeflection, _scene: Any, target: Path) -> None:
    """Write case and optimization inputs of every mesh with a case; `target` lists the calls."""
    lines = ["# Flanks for the load spectrum of each mesh: loa optimize takes these files.", ""]
    for name in mesh_names(result):
        if name not in result.cases:
            continue
        stem = "".join(letter if letter.isalnum() else "_" for letter in name)
        case = target.with_name(f"{target.stem}_{stem}.toml")
        study = target.with_name(f"{target.stem}_{stem}_optimize.toml")
        case.write_text(toml_text(result.cases[name]), encoding="utf-8")
        study.write_text(toml_text(optimization_inputs(result, name)), encoding="utf-8")
        lines.append(f"# loa optimize {case.name} {study.name} -o {target.stem}_{stem}_best")
        lines += ["[[meshes]]", f'name = "{name}"']
        lines += [f'case_file = "{case.name}"', f'study_file = "{study.name}"', ""]
    target.write_text("\n".join(lines), encoding="utf-8")


def _digits(value: float) -> float:
    """Return a number of seven digits, as files have it."""
    return float(f"{value:.7g}")
