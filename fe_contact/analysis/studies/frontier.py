"""Frontier of error against time of every fidelity of the accuracy study, on one case."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

import model_studies
from bounds.brief import brief
from fe_contact.analysis.analyze import analyze
from fe_contact.analysis.request.model_choice import decide
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import as_checked
from fe_contact.analysis.studies.closed_form_fidelity import ISO6336, POSITIONS, THIN_SLICES
from fe_contact.analysis.studies.fidelity import Fidelity
from fe_contact.analysis.studies.fidelity_result import (
    FidelityResult,
    fidelity_errors,
    fidelity_result,
    remaining_errors,
)
from fe_contact.analysis.studies.finite_element_fidelity import FiniteElementFidelity
from fe_contact.analysis.studies.full_contact_cost import FullContactLevel, known_full_contact
from fe_contact.analysis.studies.full_contact_record import (
    NAME,
    NO_RECORD,
    FullContactComparison,
    FullContactRecord,
    compare_full_contact,
    full_contact_records,
    record_of,
)
from fe_contact.errors import MeshError, SolveError, chosen, integer
from fe_contact.geometry import Gear, GearPair, ParallelAxes
from fe_contact.options import MEDIUM, AnalysisOptions, TableAxes
from fe_contact.planning.cost_model import effort
from fe_contact.ste import SteDatabase
from model_studies import Outcome, Progress, against_finest, knee_above, run_fidelities, silent
from model_studies.host_speed import host_slowness

MAX_FULL_CONTACT = 64


FIDELITIES: tuple[Fidelity, ...] = (
    ISO6336,
    THIN_SLICES,
    FiniteElementFidelity("plane_strain", "2-D plane strain", "plane_strain", "standard"),
    FiniteElementFidelity("corrected_draft", "2-D corrected for the width, draft", "auto", "draft"),
    FiniteElementFidelity("corrected", "2-D corrected for the width, standard", "auto", "standard"),
    FiniteElementFidelity("corrected_fine", "2-D corrected for the width, fine", "auto", "fine"),
    FiniteElementFidelity("3d_draft", "3-D, draft", "3d", "draft"),
    FiniteElementFidelity("3d_standard", "3-D, standard", "3d", "standard"),
    FiniteElementFidelity("3d_fine", "3-D, fine, 23 slices", "3d", "fine", 23),
)


@lru_cache(maxsize=2)
def warm_up(*, across_face: bool) -> None:
    """Analyze a narrow pair once per process, in the plane and, if requested, over the face."""
    gear = Gear(teeth=20, normal_module=1e-3, face_width=2e-3, bore_diameter=10e-3)
    pair = GearPair(gear, gear, center_distance=20e-3)
    for model in ("auto", "3d") if across_face else ("auto",):
        analyze(pair, normal_forces=[10.0], level="draft", model=model, positions=8)


@brief
@dataclass(frozen=True)
class Frontier(model_studies.Frontier[FidelityResult]):
    """The accuracy study of one case.

    Attributes
    ----------
    results, omitted, knee, chosen
        Of every accuracy study.
    """

    solves: int
    """Positions x loads x alignments of every table."""
    full_contact: FullContactComparison | None = None
    """Recorded full finite-element contact of the same pair, if it was requested and is recorded."""
    known_full_contact: tuple[FullContactLevel, ...] = ()
    """Known cost of full finite-element contact for this pair; empty for any other."""

    @staticmethod
    def request(pair: ParallelAxes | Checked, axes: TableAxes | None, options: AnalysisOptions) -> Checked:
        """Check the request that every fidelity computes, once; a checked request passes unchanged."""
        return as_checked(pair, axes, replace(options, positions=options.positions or POSITIONS))


def frontier(
    pair: ParallelAxes | Checked,
    axes: TableAxes | None = None,
    options: AnalysisOptions = AnalysisOptions(),  # noqa: B008 (frozen)
    *,
    fidelities: Sequence[str] | None = None,
    full_contact: int | None = None,
    records: Sequence[FullContactRecord] | None = None,
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
        Positions, 1 to 64, at which recorded full finite-element contact of the pair is compared with the
        finest fidelity, under the recorded loads between those of the case.
    records : sequence of FullContactRecord, optional
        Of one's own; default `full_contact_records()`, of a few pairs.
    """
    checked = Frontier.request(pair, axes, options)
    if full_contact is not None:
        integer("full_contact", full_contact, 1, MAX_FULL_CONTACT)
    names = chosen("fidelities", fidelities, [fidelity.name for fidelity in FIDELITIES])
    outcomes, omitted = run_fidelities(
        [fidelity for fidelity in FIDELITIES if fidelity.name in names],
        checked,
        _warm_up,
        partial(_complete_table, checked),
        (MeshError, SolveError),
        progress,
        predicted_frontier(checked, names, None),
    )
    read = [Outcome(outcome.fidelity, fidelity_result(outcome), outcome.cpu_seconds) for outcome in outcomes]
    errors = against_finest(read, fidelity_errors, remaining_errors)
    results = tuple(
        replace(outcome.result, **dict[str, Any](error)) for outcome, error in zip(read, errors, strict=True)
    )
    solves = outcomes[-1].result.status.size
    known = known_full_contact(checked.request.pair)
    study = Frontier(
        results, omitted, knee_above(results), chosen_fidelity(checked), solves, known_full_contact=known
    )
    if full_contact is None:
        return study
    record = record_of(checked, full_contact_records() if records is None else records)
    tables = {outcome.fidelity.name: outcome.result for outcome in outcomes}
    return _beside_full_contact(study, record, full_contact, tables)


def _beside_full_contact(
    study: Frontier, record: FullContactRecord | None, positions: int, tables: Mapping[str, SteDatabase]
) -> Frontier:
    """Return a study with its finest table beside recorded full contact, or the reason why there is none."""
    if record is None:
        return replace(study, omitted=study.omitted | {NAME: NO_RECORD})
    at_positions, plane_strain = record.at_positions(positions), tables.get("plane_strain")
    compared = compare_full_contact(at_positions, tables[study.reference.name], plane_strain)
    return replace(study, full_contact=compared)


def predicted_frontier(checked: Checked, fidelities: Sequence[str], cache: Path | None) -> dict[str, float]:
    """Predict the CPU seconds of the valid fidelities of finite elements, by name.

    By the quick model of the work that a mesh is chosen by; closed forms and records count for nothing.
    """
    seconds = {}
    for fidelity in FIDELITIES:
        if not isinstance(fidelity, FiniteElementFidelity) or fidelity.name not in fidelities:
            continue
        if fidelity.refusal(checked) is None:
            choice = fidelity.decision(fidelity.as_computed(checked))
            request, model = choice.checked.request, choice.checked.model
            work = effort(request.pair, choice.plan, model, request.alignments)
            seconds[fidelity.name] = host_slowness(cache) * work
    return seconds


def _warm_up(fidelities: Sequence[Fidelity]) -> None:
    warm_up(across_face=any(fidelity.name.startswith("3d") for fidelity in fidelities))


def _complete_table(checked: Checked, fidelity: Fidelity) -> SteDatabase:
    table = fidelity.run(checked)
    table.require_complete()
    return table


def chosen_fidelity(checked: Checked) -> str | None:
    """Return the name of the fidelity that a request's own model and mesh are; None if none is.

    Plane strain has one fidelity, whose error is the model's: it stands for all its meshes.
    """
    choice = decide(checked)
    level, model = choice.mesh.level, choice.checked.model
    if level == MEDIUM:
        return None
    if model.across_face:
        return f"3d_{level}"
    if model.finite_width:
        return "corrected" if level == "standard" else f"corrected_{level}"
    return None if checked.request.options.model == "plane_stress" else "plane_strain"
