"""From what the caller asks for to a plan: mesh and slices are chosen by the models of error and cost."""

from __future__ import annotations

from pathlib import Path

from fe_contact.contact import ContactModel
from fe_contact.geometry import ParallelAxes
from fe_contact.options import LEVELS, AnalysisOptions
from fe_contact.planning.cost_model import predict_run
from fe_contact.planning.discretization import FINER_SLICES, FaceDiscretization
from fe_contact.planning.effort import effort
from fe_contact.planning.error_model import expected_error
from fe_contact.planning.expected_curves import ExpectedCurves
from fe_contact.planning.mesh_choice import MeshChoice, MeshOption, mesh_for_time, mesh_for_tolerance
from fe_contact.planning.plan import Plan, make_plan
from fe_contact.types import FloatArray


def planned(
    pair: ParallelAxes,
    load: FloatArray,
    options: AnalysisOptions,
    model: ContactModel,
    alignments: tuple[int, int] = (1, 1),
    cache: Path | None = None,
) -> Plan:
    """Return the plan of a request: with the mesh and slices that its accuracy asks for.

    Parameters are those of `chosen_mesh`.
    """
    choice = chosen_mesh(pair, load, options, model, alignments, cache)
    return make_plan(pair, load, options, model, choice.level, choice.slices)


def chosen_mesh(
    pair: ParallelAxes,
    load: FloatArray,
    options: AnalysisOptions,
    model: ContactModel,
    alignments: tuple[int, int] = (1, 1),
    cache: Path | None = None,
    curves: ExpectedCurves | None = None,
) -> MeshChoice:
    """Choose mesh and slices by the tolerance, without one by the time budget.

    Parameters
    ----------
    pair : GearPair or InternalGearPair
    load : ndarray
        Requested normal forces in N.
    options : AnalysisOptions
    model : ContactModel
    alignments : (int, int)
        Numbers of misalignments and of center distances.
    cache : Path, optional
        Directory of compliances and of what is known of the host: a time depends on them, a tolerance does
        not.
    curves : ExpectedCurves, optional
        What is known of the transmission error of the case.
    """

    def option(level: str, slices: int | None = None) -> MeshOption:
        plan = make_plan(pair, load, options, model, level, slices)
        error = expected_error(pair, plan, curves)
        return MeshOption(level, plan.discretization.slices, error, effort(pair, plan, model, alignments))

    def seconds(choice: MeshOption) -> float:
        plan = make_plan(pair, load, options, model, choice.level, choice.slices)
        return predict_run(pair, plan, model, alignments, cache).cpu_seconds

    if options.level is not None:
        return MeshChoice(option(options.level), True, "as requested")
    if options.tolerance is None and options.time_budget is None:
        return MeshChoice(option("standard"), True, "nothing asked")
    meshes = [option(level) for level in LEVELS]
    usual = make_plan(pair, load, options, model, "draft").discretization
    if isinstance(usual, FaceDiscretization):
        meshes += [option(level, n) for level in LEVELS for n in FINER_SLICES]
    if options.tolerance is not None:
        return mesh_for_tolerance(options.tolerance, meshes)
    return mesh_for_time(options.time_budget or 0.0, meshes, seconds)
