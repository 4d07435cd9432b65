"""The scene as resolved, in plain JSON: every default and every derived value spelled out."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.mechanism.rotor import Rotor
from dynamics.meshes import GearMesh
from dynamics.motion.observation import static_deflections
from dynamics.shafts import ElasticShaft
from dynamics.types import Json

# The effect ledger of a run in plain JSON: decisions, influence, price, and the checks of the run.


NOT_CHECKED = "no; toggling it measures it (ablation)"
POSITIONS = 32


def effect_ledger(
    system: System,
    checks: Sequence[Json],
    automatic: Mapping[str, str],
    influences: Mapping[str, Json],
) -> Json:
    """Return entries, estimates, what the model leaves out, and the checks.

    Parameters
    ----------
    system : System
    checks : sequence of dict
        What `RunChecks` found.
    automatic : mapping of str to str
        Effects that were left to "auto" and are not as the scene calls for them, and why: for the tolerance,
        or because a run without them showed that they are needed.
    influences : mapping of str to dict
        What leaving effects out in all their parts is estimated to change, with `words`.
    """
    deflection = _mean_deflection(system)
    whole = system.ledger.to_json()
    entries = [_ledger_entry(entry, deflection, checks, automatic, influences) for entry in whole["entries"]]
    return {**whole, "entries": entries, "worths": dict(influences), "checks": list(checks)}


def _mean_deflection(system: System) -> float:
    """Return the largest of the meshes' mean static transmission errors under the nominal force, m."""
    table = system.arrays.elements.laws.flank.table
    position, touched = np.arange(POSITIONS) / POSITIONS, np.empty(POSITIONS)
    deflections = [0.0]
    for index, force in enumerate(system.flanks.nominal_force):
        static_deflections(table, index, position, float(force), touched)
        deflections.append(float(np.mean(np.abs(touched))))
    return max(deflections)


def _ledger_entry(
    entry: Json,
    deflection: float,
    checks: Sequence[Json],
    automatic: Mapping[str, str],
    influences: Mapping[str, Json],
) -> Json:
    """One effect of one part."""
    name = entry["effect"]
    own = [check for check in checks if (check["effect"], check["part"]) == (entry["effect"], entry["part"])]
    assessed = {
        "worth_relative": entry["worth"] / deflection if deflection > 0.0 else None,
        "checked": "; ".join(check["reason"] for check in own) or NOT_CHECKED,
        "holds": all(check["holds"] for check in own) if own else None,
    }
    if entry["price"] and not entry["on"] and name in influences:
        assessed["price"] = f"left out: {influences[name]['words']}"
    if name in automatic and entry["possible"]:
        assessed |= {"choice": "auto", "reason": automatic[name], "price": ""}
    return {**entry, **assessed}


# The model of flexible shafts: elements, modes, errors, in plain JSON.


def _flexible_shafts(rotors: Sequence[Rotor]) -> list[Json]:
    """Return one entry per flexible shaft, SI."""
    return [_entry(rotor.shaft.name, rotor.elastic) for rotor in rotors if rotor.elastic is not None]


def _entry(name: str, elastic: ElasticShaft) -> Json:
    """One shaft: how its beam was divided, what was kept of it, and the errors of either."""
    families = {"bending": elastic.bending, "extension": elastic.extension, "torsion": elastic.torsion}
    return {
        "shaft": name,
        "elements": elastic.position.size - 1,
        "element_error": elastic.mesh_error,
        "highest_frequency": elastic.highest,
        "truncation_error": elastic.truncation,
        "damping_ratio": elastic.damping_ratio,
        "held_modes": {kind: modes.fixed for kind, modes in families.items()},
        "held_modes_up_to": {kind: modes.limit for kind, modes in families.items()},
        "free_frequencies": {kind: modes.frequency.tolist() for kind, modes in families.items()},
        "freedoms": list(elastic.kinds),
    }


def resolved_case(system: System) -> Json:
    """Return what was computed: parts, dampings in use, lines of action, freedoms; of tables the size."""
    scene, flanks = system.scene, system.flanks
    case = {
        "shafts": [asdict(shaft) for shaft in scene.shafts],
        "gears": [asdict(gear) for gear in scene.gears],
        "discs": [asdict(disc) for disc in scene.discs],
        "bushings": [asdict(part) for rotor in system.rotors for part in rotor.bushings],
        "planet_bearings": [asdict(part) for rotor in system.rotors for part in rotor.planet_bearings],
        "meshes": [_mesh(system, index) for index in range(len(scene.meshes))],
        "drives": [asdict(drive) for drive in scene.drives],
        "speed_torques": [asdict(torque) for torque in scene.speed_torques],
        "forces": [asdict(force) for force in scene.forces],
        "unbalances": [asdict(part) for part in scene.unbalances],
        "housings": [vars(housing) for housing in scene.housings],  # as it is: matrices of 10^4 numbers
        "rolling_contacts": [asdict(part) for part in scene.rolling_contacts],
        "spring_curves": [asdict(part) for part in scene.spring_curves],
        "rolling_bearings": [asdict(part) for part in scene.rolling_bearings],
        "couplings": [asdict(coupling) for coupling in scene.couplings],
        "free_rotations": [asdict(rotation) for rotation in scene.free_rotations],
        "speed_ratios": {
            shaft.name: [str(value) for value in row]
            for shaft, row in zip(scene.shafts, system.kinematics.ratio, strict=True)
        },
        "loads": [asdict(load) for load in scene.loads],
        "flexible_shafts": _flexible_shafts(system.rotors),
        "duration": scene.duration,
        "gravity": list(scene.gravity),
        "effects": dict(scene.effects),
        "tolerance": scene.tolerance,
        "outputs": {**asdict(scene.outputs), "sample_rate": system.sampling.rate},
        "integration": asdict(scene.integration),
        "freedoms": list(system.freedoms.name),
        "damping_reach": [float(value) for value in flanks.law.reach[: len(scene.meshes)]],
    }
    plain: Json = json.loads(json.dumps(case, default=float))  # lists for tuples, as a file gives them back
    return plain


def _mesh(system: System, index: int) -> Json:
    mesh, line, flanks = system.scene.meshes[index], system.lines[index], system.flanks
    return {
        "name": mesh.name,
        "driver": mesh.driver,
        "driven": mesh.driven,
        "technique": mesh.technique,
        "nominal_force": float(flanks.nominal_force[index]),
        "mean_stiffness": float(flanks.mean_stiffness[index]),
        "damping": float(flanks.law.damping[index]),
        "damping_ratio": mesh.damping_ratio,
        "position_offset": mesh.position_offset,
        "misalignment": mesh.misalignment,
        "center_distance_change": mesh.center_distance_change,
        "friction": mesh.friction,
        "working_pressure_angle": line.working_pressure_angle,
        "line_of_action": [float(value) for value in line.force],
        "point_of_action": [float(value) for value in line.point],
        "coast": _coast(mesh),
        "table": {
            "positions": np.size(mesh.table.position),
            "levels": np.size(mesh.table.level),
            "period": int(mesh.table.period),
        },
    }


def _coast(mesh: GearMesh) -> Json | None:
    if mesh.coast is None:
        return None
    return {
        "backlash": mesh.coast.backlash,
        "thickness": mesh.coast.thickness,
        "own_table": mesh.coast.table is not None,
    }
