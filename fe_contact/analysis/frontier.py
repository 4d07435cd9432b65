"""Error against time of every fidelity of the accuracy study, on one case."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fe_contact.allowed_error import AllowedError
from fe_contact.analysis.accuracy_study import FIDELITIES, Fidelity
from fe_contact.analysis.accuracy_study.full_contact import ORIGIN, FullContactLevel, known_full_contact
from fe_contact.analysis.fidelity_result import FidelityResult, fidelity_results
from fe_contact.analysis.measured_full_contact import (
    NAME,
    MeasuredFullContact,
    full_contact_refusal,
    measure_full_contact,
)
from fe_contact.analysis.model_choice import decide
from fe_contact.analysis.pareto import knee_of
from fe_contact.analysis.request import Checked
from fe_contact.analysis.request_check import check_request
from fe_contact.analysis.warm_up import warm_up
from fe_contact.checks import integer
from fe_contact.errors import InputError, MeshError, SolveError
from fe_contact.geometry import ParallelAxes
from fe_contact.progress import Progress, silent
from fe_contact.ste import SteDatabase
from fe_contact.types import FloatArray, Json

POSITIONS = 64
MOST_FULL_CONTACT = 64


@dataclass(frozen=True)
class Frontier:
    """The accuracy study of one case.

    Attributes
    ----------
    results : tuple of FidelityResult
        In the order of their cost; the last one is the reference.
    left_out : dict
        Name of a fidelity to the reason why it was not run.
    solves : int
        Positions x loads x alignments of every table.
    knee : str or None
        The fidelity after which time buys least; None with fewer than three fidelities on the front.
    chosen : str or None
        The fidelity that the case's accuracy asks for.
    full_contact : MeasuredFullContact, optional
        Full finite-element contact of the same case, if it was requested and could be run.
    known_full_contact : tuple of FullContactLevel
        What full finite-element contact is known to cost on this very pair; empty on any other.
    """

    results: tuple[FidelityResult, ...]
    left_out: dict[str, str]
    solves: int
    knee: str | None
    chosen: str | None
    full_contact: MeasuredFullContact | None = None
    known_full_contact: tuple[FullContactLevel, ...] = ()

    @property
    def reference(self) -> FidelityResult:
        """The finest fidelity that was run."""
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
                for level in self.known_full_contact
            ],
            "full_finite_element_contact_origin": ORIGIN,
        } | ({} if self.full_contact is None else {NAME: self.full_contact.to_json(self.solves)})


def frontier(
    pair: ParallelAxes,
    *,
    torques: Sequence[float] | FloatArray | None = None,
    normal_forces: Sequence[float] | FloatArray | None = None,
    tolerance: AllowedError | float | None = None,
    level: str | None = None,
    time_budget: float | None = None,
    model: str = "auto",
    positions: int | None = None,
    misalignments: Sequence[float] = (0.0,),
    center_distance_changes: Sequence[float] = (0.0,),
    effects: Mapping[str, str] | None = None,
    fidelities: Sequence[str] | None = None,
    full_contact: int | None = None,
    progress: Progress | None = None,
) -> Frontier:
    """Run every fidelity of the accuracy study that is valid for a case, and compare each to the finest.

    Nothing is taken from the cache, so that times are those of a first run; compiled loops are warm.

    Parameters
    ----------
    pair, torques, normal_forces, tolerance, level, time_budget, model, misalignments, \
center_distance_changes, effects, progress
        As for `analyze`; the accuracy decides which fidelity is marked as chosen.
    positions : int, optional
        Equally spaced positions of every table; default 64.
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
    if full_contact is not None:
        integer("full_contact", full_contact, 1, MOST_FULL_CONTACT)
    asked = selected(fidelities)
    left_out = {
        fidelity.name: reason for fidelity in asked if (reason := fidelity.refusal(checked)) is not None
    }
    valid = [fidelity for fidelity in asked if fidelity.name not in left_out]
    return _run_study(checked, valid, left_out, full_contact, progress or silent)


def selected(names: Sequence[str] | None) -> tuple[Fidelity, ...]:
    """Return the fidelities of these names in the order of their cost, all if None.

    Raises
    ------
    InputError
        There is no such fidelity.
    """
    known = [fidelity.name for fidelity in FIDELITIES]
    for name in names or ():
        if name not in known:
            raise InputError("fidelities", name, f"among {', '.join(known)}")
    return tuple(fidelity for fidelity in FIDELITIES if names is None or fidelity.name in names)


def _run_study(
    checked: Checked,
    fidelities: Sequence[Fidelity],
    left_out: dict[str, str],
    full_contact: int | None,
    progress: Progress,
) -> Frontier:
    """Run the fidelities, compare, mark."""
    warm_up(across_face=any(fidelity.name.startswith("3d") for fidelity in fidelities))
    tables: dict[str, SteDatabase] = {}
    for count, fidelity in enumerate(fidelities):
        progress("ladder", count / len(fidelities))
        try:
            table = fidelity.run(checked, silent, None)
            table.require_complete()
            tables[fidelity.name] = table
        except (MeshError, SolveError) as error:
            left_out = left_out | {fidelity.name: str(error)}
        except MemoryError:
            left_out = left_out | {fidelity.name: "out of memory"}
    progress("ladder", 1.0)
    if len(tables) < 2:
        raise SolveError(f"an error needs two fidelities to compare; left out: {left_out}")
    results = fidelity_results([fidelity for fidelity in fidelities if fidelity.name in tables], tables)
    solves = tables[results[-1].name].status.size
    known = known_full_contact(checked.request.pair)
    found = Frontier(
        results, left_out, solves, _knee(results), chosen_fidelity(checked), known_full_contact=known
    )
    return found if full_contact is None else _beside(found, checked, full_contact, tables, progress)


def _beside(
    found: Frontier, checked: Checked, positions: int, tables: dict[str, SteDatabase], progress: Progress
) -> Frontier:
    """Add full contact of the case, or why there is none."""
    reason = full_contact_refusal(checked)
    if reason is None:
        try:
            measured = measure_full_contact(checked, positions, progress)
            compared = measured.compared(tables[found.reference.name], tables.get("plane_strain"))
            return replace(found, full_contact=compared)
        except SolveError as error:
            reason = str(error)
    return replace(found, left_out=found.left_out | {NAME: reason})


def _knee(results: Sequence[FidelityResult]) -> str | None:
    """Return the knee; differences below the reference's own error say nothing."""
    floor = results[-1].error if np.isfinite(results[-1].error) else 0.0
    pairs = [result for result in results if np.isfinite(result.error)]
    return knee_of({result.name: (result.cpu_seconds, max(result.error, floor)) for result in pairs})


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
    return None if checked.request.accuracy.model == "plane_stress" else "plane_strain"
