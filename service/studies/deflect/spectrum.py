"""The load spectrum of every mesh as the inputs of an optimization of its flanks."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from bounds.types import Json
from dynamics.settings.load_case import COAST
from service.convert.toml import toml_text
from service.studies.deflect.figures import mesh_names
from service.studies.deflect.result import GearboxDeflection
from service.units import UM

ALIKE = 1e-6


def optimization_inputs(result: GearboxDeflection, mesh: str) -> Json:
    """Return torques with their weights, mean misalignment and its scatter over the spectrum of a mesh.

    Load cases of equal torque are one. Those on the coast side load the other flanks and are left aside,
    unless all are. A plane model has no misalignment: there the inputs have none.
    """
    points = _points(result, mesh)
    torque = np.array([point[0] for point in points])
    weight = np.array([point[1] for point in points])
    misalignment = np.array([point[2] for point in points])
    order = np.argsort(torque)
    merged: list[list[float]] = []
    for k in order:
        if merged and torque[k] <= merged[-1][0] * (1.0 + ALIKE):
            merged[-1][1] += weight[k]
        else:
            merged.append([float(torque[k]), float(weight[k])])
    inputs: Json = {
        "torque_n_m": [_digits(point[0]) for point in merged],
        "objective": {"kind": "weighted_mean", "weights": [_digits(point[1]) for point in merged]},
    }
    if _in_plane(result, mesh):
        return inputs
    mean = float(np.average(misalignment, weights=weight))
    spread = float(np.sqrt(np.average((misalignment - mean) ** 2, weights=weight)))
    inputs["misalignment_um"] = _digits(mean / UM)
    if spread > ALIKE * max(abs(mean), UM):
        inputs["scatter"] = {"misalignment_um": _digits(spread / UM)}
    return inputs


def _in_plane(result: GearboxDeflection, mesh: str) -> bool:
    """Return whether the load was taken as even over the face."""
    return all(np.isnan(flanks.face_load_factor) for flanks in result.flanks if flanks.mesh == mesh)


def _points(result: GearboxDeflection, mesh: str) -> list[tuple[float, float, float]]:
    """Return torque on the pinion, share and misalignment of the load cases."""
    torque = {flanks.case: flanks.torque for flanks in result.flanks if flanks.mesh == mesh}
    points = []
    for case in result.deflection.cases:
        own = next(part for part in case.meshes if part.name == mesh)
        points.append((case.direction == COAST, torque[case.name], case.share, own.misalignment))
    driving = [point[1:] for point in points if not point[0]]
    return driving or [point[1:] for point in points]


def write_spectrum(result: GearboxDeflection, _scene: Any, target: Path) -> None:
    """Write case and optimization inputs of every mesh with a case beside `target`, which lists the calls."""
    lines = ["# Flanks for the load spectrum of each mesh: loa optimize takes these files.", ""]
    for name in mesh_names(result):
        if name not in result.cases:
            continue
        stem = "".join(letter if letter.isalnum() else "_" for letter in name)
        case, study = (target.with_name(f"{target.stem}_{stem}{end}.toml") for end in ("", "_optimize"))
        case.write_text(toml_text(result.cases[name]), encoding="utf-8")
        study.write_text(toml_text(optimization_inputs(result, name)), encoding="utf-8")
        lines.append(f"# loa optimize {case.name} {study.name} -o {target.stem}_{stem}_best")
        lines += [
            f'[[meshes]]\nname = "{name}"',
            f'case_file = "{case.name}"',
            f'study_file = "{study.name}"',
            "",
        ]
    target.write_text("\n".join(lines), encoding="utf-8")


def _digits(value: float) -> float:
    """Return a number of seven digits: what a file shows."""
    return float(f"{value:.7g}")
