"""Error against time of every fidelity of the accuracy study, on one case."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np

import model_studies
from fe_contact.analysis.analyze import analyze
from fe_contact.analysis.request.model_choice import decide
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import check_request
from fe_contact.analysis.studies.accuracy_study import FIDELITIES, Fidelity
from fe_contact.analysis.studies.measured_full_contact import (
    NAME,
    ORIGIN,
    FullContactLevel,
    MeasuredFullContact,
    full_contact_refusal,
    known_full_contact,
    measure_full_contact,
)
from fe_contact.errors import MeshError, SolveError, chosen, integer
from fe_contact.geometry import Gear, GearPair, ParallelAxes
from fe_contact.options import AnalysisOptions, TableAxes
from fe_contact.ste import SteDatabase
from fe_contact.types import FloatArray, Json
from model_studies import (
    Outcome,
    Progress,
    against_finest,
    called,
    in_unit,
    knee_above,
    run_fidelities,
    silent,
)
from model_studies.frontier import Errors

# Loading, and at the first use compiling, what a measured run shall not pay for.


@lru_cache(maxsize=2)
def warm_up(*, across_face: bool) -> None:
    """Analyze a narrow pair once per process, in the plane and, if requested, over the face."""
    gear = Gear(teeth=20, normal_module=1e-3, face_width=2e-3, bore_diameter=10e-3)
    pair = GearPair(gear, gear, center_distance=20e-3)
    for model in ("auto", "3d") if across_face else ("auto",):
        analyze(pair, normal_forces=[10.0], level="draft", model=model, positions=8)


# The result of a fidelity of the accuracy study on a case, and its distance from the finest one.


FIGURES = ("mean_error", "peak_to_peak_error")
NAN = float("nan")


@dataclass(frozen=True)
class FidelityResult(model_studies.FidelityResult):
    """The result of one fidelity on a case.

    Attributes
    ----------
    name, title : str
    cpu_seconds : float
        Of the whole run, its error estimate included.
    mean, peak_to_peak : ndarray, shape (C,)
        Of each curve (loads, then alignments), m.
    stated_error : float
        The error its table states: of mean and peak-to-peak, relative, the worst over the curves. That of the
        positions is in it, which is the same for all fidelities.
    stages : dict
        CPU seconds by stage.
    peak_memory_bytes : int
        Of the process by the end of the fidelity.
    mean_error, peak_to_peak_error : float
        Relative difference to the reference, the worst over the curves; of the reference what its mesh
        leaves, by the difference of the next coarser mesh and the second order of convergence (NaN if none
        was run).
    """

    FIGURES = FIGURES

    mean: FloatArray = field(metadata=in_unit("m", "curve"))
    peak_to_peak: FloatArray = field(metadata=in_unit("m", "curve"))
    stated_error: float
    stages: dict[str, float]
    peak_memory_bytes: int
    mean_error: float = NAN
    peak_to_peak_error: float = NAN


def _fidelity_results(outcomes: Sequence[Outcome[Fidelity, SteDatabase]]) -> tuple[FidelityResult, ...]:
    """Measure every table against the last one, and that one by its convergence."""
    read = [Outcome(outcome.fidelity, _result(outcome), outcome.cpu_seconds) for outcome in outcomes]
    errors = against_finest(read, _errors, _remaining)
    return tuple(
        replace(outcome.result, **dict[str, Any](error)) for outcome, error in zip(read, errors, strict=True)
    )


def _errors(result: FidelityResult, reference: FidelityResult) -> Errors:
    """Return the relative differences, the worst over the curves."""
    pairs = (result.mean, reference.mean), (result.peak_to_peak, reference.peak_to_peak)
    worst = (float(np.max(np.abs(coarse / finest - 1.0))) for coarse, finest in pairs)
    return dict(zip(FIGURES, worst, strict=True))


def _remaining(coarser: Sequence[tuple[Fidelity, Errors]], finest: Fidelity) -> Errors:
    """Return the part of the difference to the next coarser mesh that the finest one leaves: second order."""
    if not coarser:
        return dict.fromkeys(FIGURES, NAN)
    fidelity, errors = coarser[-1]
    part = 1.0 / ((fidelity.element_size / finest.element_size) ** 2 - 1.0)
    return {name: part * error for name, error in errors.items()}


def _result(outcome: Outcome[Fidelity, SteDatabase]) -> FidelityResult:
    """Read a table; time and memory are those of its receipt, which has those of child processes too."""
    fidelity, table = outcome.fidelity, outcome.result
    axes = (table.force, table.misalignment, table.center_distance_change)
    curves = [
        table.curve(force=float(force), misalignment=float(skew), center_distance_change=float(change))
        for force, skew, change in product(*axes)
    ]
    figures = [(curve.mean, curve.peak_to_peak) for curve in curves]
    receipt = table.metadata.receipt
    return FidelityResult(
        name=fidelity.name,
        title=fidelity.title,
        cpu_seconds=float(receipt["cpu_seconds"]),
        mean=np.array([mean.value for mean, _ in figures]),
        peak_to_peak=np.array([swing.value for _, swing in figures]),
        stated_error=max(abs(each.error / each.value) for pair in figures for each in pair),
        stages={name: stage["cpu_seconds"] for name, stage in receipt["stages"].items()},
        peak_memory_bytes=int(receipt["peak_memory_bytes"]),
    )


POSITIONS = 64
MOST_FULL_CONTACT = 64


@dataclass(frozen=True)
class Frontier(model_studies.Frontier[FidelityResult]):
    """The accuracy study of one case.

    Attributes
    ----------
    results, left_out, knee, chosen
        Of every accuracy study.
    solves : int
        Positions x loads x alignments of every table.
    full_contact : MeasuredFullContact, optional
        Full finite-element contact of the same case, if it was requested and is possible.
    known_full_contact : tuple of FullContactLevel
        Known cost of full finite-element contact for this pair; empty for any other.
    """

    solves: int
    full_contact: MeasuredFullContact | None = field(default=None, metadata=called(None))
    known_full_contact: tuple[FullContactLevel, ...] = field(default=(), metadata=called(None))

    def to_json(self) -> Json:
        """Return plain JSON."""
        known = [level.to_json(self.solves) for level in self.known_full_contact]
        measured = {} if self.full_contact is None else {NAME: self.full_contact.to_json(self.solves)}
        return {
            **super().to_json(),
            "full_finite_element_contact": known,
            "full_finite_element_contact_origin": ORIGIN,
            **measured,
        }


def frontier(
    pair: ParallelAxes,
    axes: TableAxes,
    options: AnalysisOptions = AnalysisOptions(),  # noqa: B008 (frozen)
    *,
    fidelities: Sequence[str] | None = None,
    full_contact: int | None = None,
    progress: Progress = silent,
) -> Frontier:
    """Run every fidelity of the accuracy study that is valid for a case, and compare each to the finest.

    The cache is not used, so times are those of a first run; compiled loops are warm.

    Parameters
    ----------
    pair : GearPair or InternalGearPair
    axes : TableAxes
    options : AnalysisOptions
        The accuracy decides which fidelity is marked as chosen; `positions` is 64 by default.
    fidelities : sequence of str, optional
        Names of fidelities to run; default all.
    full_contact : int, optional
        Positions, 1 to 64, at which full finite-element contact is run beside it, under all loads: of
        solid spur and internal pairs in plane strain, about 2.5 CPU s each; of external spur pairs in three
        dimensions where `model` is "3d" or flanks vary or are inclined across the face, 70 CPU s each.

    Raises
    ------
    InputError
        A value that cannot be used, by field name.
    SolveError
        Fewer than two fidelities gave a whole table.
    """
    checked = check_request(pair, axes, replace(options, positions=options.positions or POSITIONS))
    if full_contact is not None:
        integer("full_contact", full_contact, 1, MOST_FULL_CONTACT)
    names = chosen("fidelities", fidelities, [fidelity.name for fidelity in FIDELITIES])
    outcomes, left_out = run_fidelities(
        [fidelity for fidelity in FIDELITIES if fidelity.name in names],
        checked,
        _warm_up,
        lambda fidelity: _whole_table(fidelity, checked),
        (MeshError, SolveError),
        progress,
    )
    results = _fidelity_results(outcomes)
    solves = outcomes[-1].result.status.size
    known = known_full_contact(checked.request.pair)
    study = Frontier(
        results, left_out, knee_above(results), _chosen_fidelity(checked), solves, known_full_contact=known
    )
    tables = {outcome.fidelity.name: outcome.result for outcome in outcomes}
    return study if full_contact is None else _beside(study, checked, full_contact, tables, progress)


def _warm_up(fidelities: Sequence[Fidelity]) -> None:
    warm_up(across_face=any(fidelity.name.startswith("3d") for fidelity in fidelities))


def _whole_table(fidelity: Fidelity, checked: Checked) -> SteDatabase:
    """Return the table of a fidelity, of which no point is missing."""
    table = fidelity.run(checked)
    table.require_complete()
    return table


def _beside(
    study: Frontier, checked: Checked, positions: int, tables: dict[str, SteDatabase], progress: Progress
) -> Frontier:
    """Add full contact of the case, or why there is none."""
    reason = full_contact_refusal(checked)
    if reason is None:
        try:
            measured = measure_full_contact(checked, positions, progress)
            compared = measured.compared(tables[study.reference.name], tables.get("plane_strain"))
            return replace(study, full_contact=compared)
        except SolveError as error:
            reason = str(error)
    return replace(study, left_out=study.left_out | {NAME: reason})


def _chosen_fidelity(checked: Checked) -> str | None:
    """Return the name of the fidelity that a request's own model and mesh are; None if none is.

    Plane strain has one fidelity, whose error is the model's: it stands for all its meshes.
    """
    decided = decide(checked)
    level, model = decided.mesh.level, decided.checked.model
    if model.across_face:
        return f"3d_{level}"
    if model.finite_width:
        return "corrected" if level == "standard" else f"corrected_{level}"
    return None if checked.request.options.model == "plane_stress" else "plane_strain"
