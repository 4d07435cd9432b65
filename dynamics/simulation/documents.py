"""The documents of a result beside its series, from the system and the end of its run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.influence import Decided, Influence, estimate_influences
from dynamics.integrators.march import Ending
from dynamics.integrators.method_choice import MethodChoice
from dynamics.integrators.workspace import Count
from dynamics.motion.observation import observe
from dynamics.motion.sampled_states import States
from dynamics.plausibility import scene_findings
from dynamics.results import EnergyAudit, StepStatistics
from dynamics.results.case import resolved_case
from dynamics.results.effect_ledger import effect_ledger
from dynamics.results.energy_check import energy_check
from dynamics.results.histories import checked_series, filtered, histories, unfiltered
from dynamics.results.run_checks import RunChecks
from dynamics.scene import Integration
from dynamics.simulation.bearings_at_rest import bearings_at_rest
from dynamics.simulation.run_modes import modes_of_run
from dynamics.simulation.violations import FIRST, EarlierRun
from dynamics.types import FloatArray, Json
from host import cpu_seconds

ERROR_CHECK_FACTOR = 0.1
IMPLICIT_STAGES_PER_STEP = 5
LEAST_WORK = 500_000
"""Steps times freedoms of a run whose ledger has estimates that no tolerance requests."""


def documents(
    system: System,
    end: Ending,
    checks: RunChecks,
    seconds: dict[str, float],
    error: Json,
    decided: Decided,
    before: EarlierRun = FIRST,
    choice: MethodChoice | None = None,
) -> dict[str, Any]:
    """Return the fields of `RunResult` that are no series.

    `before` is the run that this one repeats, `choice` that of its method; None: it never started.
    """
    automatic = {**decided.automatic, **before.reasons}
    began = cpu_seconds()
    influences = {
        name: influence.to_json() for name, influence in known_influences(decided, system, end).items()
    }
    seconds = {**seconds, "worth_estimates": cpu_seconds() - began + decided.seconds}
    audit = None
    if system.scene.outputs.energy_audit:
        audit = EnergyAudit.from_arrays(end.work, end.stored, end.fallen)
    entries = [*checks.found(), *([] if audit is None else [energy_check(audit)])]
    return {
        "status": end.status,
        "statistics": _statistics(system, end),
        "energy": audit,
        "effect_ledger": effect_ledger(system, entries, automatic, influences),
        "receipt": {
            "seconds": seconds,
            "error": {**error, "sampling": end.figures.error(system)},
            "sampling": system.sampling.to_json(),
            "peaks": end.figures.to_json(system),
        }
        | _method(choice, end)
        | before.to_json()
        | bearings_at_rest(system)
        | system.corrections,
        "case": resolved_case(system),
        "warnings": [finding.to_json() for finding in scene_findings(decided.scene)],
        "modes": modes_of_run(system),
    }


def known_influences(decided: Decided, system: System, end: Ending) -> Mapping[str, Influence]:
    """Return the influence of effects: as decided by, else estimated where the run is long enough."""
    scene = decided.scene
    work = int(end.count[Count.ACCEPTED]) * len(system.freedoms.name)
    if decided.influences or scene.outputs.receipt != "full" or work < LEAST_WORK:
        return decided.influences
    return estimate_influences(scene, system=system)


def series_of(system: System, time: FloatArray, states: States) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return all series of `RunResult` for the `states` at `time` (T,), and those to check, unfiltered."""
    seen = observe(system.arrays, time, states.q, states.v, states.moved)
    if system.sampling.stop_band == 0.0:
        points = histories(system, time, states, seen, unfiltered(system, seen, states))
        return points, points
    series = histories(system, time, states, seen, filtered(system, states, seen))
    return series, checked_series(system, time, states, seen)


def _method(choice: MethodChoice | None, end: Ending) -> Json:
    """Return what a receipt says of the method."""
    steps = int(end.count[Count.ACCEPTED] + end.count[Count.REJECTED])
    if choice is None or steps == 0:
        return {}
    return {"method": choice.to_json(end.end / steps, end.seconds)}


def finer(integration: Integration) -> Integration:
    """Return the settings of the run that an error is measured against."""
    return replace(
        integration,
        tolerance=ERROR_CHECK_FACTOR * integration.tolerance,
        fixed_step=integration.fixed_step and ERROR_CHECK_FACTOR * integration.fixed_step,
    )


def requested_error(integration: Integration) -> Json:
    """Return the step error of the transmission error, m rms, that the step control must keep."""
    return {"time_step": {"rms": integration.tolerance, "unit": "m", "source": "tolerance of step control"}}


def measured_error(total: float, samples: int, meshes: int, seconds: float) -> Json:
    """Return the step error from the sum of squared differences from a finer run."""
    rms = float(np.sqrt(total / max(samples * meshes, 1)))
    source = f"difference from a run at {ERROR_CHECK_FACTOR:g} of the tolerance"
    return {"time_step": {"rms": rms, "unit": "m", "source": source, "seconds": seconds}}


def squared_difference(system: System, q: FloatArray, other: FloatArray) -> float:
    """Return the sum of the squared differences in the transmission errors of the states (T, n)."""
    difference = (q - other) @ system.arrays.direction[system.driving_rows].T
    return float(np.sum(difference**2))


def _statistics(system: System, end: Ending) -> StepStatistics:
    """Name the counts."""
    count = [int(value) for value in end.count]
    implicit = system.scene.integration.method == "implicit"
    stages = IMPLICIT_STAGES_PER_STEP * max(count[Count.ACCEPTED] + count[Count.REJECTED], 1)
    return StepStatistics(
        count[Count.ACCEPTED],
        count[Count.REJECTED],
        count[Count.NEWTON_FAILED],
        count[Count.NEWTON_TOTAL] / stages if implicit else 0.0,
        count[Count.NEWTON_MOST],
        float(end.step_range[0]),
        float(end.step_range[1]),
    )
