"""The documents of a result beside its series: ledger, resolved case, modes, bearings at rest, receipt.

Each document is plain JSON and an attribute of the result file.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any

import numpy as np

from bounds import engineering
from dynamics.assembly.assemble import System
from dynamics.bearings import RollingBearing
from dynamics.bearings.loaded_bearing import LoadedBearing
from dynamics.bearings.row_law import row_law
from dynamics.errors import SolveError
from dynamics.forces.elements import Elements
from dynamics.forces.laws import BEARING_PARTS, Law, among
from dynamics.influence import (
    Decision,
    Influence,
    estimate_influences,
    neglected_effects,
    sized_ledger,
    with_assumed_phases,
)
from dynamics.integrators import static_equilibrium
from dynamics.integrators.march import Ending
from dynamics.integrators.method_choice import MethodChoice
from dynamics.integrators.workspace import Count
from dynamics.kernels.local_state import LocalState
from dynamics.linearize import natural_modes
from dynamics.linearize.campbell import branches_up_to
from dynamics.linearize.linear_system import LinearSystem, linearize
from dynamics.linearize.mode_energy import freedom_parts
from dynamics.linearize.operating_speeds import leading_law, mesh_frequencies
from dynamics.mechanism.additions import SPEED_DEPENDENCE
from dynamics.mechanism.bearing_elements import BearingElement
from dynamics.meshes import CoastFlank
from dynamics.motion.observation import local_state, observe, observe_laws
from dynamics.motion.sampled_states import States
from dynamics.plausibility import scene_findings
from dynamics.results import EnergyAudit, StepStatistics
from dynamics.results.checks import Check
from dynamics.results.histories import checked_series, filtered, histories, unfiltered
from dynamics.results.run_checks import RunChecks
from dynamics.scene import Integration, Scene
from dynamics.shafts import ElasticShaft
from dynamics.simulation.linear_orders import linear_orders
from dynamics.simulation.violations import FIRST, EarlierRun
from dynamics.types import FloatArray, Json
from model_studies.stage_clock import StageClock

NOT_CHECKED = "no; toggling it measures it (ablation)"
MIN_SHARE = 0.05  # least share of a part in the kinetic energy of a mode that is listed
ROWS = (Law.BALLS, Law.ROLLERS)
ERROR_CHECK_FACTOR = 0.1  # tolerance or step of the finer run over that of the run
IMPLICIT_STAGES_PER_STEP = 5  # implicit stages of a step: all but the first


@dataclass(frozen=True)
class RunContext:
    """Facts of a run beside its series."""

    system: System
    scene: Scene
    """Scene with its effects as decided."""
    audit: EnergyAudit | None
    """Energy audit; None if not requested."""
    checks: Sequence[Check]
    """Checks of the run on its own model."""
    automatic: Mapping[str, str]
    """Effects that were left to "auto" and are not as the scene calls for them, each with the reason: the
    tolerance, or a run without them that showed the need.
    """
    influences: Mapping[str, Influence]
    """Estimated change by each effect, if it were left out in all its parts."""

    @classmethod
    def of(
        cls,
        system: System,
        end: Ending,
        checks: RunChecks,
        clock: StageClock,
        decision: Decision,
        before: EarlierRun,
    ) -> RunContext:
        """Gather the facts; `before` is the run that this one repeats."""
        with clock.stage("influence_estimates"):
            influences = _known_influences(decision, system)
        clock.book("influence_estimates", decision.taken)
        audit = None
        if system.scene.outputs.energy_audit:
            audit = EnergyAudit.from_arrays(end.work, end.stored, end.fallen)
        checks_of_run = [*checks.checks(), *([] if audit is None else [audit.check()])]
        automatic = {**decision.automatic, **before.reasons}
        return cls(system, decision.scene, audit, checks_of_run, automatic, influences)

    def with_errors(self, error: Json) -> RunContext:
        """Return the context with the check of the errors of the steps, where they are measured."""
        check = tolerance_check(error, self.system.scene.integration)
        return self if check is None else replace(self, checks=[*self.checks, check])


def effect_ledger(run: RunContext) -> Json:
    """Return the `sized_ledger` with the checks of the run."""
    ledger = with_assumed_phases(run.system.ledger.to_json(), run.system)
    sized = sized_ledger(ledger, run.automatic, run.influences)
    entries = [entry | _checked(entry, run.checks) for entry in sized["entries"]]
    return {**sized, "entries": entries, "checks": [check.to_json() for check in run.checks]}


def _checked(entry: Json, checks: Sequence[Check]) -> Json:
    key = entry["effect"], entry["part"]
    effect_checks = [check for check in checks if (check.effect, check.part) == key]
    return {
        "checked": "; ".join(check.reason for check in effect_checks) or NOT_CHECKED,
        "holds": all(check.holds for check in effect_checks) if effect_checks else None,
    }


def _flexible_shaft(name: str, elastic: ElasticShaft) -> Json:
    """Return the document of one shaft: elements of its beam, coordinates, and the errors of both."""
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


def _resolved_case(system: System) -> Json:
    """Return the resolved case: parts, dampings in use, lines of action, freedoms; of tables the size."""
    scene, flanks = system.scene, system.flanks

    def parts(*names: str) -> dict[str, Any]:
        return {name: getattr(scene, name) for name in names}

    case = {
        **parts("shafts", "gears", "discs"),
        "bushings": [part for rotor in system.rotors for part in rotor.bushings],
        "planet_bearings": [part for rotor in system.rotors for part in rotor.planet_bearings],
        "meshes": [_mesh(system, index) for index in range(len(scene.meshes))],
        **parts("drives", "speed_torques", "forces", "unbalances"),
        "housings": [vars(housing) for housing in scene.housings],  # as it is: matrices of 10^4 numbers
        **parts(*BEARING_PARTS, "rolling_bearings", "couplings", "free_rotations"),
        "speed_ratios": {
            shaft.name: [str(value) for value in row]
            for shaft, row in zip(scene.shafts, system.kinematics.ratio, strict=True)
        },
        **parts("loads"),
        "flexible_shafts": [
            _flexible_shaft(rotor.shaft.name, rotor.elastic)
            for rotor in system.rotors
            if rotor.elastic is not None
        ],
        "duration": scene.duration,
        "gravity": list(scene.gravity),
        "effects": dict(scene.effects),
        "tolerance": scene.tolerance,
        "level_tolerance": scene.level_tolerance,
        "outputs": replace(scene.outputs, sample_rate=system.sampling.rate),
        "integration": scene.integration,
        "freedoms": list(system.freedoms.name),
        "damping_reach": [float(value) for value in flanks.law.reach[: len(scene.meshes)]],
    }
    plain: Json = json.loads(json.dumps(case, default=_plain))  # lists for tuples, as a file gives them back
    return plain


def _plain(part: Any) -> Any:
    """Return the fields of a dataclass, or a number of NumPy as a number of Python."""
    if is_dataclass(part):
        return {item.name: getattr(part, item.name) for item in fields(part)}
    return float(part)


def _mesh(system: System, index: int) -> Json:
    mesh, line, flanks = system.scene.meshes[index], system.lines[index], system.flanks
    coast = mesh.coast
    return {
        "name": mesh.name,
        "driver": mesh.driver,
        "driven": mesh.driven,
        "technique": mesh.technique,
        "nominal_force": float(flanks.nominal_force[index]),
        "mean_stiffness": float(flanks.mean_stiffness[index]),
        "damping": float(flanks.law.damping[index]),
        "damping_ratio": mesh.damping_ratio,
        "position_offset": float(system.phases.position[index]),
        "misalignment": mesh.misalignment,
        "center_distance_change": mesh.center_distance_change,
        "friction": mesh.friction,
        "working_pressure_angle": line.working_pressure_angle,
        "line_of_action": [float(value) for value in line.force],
        "point_of_action": [float(value) for value in line.point],
        "coast": None if coast is None else _coast(coast),
        "table": {
            "positions": np.size(mesh.table.position),
            "levels": np.size(mesh.table.level),
            "period": int(mesh.table.period),
        },
    }


def _coast(coast: CoastFlank) -> Json:
    table = coast.table is not None
    return {"backlash": coast.backlash, "thickness": coast.thickness, "own_table": table}


def _modes_of_run(system: System) -> Json:
    """Return the `modes` of `RunResult`; nothing where there is no equilibrium."""
    try:
        linear = linearize(system)
    except SolveError:
        return {}
    modes = natural_modes(linear)
    maximum = np.argmax(modes.kinetic_energy, axis=1) if modes.frequency.size else []
    turning = any(part.speed.extreme != 0.0 for part in system.scene.references)
    rotating = turning and linear.freedom and system.ledger.adds(SPEED_DEPENDENCE)
    return {
        "frequency": [float(value) for value in modes.frequency],
        "damping_ratio": [float(value) for value in modes.damping_ratio],
        "freedom": [modes.freedom[index] for index in maximum],
        "moves": _moves(modes.freedom, modes.kinetic_energy),
        **({"over_speed": _over_speed(system, linear)} if rotating else {}),
    }


def _over_speed(system: System, linear: LinearSystem) -> Json:
    """Return the whirl modes up to the largest speeds of the run, those that oscillate at all of them."""
    law = leading_law(system)
    branches = branches_up_to(system, linear, abs(system.scene.references[law].speed.extreme))
    speed = branches.speed
    complete = np.all(np.isfinite(branches.frequency), axis=0)
    maximum = np.argmax(branches.kinetic_energy[-1], axis=1)
    return {
        "shaft": system.scene.references[law].shaft,
        "speed": speed.tolist(),
        "mesh_frequency": mesh_frequencies(system, speed).tolist(),
        "frequency": branches.frequency[:, complete].T.tolist(),
        "damping_ratio": branches.damping_ratio[:, complete].T.tolist(),
        "whirl": branches.whirl[:, complete].T.tolist(),
        "freedom": [linear.freedom[index] for index in maximum[complete]],
        "moves": _moves(linear.freedom, branches.kinetic_energy[-1][complete]),
    }


def _moves(freedom: Sequence[str], kinetic_energy: FloatArray) -> list[Json]:
    """Return the motions of each mode, "shaft, how", with shares in the energy (m, n), the largest first."""
    names = [f"{shaft}, {direction}" for shaft, direction in freedom_parts(freedom)]
    moves = []
    for shares in kinetic_energy.tolist():
        summed = dict.fromkeys(names, 0.0)
        for name, share in zip(names, shares, strict=True):
            summed[name] += share
        maximum = sorted(summed.items(), key=lambda part: -part[1])
        moves.append({name: share for name, share in maximum if share >= MIN_SHARE})
    return moves


def _bearings_at_rest(system: System) -> Json:
    """Return ``{"rolling_bearings": {name: ...}}`` in the equilibrium under the loads at t = 0.

    Of each: ``displacement`` of the inner ring against the outer (m, rad), ``force`` of the shaft on the
    ground (N, N m), ``element_load`` of the heaviest element (N) and ``peak_pressure`` on it (Pa). Nothing
    without such bearings or without an equilibrium.
    """
    elements = system.arrays.elements
    rows = np.flatnonzero(among(elements.law, ROWS))
    rest = static_equilibrium(system) if rows.size else None
    if rest is None or not rest.status.usable:
        return {}
    local = local_state(system.arrays, 0.0, rest.displacement, 0.0 * rest.displacement)
    bearings = {bearing.name: bearing for bearing in system.scene.rolling_bearings}
    first = elements.law.size - len(system.bearings)
    return {
        "rolling_bearings": {
            at.name: _bearing_state(elements, local, e, at, bearings[at.name])
            for e, at in enumerate(system.bearings, start=first)
            if e in rows
        }
    }


def _bearing_state(
    elements: Elements, local: LocalState, e: int, at: BearingElement, bearing: RollingBearing
) -> Json:
    rows, law = slice(elements.first[e], elements.first[e + 1]), row_law(bearing)
    turned = elements.mesh[e]  # position that the cage's angle is; -1: elements are averaged
    shift = local.coordinate[rows] / np.diag(at.local_rows)
    shift[2] += law.shift
    angle = 2.0 * np.pi * float(local.position[turned]) if turned >= 0 else 0.0
    loaded = LoadedBearing(bearing.row, 1, bearing.locating) if turned >= 0 else law.loaded
    load = loaded.evaluate(shift, angle).load
    return {
        "displacement": shift.tolist(),
        "force": (local.force[rows] @ at.local_rows).tolist(),
        "element_load": float(np.max(load.sum(axis=1))),
        "peak_pressure": bearing.row.peak_pressure(float(np.max(load))),
    }


def documents(
    run: RunContext,
    end: Ending,
    clock: StageClock,
    error: Json,
    before: EarlierRun = FIRST,
    choice: MethodChoice | None = None,
) -> dict[str, Any]:
    """Return the fields of `RunResult` that are no series and not `described`.

    `before` is the run that this one repeats, `choice` that of its method; None: it never started.
    """
    system = run.system
    steps = int(end.count[Count.ACCEPTED] + end.count[Count.REJECTED])
    invalid = [check.to_json() for check in run.checks if check.valid is False]
    method = {"method": choice.to_json(end.end / steps, end.taken.cpu_seconds)} if choice and steps else {}
    return {
        "status": end.status,
        "statistics": _statistics(system, end),
        "energy": run.audit,
        "receipt": {
            "seconds": clock.seconds,
            "wall_seconds": clock.wall_seconds,
            "error": {**error, "sampling": end.figures.error(system)},
            "sampling": system.sampling.to_json(),
            "peaks": end.figures.to_json(system),
        }
        | method
        | ({"invalid": invalid} if invalid else {})
        | before.to_json()
        | system.corrections,
    }


Description = Callable[[RunContext, dict[str, Any]], dict[str, Any]]


def described(run: RunContext, about: dict[str, Any]) -> dict[str, Any]:
    """Return `documents` with those that the scene alone decides, and the ledger: all fields but the series.

    The scene decides the resolved case, modes, implausible values, bearings at rest, the error of neglected
    effects, and the orders above the band of the output, which a full receipt has.
    """
    receipt = about["receipt"]
    neglected = neglected_effects(run.system.ledger, run.influences)
    error = receipt["error"] | ({"left_out_effects": neglected} if neglected else {})
    orders_above = linear_orders(run.system) if run.scene.outputs.receipt == "full" else {}
    return about | {
        "receipt": receipt | {"error": error} | _bearings_at_rest(run.system) | orders_above,
        "effect_ledger": effect_ledger(run),
        "case": _resolved_case(run.system),
        "warnings": [finding.to_json() for finding in scene_findings(run.scene)],
        "modes": _modes_of_run(run.system),
    }


def undescribed(run: RunContext, about: dict[str, Any]) -> dict[str, Any]:
    """Return `documents`, and the ledger where an assumption is violated: a study takes responses alone."""
    holds = all(check.holds for check in run.checks)
    return about if holds else about | {"effect_ledger": effect_ledger(run)}


def _known_influences(decision: Decision, system: System) -> Mapping[str, Influence]:
    """Return the influences by which effects were decided; else estimates, if the receipt is a full one."""
    scene = decision.scene
    if decision.influences or scene.outputs.receipt != "full":
        return decision.influences
    return estimate_influences(scene, system=system)


def series_of(system: System, time: FloatArray, states: States) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return all series of `RunResult` for the `states` at `time` (T,), and those to check, unfiltered."""
    observed = observe(system.arrays, time, states.q, states.v, states.quanta, states.carried)
    motion = system, time, observe_laws(system.arrays, time), states, observed
    if system.sampling.stop_band == 0.0:
        points = histories(*motion, unfiltered(system, observed, states))
        return points, points
    return histories(*motion, filtered(system, states, observed)), checked_series(*motion)


def finer(integration: Integration) -> Integration:
    """Return the settings of the run that an error is measured against."""
    return replace(
        integration,
        tolerance=ERROR_CHECK_FACTOR * integration.tolerance,
        fixed_step=integration.fixed_step and ERROR_CHECK_FACTOR * integration.fixed_step,
    )


def with_longest_step(integration: Integration, longest: float) -> Integration:
    """Return `integration` with adaptive steps of at most `longest`, s.

    The smallest step shrinks by the same factor: the number of step sizes between them stays, and so the run
    shares compiled code.
    """
    factor = min(longest / integration.largest_step, 1.0)
    return replace(
        integration,
        largest_step=factor * integration.largest_step,
        smallest_step=factor * integration.smallest_step,
    )


def requested_error(integration: Integration) -> Json:
    """Return the step error of the transmission error, m rms, that the step control must keep."""
    return {"time_step": {"rms": integration.tolerance, "unit": "m", "source": "tolerance of step control"}}


def tolerance_check(error: Json, integration: Integration) -> Check | None:
    """Return whether the measured error of the steps is within the tolerance; None where neither is known."""
    steps = error.get("time_step", {})
    if "met" not in steps:
        return None
    estimate, tolerance = float(steps["rms"]), integration.tolerance
    reason = f"{engineering(1e9 * estimate, 2)} nm rms stated, {engineering(1e9 * tolerance, 2)} nm requested"
    if steps.get("chaotic"):
        level = engineering(steps["levels"]["rms"], 2)
        reason = f"chaotic motion: levels are within {level} dB, traces are not"
    elif not steps["met"]:
        reason = f"{reason}: lower the tolerance"
    return Check("", "errors of the steps are within the tolerance", "time steps", steps["met"], reason)


def with_tolerance(error: Json, integration: Integration) -> Json:
    """Return errors of a run with the tolerance of its steps, and whether their measured error is within."""
    steps = error.get("time_step", {})
    if integration.fixed_step is not None or "transmission_error_orders" not in steps:
        return error
    met = float(steps["rms"]) <= integration.tolerance and not steps.get("chaotic", False)
    return error | {"time_step": {**steps, "tolerance": integration.tolerance, "met": met}}


def _statistics(system: System, end: Ending) -> StepStatistics:
    count = [int(value) for value in end.count]
    implicit = system.scene.integration.method == "implicit"
    stages = IMPLICIT_STAGES_PER_STEP * max(count[Count.ACCEPTED] + count[Count.REJECTED], 1)
    return StepStatistics(
        accepted=count[Count.ACCEPTED],
        rejected=count[Count.REJECTED],
        newton_failures=count[Count.NEWTON_FAILED],
        newton_mean=count[Count.NEWTON_TOTAL] / stages if implicit else 0.0,
        newton_most=count[Count.MAX_NEWTON],
        smallest_step=float(end.step_range[0]),
        largest_step=float(end.step_range[1]),
    )
