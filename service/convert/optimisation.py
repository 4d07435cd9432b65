"""Micro-geometry optimisation at the boundary: its study, and its result as JSON."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from fe_contact.microgeometry import (
    DesignVariable,
    DifferentialEvolution,
    GaussHermite,
    Limits,
    Method,
    NelderMead,
    Optimization,
    Scatter,
    Search,
    SequentialLinearProgramming,
    SobolSample,
    WeightedMean,
    Worst,
    optimize,
)
from fe_contact.microgeometry.confirmation import ConfirmedDesign
from fe_contact.microgeometry.design_study import Accuracies
from fe_contact.microgeometry.request import OptimizationRequest
from fe_contact.workers import InProcess, Workers
from service.convert.ablation import in_um
from service.convert.case import analysis_arguments, boundary_errors, gear_pair
from service.convert.vocabulary import boundary_name
from service.schemas import Case
from service.schemas.optimisation import (
    GearScatterInput,
    GearVariablesInput,
    OptimisationInput,
    ScatterInput,
    SearchInput,
)
from service.units import UM, factor

Json = dict[str, Any]
Report = Callable[[str, float], None]
MPA = 1e6
_ACCURACY = ("tolerance", "level", "time_budget", "model", "effects")


def optimisation_of(
    case: Case,
    study: OptimisationInput,
    cache: Path | None,
    report: Report,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
    cancel: Callable[[], bool] | None = None,
    memory: Path | None = None,
) -> Optimization:
    """Optimise the modifications of a case; when `cancel` says so, end with the best so far.

    Raises
    ------
    BadInput
        No such pair, or something that cannot be varied so.
    JobFailed
        The case cannot be computed.
    """
    with boundary_errors():
        arguments = _arguments(case, study)
        return optimize(
            **arguments,
            **{name: analysis_arguments(case)[name] for name in _ACCURACY},
            workers=workers,
            cancel=cancel,
            memory=memory,
            progress=report,
            cache=cache,
        )


def check_optimisation_of(case: Case, study: OptimisationInput) -> None:
    """Raise `BadInput` for what `optimisation_of` would, without computing anything."""
    with boundary_errors():
        accuracy = Accuracies(**{name: analysis_arguments(case)[name] for name in _ACCURACY})
        OptimizationRequest(**_arguments(case, study), accuracy=accuracy).check()


def _arguments(case: Case, study: OptimisationInput) -> Json:
    """Return what both of the library's functions take, in SI."""
    pair = gear_pair(case)
    torques = study.torque_n_m or case.load.torque_n_m
    if torques is None:
        torques = tuple(float(pair.torque(force)) for force in case.load.normal_force_n or ())
    objective = WeightedMean(study.objective.weights) if study.objective.kind == "weighted_mean" else Worst()
    return {
        "pair": pair,
        "torques": list(torques),
        "variables": tuple(_variables(study)),
        "scatter": scatter_of(study.scatter, study.search.seed),
        "misalignment": study.misalignment_um * UM,
        "objective": objective,
        "limits": _limits(study),
        "search": _search(study.search),
    }


def _variables(study: OptimisationInput) -> list[DesignVariable]:
    """Return the design variables of both gears, in SI."""
    gears = {"pinion": study.variables.pinion, "wheel": study.variables.wheel}
    return [
        DesignVariable(name, *(end * unit for end in ends))
        for gear, given in gears.items()
        for name, ends, unit in _given(gear, given)
    ]


def scatter_of(given: ScatterInput, seed: int) -> Scatter:
    """Return the scatter in SI."""
    rule = GaussHermite(given.points) if given.rule == "gauss_hermite" else SobolSample(given.log2_size, seed)
    gears = {"pinion": given.pinion, "wheel": given.wheel}
    deviations = {
        name: value * unit for gear, one in gears.items() for name, value, unit in _given(gear, one)
    }
    return Scatter(given.misalignment_um * UM, deviations, rule)


def _given(gear: str, given: GearVariablesInput | GearScatterInput) -> list[tuple[str, Any, float]]:
    """Return name in the library, value and unit of the fields that are given."""
    found = ((field, getattr(given, field)) for field in type(given).model_fields)
    return [
        (f"{gear}.{field.rpartition('_')[0]}", value, factor(field))
        for field, value in found
        if value is not None
    ]


def _limits(study: OptimisationInput) -> Limits:
    """Return the limits in SI."""
    pressure = study.limits.max_pressure_mpa
    return Limits(
        None if pressure is None else pressure * MPA,
        study.limits.face_load_factor,
        study.limits.edge_load_share,
    )


def _search(given: SearchInput) -> Search:
    """Return how it is searched."""
    methods: dict[str, Method] = {
        "sequential_linear_programming": SequentialLinearProgramming(given.sample, given.trials),
        "differential_evolution": DifferentialEvolution(given.population),
        "nelder_mead": NelderMead(),
    }
    counts = given.starts, given.evaluations, given.positions, given.exploration
    return Search(methods[given.method], given.seed, *counts)


def optimisation_json(found: Optimization) -> Json:
    """Return an optimisation in the units of a case file, other lengths in um."""
    plain = found.to_json()
    variables = [
        {"name": boundary_name(one.name), "bounds": [_typed(one.name, one.low), _typed(one.name, one.high)]}
        for one in found.variables
    ]
    steps = [
        {
            "name": boundary_name(one.name),
            "values": [_typed(one.name, one.low), _typed(one.name, one.high)],
            "change_um": [one.change_low / UM, one.change_high / UM],
        }
        for one in found.sensitivity
    ]
    designs = {name: _design_json(getattr(found, name)) for name in ("start", "optimum")}
    converted: Json = in_um(plain)
    converted["asked"] |= {"scatter": _scatter_json(found), "limits": _limits_json(found)}
    return converted | designs | {"variables": variables, "sensitivity": steps, "nodes": _nodes_json(found)}


def _scatter_json(found: Optimization) -> Json:
    """Return what scatters, by the fields of a case file."""
    asked = found.asked["scatter"]
    rule = {name: value for name, value in asked.items() if not name.endswith("_m")}
    spread = {"misalignment_um": asked["misalignment_m"] / UM, **boundary_values(asked["modification_m"])}
    return {**spread, **rule}


def _limits_json(found: Optimization) -> Json:
    """Return the limits that were requested."""
    limits = dict(found.asked["limits"])
    pressure = limits.pop("max_pressure_pa")
    return {"max_pressure_mpa": None if pressure is None else pressure / MPA, **limits}


def _nodes_json(found: Optimization) -> Json:
    """Return the nodes of the scatter."""
    names = found.nodes.names
    return {
        "names": [boundary_name(name) for name in names],
        "deviation": [
            [_typed(name, float(x)) for name, x in zip(names, row, strict=True)]
            for row in found.nodes.deviation
        ],
        "weight": found.nodes.weight.tolist(),
    }


def _design_json(design: ConfirmedDesign) -> Json:
    """Return one design: its values by the fields of a case file."""
    plain: Json = in_um(design.to_json())
    pressure = [value / MPA for value in plain.pop("max_pressure_pa")]
    plain.pop("values_um")
    return {"values": boundary_values(design.values), **plain, "max_pressure_mpa": pressure}


def boundary_values(values: Mapping[str, float]) -> dict[str, dict[str, float]]:
    """Return the values of a design by gear and field, as a case file has them."""
    out: dict[str, dict[str, float]] = {}
    for name, value in values.items():
        gear, _, field = boundary_name(name).partition(".")
        out.setdefault(gear, {})[field] = _typed(name, value)
    return out


def _typed(name: str, value: float) -> float:
    """Return a figure in the unit of its field, without the noise of the conversion."""
    return float(f"{value / factor(boundary_name(name)):.12g}")
