"""Periodic steady states of a scene: motions over speed."""

from __future__ import annotations

from typing import Any

import numpy as np

from dynamics.assembly.assemble import assemble
from dynamics.periodic import OrbitStatus, SteadyStates, steady_states
from dynamics.periodic.steady_states import BRANCH, CURVES, UP
from dynamics.scene import Scene
from lineofaction.gearbox.convert.case import boundary_errors
from lineofaction.gearbox.studies.computation import Computation, Means
from lineofaction.gearbox.studies.housing_costs import reduction_figures, with_housing_costs
from lineofaction.gearbox.studies.result_file import array_file
from lineofaction.gearbox.studies.steady import Inputs
from lineofaction.gearbox.units import RPM, UM

Json = dict[str, Any]
KINDS = ("stable", "fold", "period doubling", "Neimark-Sacker")


def _steady_of(scene: Scene, inputs: Inputs, means: Means) -> SteadyStates:
    with boundary_errors():
        return steady_states(
            assemble(scene),
            [value * RPM for value in inputs.speed_rpm],
            branch=inputs.branch,
            repeat=inputs.repeat,
            periods=inputs.settling_periods,
            progress=means.report,
        )


def status_name(status: int) -> str:
    """Name how a search ended."""
    return OrbitStatus(status).name.lower().replace("_", " ")


def facts(states: SteadyStates) -> Json:
    """Return the motions of both sweeps and of the branch, jumps and bifurcations."""
    about = states.facts
    points: dict[str, list[Json]] = {
        name: [_point(states, int(index)) for index in np.flatnonzero(states.curve == curve)]
        for curve, name in enumerate(CURVES)
    }
    return {
        "leading_shaft": about["leading_shaft"],
        "period_pitches": about["period_pitches"],
        "up": points["up"],
        "down": points["down"],
        "branch": {
            "status": about["branch"].lower().replace("_", " "),
            "points": points[CURVES[BRANCH]],
        },
        "bifurcations": [
            {"kind": KINDS[int(kind)], "speed_rpm": float(speed) / RPM}
            for kind, speed in zip(states.bifurcation_kind, states.bifurcation_speed, strict=True)
        ],
        "jumps": [
            {"sweep": "up" if curve == UP else "down", "between_rpm": (ends / RPM).tolist()}
            for curve, ends in zip(states.jump_curve, states.jump_speed, strict=True)
        ],
        "steps_per_period": about["steps_per_period"],
        "cpu_seconds": about["seconds"],
        "reduction_cost": reduction_figures(about),
        "effect_ledger": about["effect_ledger"],
    }


def _point(states: SteadyStates, index: int) -> Json:
    """One motion; of one that was not found only how the search ended."""
    point: Json = {
        "speed_rpm": float(states.speed[index]) / RPM,
        "status": status_name(int(states.status[index])),
        "iterations": int(states.iterations[index]),
    }
    for name, value in (("residual_um", states.residual[index]), ("step_error_um", states.step_error[index])):
        if np.isfinite(value):
            point[name] = float(value) / UM
    if states.status[index] != OrbitStatus.CONVERGED:
        return point
    largest = states.multiplier[index, 0]
    return point | {
        "stability": KINDS[int(states.instability[index])],
        "largest_multiplier": [float(largest.real), float(largest.imag)],
        "meshes": {name: _mesh(states, index, mesh) for mesh, name in enumerate(states.mesh)},
        "bearings": {
            name: {"rms_force_n": float(states.rms_bearing_force[index, bearing])}
            for bearing, name in enumerate(states.bearing)
        },
    }


def _mesh(states: SteadyStates, index: int, mesh: int) -> Json:
    return {
        "mean_error_um": float(states.mean_error[index, mesh]) / UM,
        "rms_error_um": float(states.rms_error[index, mesh]) / UM,
        "peak_to_peak_error_um": float(states.peak_to_peak_error[index, mesh]) / UM,
        "least_force_n": float(states.least_force[index, mesh]),
        "largest_force_n": float(states.largest_force[index, mesh]),
        "parted": float(states.parted[index, mesh]),
        "coasting": float(states.coasting[index, mesh]),
    }


def _not_found(states: SteadyStates) -> str:
    """Say at how many speeds a sweep found no motion."""
    missing = (states.status != 0) & (states.curve != BRANCH)
    if not missing.any():
        return ""
    speeds = sorted({f"{speed / RPM:.6g}" for speed in states.speed[missing]})
    shown = ", ".join(speeds[:5]) + (" ..." if len(speeds) > 5 else "")
    return (
        f"{int(missing.sum())} of {int((states.curve != BRANCH).sum())} motions were not found, at {shown} "
        "rpm. They may repeat after more periods (--repeat 2), or never."
    )


RUN = Computation(
    with_housing_costs(_steady_of),
    facts,
    array_file(SteadyStates),
    failure=_not_found,
)
