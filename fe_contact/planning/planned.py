"""From what the caller asks for to a plan: mesh and slices are chosen by the models of error and cost."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bounds import engineering
from fe_contact.allowed_error import RELATIVE, AllowedError
from fe_contact.contact import ContactModel
from fe_contact.geometry import ParallelAxes
from fe_contact.geometry.finite_width import finite_width_excess
from fe_contact.options import LEVELS, AnalysisOptions
from fe_contact.planning.cost_model import effort, predict_run
from fe_contact.planning.model_error import helical_share, in_small_displacements, model_errors
from fe_contact.planning.plan import (
    FINER_SLICES,
    SLICE_ORDER,
    FaceDiscretization,
    Plan,
    make_plan,
)
from fe_contact.planning.plane_bias import plane_bias
from fe_contact.ste.plane_bias import PlaneBias
from fe_contact.types import FloatArray, Json

# Mean and peak-to-peak transmission error as expected before anything is computed.


_PLANE_RIPPLE, _SPUR_RIPPLE, _HELICAL_RIPPLE = 0.4, 0.4, 0.15
"""Peak-to-peak over mean of usual pairs: in the plane, over the face of spur and of helical pairs."""

_PLANE = {"draft": (8e-4, 1.2e-3), "standard": (2.6e-4, 2.6e-4), "fine": (5.4e-5, 5e-5)}
_SPUR = {"draft": (2.2e-3, 1.1e-3), "standard": (1.1e-3, 6e-4), "fine": (4.6e-4, 4.6e-4)}
_HELICAL = {"draft": (5e-3, 3e-3), "standard": (1.8e-3, 8.5e-4), "fine": (8e-4, 4e-4)}
_RELIEVED = {"draft": (4e-3, 1.8e-3), "standard": (1.6e-3, 4.5e-4), "fine": (6e-4, 2.3e-4)}
"""Mesh: of mean and of peak-to-peak in parts of what the load adds to the mean. In the plane; over the face
of spur pairs; of helical pairs with plain and with modified profiles, whose contact lines end under less
load."""
_HELICAL_SLICES, _SPUR_SLICES, _SLICES = 7e-4, 5e-5, 15
"""Peak-to-peak at so many slices in parts of the same: of helical pairs times the overlap ratio."""
_CORRECTION = 0.03
"""Error of the correction for a finite width over what it is expected to correct."""
_WIDTH_RIPPLE = 0.45
"""Peak-to-peak over mean of usual spur pairs."""
_PLANE_POSITIONS, _FACE_POSITIONS = 0.14, 0.55
"""Error of peak-to-peak between positions over what their search allows."""


@dataclass(frozen=True)
class ExpectedCurves:
    """Mean and peak-to-peak STE of some curves of a table."""

    force: FloatArray
    """Normal force, N. Shape (C,)."""
    added: FloatArray
    """Mean less that at no load, m. Shape (C,)."""
    mean: FloatArray
    peak_to_peak: FloatArray
    """`mean`, `peak_to_peak`: m. Shape (C,) each."""
    allowed: AllowedError
    """Says below which size errors count absolutely."""
    absolute: bool = True
    """Whether these are sizes of the case; False: parts of its mean, as usual pairs have them."""

    @property
    def scale(self) -> FloatArray:
        """Sizes (2, C) of which errors of mean and peak-to-peak are parts, m."""
        return self.allowed.scale(np.stack([self.mean, self.peak_to_peak]))


def _usual_curves(pair: ParallelAxes, plan: Plan) -> ExpectedCurves:
    """Return those of usual pairs, whose mean is 1."""
    unity = np.ones(plan.load.size)
    across_face = isinstance(plan.discretization, FaceDiscretization)
    spur = _SPUR_RIPPLE if across_face else _PLANE_RIPPLE
    ripple = spur + helical_share(pair) * (_HELICAL_RIPPLE - spur)
    return ExpectedCurves(plan.load, unity, unity, ripple * unity, RELATIVE, absolute=False)


# Prediction of the error that a run will state of a model, a mesh and slices.


@dataclass(frozen=True)
class ExpectedError:
    """Error of mean or peak-to-peak STE, whichever is worse, at the load where it is largest.

    Parts are of the size that a tolerance counts by: of the quantity or, where that is less, of the size at
    which the floor holds.
    """

    mesh: float
    """Finite elements."""
    slices: float
    """Slices of the face; 0 in the plane."""
    positions: float
    """Interpolation between positions."""
    plane: float
    """The plane standing in for three dimensions."""
    method: float
    """What the method leaves out of full contact, whatever the mesh (`model_error`)."""
    mean: float | None = None
    peak_to_peak: float | None = None
    """`mean`, `peak_to_peak`: The largest errors over the loads without `bias`, m; None where no size is
    known before the run.
    """
    chosen: bool = False
    """Whether the caller chose the model, so that no run of this request lowers `plane`."""
    bias: PlaneBias | None = None
    """What a plane leaves out where it is not corrected; `plane` is its size then."""

    @property
    def numerical(self) -> float:
        """The part that finer meshes, more slices and positions lower."""
        return float(np.sqrt(self.mesh**2 + self.slices**2 + self.positions**2))

    @property
    def bought(self) -> float:
        """The part that work lowers, to which a tolerance applies: with the plane, unless it was chosen."""
        return self.numerical if self.chosen else float(np.hypot(self.numerical, self.plane))

    @property
    def words(self) -> str:
        """What a tolerance applies to."""
        plane = f", with the plane {_percent(self.bought)} %" if self.bought > self.numerical else ""
        return f"{_percent(self.numerical)} %{plane}"

    @property
    def total(self) -> float:
        """Of all, which are independent of each other."""
        return float(np.sqrt(self.numerical**2 + self.plane**2 + self.method**2))

    def to_json(self) -> Json:
        """Return plain JSON."""
        names = ("mesh", "slices", "positions", "numerical", "plane", "method", "total")
        parts: Json = {name: getattr(self, name) for name in names}
        parts["bias"] = self.bias and self.bias.to_json()
        return parts | {"mean_m": self.mean, "peak_to_peak_m": self.peak_to_peak}


def expected_error(
    pair: ParallelAxes, plan: Plan, curves: ExpectedCurves | None = None, *, bound: bool = False
) -> ExpectedError:
    """Say the error of a plan.

    Parameters
    ----------
    curves : ExpectedCurves, optional
        What is known of mean and peak-to-peak before the run; default: those of usual pairs.
    bound : bool
        The caller chose the model.
    """
    known = curves or _usual_curves(pair, plan)
    parts, values = _parts(pair, plan, known), np.stack([known.mean, known.peak_to_peak])
    relative = np.sqrt(sum(np.square(part) for part in parts.values())) / known.scale
    if bias := plane_bias(pair, plan.discretization):
        bias = bias.of_curves(*values) if known.absolute and _modified(pair) else bias
    counted = [part for name, part in parts.items() if not (bias and name == "plane")]
    absolute = np.sqrt(sum(np.square(part) for part in counted))
    worst = np.unravel_index(int(np.argmax(relative)), relative.shape)
    at_worst = {name: float((part / known.scale)[worst]) for name, part in parts.items()}
    mean, ripple = (float(value) for value in absolute.max(axis=1)) if known.absolute else (None, None)
    return ExpectedError(**at_worst, mean=mean, peak_to_peak=ripple, chosen=bound, bias=bias)


def usual_mesh_error(pair: ParallelAxes, plan: Plan) -> tuple[float, float]:
    """Return the median error by mesh of mean and of peak-to-peak, in parts of what the load adds."""
    if not isinstance(plan.discretization, FaceDiscretization):
        return _PLANE[plan.level]
    helical, wound = helical_share(pair), (_RELIEVED if _modified(pair) else _HELICAL)[plan.level]
    mean, ripple = ((1.0 - helical) * a + helical * b for a, b in zip(_SPUR[plan.level], wound, strict=True))
    return mean, ripple


def _modified(pair: ParallelAxes) -> bool:
    return any(gear.modification.varies_along_profile for gear in (pair.pinion, pair.wheel))


def _parts(pair: ParallelAxes, plan: Plan, known: ExpectedCurves) -> dict[str, FloatArray]:
    """Return the errors of mean and peak-to-peak by source, each (2, C) in m."""
    made = plan.discretization
    mean, ripple = known.mean, known.peak_to_peak
    values = np.stack([mean, ripple])
    by_mesh = np.outer(usual_mesh_error(pair, plan), known.added)
    nothing = np.zeros_like(by_mesh)
    slices, plane = nothing.copy(), nothing.copy()
    if isinstance(made, FaceDiscretization):
        part = max(_HELICAL_SLICES * pair.overlap_ratio, _SPUR_SLICES)
        slices[1] = part * (_SLICES / made.slices) ** SLICE_ORDER * known.added
    elif made.corrected:
        plane = np.outer(_CORRECTION * np.array(finite_width_excess(pair)) * (1.0, _WIDTH_RIPPLE), mean)
    elif bias := plane_bias(pair, made):
        plane = bias.largest(mean, ripple)
    left = model_errors if known.absolute else in_small_displacements  # large ones are known in m alone
    method = left(pair, known.force, values, over_face=isinstance(made, FaceDiscretization))
    positions = nothing.copy()
    over_allowed = _FACE_POSITIONS if isinstance(made, FaceDiscretization) else _PLANE_POSITIONS
    positions[1] = over_allowed * plan.nodes.tolerance * np.maximum(ripple, plan.nodes.least_ripple)
    return {"mesh": by_mesh, "slices": slices, "positions": positions, "plane": plane, "method": method}


# Choice of mesh and slices for a tolerance or a time, by the models of error and of cost.


@dataclass(frozen=True)
class MeshOption:
    """A mesh with its slices."""

    level: str
    """"draft", "standard" or "fine"."""
    slices: int
    """Of the face; 1 in the plane."""
    error: ExpectedError
    effort: float
    """Work of a run, in CPU seconds of the host on which the models were measured and with nothing in the
    cache: equal on every host, so that the choice is.
    """

    @property
    def name(self) -> str:
        """In words."""
        return self.level if self.slices == 1 else f"{self.level}, {self.slices} slices"


@dataclass(frozen=True)
class MeshChoice:
    """A mesh with its slices, the reason, and whether the request can be met."""

    option: MeshOption
    met: bool
    """Whether the models promise what was requested."""
    reason: str
    """In words."""

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
    """Return the option of least effort whose error is expected to be within the tolerance.

    Expected errors are parts of the size of each quantity that the tolerance counts by, and without what
    lasts, which no mesh mends. If there is none: where it is the plane that is beyond it, the one of least
    effort whose numerical error is within it; else the most exact one. Said in either case.
    """
    within = [option for option in options if option.error.bought <= tolerance.relative]
    if within:
        best = min(within, key=_effort)
        return MeshChoice(best, True, f"expected error {best.error.words}")
    enough = [option for option in options if option.error.numerical <= tolerance.relative]
    beyond = min(option.error.plane for option in options) > tolerance.relative
    best = min(enough, key=_effort) if enough and beyond else min(options, key=lambda o: o.error.bought)
    error = best.error
    parts = f"mesh {_percent(error.numerical)} %, plane {_percent(error.plane)} %"
    return MeshChoice(best, False, f"no mesh is expected within {tolerance.words} ({parts})")


def mesh_for_time(
    budget: float, options: Sequence[MeshOption], seconds: Callable[[MeshOption], float]
) -> MeshChoice:
    """Return the most exact option that is predicted to fit into `budget` CPU seconds, else the cheapest."""
    for option in sorted(options, key=lambda o: (o.error.total, o.effort)):
        predicted = seconds(option)
        if predicted <= budget:
            return MeshChoice(option, True, f"predicted {engineering(predicted, 2)} CPU s")
    least = min(options, key=_effort)
    reason = f"even the fastest mesh is predicted to take {engineering(seconds(least), 2)} CPU s"
    return MeshChoice(least, False, reason)


def _effort(option: MeshOption) -> float:
    return option.effort


def _percent(value: float) -> str:
    return engineering(100.0 * value, 2)


def mesh_options(
    pair: ParallelAxes,
    load: FloatArray,
    options: AnalysisOptions,
    model: ContactModel,
    alignments: tuple[int, int] = (1, 1),
    curves: ExpectedCurves | None = None,
    *,
    bound: bool = False,
) -> list[MeshOption]:
    """Return the meshes and slices that there are, the levels first; parameters of `chosen_mesh`."""

    def option(level: str, slices: int | None = None) -> MeshOption:
        plan = make_plan(pair, load, options, model, level, slices)
        error = expected_error(pair, plan, curves, bound=bound)
        return MeshOption(level, plan.discretization.slices, error, effort(pair, plan, model, alignments))

    if options.level is not None:
        return [option(options.level)]
    meshes = [option(level) for level in LEVELS]
    usual = make_plan(pair, load, options, model, "draft").discretization
    if isinstance(usual, FaceDiscretization):
        meshes += [option(level, n) for level in LEVELS for n in FINER_SLICES]
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
    bound: bool = False,
) -> MeshChoice:
    """Choose mesh and slices by the tolerance, without one by the time budget.

    Parameters
    ----------
    load : ndarray
        Requested normal forces in N.
    alignments : (int, int)
        Numbers of misalignments and of center distances.
    cache : Path, optional
        Directory of compliances and of what is known of the host: a time depends on them, a tolerance does
        not.
    curves : ExpectedCurves, optional
        What is known of the transmission error of the case.
    bound : bool
        The caller chose the model.
    """

    def seconds(choice: MeshOption) -> float:
        plan = make_plan(pair, load, options, model, choice.level, choice.slices)
        return predict_run(pair, plan, model, alignments, cache).cpu_seconds

    meshes = mesh_options(pair, load, options, model, alignments, curves, bound=bound)
    if options.level is not None:
        return MeshChoice(meshes[0], True, "as requested")
    if options.tolerance is None and options.time_budget is None:
        return MeshChoice(meshes[LEVELS.index("standard")], True, "nothing asked")
    if options.tolerance is not None:
        return mesh_for_tolerance(options.tolerance, meshes)
    return mesh_for_time(options.time_budget or 0.0, meshes, seconds)
