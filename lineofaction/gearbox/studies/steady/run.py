"""Periodic steady states of a scene: motions over speed."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from bounds import engineering
from bounds.types import Json
from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError, SolveError
from dynamics.periodic import OrbitStatus, SteadyStates, steady_states
from dynamics.periodic.steady_cost import SteadyCost, steady_cost
from dynamics.periodic.steady_states import BRANCH, CURVES, UP
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.computation import Means, SceneStudy, array_file
from lineofaction.gearbox.studies.cost import LONG, StudyCost, Work
from lineofaction.gearbox.studies.excitations import with_scene_metadata
from lineofaction.gearbox.studies.figures import Row, rows
from lineofaction.gearbox.studies.scene_before_tables import planned_positions, scene_before_tables, sized
from lineofaction.gearbox.studies.steady import Inputs, SteadyFigures
from lineofaction.gearbox.units import RPM

KINDS = ("stable", "fold", "period doubling", "Neimark-Sacker")
"""Stability of a motion, and bifurcations where it is lost: names by their number in a result."""


class _SteadyStudy(SceneStudy[Inputs, SteadyFigures, SteadyStates]):
    inputs, answer, file = Inputs, SteadyFigures, array_file(SteadyStates)

    def predicted(self, scene: SceneInput, inputs: Inputs, cache: Path | None) -> StudyCost | None:
        """Return the predicted cost of the motions of both sweeps and of a branch without folds.

        A few steps of the scene give the cost of a period; steps end at the positions of the tables, so that
        tables of many positions take more of them. The number of modes of a solid housing is known
        only after its reduction, so their cost is left out. None: the motion of the scene does not repeat, or
        the scene cannot be assembled without its tables.
        """
        with boundary_errors():
            before = scene_before_tables(scene)
            if before is None:
                return None
            positions = planned_positions(scene, cache)
        speeds = np.array(inputs.speed_rpm) * RPM
        options: Json = {"branch": inputs.branch, "repeat": inputs.repeat, "periods": inputs.settling_periods}
        try:
            system = sized(scene, positions=positions)
            cost = _study_cost(steady_cost(system, speeds, **options))
            if cost.seconds <= LONG:
                return cost
            single = steady_cost(system, speeds[-1:], **options)
        except (InputError, SolveError):
            return None  # the study raises this error itself
        return replace(cost, remedy=_remedy(single, inputs.speed_rpm[-1]))

    def compute(self, subject: TabledScene, inputs: Inputs, means: Means) -> SteadyStates:
        with boundary_errors():
            states = steady_states(
                assemble(subject.steady.scene),
                [value * RPM for value in inputs.speed_rpm],
                branch=inputs.branch,
                repeat=inputs.repeat,
                periods=inputs.settling_periods,
                progress=means.report,
                workers=means.workers,
            )
        return with_scene_metadata(states, subject)

    def _derived(self, states: SteadyStates) -> Json:
        points: dict[str, list[Any]] = {
            name: [_motion(states, int(index)) for index in np.flatnonzero(states.curve == curve)]
            for curve, name in enumerate(CURVES)
        }
        ended = states.metadata["branch"].lower().replace("_", " ")
        changes = zip(states.bifurcation_kind, states.bifurcation_speed, strict=True)
        jumps = zip(states.jump_curve, states.jump_speed, strict=True)
        return {
            "up": points["up"],
            "down": points["down"],
            "branch": {"status": ended, "points": points[CURVES[BRANCH]]},
            "bifurcations": [{"kind": KINDS[int(kind)], "speed": speed} for kind, speed in changes],
            "jumps": [{"sweep": "up" if curve == UP else "down", "between": ends} for curve, ends in jumps],
        }

    def failure(self, states: SteadyStates) -> str:
        missing = (states.status != 0) & (states.curve != BRANCH)
        if not missing.any():
            return ""
        speeds = sorted({f"{speed / RPM:.6g}" for speed in states.speed[missing]})
        listed = ", ".join(speeds[:5]) + (" ..." if len(speeds) > 5 else "")
        return (
            f"{int(missing.sum())} of {int((states.curve != BRANCH).sum())} motions were not found, at "
            f"{listed} rpm. They may repeat after more periods (--repeat 2), or never."
        )


def status_name(status: int) -> str:
    """Return the name of the status with which the search for a motion ended."""
    return OrbitStatus(status).name.lower().replace("_", " ")


def _motion(states: SteadyStates, index: int) -> tuple[Any, ...]:
    """Return the record of a motion and further figures; one that was not found has a status alone."""
    point = Row(states, index)
    figures: Json = {"status": status_name(int(point.status)), "meshes": None, "bearings": None}
    if point.status == OrbitStatus.CONVERGED:
        largest = point.multiplier[0]  # Floquet multipliers stand by falling size
        figures |= {
            "stability": KINDS[int(point.instability)],
            "largest_multiplier": [largest.real, largest.imag],
            "meshes": rows(point, states.mesh),
            "bearings": {
                name: {"rms_force": force}
                for name, force in zip(states.bearing, point.rms_bearing_force, strict=True)
            },
        }
    return point, figures


def _study_cost(cost: SteadyCost) -> StudyCost:
    sweeps = (Work("motions", cost.motion, cost.motions / 2.0, sweep) for sweep in ("up", "down"))
    return StudyCost((*sweeps, Work("points of the branch", cost.point, cost.points, "branch")))


def _remedy(single: SteadyCost, rpm: float) -> str:
    """Return advice on a motion that is too expensive at many speeds: its cost at one, alternatives."""
    pitches = " and ".join(map(str, single.pitches))
    repeats = f"repeats after {pitches} base pitches of the meshes and " if pitches else ""
    return (
        f"A motion {repeats}is derived by {2 * single.freedoms} states. One at {rpm:.6g} rpm takes "
        f"{engineering(single.motion, 2)} CPU s: name few speeds, without the branch (--no-branch). Or try "
        "loa response, which is linear, or loa simulate through the speeds."
    )


RUN = _SteadyStudy()
