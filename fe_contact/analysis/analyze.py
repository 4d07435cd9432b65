"""The main flow: gear pair in, STE database out."""

from __future__ import annotations

import platform
from collections.abc import Callable, Mapping, Sequence
from importlib.metadata import version
from pathlib import Path

from fe_contact.analysis.error_estimate import ErrorSources, estimate_errors, worst_residual
from fe_contact.analysis.pair_contact import pair_contact
from fe_contact.analysis.position_nodes import table_nodes
from fe_contact.analysis.request import Request, check_request
from fe_contact.analysis.table_places import Places, table_places
from fe_contact.analysis.tabulate import pair_facts, table_fields, table_support
from fe_contact.contact import ContactProblem, ContactSolution
from fe_contact.effects import LedgerEntry
from fe_contact.geometry import GearPair
from fe_contact.planning import Plan, StageClock, make_plan
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
        External gears on parallel axes, spur or helical.
    torques : sequence of float
        Torques on the driving gear in N m, increasing, > 0; or `normal_forces` in N.
    tolerance, level, time_budget
        Asked accuracy: relative error, "draft" | "standard" | "fine", or seconds; at most one.
    model : str
        "auto" (three dimensions where the scene acts across the face, else plane strain), "plane_strain",
        "plane_stress" or "3d".
    positions : int, optional
        Equally spaced positions; default: nodes placed so that interpolation keeps 0.2 % of peak-to-peak.
    misalignments, center_distance_changes : sequence of float
        Table axes in m, increasing. Misalignment is the growth of the gap over the common face width in the
        plane of action, zero at its middle.
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
    checked = check_request(
        pair,
        torques=torques,
        normal_forces=normal_forces,
        tolerance=tolerance,
        level=level,
        time_budget=time_budget,
        model=model,
        positions=positions,
        misalignments=misalignments,
        center_distance_changes=center_distance_changes,
        effects=effects,
    )
    request = checked.request
    plan = make_plan(pair, request.load, request.accuracy, checked.model)
    fine = _places(request, plan, clock, report, cache, coarse=False)
    with clock.stage("contact"):
        nodes = table_nodes(fine, plan)
        report("contact", 0.3)
        solved = [place.solve(nodes.position, plan.load) for place in fine.places]
        support = [place.solve(nodes.position, plan.support) for place in fine.places]
        report("contact", 1.0)
    coarse = _places(request, plan, clock, report, cache, coarse=True)
    with clock.stage("error estimate"):
        rough = [place.solve(nodes.position, plan.load)[1] for place in coarse.places]
        errors = estimate_errors(fine, [solution for _, solution in solved], rough, nodes, plan)
    return SteDatabase(
        position=nodes.position,
        force=plan.load,
        torque=pair.torque(plan.load),
        misalignment=request.misalignment,
        center_distance_change=request.center_distance_change,
        facts=pair_facts(pair),
        error_estimate=errors.total,
        metadata=_metadata(case or request.to_json(), plan, checked.ledger, clock, errors, solved),
        **table_fields(fine, solved),
        **table_support(fine, support),
    )


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
    ledger: tuple[LedgerEntry, ...],
    clock: StageClock,
    errors: ErrorSources,
    solved: list[tuple[ContactProblem, ContactSolution]],
) -> Metadata:
    """Everything about the making of the table."""
    receipt = clock.to_json() | {
        "error_by_source": errors.to_json(),
        "plan": plan.to_json(),
        "newton_iterations_max": max(int(solution.iterations.max()) for _, solution in solved),
        "residuals_max": max(worst_residual(solution) for _, solution in solved),
        "patch_outgrown_points": sum(int(solution.beyond.sum()) for _, solution in solved),
    }
    return Metadata(
        case=case,
        effect_ledger=[entry.to_json() for entry in ledger],
        receipt=receipt,
        content_hash=content_hash(case, SOLVER_VERSION, SCHEMA_VERSION),
        software_versions={"python": platform.python_version()} | {name: version(name) for name in PACKAGES},
    )
