"""Micro-geometry optimization of a case."""

from __future__ import annotations

from collections.abc import Mapping
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
    OptimizationRequest,
    Scatter,
    Search,
    SequentialLinearProgramming,
    SobolSample,
    WeightedMean,
    Worst,
    optimize,
)
from fe_contact.microgeometry.confirmation import ConfirmedDesign
from fe_contact.microgeometry.search import never
from fe_contact.options import Run
from service.convert.case import analysis_options, boundary_errors, gear_pair
from service.convert.vocabulary import boundary_name
from service.schemas import Case
from service.studies.computation import Computation, Means
from service.studies.optimize import GearScatterInput, GearVariablesInput, Inputs, ScatterInput, SearchInput
from service.studies.optimize.stored import read
from service.units import UM, factor, in_um

Json = dict[str, Any]
MPA = 1e6


def optimization_of(case: Case, study: Inputs, means: Means) -> Optimization:
    """Optimize the modifications of a case; when it is cancelled, end with the best so far.

    Designs are remembered: another attempt, or another deadline, goes on from them.

    Raises
    ------
    BadInput
        No such pair, or something that cannot be varied so.
    JobFailed
        The case cannot be computed.
    """
    with boundary_errors():
        run = Run(means.workers, means.home / "compliance", means.report)
        return optimize(
            _request(case, study), run, cancel=means.cancel or never, memory=means.home / "searches"
        )


def check(case: Case, study: Inputs) -> None:
    """Raise `BadInput` for what `optimization_of` would, without computing anything."""
    with boundary_errors():
        _request(case, study).check()


def _request(case: Case, study: Inputs) -> OptimizationRequest:
    """Return what is requested of the library, in SI."""
    pair = gear_pair(case)
    torques = study.torque_n_m or case.load.torque_n_m
    if torques is None:
        torques = tuple(float(pair.torque(force)) for force in case.load.normal_force_n or ())
    objective = WeightedMean(study.objective.weights) if study.objective.kind == "weighted_mean" else Worst()
    return OptimizationRequest(
        pair,
        list(torques),
        tuple(_variables(study)),
        scatter_of(study.scatter, study.search.seed),
        study.misalignment_um * UM,
        objective,
        _limits(study),
        _search(study.search),
        analysis_options(case),
    )


def _variables(study: Inputs) -> list[DesignVariable]:
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


def _limits(study: Inputs) -> Limits:
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


def optimization_json(found: Optimization) -> Json:
    """Return an optimization in the units of a case file, other lengths in um."""
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


def write_values(found: Optimization, target: Path) -> None:
    """Write the best design as TOML: lines for the tables of both gears in the case file."""
    lines = [f"# {found.reason}"]
    for gear, fields in boundary_values(found.optimum.values).items():
        lines += ["", f"[pair.{gear}]", *(f"{name} = {value:.6g}" for name, value in fields.items())]
    target.write_text("\n".join(lines) + "\n", encoding="utf-8")


RUN = Computation(
    optimization_of,
    optimization_json,
    read,
    marks=dict.fromkeys(("start", "optimum", "variables")),
    check=check,
    interruptible=True,
    writers={".toml": write_values},
)
