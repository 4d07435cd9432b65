"""Error against time of every rung of the ladder, on one case."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from fe_contact.analysis.ladder import RUNGS, Rung
from fe_contact.analysis.ladder.full_contact import FULL_CONTACT, ORIGIN
from fe_contact.analysis.pareto import knee_of
from fe_contact.analysis.request import Checked, check_request
from fe_contact.analysis.solved_table import Progress
from fe_contact.analysis.warm_up import warm_up
from fe_contact.errors import InputError, MeshError, SolveError
from fe_contact.geometry import ParallelAxes
from fe_contact.planning import chosen_level
from fe_contact.ste import SteDatabase
from fe_contact.types import FloatArray, Json

POSITIONS = 64


@dataclass(frozen=True)
class RungResult:
    """What one rung gave on a case.

    Attributes
    ----------
    name, title : str
    mean, peak_to_peak : ndarray, shape (C,)
        Of each curve (loads, then alignments), m.
    stated_error : float
        The error its table states: of mean and peak-to-peak, relative, the worst over the curves. That of the
        positions is in it, which is the same for all rungs.
    mean_error, peak_to_peak_error : float
        Relative difference to the reference, the worst over the curves; of the reference what its mesh
        leaves, by the difference of the next coarser mesh and the second order of convergence (NaN if none
        was run).
    cpu_seconds : float
        Of the whole run, its error estimate included.
    stages : dict
        CPU seconds by stage.
    peak_memory_bytes : int
        Of the process by the end of the rung.
    """

    name: str
    title: str
    mean: FloatArray
    peak_to_peak: FloatArray
    stated_error: float
    mean_error: float
    peak_to_peak_error: float
    cpu_seconds: float
    stages: dict[str, float]
    peak_memory_bytes: int

    @property
    def error(self) -> float:
        """The worse of both errors, which a tolerance speaks of."""
        return max(self.mean_error, self.peak_to_peak_error)

    def to_json(self) -> Json:
        """Return plain JSON; errors that are not known are left out."""
        errors = {"mean_error": self.mean_error, "peak_to_peak_error": self.peak_to_peak_error}
        known = {name: error for name, error in errors.items() if np.isfinite(error)}
        return known | {
            "name": self.name,
            "title": self.title,
            "mean_m": self.mean.tolist(),
            "peak_to_peak_m": self.peak_to_peak.tolist(),
            "stated_error": self.stated_error,
            "cpu_seconds": self.cpu_seconds,
            "stages": self.stages,
            "peak_memory_bytes": self.peak_memory_bytes,
        }


@dataclass(frozen=True)
class Frontier:
    """The ladder on one case.

    Attributes
    ----------
    results : tuple of RungResult
        In the order of the ladder; the last one is the reference.
    left_out : dict
        Name of a rung to the reason why it was not run.
    solves : int
        Positions x loads x alignments of every table.
    knee : str or None
        The rung after which time buys least; None with fewer than three rungs on the front.
    chosen : str or None
        The rung that the case's accuracy asks for.
    """

    results: tuple[RungResult, ...]
    left_out: dict[str, str]
    solves: int
    knee: str | None
    chosen: str | None

    @property
    def reference(self) -> RungResult:
        """The finest rung that was run."""
        return self.results[-1]

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {
            "rungs": [result.to_json() for result in self.results],
            "left_out": self.left_out,
            "reference": self.reference.name,
            "knee": self.knee,
            "chosen": self.chosen,
            "solves": self.solves,
            "full_finite_element_contact": [
                {
                    "unknowns": level.unknowns,
                    "cpu_seconds": level.seconds(self.solves),
                    "mean_error": level.relative_error,
                }
                for level in FULL_CONTACT
            ],
            "full_finite_element_contact_origin": ORIGIN,
        }


def frontier(
    pair: ParallelAxes,
    *,
    torques: Sequence[float] | FloatArray | None = None,
    normal_forces: Sequence[float] | FloatArray | None = None,
    tolerance: float | None = None,
    level: str | None = None,
    time_budget: float | None = None,
    model: str = "auto",
    positions: int | None = None,
    misalignments: Sequence[float] = (0.0,),
    center_distance_changes: Sequence[float] = (0.0,),
    effects: Mapping[str, str] | None = None,
    rungs: Sequence[str] | None = None,
    progress: Progress | None = None,
) -> Frontier:
    """Run every rung of the ladder that is valid for a case, and compare each to the finest.

    Nothing is taken from the cache, so that times are those of a first run; compiled loops are warm.

    Parameters
    ----------
    pair, torques, normal_forces, tolerance, level, time_budget, model, misalignments, \
center_distance_changes, effects, progress
        As for `analyze`; the accuracy decides which rung is marked as chosen.
    positions : int, optional
        Equally spaced positions of every table; default 64.
    rungs : sequence of str, optional
        Names of rungs to run; default all.

    Raises
    ------
    InputError
        A value that cannot be used, by field name.
    SolveError
        Fewer than two rungs gave a whole table.
    """
    checked = check_request(
        pair,
        torques=torques,
        normal_forces=normal_forces,
        tolerance=tolerance,
        level=level,
        time_budget=time_budget,
        model=model,
        positions=positions or POSITIONS,
        misalignments=misalignments,
        center_distance_changes=center_distance_changes,
        effects=effects,
    )
    asked = selected(rungs)
    left_out = {rung.name: reason for rung in asked if (reason := rung.refusal(checked)) is not None}
    return _climbed(checked, [rung for rung in asked if rung.name not in left_out], left_out, progress)


def selected(names: Sequence[str] | None) -> tuple[Rung, ...]:
    """Return the rungs of these names in the order of the ladder, all if None.

    Raises
    ------
    InputError
        There is no such rung.
    """
    known = [rung.name for rung in RUNGS]
    for name in names or ():
        if name not in known:
            raise InputError("rungs", name, f"among {', '.join(known)}")
    return tuple(rung for rung in RUNGS if names is None or rung.name in names)


def _climbed(
    checked: Checked, rungs: Sequence[Rung], left_out: dict[str, str], progress: Progress | None
) -> Frontier:
    """Run the rungs, compare, mark."""
    warm_up(across_face=any(rung.name.startswith("3d") for rung in rungs))
    tables: dict[str, SteDatabase] = {}
    for count, rung in enumerate(rungs):
        if progress is not None:
            progress("ladder", count / len(rungs))
        try:
            table = rung.run(checked, _silent, None)
            table.require_complete()
            tables[rung.name] = table
        except (MeshError, SolveError) as error:
            left_out = left_out | {rung.name: str(error)}
    if len(tables) < 2:
        raise SolveError(f"an error needs two rungs to compare; left out: {left_out}")
    results = _results([rung for rung in rungs if rung.name in tables], tables)
    solves = tables[results[-1].name].status.size
    return Frontier(results, left_out, solves, _knee(results), chosen_rung(checked))


def _knee(results: Sequence[RungResult]) -> str | None:
    """Return the knee; differences below the reference's own error say nothing."""
    floor = results[-1].error if np.isfinite(results[-1].error) else 0.0
    pairs = [result for result in results if np.isfinite(result.error)]
    return knee_of({result.name: (result.cpu_seconds, max(result.error, floor)) for result in pairs})


def _results(rungs: Sequence[Rung], tables: Mapping[str, SteDatabase]) -> tuple[RungResult, ...]:
    """Measure every table against the last one, and that one by its convergence."""
    figures = {name: _figures(table) for name, table in tables.items()}
    reference = figures[rungs[-1].name]
    found = [_result(rung, tables[rung.name], figures[rung.name], reference) for rung in rungs]
    part, coarser = _remaining(rungs)
    errors = (
        (found[coarser].mean_error, found[coarser].peak_to_peak_error) if coarser is not None else (0.0, 0.0)
    )
    found[-1] = replace(found[-1], mean_error=part * errors[0], peak_to_peak_error=part * errors[1])
    return tuple(found)


def _remaining(rungs: Sequence[Rung]) -> tuple[float, int | None]:
    """Part of the difference to the next coarser mesh that the last rung leaves, and where that stands."""
    last = rungs[-1]
    alike = [
        i
        for i, rung in enumerate(rungs[:-1])
        if rung.family == last.family and rung.element_size > last.element_size
    ]
    if not alike:
        return float("nan"), None
    ratio = (rungs[alike[-1]].element_size / last.element_size) ** 2
    return 1.0 / (ratio - 1.0), alike[-1]


def _figures(table: SteDatabase) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Mean, peak-to-peak (C,) in m of every curve, and the worse of their stated relative errors."""
    axes = (table.force, table.misalignment, table.center_distance_change)
    curves = [
        table.curve(force=float(force), misalignment=float(skew), center_distance_change=float(change))
        for force, skew, change in product(*axes)
    ]
    mean, swing = ([getattr(curve, name) for curve in curves] for name in ("mean", "peak_to_peak"))
    stated = [max(abs(a.error / a.value), abs(b.error / b.value)) for a, b in zip(mean, swing, strict=True)]
    return np.array([m.value for m in mean]), np.array([p.value for p in swing]), np.array(stated)


def _result(
    rung: Rung,
    table: SteDatabase,
    figures: tuple[FloatArray, FloatArray, FloatArray],
    reference: tuple[FloatArray, FloatArray, FloatArray],
) -> RungResult:
    """One rung against the reference."""
    receipt = table.metadata.receipt
    return RungResult(
        name=rung.name,
        title=rung.title,
        mean=figures[0],
        peak_to_peak=figures[1],
        stated_error=float(figures[2].max()),
        mean_error=float(np.max(np.abs(figures[0] / reference[0] - 1.0))),
        peak_to_peak_error=float(np.max(np.abs(figures[1] / reference[1] - 1.0))),
        cpu_seconds=float(receipt["cpu_seconds"]),
        stages={name: stage["cpu_seconds"] for name, stage in receipt["stages"].items()},
        peak_memory_bytes=int(receipt["peak_memory_bytes"]),
    )


def chosen_rung(checked: Checked) -> str | None:
    """Return the name of the rung that a request's own model and mesh are; None if none is.

    Plane strain has one rung, whose error is the model's: it stands for all its meshes.
    """
    asked = checked.request
    level = chosen_level(asked.pair, asked.load, asked.accuracy, checked.model, asked.alignments).level
    if checked.model.across_face:
        return f"3d_{level}"
    if checked.model.finite_width:
        return "corrected" if level == "standard" else f"corrected_{level}"
    return None if asked.accuracy.model == "plane_stress" else "plane_strain"


def _silent(stage: str, fraction: float) -> None:
    """Report no progress."""
