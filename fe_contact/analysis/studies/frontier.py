"""Error against time of every fidelity of the accuracy study, on one case."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import model_studies
from fe_contact.analysis.request.model_choice import decide
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import check_request
from fe_contact.analysis.studies.accuracy_study import FIDELITIES, Fidelity
from fe_contact.analysis.studies.accuracy_study.full_contact import (
    ORIGIN,
    FullContactLevel,
    known_full_contact,
)
from fe_contact.analysis.studies.fidelity_result import FidelityResult, fidelity_results
from fe_contact.analysis.studies.measured_full_contact import (
    NAME,
    MeasuredFullContact,
    full_contact_refusal,
    measure_full_contact,
)
from fe_contact.analysis.studies.warm_up import warm_up
from fe_contact.checks import chosen, integer
from fe_contact.errors import MeshError, SolveError
from fe_contact.geometry import ParallelAxes
from fe_contact.options import AnalysisOptions, TableAxes
from fe_contact.ste import SteDatabase
from fe_contact.types import Json
from model_studies import Progress, called, knee_above, run_fidelities, silent

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
    results = fidelity_results(outcomes)
    solves = outcomes[-1].result.status.size
    known = known_full_contact(checked.request.pair)
    study = Frontier(
        results, left_out, knee_above(results), chosen_fidelity(checked), solves, known_full_contact=known
    )
    tables = {outcome.fidelity.name: outcome.result for outcome in outcomes}
    return study if full_contact is None else _beside(study, checked, full_contact, tables, progress)


def _warm_up(fidelities: Sequence[Fidelity]) -> None:
    """Load and compile what the fidelities run."""
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


def chosen_fidelity(checked: Checked) -> str | None:
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
