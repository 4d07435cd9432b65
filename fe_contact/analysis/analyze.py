"""The main flow: gear pair in, STE database out."""

from __future__ import annotations

import platform
from collections.abc import Callable, Mapping, Sequence
from importlib.metadata import version
from pathlib import Path

import numpy as np

from fe_contact.analysis.error_estimate import ErrorSources, error_sources
from fe_contact.analysis.pair_contact import PairContact, plane_compliances
from fe_contact.analysis.position_nodes import PositionNodes, adaptive_nodes, fixed_nodes
from fe_contact.analysis.request import Request, load_levels, refuse_beyond_plane
from fe_contact.analysis.tabulate import contact_fields, pair_facts, support_fields
from fe_contact.contact import ContactModel, ContactSolution
from fe_contact.effects import EFFECTS, ContactScene, LedgerEntry, compose
from fe_contact.geometry import GearPair
from fe_contact.mesh import MeshRecipe
from fe_contact.planning import Accuracy, StageClock, make_plan
from fe_contact.planning.plan import BASE_POSITIONS, TABLE_TOLERANCE, Plan
from fe_contact.ste import Metadata, SteDatabase
from fe_contact.ste.content_hash import content_hash
from fe_contact.ste.facts import SCHEMA_VERSION
from fe_contact.types import FloatArray, Json

Progress = Callable[[str, float], None]
SOLVER_VERSION = "1"
PACKAGES = ("lineofaction", "numpy", "scipy", "numba", "scikit-fem", "gmsh")


def analyze(
    pair: GearPair,
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
    case: Json | None = None,
    progress: Progress | None = None,
    cache: Path | None = None,
) -> SteDatabase:
    """Compute the static transmission error of a gear pair.

    Parameters
    ----------
    pair : GearPair
        Spur gears in this version.
    torques : sequence of float
        Torques on the driving gear in N m, increasing, > 0; or `normal_forces` in N.
    tolerance, level, time_budget
        Asked accuracy: relative error, "draft" | "standard" | "fine", or seconds; at most one.
    model : str
        "auto" (plane strain), "plane_strain" or "plane_stress".
    positions : int, optional
        Equally spaced positions; default: nodes placed so that interpolation keeps 0.2 % of peak-to-peak.
    misalignments, center_distance_changes : sequence of float
        m; only (0.0,) in a plane model.
    effects : mapping, optional
        Effect name to "on", "off" or "auto".
    case : dict, optional
        The case as the caller phrased it, echoed into the result and hashed; default: the request in SI
        units.
    progress : callable, optional
        Called as progress(stage, fraction).
    cache : Path, optional
        Directory of flank compliances.

    Returns
    -------
    SteDatabase
        Failed points hold NaN and their status.

    Raises
    ------
    InputError
        A value that cannot be used, by field name.
    MeshError, SolveError
        No acceptable mesh, or a linear system that cannot be solved.
    """
    clock = StageClock()
    report = progress or (lambda stage, fraction: None)
    refuse_beyond_plane(pair, misalignments, center_distance_changes)
    accuracy = Accuracy(tolerance, time_budget, level, model, positions)
    request = Request(pair, load_levels(pair, torques, normal_forces), accuracy, dict(effects or {}))
    contact_model, ledger = compose(ContactScene(pair, request.torque), request.effects, EFFECTS)
    plan = make_plan(pair, request.load, accuracy)
    fine = _pair_contact(request, plan, plan.recipes, clock, "compliance", report, cache)
    with clock.stage("contact"):
        nodes = _nodes(fine, contact_model, plan)
        report("contact", 0.5)
        candidates, solution = fine.solve(contact_model, nodes.position, plan.load)
        _, support = fine.solve(contact_model, nodes.position, plan.support)
        report("contact", 1.0)
    coarse = _pair_contact(request, plan, plan.coarse_recipes, clock, "error estimate", report, cache)
    with clock.stage("error estimate"):
        rough = coarse.solve(contact_model, nodes.position, plan.load)[1].deflection
        errors = error_sources(solution, rough, nodes.error)
    fields = contact_fields(candidates, solution, fine.contact_modulus) | support_fields(support)
    return SteDatabase(
        position=nodes.position,
        force=plan.load,
        torque=pair.torque(plan.load),
        misalignment=np.zeros(1),
        center_distance_change=np.zeros(1),
        pair=candidates.pair,
        no_load_transmission_error=solution.no_load[:, None, None],
        error_estimate=errors.total[:, :, None, None],
        facts=pair_facts(pair),
        metadata=_metadata(case or request.to_json(), plan, ledger, clock, errors, solution),
        **fields,
    )


def _pair_contact(
    request: Request,
    plan: Plan,
    recipes: tuple[MeshRecipe, MeshRecipe],
    clock: StageClock,
    stage: str,
    report: Progress,
    cache: Path | None,
) -> PairContact:
    """Compute or fetch the compliances of both gears."""
    report(stage, 0.0)
    with clock.stage(stage):
        compliances = plane_compliances(request.pair, plan, recipes, cache)
    report(stage, 1.0)
    return PairContact(request.pair, plan, compliances)


def _nodes(contact: PairContact, model: ContactModel, plan: Plan) -> PositionNodes:
    """Place the positions."""

    def solve(position: FloatArray) -> FloatArray:
        return contact.solve(model, position, plan.load)[1].deflection

    if plan.positions is not None:
        return fixed_nodes(plan.positions, solve)
    return adaptive_nodes(BASE_POSITIONS, solve, TABLE_TOLERANCE)


def _metadata(
    case: Json,
    plan: Plan,
    ledger: tuple[LedgerEntry, ...],
    clock: StageClock,
    errors: ErrorSources,
    solution: ContactSolution,
) -> Metadata:
    """Everything about the making of the table."""
    receipt = clock.to_json() | {
        "error_by_source": errors.to_json(),
        "plan": plan.to_json(),
        "newton_iterations_max": int(solution.iterations.max()),
        "residuals_max": solution.residuals.max(axis=(0, 1)).tolist(),
        "patch_outgrown_points": int(solution.beyond.sum()),
    }
    return Metadata(
        case=case,
        effect_ledger=[entry.to_json() for entry in ledger],
        receipt=receipt,
        content_hash=content_hash(case, SOLVER_VERSION, SCHEMA_VERSION),
        software_versions={"python": platform.python_version()} | {name: version(name) for name in PACKAGES},
    )
