"""A sweep: ripple, pressure and K_Hbeta over one or two quantities of a pair, on one compliance."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np

from fe_contact.analysis.live.condensed_pair import CondensedPair
from fe_contact.analysis.live.condensed_request import condense
from fe_contact.analysis.request.solved_run import SolvedOperatingPoint
from fe_contact.contact import contact_pressure
from fe_contact.microgeometry.evaluator import over_face
from fe_contact.microgeometry.sweep_request import TORQUE, SweepRequest
from fe_contact.options import Run
from fe_contact.ste import SteDatabase
from fe_contact.types import BoolArray, FloatArray, Json, Status
from model_studies import in_unit
from model_studies.stage_clock import StageClock

HARMONICS = 3
_OF_CURVE = {"peak_to_peak": "m"} | {f"harmonic_{n}": "m" for n in range(1, HARMONICS + 1)}
_OF_FLANKS = {"max_pressure": "Pa", "face_load_factor": ""}
SWEPT = {**_OF_CURVE, **_OF_FLANKS}
"""Quantities of a sweep and their SI units. The face load factor is that of the mesh cycle; the plane has
none."""


@dataclass(frozen=True)
class SweptQuantity:
    """A quantity at all N points."""

    name: str
    unit: str
    """`name`, `unit`: Name and unit of the quantity, as in `SWEPT`."""
    value: FloatArray = field(metadata=in_unit("1", "point"))
    error: FloatArray = field(metadata=in_unit("1", "point"))
    """`value`, `error`: Value and error in the unit; NaN where the contact was not solved. The error of a
    ripple is that of its table. The error of pressure and face load factor is the sum of their changes by
    half the slices, the coarse meshes and half the positions. Shape (N,) each.
    """

    @property
    def minimum(self) -> int:
        """Index of the point of the least value."""
        return int(np.nanargmin(self.value))

    @property
    def like_least(self) -> BoolArray:
        """Points (N,) that differ from the least by no more than both errors."""
        minimum = self.minimum
        return np.asarray(self.value - self.value[minimum] <= self.error + self.error[minimum])


@dataclass(frozen=True)
class Sweep:
    """A pair over a grid of N points, the first axis running slowest."""

    axes: tuple[str, ...]
    """Names of one or two `SweepAxis`."""
    point: FloatArray = field(metadata=in_unit("1", "point", "axis"))
    """Values of the axes at each point: N m of the torque, m of all others. Shape (N, axes)."""
    quantities: tuple[SweptQuantity, ...]
    reason: tuple[str, ...]
    """Reason why a point has no figures; empty if it has figures (N,)."""
    held: Json
    """Values of torque, misalignment and change of the center distance that were not swept, in SI units."""
    cost: Json
    """CPU seconds of all processes and wall seconds, by stage."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Numbers of values of the axes."""
        return tuple(np.unique(column).size for column in self.point.T)

    @property
    def usable(self) -> int:
        """Points with figures."""
        return sum(not reason for reason in self.reason)


def sweep(request: SweepRequest, run: Run = Run()) -> Sweep:  # noqa: B008 (frozen)
    """Solve the contact at every point of a grid; the gears are condensed once.

    `run`: its workers take a design each, all torques at once. Raises `InputError`: a value that cannot be
    used, by field name; `MeshError`, `SolveError`: no acceptable mesh.
    """
    clock = StageClock(run.workers.cost)
    swept = _SweptPair(request, None if run.cache is None else str(run.cache))
    _ = request.checked
    run.progress("compliance", 0.0)
    with clock.stage("compliance"):
        across_face = swept.bodies.checked.model.across_face
    run.progress("compliance", 1.0)
    designs, rows = request.designs, []
    with clock.stage("contact"):
        for row in run.workers.run(_swept_design, swept, [tuple(design.items()) for design in designs]):
            rows.append(row)
            run.progress("contact", len(rows) / len(designs))
    figures = _on_grid(request, np.stack(rows))
    names = [name for name in SWEPT if across_face or name != "face_load_factor"]
    value, error = figures
    quantities = tuple(
        SweptQuantity(name, SWEPT[name], value[:, k], error[:, k])
        for k, name in enumerate(SWEPT)
        if name in names
    )
    reason = tuple("" if np.isfinite(row).all() else "the contact was not solved" for row in value)
    grids = np.meshgrid(*(axis.values for axis in request.axes), indexing="ij")
    point = np.stack([grid.ravel() for grid in grids], axis=1)
    return Sweep(
        tuple(axis.name for axis in request.axes),
        point,
        quantities,
        reason,
        _fixed_values(request),
        clock.to_json(),
    )


@dataclass(frozen=True)
class _SweptPair:
    """Task data that all designs of a sweep share: the request, and the folder of compliances.

    The condensed bodies are computed when first needed. They are no field and no part of the task's key.
    """

    request: SweepRequest
    cache: str | None

    @cached_property
    def bodies(self) -> CondensedPair:
        """The gears, condensed."""
        cache = None if self.cache is None else Path(self.cache)
        return condense(self.request.pair, self.request.checked, cache)


def _swept_design(pair: _SweptPair, design: tuple[tuple[str, float], ...]) -> FloatArray:
    """Return values and errors (2, L, Q) in SI of all quantities at all torques of a design: one task."""
    request, bodies, values = pair.request, pair.bodies, dict(design)
    question = request.flanks(values), request.torques, *request.alignment(values)
    table, solved_point = bodies.solve_table(*question)
    curves = np.array(list(_of_curves(table, solved_point.solution.status == Status.CONVERGED)))
    at_half = _on_flanks(solved_point, 2)
    flanks = _on_flanks(solved_point)
    others = [at_half, *(_on_flanks(rougher) for rougher in bodies.solve_rougher(*question))]
    errors = np.sum([np.abs(flanks - other) for other in others], axis=0)
    of_flanks = np.stack([flanks, errors])
    of_flanks[:, np.isnan(curves[:, 0, 0])] = np.nan
    return np.concatenate([curves.transpose(1, 0, 2), of_flanks], axis=2)


def _of_curves(table: SteDatabase, solved: BoolArray) -> Iterator[FloatArray]:
    """Yield values and errors (2, q) of the curves of all loads, m; NaN where a position was not solved."""
    skew, change = float(table.misalignment[0]), float(table.center_distance_change[0])
    for k, force in enumerate(table.force):
        if not solved[:, k].all():
            yield np.full((2, len(_OF_CURVE)), np.nan)
            continue
        curve = table.curve(
            force=float(force), misalignment=skew, center_distance_change=change, allow_failed=True
        )
        figures = (curve.peak_to_peak, *curve.harmonics[:HARMONICS])
        yield np.array([[figure.value for figure in figures], [figure.error for figure in figures]])


def _on_flanks(point: SolvedOperatingPoint, every: int = 1) -> FloatArray:
    """Return largest pressure in Pa and face load factor of the cycle (L, 2), of each `every`-th position."""
    problem, force = point.problem, point.solution.force
    pressure, edge = contact_pressure(problem, force)
    clear = np.where(edge, 0.0, pressure)[::every].max(axis=(0, 2))
    load = over_face(problem, force[::every])
    return np.stack([clear, load.max(axis=1) / load.mean(axis=1)], axis=1)


def _on_grid(request: SweepRequest, rows: FloatArray) -> FloatArray:
    """Return values and errors (2, N, Q) from those of all designs (D, 2, L, Q)."""
    ordered = rows.transpose(1, 0, 2, 3)
    if request.axes[0].name == TORQUE:
        ordered = ordered.transpose(0, 2, 1, 3)
    return ordered.reshape(2, -1, len(SWEPT))


def _fixed_values(request: SweepRequest) -> Json:
    swept = {axis.name for axis in request.axes}
    point = request.point
    values: Json = {
        "misalignment": point.misalignment,
        "center_distance_change": point.center_distance_change,
    }
    if TORQUE not in swept:
        values[TORQUE] = float(request.torques[0])
    return {name: value for name, value in values.items() if name not in swept}
