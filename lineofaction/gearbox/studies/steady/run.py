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
from lineofaction.gearbox.studies.figures import Row, figures_of, rows
from lineofaction.gearbox.studies.housing_costs import kept_costs, with_housing_costs
from lineofaction.gearbox.studies.result_file import array_file
from lineofaction.gearbox.studies.steady import Inputs, SteadyFigures
from lineofaction.gearbox.units import RPM

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
    points: dict[str, list[Any]] = {
        name: [_motion(states, int(index)) for index in np.flatnonzero(states.curve == curve)]
        for curve, name in enumerate(CURVES)
    }
    changes = zip(states.bifurcation_kind, states.bifurcation_speed, strict=True)
    jumps = zip(states.jump_curve, states.jump_speed, strict=True)
    return figures_of(
        SteadyFigures,
        about,
        up=points["up"],
        down=points["down"],
        branch={"status": about["branch"].lower().replace("_", " "), "points": points[CURVES[BRANCH]]},
        bifurcations=[{"kind": KINDS[int(kind)], "speed": speed} for kind, speed in changes],
        jumps=[{"sweep": "up" if curve == UP else "down", "between": ends} for curve, ends in jumps],
        reduction_cost=kept_costs(about),
    )


def _motion(states: SteadyStates, index: int) -> tuple[Any, ...]:
    """Return a motion; of one that was not found only how the search ended."""
    point = Row(states, index)
    own: Json = {"status": status_name(int(point.status)), "meshes": None, "bearings": None}
    if point.status == OrbitStatus.CONVERGED:
        largest = point.multiplier[0]
        own |= {
            "stability": KINDS[int(point.instability)],
            "largest_multiplier": [largest.real, largest.imag],
            "meshes": rows(point, states.mesh),
            "bearings": {
                name: {"rms_force": force}
                for name, force in zip(states.bearing, point.rms_bearing_force, strict=True)
            },
        }
    return point, own


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
