"""Prediction of the error that a run will state of a model, a mesh and slices."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from bounds import engineering
from fe_contact.geometry import ParallelAxes
from fe_contact.geometry.finite_width import correction_error, finite_width_excess
from fe_contact.planning.discretization import SLICE_ORDER, FaceDiscretization
from fe_contact.planning.expected_curves import (
    FACE_POSITIONS,
    HELICAL,
    HELICAL_SLICES,
    PLANE,
    PLANE_POSITIONS,
    QUIET,
    QUIET_SCATTER,
    QUIET_SLICES,
    RELIEVED,
    SLICES,
    SPUR,
    SPUR_SLICES,
    WIDTH_RIPPLE,
    ExpectedCurves,
    usual_curves,
)
from fe_contact.planning.model_error import (
    helical_share,
    in_small_displacements,
    is_relieved_helical,
    model_errors,
)
from fe_contact.planning.plan import Plan
from fe_contact.planning.plane_bias import plane_bias
from fe_contact.ste.plane_bias import PlaneBias
from fe_contact.types import FloatArray, Json

NINE_OF_TEN = 1.28
"""Standard deviations of a normal distribution below which nine of ten lie."""


@dataclass(frozen=True)
class ExpectedError:
    """Error of mean or peak-to-peak STE, whichever is worse, at the load where it is largest.

    Errors by source are relative, to the same size as a tolerance is: to the quantity, or to a least size
    where the quantity is less.
    """

    mesh: float
    """Error by finite elements."""
    slices: float
    """Error by slices of the face; 0 in the plane."""
    positions: float
    """Error by interpolation between positions."""
    plane: float
    """Error of a plane model for the gears in three dimensions; 0 in three dimensions."""
    method: float
    """Error of the method against full contact, for any mesh (`model_error`)."""
    mean: float | None = None
    peak_to_peak: float | None = None
    """`mean`, `peak_to_peak`: The largest errors over the loads without `bias`, m; None where no size is
    known before the run.
    """
    chosen: bool = False
    """Whether the caller chose the model, so that no run of this request lowers `plane`."""
    bias: PlaneBias | None = None
    """Bias of a plane that is not corrected for the finite width; `plane` is its size then."""
    scatter: float = 0.0
    """Standard deviation of the logarithm of the stated over the expected error; 0: not known."""

    @property
    def numerical(self) -> float:
        """The part that finer meshes, more slices and positions lower."""
        return float(np.sqrt(self.mesh**2 + self.slices**2 + self.positions**2))

    @property
    def reducible(self) -> float:
        """The part that more computation lowers, to which a tolerance applies.

        It includes the error of the plane, which a run in three dimensions does not have, unless the caller
        chose the model.
        """
        return self.numerical if self.chosen else float(np.hypot(self.numerical, self.plane))

    @property
    def prudent(self) -> float:
        """Bound of the reducible error that nine runs of ten keep, as far as the scatter of runs is known."""
        return self.reducible * math.exp(NINE_OF_TEN * self.scatter)

    def probability(self, relative: float) -> float | None:
        """Return the part of runs that keep a relative tolerance; None where their scatter is not known."""
        if not self.scatter or not self.reducible:
            return None
        return 0.5 * math.erfc(-math.log(relative / self.reducible) / (math.sqrt(2.0) * self.scatter))

    @property
    def text(self) -> str:
        """Text of the errors that a tolerance applies to."""
        plane = f", with the plane {percent(self.reducible)} %" if self.reducible > self.numerical else ""
        return f"{percent(self.numerical)} %{plane}"

    @property
    def total(self) -> float:
        """Root of the sum of squares of all errors, which are independent."""
        return float(np.sqrt(self.numerical**2 + self.plane**2 + self.method**2))

    def to_json(self) -> Json:
        """Return plain JSON."""
        names = ("mesh", "slices", "positions", "numerical", "plane", "method", "total")
        parts: Json = {name: getattr(self, name) for name in names}
        parts["bias"] = self.bias and self.bias.to_json()
        return parts | {"mean_m": self.mean, "peak_to_peak_m": self.peak_to_peak}


def expected_error(
    pair: ParallelAxes, plan: Plan, curves: ExpectedCurves | None = None, *, model_chosen: bool = False
) -> ExpectedError:
    """Return the error that a run of a plan is expected to state.

    Parameters
    ----------
    curves : ExpectedCurves, optional
        Mean and peak-to-peak that are known or estimated before the run; default: those of usual pairs.
    model_chosen : bool
        Whether the caller chose the model.
    """
    known = curves or usual_curves(pair, plan)
    parts, values = _parts(pair, plan, known), np.stack([known.mean, known.peak_to_peak])
    relative = np.sqrt(sum(np.square(part) for part in parts.values())) / known.scale
    if bias := plane_bias(pair, plan.discretization):
        bias = bias.of_curves(*values) if known.absolute and _modified(pair) else bias
    counted = [part for name, part in parts.items() if not (bias and name == "plane")]
    absolute = np.sqrt(sum(np.square(part) for part in counted))
    worst = np.unravel_index(int(np.argmax(relative)), relative.shape)
    at_worst = {name: float((part / known.scale)[worst]) for name, part in parts.items()}
    mean, ripple = (float(value) for value in absolute.max(axis=1)) if known.absolute else (None, None)
    scatter = QUIET_SCATTER if _is_quiet(pair, plan) else 0.0
    return ExpectedError(
        **at_worst, mean=mean, peak_to_peak=ripple, chosen=model_chosen, bias=bias, scatter=scatter
    )


def usual_mesh_error(pair: ParallelAxes, plan: Plan) -> tuple[float, float]:
    """Return the median errors by mesh of mean and peak-to-peak, over the part of the mean that load adds."""
    made = plan.discretization
    if not isinstance(made, FaceDiscretization):
        return PLANE[plan.level]
    if is_relieved_helical(pair):
        mean, ripple = QUIET[plan.level]
        return made.remaining * mean, made.remaining * ripple
    # between the errors of spur and of helical gears, by the helix
    helical, of_helical = helical_share(pair), (RELIEVED if _modified(pair) else HELICAL)[plan.level]
    mean, ripple = (
        (1.0 - helical) * a + helical * b for a, b in zip(SPUR[plan.level], of_helical, strict=True)
    )
    return mean, ripple


def _is_quiet(pair: ParallelAxes, plan: Plan) -> bool:
    return isinstance(plan.discretization, FaceDiscretization) and is_relieved_helical(pair)


def _modified(pair: ParallelAxes) -> bool:
    return any(gear.modification.varies_along_profile for gear in (pair.pinion, pair.wheel))


def _parts(pair: ParallelAxes, plan: Plan, curves: ExpectedCurves) -> dict[str, FloatArray]:
    """Return the errors of mean and peak-to-peak by source, each (2, C) in m, for C curves (loads)."""
    made = plan.discretization
    mean, ripple = curves.mean, curves.peak_to_peak
    values = np.stack([mean, ripple])
    by_mesh = np.outer(usual_mesh_error(pair, plan), curves.added)
    nothing = np.zeros_like(by_mesh)
    slices, plane = nothing.copy(), nothing.copy()
    if isinstance(made, FaceDiscretization):
        by_overlap = QUIET_SLICES if _is_quiet(pair, plan) else HELICAL_SLICES
        part = max(by_overlap * pair.overlap_ratio, SPUR_SLICES)
        slices[1] = part * (SLICES / made.slices) ** SLICE_ORDER * curves.added
    elif made.corrected:
        plane = np.outer(
            correction_error(pair) * np.array(finite_width_excess(pair)) * (1.0, WIDTH_RIPPLE), mean
        )
    elif bias := plane_bias(pair, made):
        plane = bias.largest(mean, ripple)
    # displacements that are not small have errors that are known only with the curves in m
    error_of = model_errors if curves.absolute else in_small_displacements
    method = error_of(pair, curves.force, values, over_face=isinstance(made, FaceDiscretization))
    positions = nothing.copy()
    over_allowed = FACE_POSITIONS if isinstance(made, FaceDiscretization) else PLANE_POSITIONS
    positions[1] = over_allowed * plan.nodes.tolerance * np.maximum(ripple, plan.nodes.least_ripple)
    return {"mesh": by_mesh, "slices": slices, "positions": positions, "plane": plane, "method": method}


def percent(value: float) -> str:
    """Write a relative error in per cent, with two digits."""
    return engineering(100.0 * value, 2)
