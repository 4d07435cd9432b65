"""Error against time of every fidelity of the accuracy study, on one case."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache, partial
from itertools import product
from pathlib import Path
from typing import Any, Protocol

import numpy as np

import model_studies
from fe_contact.analysis.analyze import analyze
from fe_contact.analysis.database.compute_database import compute_database
from fe_contact.analysis.pairs.kept_contact import KeptContact
from fe_contact.analysis.pairs.pair_contact import OperatingPoints, operating_points
from fe_contact.analysis.pairs.slice_springs import (
    SliceLaw,
    SpringContact,
    mean_stiffness,
    parabolic_stiffness,
)
from fe_contact.analysis.request.model_choice import Decided, decide
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import as_checked, checked_request
from fe_contact.analysis.studies.measured_full_contact import (
    NAME,
    FullContactLevel,
    MeasuredFullContact,
    full_contact_refusal,
    known_full_contact,
    measure_full_contact,
    position_seconds,
)
from fe_contact.analysis.tables import table_fields, table_support
from fe_contact.errors import InputError, MeshError, SolveError, chosen, integer
from fe_contact.geometry import Gear, GearPair, ParallelAxes
from fe_contact.options import AnalysisOptions, Run, TableAxes
from fe_contact.planning.cost_model import effort
from fe_contact.planning.plan import PLANE_REFINEMENT, Plan
from fe_contact.solver_version import SOLVER_VERSION, software_versions
from fe_contact.ste import Metadata, PairFacts, SteDatabase
from fe_contact.ste.facts import SCHEMA_VERSION, content_hash
from fe_contact.types import FloatArray
from model_studies import (
    Outcome,
    Progress,
    against_finest,
    in_unit,
    knee_above,
    run_fidelities,
    silent,
)
from model_studies.frontier import Errors
from model_studies.host_speed import host_slowness
from model_studies.stage_clock import StageClock

# The accuracy study: ways to the transmission error from a closed form to fine finite elements.


class _Fidelity(model_studies.Fidelity[Checked], Protocol):
    """One way to a table of transmission error; those of one family differ by their mesh only.

    `element_size`: what a convergence is assessed by.
    """

    @property
    def element_size(self) -> float:
        """Size of the elements beside that of the other fidelities of the family; 0 without elements."""

    def as_computed(self, checked: Checked) -> Checked:
        """Return the request as this fidelity computes it: with its model and mesh.

        Raises `InputError`: the fidelity is not valid for it.
        """

    def run(self, checked: Checked) -> SteDatabase:
        """Compute the table without a cache, with its time, memory and error in the receipt."""


# The fidelities without finite elements: tooth stiffness of ISO 6336-1 over contact lines, thin slices.
#
# Both take the stiffness of the series of ISO 6336-1, method B, which was fitted to external steel pairs.
#
# - **ISO 6336**: the mesh stiffness follows the length of the contact lines and has the standard's mean
#   value, k(x) = c_gamma_alpha b l(x)/mean(l). Nothing but the macro geometry enters.
# - **Thin slices**: uncoupled slices of the face between the true gaps, so that modifications, misalignment
#   and corner contact act. Measured gears are softer than the theory by C_M = 0.8; finite elements are not,
#   so c'/C_M is taken. Along the path of contact the stiffness falls from the middle by a parabola to both
#   ends, as deep as the standard's mean asks: c_gamma_alpha = c'(0.75 eps_alpha + 0.25) for eps_alpha pairs.

POSITIONS = 64

ISO_ERROR, SLICE_ERROR = 0.45, 0.6
"""Relative error of the mean stated for the fidelities: above the worst of docs/accuracy.md."""


@dataclass(frozen=True)
class _ClosedFormFidelity:
    """A fidelity of uncoupled slices.

    `relative_error`: of the transmission error, stated with every point of its table.
    """

    name: str
    title: str
    law: SliceLaw
    relative_error: float

    element_size = 0.0

    @property
    def family(self) -> str:
        """A family of its own."""
        return self.name

    def refusal(self, checked: Checked) -> str | None:
        """Say why it is not valid: the series is for external pairs, and shafts couple the slices."""
        pair = checked.request.pair
        if pair.internal:
            return "the stiffness of ISO 6336-1 applies to external pairs only"
        if checked.model.compliances:
            return "flexible shafts couple the slices"
        return None

    def as_computed(self, checked: Checked) -> Checked:
        """Return the request as it is: there is no mesh to choose."""
        return checked

    def run(self, checked: Checked) -> SteDatabase:
        """Compute the table."""
        clock = StageClock()
        request = checked.request
        plan = checked.plan()
        with clock.stage("contact"):
            nominal = SpringContact(request.pair, plan, law=self.law)
            points = operating_points(request.scene, request.choices, nominal)
            table = self._table(checked, plan, points)
        case = request.to_json() | {"rung": self.name}
        ledger = [entry.to_json() for entry in checked.ledger]
        receipt = clock.to_json() | {"plan": {"model": self.name, "positions": table.position.size}}
        name = content_hash(case, SOLVER_VERSION, SCHEMA_VERSION)
        return replace(table, metadata=Metadata(case, ledger, receipt, name, software_versions()))

    def _table(self, checked: Checked, plan: Plan, points: OperatingPoints) -> SteDatabase:
        request = checked.request
        count = plan.positions or POSITIONS
        position, pitches = np.arange(count) / count, np.arange(points.period)
        table, support = (
            [
                KeptContact.of(point.contact.pair, *point.solve_pitches(position, load, pitches))
                for point in points.places
            ]
            for load in (plan.load, plan.support)
        )
        solutions = [each.solution for each in table]
        elastic = [solution.deflection - solution.no_load[:, None] for solution in solutions]
        return SteDatabase(
            position=(pitches[:, None] + position).ravel(),
            force=plan.load,
            torque=request.torque,
            misalignment=request.misalignment,
            center_distance_change=request.center_distance_change,
            facts=PairFacts.of(request.pair),
            period=points.period,
            error_estimate=points.gathered([self.relative_error * np.abs(part) for part in elastic]),
            metadata=Metadata(),
            **table_fields(points, table),
            **table_support(points, support),
        )


ISO6336 = _ClosedFormFidelity(
    "iso6336", "ISO 6336 stiffness over contact lines", SliceLaw(mean_stiffness, with_gaps=False), ISO_ERROR
)
THIN_SLICES = _ClosedFormFidelity(
    "thin_slices", "thin slices", SliceLaw(parabolic_stiffness, with_gaps=True), SLICE_ERROR
)


# The fidelities of finite elements: `analyze` with a model and a mesh.

SECTOR_FLANK_SIZE = {"draft": 0.2, "standard": 0.15, "fine": 0.1}
"""Modules; of `SectorRecipe`."""


@dataclass(frozen=True)
class _FiniteElementFidelity:
    """A model and a mesh of `analyze`.

    The model is "plane_strain", "3d", or "auto" for the plane corrected for its finite width; without
    `slices` it has those that usually go with the mesh.
    """

    name: str
    title: str
    model: str
    level: str
    slices: int | None = None

    @property
    def family(self) -> str:
        """Fidelities of one family differ by their mesh only."""
        return self.model

    @property
    def element_size(self) -> float:
        """Size of the elements beside that of the other fidelities of the family."""
        return SECTOR_FLANK_SIZE[self.level] if self.model == "3d" else 1.0 / PLANE_REFINEMENT[self.level]

    def refusal(self, checked: Checked) -> str | None:
        """Say why the fidelity is not valid: no plane holds what acts across the face."""
        try:
            self.as_computed(checked)
        except InputError as error:
            return f"{error.field} must be {error.bound}"
        return None

    def as_computed(self, checked: Checked) -> Checked:
        """Return the request with this model and mesh; explicit choices of other effects stay."""
        request = checked.request
        own = face, width = request.model_effects
        effects = {name: choice for name, choice in request.options.effects.items() if name not in own}
        if self.model == "auto":
            effects |= {face: "off", width: "on"}
        options = request.options.at_level(self.level)
        options = replace(options, model=self.model, effects=effects, receipt="full")
        return checked_request(replace(request, options=options))

    def run(self, checked: Checked) -> SteDatabase:
        """Compute the table."""
        computed = self.as_computed(checked)
        return compute_database(computed, computed.request.to_json(), Run(), self.decided(computed))

    def decided(self, computed: Checked) -> Decided:
        """Return the request as it is computed with its plan."""
        decided = decide(computed)
        return decided if self.slices is None else decided.in_slices(self.slices)


FIDELITIES: tuple[_Fidelity, ...] = (
    ISO6336,
    THIN_SLICES,
    _FiniteElementFidelity("plane_strain", "2-D plane strain", "plane_strain", "standard"),
    _FiniteElementFidelity("corrected_draft", "2-D corrected for the width, draft", "auto", "draft"),
    _FiniteElementFidelity("corrected", "2-D corrected for the width, standard", "auto", "standard"),
    _FiniteElementFidelity("corrected_fine", "2-D corrected for the width, fine", "auto", "fine"),
    _FiniteElementFidelity("3d_draft", "3-D, draft", "3d", "draft"),
    _FiniteElementFidelity("3d_standard", "3-D, standard", "3d", "standard"),
    _FiniteElementFidelity("3d_fine", "3-D, fine, 23 slices", "3d", "fine", 23),
)


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
    cpu_seconds : float
        Of the whole run, its error estimate included.
    """

    FIGURES = FIGURES

    mean: FloatArray = field(metadata=in_unit("m", "curve"))
    peak_to_peak: FloatArray = field(metadata=in_unit("m", "curve"))
    """`mean`, `peak_to_peak`: Of each curve (loads, then alignments), m. Shape (C,) each."""
    stated_error: float
    """The error its table states: of mean and peak-to-peak, relative, the worst over the curves. That of the
    positions is in it, which is the same for all fidelities.
    """
    stages: dict[str, float]
    """CPU seconds by stage."""
    peak_memory_bytes: int
    """Of the process by the end of the fidelity."""
    mean_error: float = NAN
    peak_to_peak_error: float = NAN
    """`mean_error`, `peak_to_peak_error`: Relative difference to the reference, the worst over the curves; of
    the reference what its mesh leaves, by the difference of the next coarser mesh and the second order of
    convergence (NaN if none was run).
    """


def _errors(result: FidelityResult, reference: FidelityResult) -> Errors:
    """Return the relative differences, the worst over the curves."""
    pairs = (result.mean, reference.mean), (result.peak_to_peak, reference.peak_to_peak)
    worst = (float(np.max(np.abs(coarse / finest - 1.0))) for coarse, finest in pairs)
    return dict(zip(FIGURES, worst, strict=True))


def _remaining(coarser: Sequence[tuple[_Fidelity, Errors]], finest: _Fidelity) -> Errors:
    """Return the part of the difference to the next coarser mesh that the finest one leaves: second order."""
    if not coarser:
        return dict.fromkeys(FIGURES, NAN)
    fidelity, errors = coarser[-1]
    part = 1.0 / ((fidelity.element_size / finest.element_size) ** 2 - 1.0)
    return {name: part * error for name, error in errors.items()}


def _result(outcome: Outcome[_Fidelity, SteDatabase]) -> FidelityResult:
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


MOST_FULL_CONTACT = 64


@dataclass(frozen=True)
class Frontier(model_studies.Frontier[FidelityResult]):
    """The accuracy study of one case.

    Attributes
    ----------
    results, left_out, knee, chosen
        Of every accuracy study.
    """

    solves: int
    """Positions x loads x alignments of every table."""
    full_contact: MeasuredFullContact | None = None
    """Full finite-element contact of the same case, if it was requested and is possible."""
    known_full_contact: tuple[FullContactLevel, ...] = ()
    """Known cost of full finite-element contact for this pair; empty for any other."""

    @staticmethod
    def request(pair: ParallelAxes | Checked, axes: TableAxes | None, options: AnalysisOptions) -> Checked:
        """Check the request that every fidelity computes, once; what is checked stays as it is."""
        return as_checked(pair, axes, replace(options, positions=options.positions or POSITIONS))


def frontier(
    pair: ParallelAxes | Checked,
    axes: TableAxes | None = None,
    options: AnalysisOptions = AnalysisOptions(),  # noqa: B008 (frozen)
    *,
    fidelities: Sequence[str] | None = None,
    full_contact: int | None = None,
    progress: Progress = silent,
) -> Frontier:
    """Run every fidelity of the accuracy study that is valid for a case, and compare each to the finest.

    The cache is not used, so times are those of a first run; compiled loops are warm. Raises `InputError`: a
    value that cannot be used, by field name; `SolveError`: fewer than two fidelities gave a whole table.

    Parameters
    ----------
    pair : GearPair, InternalGearPair or Checked
        What `Frontier.request` returns stands for pair, axes and options.
    axes : TableAxes, optional
    options : AnalysisOptions
        The accuracy decides which fidelity is marked as chosen; `positions` is 64 by default.
    fidelities : sequence of str, optional
        Names of fidelities to run; default all.
    full_contact : int, optional
        Positions, 1 to 64, at which full finite-element contact is run beside it, under all loads: of
        solid spur and internal pairs in plane strain, about 2.5 CPU s each; of external spur pairs in three
        dimensions where `model` is "3d" or flanks vary or are inclined across the face, 70 CPU s each.
    """
    checked = Frontier.request(pair, axes, options)
    if full_contact is not None:
        integer("full_contact", full_contact, 1, MOST_FULL_CONTACT)
    names = chosen("fidelities", fidelities, [fidelity.name for fidelity in FIDELITIES])
    outcomes, left_out = run_fidelities(
        [fidelity for fidelity in FIDELITIES if fidelity.name in names],
        checked,
        _warm_up,
        partial(_whole_table, checked),
        (MeshError, SolveError),
        progress,
    )
    read = [Outcome(outcome.fidelity, _result(outcome), outcome.cpu_seconds) for outcome in outcomes]
    errors = against_finest(read, _errors, _remaining)
    results = tuple(
        replace(outcome.result, **dict[str, Any](error)) for outcome, error in zip(read, errors, strict=True)
    )
    solves = outcomes[-1].result.status.size
    known = known_full_contact(checked.request.pair)
    study = Frontier(
        results, left_out, knee_above(results), _chosen_fidelity(checked), solves, known_full_contact=known
    )
    tables = {outcome.fidelity.name: outcome.result for outcome in outcomes}
    return study if full_contact is None else _beside(study, checked, full_contact, tables, progress)


def predicted_frontier(
    checked: Checked, fidelities: Sequence[str], full_contact: int | None, cache: Path | None
) -> dict[str, float]:
    """Predict the CPU seconds of the valid fidelities of finite elements, and of full contact, by name.

    By the quick model of the work that a mesh is chosen by; closed forms count for nothing.
    """
    seconds = {}
    for fidelity in FIDELITIES:
        if not isinstance(fidelity, _FiniteElementFidelity) or fidelity.name not in fidelities:
            continue
        if fidelity.refusal(checked) is None:
            own = fidelity.decided(fidelity.as_computed(checked))
            request, model = own.checked.request, own.checked.model
            work = effort(request.pair, own.plan, model, request.alignments)
            seconds[fidelity.name] = host_slowness(cache) * work
    if full_contact is not None and full_contact_refusal(checked) is None:
        seconds[NAME] = full_contact * position_seconds(checked)
    return seconds


def _warm_up(fidelities: Sequence[_Fidelity]) -> None:
    warm_up(across_face=any(fidelity.name.startswith("3d") for fidelity in fidelities))


def _whole_table(checked: Checked, fidelity: _Fidelity) -> SteDatabase:
    table = fidelity.run(checked)
    table.require_complete()
    return table


def _beside(
    study: Frontier, checked: Checked, positions: int, tables: dict[str, SteDatabase], progress: Progress
) -> Frontier:
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
