"""Study of a change of flanks in a scene, over one sample of tolerances."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from bounds.types import Json
from fe_contact.analysis.live.stored_bodies import condensed_pair
from fe_contact.analysis.run_plan import predicted_designs
from fe_contact.errors import SolveError
from fe_contact.geometry import ParallelAxes
from fe_contact.microgeometry.tolerance_study import ToleranceRequest
from fe_contact.types import FloatArray
from host import cpu_seconds
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.boundary_names import boundary_name
from lineofaction.gearbox.convert.case import PLANE
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.case import Case
from lineofaction.gearbox.schemas.meshes import MeshInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.change import ChangeFigures, Inputs
from lineofaction.gearbox.studies.change.question import check_driving, check_receiver, flank_mesh
from lineofaction.gearbox.studies.change.result import DesignLevels, FlankChange
from lineofaction.gearbox.studies.change.sound_flanks import (
    UNITS,
    FlankLevels,
    HeardFlanks,
    levels_cost,
    line_names,
    quantity_of,
    sound_loads,
)
from lineofaction.gearbox.studies.computation import Means, SceneStudy, record_file
from lineofaction.gearbox.studies.cost import StudyCost, Work
from lineofaction.gearbox.studies.scatter.run import tolerance_request
from lineofaction.gearbox.studies.scene_before_tables import CASES
from lineofaction.gearbox.studies.study.scenes import FLANKS
from lineofaction.gearbox.units import RPM
from model_studies.progress import announce
from model_studies.stage_clock import StageClock

IN_A_TASK = 5
"""Number of pairs in a task, which takes some seconds. The number is the same for any executor."""
MAX_PAIRS = 10_000
"""Most pairs of a job: each takes two contact solutions."""
_TABLE = 0.08
"""CPU seconds of errors and forces of the table of a pair, measured 0.11 at 12 loads and 192 positions."""
GEARS = ("pinion", "wheel")


class _ChangeStudy(SceneStudy[Inputs, ChangeFigures, FlankChange]):
    inputs, answer, file = Inputs, ChangeFigures, record_file(("change", FlankChange))

    def check(self, scene: SceneInput, inputs: Inputs) -> None:
        """Refuse another pair than the scene's, impossible tolerances, and a quantity that it lacks."""
        if inputs.tolerances.samples > MAX_PAIRS:
            raise BadInput.of("tolerances.samples", inputs.tolerances.samples, f"at most {MAX_PAIRS}")
        check_receiver(scene, inputs.heard)
        check_driving(scene, inputs.load_cases)
        mesh = flank_mesh(scene, inputs.mesh)
        if mesh.case is not None:
            _designs(mesh.case, inputs)

    def predicted(self, scene: SceneInput, inputs: Inputs, cache: Path | None) -> StudyCost | None:
        """Return the cost of transfer functions and pairs; gears are condensed with the scene's table."""
        mesh = flank_mesh(scene, inputs.mesh)
        if mesh.case is None:
            return None
        with boundary_errors():
            levels = levels_cost(scene, mesh.name, inputs)
            design = predicted_designs(CASES.of(mesh.case).checked, cache).design
        if levels is None:
            return None
        pairs = Work("pairs", design + _TABLE + levels.per_table, 2 * (inputs.tolerances.samples + 1))
        return StudyCost((Work("transfer functions", levels.transfer), pairs))

    def compute(self, subject: TabledScene, inputs: Inputs, means: Means) -> FlankChange:
        clock = StageClock(means.workers.cost)
        mesh = flank_mesh(subject.inputs, inputs.mesh)
        assert mesh.case is not None  # a scene with its tables has its cases written out
        before, after = _designs(mesh.case, inputs)
        tolerances, sampling = before.tolerances, before.sampling
        names, deviation = tuple(tolerances.widths), tolerances.sample(sampling.samples, sampling.seed)
        with boundary_errors():
            with clock.stage("transfer functions"):
                model, nominal, cost = _level_model(subject, mesh, (before.pair, after.pair), inputs, means)
            expected = 2.0 * cost * len(deviation)
            announce(means.report, "pairs", expected, f"{len(deviation)} before and after")
            with clock.stage("pairs"):
                levels = _levels(model, (before.pair, after.pair), names, deviation, means)
        first, second = (
            DesignLevels(design.level, pairs, design.parting, error)
            for (design, error), pairs in zip(nominal, levels, strict=True)
        )
        quantity = quantity_of(subject, inputs.heard)
        return FlankChange(
            mesh=mesh.name,
            quantity=quantity if inputs.heard.bearing is None else f"{quantity} of {inputs.heard.bearing}",
            unit=UNITS[quantity],
            over_speeds=inputs.heard.over_speeds,
            lines=line_names(inputs.orders),
            torque=model.torque,
            speed=np.array(inputs.speed_rpm) * RPM,
            names=names,
            deviation=deviation,
            before=first,
            after=second,
            requirement=inputs.requirement_db,
            cost=clock.to_json() | {"pairs_expected_cpu_seconds": expected},
        )

    def _derived(self, result: FlankChange) -> Json:
        return {
            "verdict": " ".join(filter(None, (result.verdict(), result.required()))),
            "met": result.met,
            "requirement_db": result.requirement,
            "pairs": len(result.deviation),
            "load_cases": [_load_case(result, load) for load in range(result.torque.size)],
            "louder": list(result.louder()),
            "parting": list(result.partings()),
        }


def _load_case(result: FlankChange, load: int) -> Json:
    sides = {
        "before": (result.before.nominal, result.before.quantiles()),
        "after": (result.after.nominal, result.after.quantiles()),
        "change": (result.nominal_change, result.change_quantiles),
    }
    lines = [
        {"order": name, "louder_share": float(result.louder_share[load, line])}
        | {
            side: _quantiles(nominal[load, line], band[:, load, line])
            for side, (nominal, band) in sides.items()
        }
        for line, name in enumerate(result.lines)
    ]
    names = [boundary_name(name) for name in result.names]
    of_change, of_level = (dict(zip(names, rank[:, load].tolist(), strict=True)) for rank in result.influence)
    return {
        "torque_n_m": float(result.torque[load]),
        "lines": lines,
        "influence_on_change": of_change,
        "influence_after": of_level,
    }


def _quantiles(nominal: float, band: FloatArray) -> Json:
    low, median, high = band.tolist()
    return {"nominal_db": float(nominal), "low_db": low, "median_db": median, "high_db": high}


def _designs(case: Case, inputs: Inputs) -> tuple[ToleranceRequest, ToleranceRequest]:
    """Return both designs with their tolerances: flanks on the bodies, loads and accuracy of a case.

    Raises `BadInput`.
    """
    if len(case.errors.misalignment_um) > 1 or len(case.errors.center_distance_change_mm) > 1:
        bound = "one misalignment and one center distance in the case of the mesh"
        raise BadInput.of("scene.meshes", "a range", bound, "The tolerances vary the misalignment.")
    skew = inputs.tolerances.misalignment_um
    if skew and case.accuracy.model in PLANE:
        remedy = "A plane model has no width: take the 3-D model."
        raise BadInput.of("tolerances.misalignment_um", skew, "0 in a plane model", remedy)
    before = _design(case, "before", inputs.before or case, inputs)
    return before, _design(case, "after", inputs.after, inputs)


def _design(case: Case, name: str, design: Case, inputs: Inputs) -> ToleranceRequest:
    for path, value, known in _bodies(design, case):
        if value != known:
            bound = f"{known}, as in the case of the mesh: only flanks may differ"
            raise BadInput.of(f"{name}.pair.{path}", value, bound)
    checked = CheckedCase(case.model_copy(update={"pair": design.pair}))
    try:
        request = checked.request(tolerance_request, inputs.tolerances)
        with boundary_errors():
            _ = request.checked
    except BadInput as error:
        raise error.within("tolerances") from None
    return request


def _bodies(first: Case, second: Case) -> list[tuple[str, Any, Any]]:
    """Return the figures of two pairs that are none of their flanks, by their paths."""
    a, b = (_leaves(case.pair.model_dump(mode="json"), "") for case in (first, second))
    return [(path, a.get(path), b.get(path)) for path in {**a, **b}]


def _leaves(table: Mapping[str, Any], path: str) -> dict[str, Any]:
    leaves: dict[str, Any] = {}
    for name, value in table.items():
        if path and name in (*FLANKS, "flank_grid"):
            continue
        leaf = f"{path}.{name}" if path else name
        leaves |= _leaves(value, leaf) if name in GEARS else {leaf: value}
    return leaves


def _level_model(
    subject: TabledScene,
    mesh: MeshInput,
    pairs: tuple[ParallelAxes, ParallelAxes],
    inputs: Inputs,
    means: Means,
) -> tuple[HeardFlanks, list[tuple[FlankLevels, FloatArray]], float]:
    """Return the scene prepared for other flanks, both designs with their errors, and CPU seconds of one."""
    assert mesh.case is not None
    database, cache = subject.databases[mesh.name], means.home / "compliance"
    bodies = condensed_pair(
        CheckedCase(mesh.case).pair, database, dict(mesh.case.effects), cache, compute=True
    )
    assert bodies is not None
    level_model = HeardFlanks(database, bodies, inputs.heard.over_speeds == "worst")
    first = level_model.table(pairs[0])
    cases = sound_loads(subject, mesh.name, inputs, [first] * len(inputs.load_cases), means)
    level_model = replace(level_model, load_cases=cases)
    before, began = level_model.levels(first), cpu_seconds()
    second = level_model.table(pairs[1])
    after = level_model.levels(second)  # as every pair; all is compiled by now
    seconds = cpu_seconds() - began
    return level_model, [(before, level_model.errors(first)), (after, level_model.errors(second))], seconds


def _levels(
    level_model: HeardFlanks,
    pairs: tuple[ParallelAxes, ParallelAxes],
    names: tuple[str, ...],
    deviation: FloatArray,
    means: Means,
) -> tuple[FloatArray, FloatArray]:
    """Return the levels (N, L, K) of both designs with the same deviations (N, d), m."""
    tasks = [deviation[k : k + IN_A_TASK] for k in range(0, len(deviation), IN_A_TASK)]
    parts = []
    for done, part in enumerate(means.workers.run(_levels_of_pairs, (level_model, pairs, names), tasks)):
        parts.append(part)
        means.report("pairs", (done + 1) / len(tasks))
    before, after = np.concatenate(parts, axis=1)
    for design_levels in (before, after):
        bad = int((~np.isfinite(design_levels)).any(axis=(1, 2)).sum())
        if bad:
            raise SolveError(f"{bad} of {len(design_levels)} pairs have no level", design_levels)
    return before, after


def _levels_of_pairs(
    shared: tuple[HeardFlanks, tuple[ParallelAxes, ParallelAxes], tuple[str, ...]], deviation: FloatArray
) -> FloatArray:
    """Return the levels (2, n, L, K) of some pairs (n, d): one task."""
    level_model, pairs, names = shared
    return np.stack(
        [np.stack([level_model.of_pair(pair, names, row).level for row in deviation]) for pair in pairs]
    )


RUN = _ChangeStudy()
