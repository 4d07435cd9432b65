"""An optimization as its report needs it: a fresh one, or read back from the JSON that it was stored as."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from fe_contact.microgeometry import DesignVariable, Ended, HarrisMap, Perturbation, ScatterNodes, SearchRun
from fe_contact.microgeometry.design_problem import Assessed
from fe_contact.types import Estimate
from service.drawing.figure import FloatArray
from service.units import UM, factor

Json = dict[str, Any]


class ShownDesign(Protocol):
    """A design as a report shows it: a `ConfirmedDesign`, or one read back."""

    @property
    def values(self) -> Mapping[str, float]:
        """``gear.quantity`` to m."""

    @property
    def harris_map(self) -> HarrisMap:
        """Curves and ripple over torque."""

    @property
    def objective(self) -> Estimate:
        """Expected peak-to-peak in m."""


class ShownOptimization(Protocol):
    """An optimization as a report shows it: an `Optimization`, or one read back."""

    @property
    def outcome(self) -> str:
        """Value of an `Outcome`."""

    @property
    def reason(self) -> str:
        """The outcome in words."""

    @property
    def variables(self) -> Sequence[DesignVariable]:
        """The free variables."""

    @property
    def torque(self) -> FloatArray:
        """Torques that count (L,), N m."""

    @property
    def nodes(self) -> ScatterNodes:
        """Of the scatter."""

    @property
    def start(self) -> ShownDesign:
        """The case as it was."""

    @property
    def optimum(self) -> ShownDesign:
        """The best design."""

    @property
    def runs(self) -> Sequence[SearchRun]:
        """One for each start."""

    @property
    def sensitivity(self) -> Sequence[Perturbation]:
        """The changes by a perturbation of each variable."""

    @property
    def not_tried(self) -> Sequence[str]:
        """The alternatives that were not tried, in words."""

    @property
    def cost(self) -> Json:
        """CPU seconds by stage."""

    @property
    def gain(self) -> Estimate:
        """By how much the objective fell, m."""

    @property
    def evaluations(self) -> int:
        """Designs of all searches."""


@dataclass(frozen=True)
class StoredDesign:
    """A `ShownDesign` that was read back."""

    values: dict[str, float]
    harris_map: HarrisMap
    objective: Estimate


@dataclass(frozen=True)
class StoredOptimization:
    """A `ShownOptimization` that was read back."""

    outcome: str
    reason: str
    variables: tuple[DesignVariable, ...]
    torque: FloatArray
    nodes: ScatterNodes
    start: StoredDesign
    optimum: StoredDesign
    runs: tuple[SearchRun, ...]
    sensitivity: tuple[Perturbation, ...]
    not_tried: tuple[str, ...]
    cost: Json
    gain: Estimate
    evaluations: int


def read(file: Path) -> StoredOptimization:
    """Return the optimization in a file of its figures.

    Not stored, and NaN in it: the places and merits of the searches' best designs.
    """
    content = json.loads(file.read_text(encoding="utf-8"))
    nodes = _nodes(content["nodes"])
    variables = (
        DesignVariable(_library(variable["name"]), *_si(variable["name"], variable["bounds"]))
        for variable in content["variables"]
    )
    asides = (
        Perturbation(
            _library(step["name"]), *_si(step["name"], step["values"]), *(UM * x for x in step["change_um"])
        )
        for step in content["sensitivity"]
    )
    runs = (
        SearchRun(
            np.full(len(content["variables"]), np.nan),
            Assessed(run["objective_um"] * UM, run["violation"], np.nan),
            run["evaluations"],
            Ended(run["ended"]),
            run["cpu_seconds"],
            run["explored"],
            run["spread_um"] * UM,
        )
        for run in content["runs"]
    )
    return StoredOptimization(
        content["outcome"],
        content["reason"],
        tuple(variables),
        np.array(content["torque_n_m"], dtype=float),
        nodes,
        _design(content["start"], nodes),
        _design(content["optimum"], nodes),
        tuple(runs),
        tuple(asides),
        tuple(content["not_tried"]),
        content["cost"],
        Estimate(content["gain_um"] * UM, content["gain_error_um"] * UM, "m"),
        content["evaluations"],
    )


def _library(name: str) -> str:
    """Name in the library: without the unit of the case file."""
    return name.rpartition("_")[0]


def _si(name: str, values: Sequence[float]) -> list[float]:
    """Values of a field of a case file in m."""
    return [value * factor(name) for value in values]


def _nodes(content: Json) -> ScatterNodes:
    """Return the nodes of the scatter."""
    names = content["names"]
    deviation = np.array(content["deviation"], dtype=float).reshape(len(content["weight"]), len(names))
    unit = np.array([factor(name) for name in names])
    return ScatterNodes(
        tuple(map(_library, names)), deviation * unit, np.array(content["weight"], dtype=float)
    )


def _design(content: Json, nodes: ScatterNodes) -> StoredDesign:
    """Return one design."""
    values = {
        f"{gear}.{_library(name)}": value * factor(name)
        for gear, fields in content["values"].items()
        for name, value in fields.items()
    }
    harris = content["harris_map"]
    names = ("nominal_peak_to_peak", "nominal_error", "peak_to_peak", "error")
    nominal, nominal_error, ripple, error = (
        np.array(harris[f"{name}_um"], dtype=float) * UM for name in names
    )
    drawn = HarrisMap(
        np.array(harris["torque_n_m"], dtype=float),
        np.array(harris["position"], dtype=float),
        np.array(harris["ste_um"], dtype=float).T * UM,
        nominal,
        nominal_error,
        ripple,
        error,
        nodes.weight,
    )
    return StoredDesign(
        values, drawn, Estimate(content["objective_um"] * UM, content["objective_error_um"] * UM, "m")
    )
