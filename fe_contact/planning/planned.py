"""Choice of mesh and slices for a tolerance or a time, by the models of error and of cost.

A mesh is one of `MESHES` by its name; it is two-dimensional ("in the plane") or extruded over the face, which
is then cut into slices.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from bounds import engineering
from fe_contact.allowed_error import AllowedError
from fe_contact.contact import ContactModel
from fe_contact.geometry import ParallelAxes
from fe_contact.options import LEVELS, MEDIUM, MESHES, AnalysisOptions
from fe_contact.planning.cost_model import effort, predict_run
from fe_contact.planning.discretization import FINER_SLICES, FaceDiscretization
from fe_contact.planning.expected_curves import ExpectedCurves
from fe_contact.planning.expected_error import ExpectedError, expected_error, percent
from fe_contact.planning.model_error import is_relieved_helical
from fe_contact.planning.plan import make_plan
from fe_contact.types import FloatArray, Json


@dataclass(frozen=True)
class MeshOption:
    """A mesh with its slices."""

    level: str
    """"draft", "medium", "standard" or "fine"."""
    slices: int
    """Number of slices of the face; 1 in the plane."""
    error: ExpectedError
    effort: float
    """CPU seconds of a run on the host on which the cost model was measured, with an empty cache. The number
    does not depend on this host, so that every host makes the same choice.
    """

    @property
    def name(self) -> str:
        """Name of the mesh in words."""
        return self.level if self.slices == 1 else f"{self.level}, {self.slices} slices"


@dataclass(frozen=True)
class MeshChoice:
    """A mesh with its slices, the reason, and whether the request can be met."""

    option: MeshOption
    met: bool
    """Whether the models predict that the request is met."""
    reason: str
    """Reason of the choice, in words."""

    @property
    def level(self) -> str:
        """Level of the mesh."""
        return self.option.level

    @property
    def slices(self) -> int:
        """Slices of the face; 1 in the plane."""
        return self.option.slices

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {"level": self.level, "slices": self.slices, "met": self.met, "reason": self.reason}


def mesh_for_tolerance(tolerance: AllowedError, options: Sequence[MeshOption]) -> MeshChoice:
    """Return the option of least effort whose reducible error is expected to be within the tolerance.

    Where the scatter of runs is known, an option counts first by its prudent error, which nine runs of ten
    keep: a run that misses the tolerance costs a second run on a finer mesh. If no prudent error is within
    the tolerance, the expected errors count.

    If no expected error is within the tolerance either, the choice says so. Where the error of the plane
    alone exceeds the tolerance, it is the option of least effort whose numerical error is within it. Else it
    is the option with the smallest error.
    """
    within = [option for option in options if option.error.prudent <= tolerance.relative]
    within = within or [option for option in options if option.error.reducible <= tolerance.relative]
    if within:
        best = min(within, key=_effort)
        reason = f"expected error {best.error.text}{_probability_text(best, tolerance)}"
        return MeshChoice(best, met=True, reason=reason)
    fine_enough = [option for option in options if option.error.numerical <= tolerance.relative]
    plane_exceeds = min(option.error.plane for option in options) > tolerance.relative
    if fine_enough and plane_exceeds:
        best = min(fine_enough, key=_effort)
    else:
        best = min(options, key=lambda option: option.error.reducible)
    parts = f"mesh {percent(best.error.numerical)} %, plane {percent(best.error.plane)} %"
    return MeshChoice(best, met=False, reason=f"no mesh is expected within {tolerance.text} ({parts})")


def _probability_text(option: MeshOption, tolerance: AllowedError) -> str:
    """Return the text of the share of runs whose error is within the tolerance, and of the others' next mesh.

    It is empty where the scatter of runs is not known.
    """
    probability = option.error.probability(tolerance.relative)
    if probability is None:
        return ""
    finer = MESHES[min(MESHES.index(option.level) + 1, len(MESHES) - 1)]
    following = "standard" if finer == MEDIUM else finer  # a second pass does not use the medium mesh
    share = min(round(100.0 * probability), 99)
    return f", within the tolerance in {share} % of runs; others take a second pass, mesh {following} at most"


def mesh_for_time(
    budget: float, options: Sequence[MeshOption], seconds: Callable[[MeshOption], float]
) -> MeshChoice:
    """Return the most exact option that is predicted to fit into `budget` CPU seconds, else the cheapest."""
    for option in sorted(options, key=lambda o: (o.error.total, o.effort)):
        predicted = seconds(option)
        if predicted <= budget:
            return MeshChoice(option, met=True, reason=f"predicted {engineering(predicted, 2)} CPU s")
    minimum = min(options, key=_effort)
    reason = f"even the fastest mesh is predicted to take {engineering(seconds(minimum), 2)} CPU s"
    return MeshChoice(minimum, met=False, reason=reason)


def _effort(option: MeshOption) -> float:
    return option.effort


def mesh_options(
    pair: ParallelAxes,
    load: FloatArray,
    options: AnalysisOptions,
    model: ContactModel,
    alignments: tuple[int, int] = (1, 1),
    curves: ExpectedCurves | None = None,
    *,
    model_chosen: bool = False,
) -> list[MeshOption]:
    """Return all meshes and numbers of slices of a request, `LEVELS` first.

    The parameters are those of `chosen_mesh`.
    """

    def option(level: str, slices: int | None = None) -> MeshOption:
        plan = make_plan(pair, load, options, model, level, slices)
        error = expected_error(pair, plan, curves, model_chosen=model_chosen)
        return MeshOption(level, plan.discretization.slices, error, effort(pair, plan, model, alignments))

    if options.level is not None:
        return [option(options.level)]
    meshes = [option(level) for level in LEVELS]
    discretization = make_plan(pair, load, options, model, "draft").discretization
    if isinstance(discretization, FaceDiscretization):  # any level tells whether the model is extruded
        levels = MESHES if is_relieved_helical(pair) else LEVELS
        meshes += [option(level) for level in levels if level not in LEVELS]
        meshes += [option(level, n) for level in levels for n in FINER_SLICES]
    return meshes


def chosen_mesh(
    pair: ParallelAxes,
    load: FloatArray,
    options: AnalysisOptions,
    model: ContactModel,
    alignments: tuple[int, int] = (1, 1),
    cache: Path | None = None,
    curves: ExpectedCurves | None = None,
    *,
    model_chosen: bool = False,
) -> MeshChoice:
    """Choose mesh and slices by the tolerance, without one by the time budget.

    Parameters
    ----------
    load : ndarray
        Requested normal forces in N.
    alignments : (int, int)
        Numbers of misalignments and of center distances of the table.
    cache : Path, optional
        Directory of compliances and of the measured speed of this host. The choice by a time budget depends
        on them; the choice by a tolerance does not.
    curves : ExpectedCurves, optional
        Estimate of the transmission error of the case.
    model_chosen : bool
        Whether the caller chose the model; a tolerance then does not apply to the error of the plane.
    """

    def seconds(choice: MeshOption) -> float:
        plan = make_plan(pair, load, options, model, choice.level, choice.slices)
        return predict_run(pair, plan, model, alignments, cache).cpu_seconds

    if options.level is None and options.tolerance is None and options.time_budget is None:
        options, reason = replace(options, level="standard"), "nothing asked"
    else:
        reason = "as requested"
    meshes = mesh_options(pair, load, options, model, alignments, curves, model_chosen=model_chosen)
    if options.level is not None:
        return MeshChoice(meshes[0], met=True, reason=reason)
    if options.tolerance is not None:
        return mesh_for_tolerance(options.tolerance, meshes)
    return mesh_for_time(options.time_budget or 0.0, meshes, seconds)
