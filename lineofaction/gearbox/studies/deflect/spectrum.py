"""The load spectrum of every mesh as the inputs of an optimization of its flanks."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from bounds.types import Json
from dynamics.settings.load_case import COAST
from lineofaction.gearbox.convert.toml import toml_text
from lineofaction.gearbox.studies.deflect.figures import mesh_names
from lineofaction.gearbox.studies.deflect.result import GearboxDeflection
from lineofaction.gearbox.units import UM

DIGITS = 3
"""Of a misalignment in um behind the point."""


def optimization_inputs(result: GearboxDeflection, mesh: str) -> Json:
    """Return the loads of a mesh over the spectrum: torques, their misalignments, their shares as weights.

    Load cases of equal torque and misalignment, to the digits of the file, are one load; those of equal
    torque at different misalignments are several. Load cases on the coast side load the other flanks and are
    left aside, unless all are. A plane model has no misalignment: there the inputs have none.
    """
    in_plane, shares = _in_plane(result, mesh), dict[tuple[float, float], float]()
    for torque, share, misalignment in _points(result, mesh):
        load = _digits(torque), 0.0 if in_plane else round(misalignment / UM, DIGITS) + 0.0
        shares[load] = shares.get(load, 0.0) + share
    torques, misalignments = zip(*sorted(shares), strict=True)
    weights = [_digits(shares[load]) for load in sorted(shares)]
    return {
        "torque_n_m": list(torques),
        **({} if in_plane else {"misalignment_um": list(misalignments)}),
        "objective": {"kind": "weighted_mean", "weights": weights},
    }


def _in_plane(result: GearboxDeflection, mesh: str) -> bool:
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
