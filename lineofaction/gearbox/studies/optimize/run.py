"""Micro-geometry optimization of a case."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from bounds import engineering
from bounds.types import Json
from fe_contact.microgeometry.confirmation import HarrisMap
from fe_contact.microgeometry.objective import HarmonicAmplitude, Limits, Objective, WeightedMean, Worst
from fe_contact.microgeometry.optimization import Optimization, OptimizationRequest
from fe_contact.microgeometry.optimize import optimize
from fe_contact.microgeometry.scatter import GaussHermite, Scatter, SobolSample
from fe_contact.microgeometry.search import Search
from fe_contact.microgeometry.search_methods import (
    DifferentialEvolution,
    Method,
    NelderMead,
    SequentialLinearProgramming,
    StagedLinearProgramming,
    never,
)
from fe_contact.microgeometry.variables import DesignVariable
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.boundary_names import boundary_name
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.gear import with_figures
from lineofaction.gearbox.schemas.meshes import MeshInput
from lineofaction.gearbox.schemas.reading import validated
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.schemas.toml import toml_text
from lineofaction.gearbox.studies.change.question import check_driving, check_receiver, flank_mesh
from lineofaction.gearbox.studies.computation import Computation, Means, record_file
from lineofaction.gearbox.studies.cost import StudyCost
from lineofaction.gearbox.studies.optimize import (
    SOUND_TRIALS,
    TRIALS,
    GearScatterInput,
    GearVariablesInput,
    HeardObjectiveInput,
    Inputs,
    OptimizeFigures,
    ScatterInput,
    SearchInput,
)
from lineofaction.gearbox.studies.optimize.case_cost import search_cost
from lineofaction.gearbox.studies.optimize.complained import has_cases, of_case, of_scene
from lineofaction.gearbox.studies.optimize.drawing import as_typed, drawing_grid
from lineofaction.gearbox.studies.optimize.result import HeardOptimization
from lineofaction.gearbox.studies.optimize.sound_search import sound_cost, sound_optimum
from lineofaction.gearbox.units import UM, factor, in_um

MPA = 1e6
OF_CASE = ("torque_n_m", "misalignment_um", "objective")
"""Fields of a case that a scene has in its load cases and its objective."""


def _write_case(
    result: Optimization | HeardOptimization, checked: CheckedCase | SceneInput, target: Path
) -> None:
    """Write the case with the best design as a case file: the stated case, and the best flanks."""
    content: Json
    if isinstance(checked, CheckedCase):
        checked_case = checked
        content = checked.case.model_dump(mode="json", exclude_unset=True)
    else:
        content = copy.deepcopy(getattr(result, "case", {}))
        checked_case = CheckedCase(validated(Case, content))
    for gear, fields in as_typed(checked_case.case, checked_case.pair, result.optimum.values).items():
        content["pair"][gear] = with_figures(content["pair"][gear], fields)
    target.write_text(f"# {result.reason}\n\n{toml_text(content)}", encoding="utf-8")


class _OptimizeStudy(
    Computation[
        CheckedCase | SceneInput,
        CheckedCase | TabledScene,
        Inputs,
        OptimizeFigures,
        Optimization | HeardOptimization,
    ]
):
    inputs, answer = Inputs, OptimizeFigures
    file = record_file(("optimization", Optimization), ("heard optimization", HeardOptimization))
    interruptible = True
    writers = MappingProxyType({".toml": _write_case})

    def check(self, subject: CheckedCase | SceneInput, study: Inputs) -> None:
        """Refuse variables that the subject lacks, and an impossible search."""
        if isinstance(subject, CheckedCase):
            if study.heard is not None:
                raise BadInput.of("heard", "given", "left out with a case", "A scene is heard: name one.")
            with boundary_errors():
                _ = subject.request(_library_request, study).checked
            return
        if study.heard is None and subject.complaint is not None and not has_cases(subject):
            return  # the complaint names the mesh once the cases are read
        question, mesh = _question_of(subject, study)
        check_receiver(subject, question)
        if mesh.case is not None:
            with boundary_errors():
                _ = request_of(mesh.case, study).checked

    def predicted(
        self, subject: CheckedCase | SceneInput, study: Inputs, cache: Path | None
    ) -> StudyCost | None:
        """Return the cost of the gears, the designs of a usual search, and both analyses at the end."""
        if isinstance(subject, SceneInput):
            question, mesh = _question_of(subject, study)
            check_receiver(subject, question)
            with boundary_errors():
                return sound_cost(subject, mesh, question, _mesh_request(subject, mesh, study), cache)
        with boundary_errors():
            return search_cost(subject.request(_library_request, study), cache)

    def normalized(self, subject: CheckedCase | SceneInput, study: Inputs) -> Json:
        """Return all inputs, with the usual variables if none are named."""
        case: Case | None
        if isinstance(subject, CheckedCase):
            case = subject.case
            study = of_case(case, study)
        else:
            study = of_scene(subject, study)
            case = _question_of(subject, study)[1].case
        return super().normalized(subject, study if case is None else _with_variables(case, study))

    def compute(
        self, subject: CheckedCase | TabledScene, study: Inputs, means: Means
    ) -> Optimization | HeardOptimization:
        """Optimize the modifications of a case or of a mesh; a cancelled search ends with its best design.

        Designs of a case are stored: another attempt, or another deadline, goes on from them.
        """
        with boundary_errors():
            if isinstance(subject, TabledScene):
                question, mesh = _question_of(subject.inputs, study)
                request = _mesh_request(subject.inputs, mesh, study)
                return sound_optimum(subject, mesh, question, request, means)
            return optimize(
                subject.request(_library_request, study),
                means.analysis,
                cancel=means.cancel or never,
                memory=means.home / "searches",
            )

    def _derived(self, result: Optimization | HeardOptimization) -> Json:
        return _sound_figures(result) if isinstance(result, HeardOptimization) else self._of_case(result)

    def _of_case(self, result: Optimization) -> Json:
        limits = dict(result.request["limits"])
        units = {
            "max_pressure_mpa": ("max_pressure_pa", MPA),
            "peak_to_peak_um": ("peak_to_peak_m", UM),
            "root_stress_mpa": ("root_stress_pa", MPA),
        }
        for name, (known, unit) in units.items():
            value = limits.pop(known, None)  # files of version 0.2 lack some
            limits[name] = None if value is None else value / unit
        nodes = result.nodes
        deviation = []
        for row in nodes.deviation:
            by_name = zip(nodes.names, row, strict=True)
            deviation.append([_typed(name, float(x)) for name, x in by_name])
        requested = {"scatter": _scattering(result), "limits": limits}
        return {
            "variables": list(map(_variable, result.variables)),
            "nodes": (nodes, {"names": list(map(boundary_name, nodes.names)), "deviation": deviation}),
            "start": (result.start, {"values": _at_boundary(result.start.values)}),
            "optimum": (result.optimum, {"values": _at_boundary(result.optimum.values)}),
            "sensitivity": [
                {
                    "name": boundary_name(step.name),
                    "values": _range(step.name, step.low, step.high),
                    "change": (step.change_low, step.change_high),
                }
                for step in result.sensitivity
            ],
            "asked": in_um(result.request) | requested,
        }

    def warnings(self, result: Optimization | HeardOptimization) -> list[Json]:
        """Return the torques at which the best design ripples more than the start."""
        if isinstance(result, HeardOptimization):
            return []
        before, after = result.start.harris_map, result.optimum.harris_map
        return [_worse_load_warning(before, after, int(index)) for index in result.rising]


def _question_of(scene: SceneInput, study: Inputs) -> tuple[HeardObjectiveInput, MeshInput]:
    """Return the objective on the sound of a scene, by default its complaint, and the mesh.

    Raises `BadInput`.
    """
    study = of_scene(scene, study)
    if study.heard is None:
        remedy = "For example heard = { speed_rpm = [1000, 2000, 3000] }."
        raise BadInput.of("heard", None, "given with a scene", remedy)
    for name in OF_CASE:
        if getattr(study, name) != type(study).model_fields[name].default:
            raise BadInput.of(name, "given", "left out with a scene", "Its loads are heard.load_cases.")
    try:
        check_driving(scene, study.heard.load_cases)
        return study.heard, flank_mesh(scene, study.heard.mesh)
    except BadInput as error:
        raise error.within("heard") from None


def request_of(case: Case, study: Inputs) -> OptimizationRequest:
    """Return the request of the flanks of a mesh; raises `BadInput`."""
    request: OptimizationRequest = CheckedCase(case).request(_library_request, study)
    return request


def _mesh_request(scene: SceneInput, mesh: MeshInput, study: Inputs) -> OptimizationRequest:
    """Return the request of the flanks of a mesh whose case is written out.

    Flanks that answer a complaint end on the grid of the drawing.
    """
    assert mesh.case is not None
    request = request_of(mesh.case, study)
    if scene.complaint is None:
        return request
    return replace(request, grid=drawing_grid(mesh.case, request.pair, request.variables))


def _sound_figures(result: HeardOptimization) -> Json:
    start, optimum = result.start, result.optimum
    error = start.level_error + optimum.level_error
    levels = []
    for load in range(result.torque.size):
        lines = []
        for line, name in enumerate(result.lines):
            level = {"before_db": start.level[load, line], "after_db": optimum.level[load, line]}
            lines.append({"order": name, **level, "error_db": error[load, line]})
        levels.append(lines)
    notes: Json = {"worse": list(result.worse()), "parting": list(result.partings()), "ended": result.ended()}
    notes["start"] = start, {"values": _at_boundary(start.values)}
    notes["optimum"] = optimum, {"values": _at_boundary(optimum.values)}
    notes["levels"] = levels
    notes["pairs"] = None
    if result.pairs.size:
        names = "before_db", "after_db", "change_db"
        notes["pairs"] = {
            "tolerance_class": result.tolerance_class,
            "pairs": result.pairs.shape[1],
            **dict(zip(names, map(tuple, result.bands.tolist()), strict=True)),
            "louder_share": result.louder_share,
        }
    of_case = dict.fromkeys(("gain", "gain_error", "start", "optimum", "runs", "torque", "misalignment"))
    return of_case | {"variables": list(map(_variable, result.variables)), "heard": (result, notes)}


def _variable(variable: DesignVariable) -> Json:
    """Return the name and the bounds of a variable, as a case file has them."""
    bounds = _range(variable.name, variable.low, variable.high)
    return {"name": boundary_name(variable.name), "bounds": bounds}


def _with_variables(case: Case, study: Inputs) -> Inputs:
    """Return a study with the usual variables of a case, if it names none."""
    variables = study.variables
    if any(gear.model_dump(exclude_none=True) for gear in (variables.pinion, variables.wheel)):
        return study
    module = case.pair.normal_module_mm
    relief = {
        "tip_relief_um": (0.0, variables.most_tip_relief_um),
        "tip_relief_length_mm": (0.15 * module, 0.8 * module),
    }
    in_plane = case.accuracy.model in ("plane_strain", "plane_stress")
    crowning = {} if in_plane else {"helix_crowning_um": (0.0, 30.0)}
    gears = {"pinion": GearVariablesInput(**relief, **crowning), "wheel": GearVariablesInput(**relief)}
    return study.model_copy(update={"variables": variables.model_copy(update=gears)})


def _library_request(checked: CheckedCase, study: Inputs) -> OptimizationRequest:
    pair, case = checked.pair, checked.case
    study = _with_variables(case, of_case(case, study))
    torques = study.torque_n_m or case.load.torque_n_m
    if torques is None:
        torques = tuple(float(pair.torque(force)) for force in case.load.normal_force_n or ())
    objective: Objective
    harmonic, weights = study.objective.harmonic, study.objective.weights
    over_loads = WeightedMean(weights) if study.objective.kind == "weighted_mean" else Worst()
    objective = over_loads if harmonic is None else HarmonicAmplitude(harmonic, over_loads)
    variables = [
        DesignVariable(name, low * unit, high * unit)
        for name, (low, high), unit in _set_fields(study.variables.pinion, study.variables.wheel)
    ]
    limits_input = study.limits
    limits = Limits(
        _si(limits_input.max_pressure_mpa, MPA),
        limits_input.face_load_factor,
        limits_input.edge_load_share,
        _si(limits_input.peak_to_peak_um, UM),
        _si(limits_input.root_stress_mpa, MPA),
    )
    return OptimizationRequest(
        pair=pair,
        torques=list(torques),
        variables=tuple(variables),
        scatter=_scatter_of(study.scatter, study.search.seed),
        misalignment=np.asarray(study.misalignment_um) * UM,
        objective=objective,
        limits=limits,
        search=_search(study.search, of_sound=study.heard is not None),
        options=checked.options,
        grid={} if harmonic is None else drawing_grid(case, pair, variables),
    )


def _si(value: float | None, unit: float) -> float | None:
    return None if value is None else value * unit


def _scatter_of(scatter: ScatterInput, seed: int) -> Scatter:
    hermite = scatter.rule == "gauss_hermite"
    rule = GaussHermite(scatter.points) if hermite else SobolSample(scatter.log2_size, seed)
    fields = _set_fields(scatter.pinion, scatter.wheel)
    deviations = {name: value * unit for name, value, unit in fields}
    return Scatter(scatter.misalignment_um * UM, deviations, rule)


def _set_fields(
    pinion: GearVariablesInput | GearScatterInput, wheel: GearVariablesInput | GearScatterInput
) -> Iterator[tuple[str, Any, float]]:
    """Yield name in the library, value and unit of the fields of both gears that have a value."""
    for gear, inputs in (("pinion", pinion), ("wheel", wheel)):
        for field in type(inputs).model_fields:
            value = getattr(inputs, field)
            if value is not None:
                yield f"{gear}.{field.rpartition('_')[0]}", value, factor(field)


def _search(search: SearchInput, *, of_sound: bool) -> Search:
    """Return the search; few positions tell a level nearly as well as many, but not a ripple."""
    trials = search.trials
    if trials is None:
        trials = SOUND_TRIALS if of_sound else TRIALS
    linear = StagedLinearProgramming if of_sound else SequentialLinearProgramming
    methods: dict[str, Method] = {
        "sequential_linear_programming": linear(search.sample, trials),
        "differential_evolution": DifferentialEvolution(search.population),
        "nelder_mead": NelderMead(),
    }
    counts = search.starts, search.evaluations, search.positions, search.exploration
    return Search(methods[search.method], search.seed, *counts)


def _scattering(result: Optimization) -> Json:
    """Return the scattering variables by the fields of a case file."""
    scatter = result.request["scatter"]
    rule = {name: value for name, value in scatter.items() if not name.endswith("_m")}
    misalignment = scatter["misalignment_m"] / UM
    return {"misalignment_um": misalignment, **_at_boundary(scatter["modification_m"]), **rule}


def _range(name: str, low: float, high: float) -> list[float]:
    return [_typed(name, low), _typed(name, high)]


def _at_boundary(values: Mapping[str, float]) -> dict[str, dict[str, float]]:
    """Return the values of a design by gear and field, as a case file has them."""
    out: dict[str, dict[str, float]] = {}
    for name, value in values.items():
        gear, _, field = boundary_name(name).partition(".")
        out.setdefault(gear, {})[field] = _typed(name, value)
    return out


def _typed(name: str, value: float) -> float:
    """Return a figure in the unit of its field, without the noise of the conversion."""
    return float(f"{value / factor(boundary_name(name)):.12g}")


def _worse_load_warning(before: HarrisMap, after: HarrisMap, index: int) -> Json:
    first, second = (float(design.expected[index]) / UM for design in (before, after))
    error = float(before.expected_error[index] + after.expected_error[index]) / UM
    torque = float(before.torque[index])
    reason = "the search makes another load better at the cost of this one"
    text = f"from {first:.3g} to {second:.3g} µm, errors {engineering(error, 2)} µm: {reason}"
    return {
        "check": "worse_load",
        "field": f"torque_n_m = {torque:.6g}",
        "value": second,
        "unit": "um",
        "low": None,
        "high": first + error,
        "reason": reason,
        "source": "the design from which the search starts",
        "whole": "",
        "message": f"expected peak-to-peak rises at {torque:.6g} N m {text}",
    }


RUN = _OptimizeStudy()
