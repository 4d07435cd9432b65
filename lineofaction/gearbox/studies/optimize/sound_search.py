"""Search for the quietest flanks of a mesh in a scene.

A design is a set of values of the flank modifications. Few positions, or rough: the designs on which the
search explores are solved at fewer positions of the mesh than those that count. Shapes: L load cases, K lines
of the sound (all orders together, then each).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from dynamics.assembly.assemble import assemble
from dynamics.deflection.loaded_scene import with_loads
from dynamics.linearize.steady_vibration import excited
from fe_contact.analysis.live.condensed_pair import CondensedPair
from fe_contact.analysis.live.stored_bodies import condensed_pair
from fe_contact.analysis.run_plan import predicted_designs
from fe_contact.analysis.table_fields import table_of_solution
from fe_contact.effects import EFFECTS, named
from fe_contact.errors import InputError, SolveError
from fe_contact.geometry import ParallelAxes
from fe_contact.microgeometry.confirmed_figures import confirmed_figures
from fe_contact.microgeometry.design_study import DesignSpace, design_study
from fe_contact.microgeometry.drawing_grid import best_on_grid
from fe_contact.microgeometry.evaluator import Evaluator
from fe_contact.microgeometry.optimization import OptimizationRequest
from fe_contact.microgeometry.optimize import search_all
from fe_contact.microgeometry.scatter import MISALIGNMENT, ScatterNodes
from fe_contact.microgeometry.search import Search
from fe_contact.microgeometry.search_methods import EXPLORED, FINISHED, MISSES, StagedLinearProgramming, never
from fe_contact.microgeometry.variables import effect_of, modified
from fe_contact.ste import SteDatabase
from fe_contact.types import Estimate, FloatArray
from host import cpu_seconds
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.schemas.case import Case
from lineofaction.gearbox.schemas.meshes import MeshInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.change.sound_flanks import (
    UNITS,
    levels_cost,
    line_names,
    mesh_index,
    quantity_of,
    sound_loads,
)
from lineofaction.gearbox.studies.computation import Means
from lineofaction.gearbox.studies.cost import StudyCost, Work
from lineofaction.gearbox.studies.deflect import Inputs as DeflectInputs
from lineofaction.gearbox.studies.deflect.cases import load_cases
from lineofaction.gearbox.studies.deflect.run import RUN as DEFLECT
from lineofaction.gearbox.studies.optimize import HeardObjectiveInput
from lineofaction.gearbox.studies.optimize.result import HeardDesign, HeardOptimization
from lineofaction.gearbox.studies.optimize.sound_problem import (
    LOAD_FACTORS,
    HeardAt,
    HeardObjective,
    HeardProblem,
    with_neighbor_loads,
)
from lineofaction.gearbox.studies.scatter.run import tolerances_of
from lineofaction.gearbox.units import RPM, UM
from model_studies.progress import announce, by_cost, silent
from model_studies.stage_clock import StageClock

DEFLECTION = "deflection"
"""Stage of a deflection of the scene, of which the misalignment of the mesh follows."""

WALK, FINISH, LINEARIZED = 20, 8, 2.5
"""Figures of usual searches, by which the cost is predicted.

They are the steps of a walk at few positions, the steps of one that goes on in full, and the cost of a step
with its derivatives over that of a design without.
"""


@dataclass(frozen=True)
class SoundSearch:
    """Problem, bodies and load cases that a search and its confirmation work on."""

    problem: HeardProblem
    sample: HeardProblem | None
    """The same problem over pairs within tolerances; None: the standard has no tolerances for these gears."""
    bodies: CondensedPair
    torque: FloatArray
    misalignment: FloatArray
    """`torque`, `misalignment`: Torque of the load cases on the driving gear, N m, and misalignment of the
    mesh, m. Shape (L,) each.
    """


def sound_optimum(
    subject: TabledScene,
    mesh: MeshInput,
    question: HeardObjectiveInput,
    request: OptimizationRequest,
    means: Means,
) -> HeardOptimization:
    """Search from the flanks of a mesh, and return start and optimum with their errors.

    `request`: pair, variables, scatter, limits, search and options; its torques are replaced by those of the
    load cases. Raises `InputError`, `SolveError`: no such flanks, no equilibrium, or no contact of the start.
    """
    assert mesh.case is not None  # a scene with its tables has its cases written out
    clock = StageClock(means.workers.cost)
    run = means.analysis
    with clock.stage("deflection"):
        misalignment = misalignments(subject, mesh, question, means)
    with clock.stage("transfer functions"):
        setup = sound_problem(subject, mesh, question, request, misalignment, means)
    with clock.stage("search"):
        start = dict(zip(setup.problem.names, request.start_design, strict=True))
        sample = setup.sample
        searched = setup.problem if question.quantile is None else sample or setup.problem
        problem = _scaled_problem(searched, start)
        expected = _expected_seconds(problem, start, request.search)
        cancel = means.cancel or never
        announce(means.report, "search", expected)
        runs = search_all(problem, request.search, request.start_design, run, cancel)
        runs = tuple(best_on_grid(problem, part, request.grid, cancel) for part in runs)
    best = min(range(len(runs)), key=lambda i: runs[i].assessed.order)
    designs = start, problem.values(runs[best].coordinates)
    with clock.stage("confirmation"):
        (before, after), positions = _confirmed_designs(replace(setup, problem=problem), designs, run.cache)
    with clock.stage("pairs"):
        made = request.search.exploration if question.quantile is None else positions
        rough = None if sample is None or cancel() else sample.at(made)
        pairs = [np.zeros(0) if rough is None else rough.levels(values, means.workers) for values in designs]
    run.progress("confirmation", 1.0)
    spent = {"evaluations": sum(part.evaluations for part in runs), "search_expected_cpu_seconds": expected}
    quantity = quantity_of(subject, question)
    return HeardOptimization(
        mesh=mesh.name,
        quantity=quantity if question.bearing is None else f"{quantity} of {question.bearing}",
        unit=UNITS[quantity],
        over_speeds=question.over_speeds,
        over_loads=question.over_loads,
        lines=line_names(question.orders),
        variables=request.variables,
        load_case=tuple(case.name for case in question.load_cases),
        torque=setup.torque,
        misalignment=setup.misalignment,
        speed=np.array(question.speed_rpm) * RPM,
        start=before,
        optimum=after,
        runs=runs,
        best_run=best,
        tolerance_class=question.tolerances.tolerance_class,
        pairs=np.stack(pairs),
        case=mesh.case.model_dump(mode="json", exclude_unset=True),
        cost=clock.to_json() | spent,
    )


def _scaled_problem(problem: HeardProblem, start: dict[str, float]) -> HeardProblem:
    """Return a problem whose objective is relative to the level of the start, dB.

    Raises `SolveError`: the contact of the start has no solution.
    """
    scaled = replace(problem, scale=problem.evaluated(start)[0])
    if not math.isfinite(scaled.scale):
        raise SolveError("the contact of the start design cannot be solved at every position and load")
    return scaled


def _expected_seconds(problem: HeardProblem, values: dict[str, float], search: Search) -> float:
    """Return the CPU seconds of a usual search, by timing a design at few positions and one in full."""
    rough = problem.rough(search.exploration)
    seconds = []
    for timed in (rough, rough, problem):  # the first call also loads compiled code, and is not counted
        began = cpu_seconds()
        timed.evaluated(values)
        seconds.append(cpu_seconds() - began)
    coarse_designs, full_designs = usual_sound_designs(search)
    return coarse_designs * seconds[1] + full_designs * seconds[2]


def usual_sound_designs(search: Search) -> tuple[float, float]:
    """Return the numbers of designs of a usual search, at few positions and in full."""
    method = search.method
    coarse, full = 0.0, float(search.evaluations)
    if isinstance(method, StagedLinearProgramming):
        coarse = min(method.sample + LINEARIZED * WALK * (method.trials + 1 + MISSES), EXPLORED * full)
        full = min(LINEARIZED * FINISH * FINISHED, full)
    return search.starts * coarse, search.starts * full


def sound_cost(
    scene: SceneInput,
    mesh: MeshInput,
    question: HeardObjectiveInput,
    request: OptimizationRequest,
    cache: Path | None,
) -> StudyCost | None:
    """Return the cost of a usual search; None: it cannot be predicted.

    The modes and the radiation of a solid housing are not known beforehand and not included. Raises
    `BadInput`.
    """
    levels = levels_cost(scene, mesh.name, question)
    if levels is None:
        return None
    predicted = predicted_designs(request.checked, cache)
    search, pairs = request.search, question.tolerances
    share = len(question.load_cases) * LOAD_FACTORS.size / request.checked.request.load.size
    fewer_positions = min(search.exploration / search.positions, 1.0)
    rough = share * predicted.design * fewer_positions + levels.per_table
    full = share * predicted.design + levels.per_table
    confirmed = share * predicted.design * predicted.positions / search.positions + levels.per_table
    nodes = request.scatter.nodes().weight.size if question.quantile is None else pairs.samples
    of_pair = rough if question.quantile is None else confirmed
    coarse_designs, full_designs = usual_sound_designs(search)
    parts = [
        Work("gears", predicted.all_bodies, stage="compliance"),
        Work("transfer functions", levels.transfer, stage="transfer functions"),
        Work("designs", rough, coarse_designs, "search"),
        Work("designs", full, full_designs * nodes, "search"),
        Work("analyses", share * (predicted.design + predicted.errors), 2, "confirmation"),
        Work("scatter", confirmed, 0 if nodes == 1 else 2 * nodes, "confirmation"),
        Work("pairs", of_pair, 2 * pairs.samples, "confirmation"),
    ]
    cost = StudyCost(tuple(parts), predicted.bytes)
    scene_misalignment = levels.scene.meshes[mesh_index(levels.scene, mesh.name)].misalignment
    # the deflection under load then states the misalignment, see `misalignments`
    if question.misalignment_um is None and predicted.across_face and not scene_misalignment:
        deflected = DEFLECT.predicted(scene, DeflectInputs(load_cases=question.load_cases), cache)
        parts = [part._replace(stage=DEFLECTION) for part in deflected.parts]
        cost += StudyCost(tuple(parts), deflected.bytes)
    return cost


def misalignments(
    subject: TabledScene, mesh: MeshInput, question: HeardObjectiveInput, means: Means
) -> FloatArray:
    """Return the misalignment of the mesh under each load case (L,), m.

    The first of these that is stated counts: the question's, the scene's (0 for a plane model), and else the
    misalignment by the deflection of shafts, bearings and housing.
    """
    shape = (len(question.load_cases),)
    plan = subject.databases[mesh.name].metadata.receipt["plan"]
    plane = plan["model"] in ("plane_strain", "plane_stress")
    nominal = subject.scene.meshes[mesh_index(subject.scene, mesh.name)].misalignment
    if question.misalignment_um is not None:
        return np.broadcast_to(np.asarray(question.misalignment_um, dtype=float) * UM, shape).copy()
    if plane or nominal:
        return np.full(shape, nominal)
    inputs = DeflectInputs(load_cases=question.load_cases)
    plan = DEFLECT.predicted(subject.inputs, inputs, means.analysis.cache)
    costs = {part.stage: 0.0 for part in plan.parts}
    for part in plan.parts:
        costs[part.stage] += part.seconds
    in_one_stage = by_cost(partial(means.report, DEFLECTION), costs)
    deflected = DEFLECT.compute(subject, inputs, replace(means, report=in_one_stage))
    if failure := DEFLECT.failure(deflected):
        raise SolveError(failure)
    meshes = [part for case in deflected.deflection.cases for part in case.meshes if part.name == mesh.name]
    return np.array([part.misalignment for part in meshes])


def sound_problem(
    subject: TabledScene,
    mesh: MeshInput,
    question: HeardObjectiveInput,
    request: OptimizationRequest,
    misalignment: FloatArray,
    means: Means,
) -> SoundSearch:
    """Return the problem of a search at misalignments (L,) in m, its scale 0 dB."""
    assert mesh.case is not None
    cache, known = means.home / "compliance", subject.databases[mesh.name]
    bodies = condensed_pair(request.pair, known, dict(mesh.case.effects), cache, compute=True)
    assert bodies is not None
    torque = _torques(subject, mesh.name, question)
    tables = [
        bodies.table(request.pair, load * LOAD_FACTORS, skew)
        for load, skew in zip(torque, misalignment, strict=True)
    ]
    loads = sound_loads(subject, mesh.name, question, tables, means)
    evaluator = _evaluator(request, torque, misalignment, means)
    shares = np.array([load_case.load.share for load_case in loads])
    counted = list(question.counted_orders)  # the first line is all orders, then each
    at = tuple(
        HeardAt(case, case.lines[counted].sum(axis=0) if counted else case.lines[0], float(share))
        for case, share in zip(loads, shares / shares.sum(), strict=True)
    )
    objective = HeardObjective(at, question.over_speeds == "worst", question.over_loads == "worst")
    problem = HeardProblem(evaluator, request.variables, request.limits, 0.0, sound=objective)
    return SoundSearch(problem, _sampled_problem(problem, mesh.case, question), bodies, torque, misalignment)


def _sampled_problem(problem: HeardProblem, case: Case, question: HeardObjectiveInput) -> HeardProblem | None:
    """Return the problem with a sample of pairs within tolerances as nodes, to count by a quantile of them.

    None: the standard has no tolerances for these gears. Deviations whose effect is off in the case are 0.
    """
    evaluator, tolerance_input = problem.evaluator, question.tolerances
    try:
        across = evaluator.contact.face is not None
        tolerances = tolerances_of(evaluator.contact.pair, tolerance_input, across_face=across)
    except InputError as error:
        if {"tolerances", "quantile"} & question.model_fields_set:
            raise error.within("heard.tolerances") from None
        return None
    drawn = tolerances.sample(tolerance_input.samples, tolerance_input.seed)
    # the effect of each deviation; the misalignment, no flank variable, is one by its name
    skew = {MISALIGNMENT: named(EFFECTS, MISALIGNMENT)}
    effect = {name: skew.get(name) or effect_of(name, EFFECTS) for name in tolerances.widths}
    acting = [k for k, name in enumerate(effect) if case.effects.get(effect[name]) != "off"]
    names = [list(effect)[k] for k in acting]
    nodes = ScatterNodes(tuple(names), drawn[:, acting], np.full(len(drawn), 1.0 / len(drawn)))
    choices = {**evaluator.choices, **dict.fromkeys((effect[name] for name in names), "on")}
    pairs = replace(evaluator, choices=choices, nodes=nodes)
    return replace(problem, evaluator=pairs, quantile=question.quantile)


def _torques(subject: TabledScene, mesh: str, question: HeardObjectiveInput) -> FloatArray:
    """Return the torque on the driving gear of the mesh under each load case (L,), N m."""
    index = mesh_index(subject.scene, mesh)
    radius = subject.databases[mesh].geometry.base_radius[0]
    systems = [assemble(with_loads(subject.scene, load)) for load in load_cases(question.load_cases)]
    forces = [float(excited(system).linear.equilibrium.mesh_force[index]) for system in systems]
    return np.array(forces) * radius


def _evaluator(
    request: OptimizationRequest, torque: FloatArray, misalignment: FloatArray, means: Means
) -> Evaluator:
    """Return the evaluator of all designs, with three loads for each load case."""
    points = sorted({*zip(torque.tolist(), misalignment.tolist(), strict=True)})
    acting = {variable.name: variable.acting for variable in request.variables}
    minimum = {variable.name: variable.low for variable in request.variables}
    skews = [skew for _, skew in points]
    space = DesignSpace(
        request.pair, acting, request.scatter, skews, request.search.positions, request.options, minimum
    )
    run = replace(means.analysis, progress=silent)
    torques = [load for load, _ in points]
    study = design_study(space, torques, (), StageClock(), run, limits=request.limits)
    force = torque / float(request.pair.torque(1.0))
    load, alignment = with_neighbor_loads(force, misalignment)
    return replace(study.evaluator, load=load, misalignment=alignment)


def _confirmed_designs(
    setup: SoundSearch, designs: Iterable[dict[str, float]], cache: Path | None
) -> tuple[list[HeardDesign], int]:
    """Return designs with errors, and the number of positions at which their scatter was solved."""
    tables = [(values, _tables(setup, values)) for values in designs]
    positions = max(setup.problem.evaluator.position.size, tables[0][1][0].position.size)
    return [_confirmed_design(setup, *design, positions, cache) for design in tables], positions


def _tables(setup: SoundSearch, values: dict[str, float]) -> list[SteDatabase]:
    """Return the table of a design under each load case."""
    pair = modified(setup.bodies.checked.request.pair, values)
    return [setup.bodies.table(pair, *point) for point in _points(setup)]


def _points(setup: SoundSearch) -> list[tuple[FloatArray, float]]:
    """Return the torques (N m, rising) and the misalignment (m) of each load case."""
    return list(zip(np.outer(setup.torque, LOAD_FACTORS), setup.misalignment.tolist(), strict=True))


def _confirmed_design(
    setup: SoundSearch,
    values: dict[str, float],
    tables: list[SteDatabase],
    positions: int,
    cache: Path | None,
) -> HeardDesign:
    """Return a design with errors: changes by rougher contacts, which have fewer slices or coarser meshes.

    Its level is that of its tables. With scatter it is solved at a number of `positions`, and its error has
    what the nominal flanks are off their tables there.
    """
    problem = setup.problem
    pair = modified(setup.bodies.checked.request.pair, values)
    rougher = zip(*(_rougher(setup.bodies, pair, *point) for point in _points(setup)), strict=True)
    contacts = [_levels(problem, contact) for contact in (tables, *rougher)]
    levels = np.stack([contact.level for contact in contacts])
    objectives = np.array([contact.objective for contact in contacts])
    violation = problem.evaluated(values)[1]
    objective, changes = float(objectives[0]), objectives[1:] - objectives[0]
    if not problem.is_nominal:
        fine = problem.at(positions)
        objective = fine.evaluated(values)[0]
        changes = np.append(changes, fine.nominal.evaluated(values)[0] - objectives[0])
    figures = confirmed_figures(problem.evaluator, values, cache)
    nominal_loads = slice(1, None, LOAD_FACTORS.size)  # the load case itself, the second of its loads
    ripple = [table.peak_to_peak(force=float(table.force[1])) for table in tables]
    return HeardDesign(
        values=dict(values),
        objective=Estimate(objective, float(np.linalg.norm(changes)), "dB"),
        level=levels[0],
        level_error=np.linalg.norm(levels[1:] - levels[0], axis=0),
        peak_to_peak=np.array([estimate.value for estimate in ripple]),
        peak_to_peak_error=np.array([estimate.error for estimate in ripple]),
        pressure=figures.pressure.max(axis=0)[nominal_loads],
        face_load_factor=figures.face_load_factor.max(axis=0)[nominal_loads],
        edge_load_share=figures.edge_load_share.max(axis=0)[nominal_loads],
        parting=contacts[0].parting,
        violation=violation,
        root_stress=figures.root_stress.max(axis=0)[nominal_loads],
        root_stress_error=figures.root_stress_error.max(axis=0)[nominal_loads],
        pressure_error=figures.pressure_error.max(axis=0)[nominal_loads],
        face_load_factor_error=figures.face_load_factor_error.max(axis=0)[nominal_loads],
    )


class _Levels(NamedTuple):
    """Levels (L, K) of tables, dB, the objective without scatter, dB, and where flanks part (L,)."""

    level: FloatArray
    objective: float
    parting: FloatArray


def _levels(problem: HeardProblem, tables: Sequence[SteDatabase]) -> _Levels:
    """Return the levels of tables, one for each load case."""
    sound = problem.sound
    level, power, parting = [], [], []
    for at, table in zip(sound.at, tables, strict=True):
        flanks = at.case.with_table(table).excitation
        weighted = at.case.power(flanks)
        level.append(at.case.levels(weighted, sound.worst_speed))
        power.append(weighted @ at.counted)
        parting.append(at.case.parting(flanks))
    return _Levels(np.stack(level), sound.level(np.stack(power)), np.array(parting))


def _rougher(
    bodies: CondensedPair, pair: ParallelAxes, torques: FloatArray, misalignment: float
) -> list[SteDatabase]:
    """Return the tables of a pair under a load case on each rougher contact; `torques` in N m, rising."""
    tables = []
    for solved in bodies.solve_rougher(pair, torques, misalignment):
        problem = solved.problem
        positions = np.unique(np.mod(problem.candidates.position, 1.0))
        tables.append(table_of_solution(solved.pair, problem, solved.solution, positions, misalignment))
    return tables
