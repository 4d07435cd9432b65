"""The main flow: from a checked request to the STE database."""

from __future__ import annotations

import platform
from collections.abc import Callable
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path

import numpy as np

from fe_contact.analysis.contact_receipt import contact_receipt
from fe_contact.analysis.judged_table import judged_table, unjudged_table
from fe_contact.analysis.pair_contact import pair_contact
from fe_contact.analysis.position_nodes import PositionNodes
from fe_contact.analysis.request import Checked, Request
from fe_contact.analysis.table_nodes import table_nodes
from fe_contact.analysis.table_places import Places, table_places
from fe_contact.analysis.tabulate import pair_facts, table_fields, table_support
from fe_contact.contact import ContactProblem, ContactSolution
from fe_contact.planning import Plan, Prediction, expected_error, planned, predict_run
from fe_contact.planning.cost_model import log_name
from fe_contact.planning.run_log import record
from fe_contact.stage_clock import StageClock
from fe_contact.ste import Metadata, SteDatabase
from fe_contact.ste.content_hash import content_hash
from fe_contact.ste.facts import SCHEMA_VERSION
from fe_contact.types import FloatArray, Json

Progress = Callable[[str, float], None]
SOLVER_VERSION = "4"
PACKAGES = ("lineofaction", "numpy", "scipy", "numba", "scikit-fem", "gmsh")


def compute_database(checked: Checked, case: Json, report: Progress, cache: Path | None) -> SteDatabase:
    """Compute the table of a checked request.

    Parameters
    ----------
    checked : Checked
    case : dict
        Echoed into the result and hashed.
    report : callable
        Called as report(stage, fraction).
    cache : Path, optional
        Directory of flank compliances.
    """
    clock = StageClock()
    request = checked.request
    full = request.accuracy.receipt == "full"
    with clock.stage("planning"):
        wish = request.pair, request.load, request.accuracy, checked.model
        plan = planned(*wish, request.alignments, cache)
        prediction = predict_run(request.pair, plan, checked.model, request.alignments, cache)
    fine = _places(request, plan, clock, report, cache, coarse=False)
    with clock.stage("contact"):
        nodes = table_nodes(fine, plan, measured=full)
        report("contact", 0.3)
        solved = _solved(fine, nodes, plan.load)
        support = _solved(fine, nodes, plan.support)
        table = _table(request, fine, nodes, solved, support)
        found = contact_receipt(solved, support)
        report("contact", 1.0)
    judged = unjudged_table(table, fine, plan)
    if full:
        coarse = _places(request, plan, clock, report, cache, coarse=True)
        with clock.stage("error estimate"):
            judged = judged_table(table, fine, coarse, solved, nodes, checked, plan)
        spent = {log_name(prediction.kind, name): seconds for name, seconds in clock.seconds.items()}
        record(cache, prediction.logged, spent)
    metadata = _metadata(case, plan, checked, clock, judged.to_json() | found)
    metadata.receipt["prediction"] = _predicted(prediction, plan, request)
    return replace(table, error_estimate=judged.band, curve_error=judged.curve_error, metadata=metadata)


def _table(
    request: Request,
    places: Places,
    nodes: PositionNodes,
    solved: list[tuple[ContactProblem, ContactSolution]],
    support: list[tuple[ContactProblem, ContactSolution]],
) -> SteDatabase:
    """Assemble the table, its errors not yet estimated."""
    position = (np.arange(places.period)[:, None] + nodes.position).ravel()
    return SteDatabase(
        position=position,
        force=request.load,
        torque=request.torque,
        misalignment=request.misalignment,
        center_distance_change=request.center_distance_change,
        facts=pair_facts(request.pair),
        period=places.period,
        error_estimate=np.full((position.size, request.load.size, *places.shape), np.nan),
        metadata=Metadata(),
        **table_fields(places, solved),
        **table_support(places, support),
    )


def _predicted(prediction: Prediction, plan: Plan, request: Request) -> Json:
    """Return what was expected of the run before it began, to stand beside what happened."""
    error = expected_error(request.pair, plan.discretisation, plan.level)
    return prediction.to_json() | {"error": error.to_json()}


def _solved(
    places: Places, nodes: PositionNodes, load: FloatArray
) -> list[tuple[ContactProblem, ContactSolution]]:
    """Solve every place at the positions of all base pitches."""
    pitches = np.arange(places.period)
    return [place.solve_pitches(nodes.position, load, pitches) for place in places.places]


def _places(
    request: Request, plan: Plan, clock: StageClock, report: Progress, cache: Path | None, *, coarse: bool
) -> Places:
    """Compute or fetch the compliances of both gears, and lay out the table over them."""
    stage = "error estimate" if coarse else "compliance"
    report(stage, 0.0)
    with clock.stage(stage):
        nominal = pair_contact(request.pair, plan, cache, coarse)
    report(stage, 1.0)
    return table_places(request.scene, request.choices, nominal)


def _metadata(
    case: Json,
    plan: Plan,
    checked: Checked,
    clock: StageClock,
    found: Json,
) -> Metadata:
    """Everything about the making of the table; `found` is what was found of its errors and its contact."""
    receipt = clock.to_json() | found | {"plan": plan.to_json()}
    if checked.cycle is not None:
        receipt["predicted"] = checked.cycle.to_json()
    return Metadata(
        case=case,
        effect_ledger=[entry.to_json() for entry in checked.ledger],
        receipt=receipt,
        content_hash=content_hash(case, SOLVER_VERSION, SCHEMA_VERSION),
        software_versions=software_versions(),
    )


def software_versions() -> dict[str, str]:
    """Return what a result was made with."""
    return {"python": platform.python_version()} | {name: version(name) for name in PACKAGES}
