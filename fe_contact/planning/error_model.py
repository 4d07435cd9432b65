"""Prediction of the error that a run will state of a model, a mesh and slices.

What a mesh or slices change is a part of the transmission error that the load adds, also where it is
peak-to-peak that they change: the smaller the ripple, the larger its relative error. Constants are medians of
what runs state, on the pairs that docs/frontier.md names under "Plan"; a run's own error estimate replaces
what is said here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.compliance import PlaneHypothesis
from fe_contact.geometry import ParallelAxes
from fe_contact.geometry.finite_width import finite_width_excess, plane_stress_excess
from fe_contact.planning.discretization import SLICE_ORDER, Discretization, FaceDiscretization
from fe_contact.planning.expected_curves import ExpectedCurves, usual_curves
from fe_contact.planning.model_error import in_small_displacements, model_errors, of_bending
from fe_contact.planning.plan import Plan
from fe_contact.types import FloatArray, Json

_PLANE = {"draft": (1.3e-3, 6e-4), "standard": (4e-4, 3e-4), "fine": (6e-5, 5e-5)}
_SPUR = {"draft": (5e-3, 6.5e-3), "standard": (1.8e-3, 1.3e-3), "fine": (8e-4, 8e-4)}
_HELICAL = {"draft": (5e-3, 3e-3), "standard": (1.8e-3, 1.2e-3), "fine": (8e-4, 5e-4)}
_RELIEVED = {"draft": (4e-3, 1.8e-3), "standard": (1.6e-3, 6e-4), "fine": (6e-4, 3e-4)}
"""Mesh: of mean and of peak-to-peak in parts of what the load adds to the mean. In the plane; over the face
of spur pairs; of helical pairs with plain and with modified profiles, whose contact lines end under less
load."""
_HELICAL_SLICES, _SPUR_SLICES, _SLICES = 7e-4, 5e-5, 15
"""Peak-to-peak at so many slices in parts of the same: of helical pairs times the overlap ratio."""
_CORRECTION, LEFT_OUT = 0.03, 1.25
"""Error of the correction for a finite width over what it is expected to correct, and of leaving it out."""
_WIDTH_RIPPLE = 0.45
"""Peak-to-peak over mean of a correction that is the same in all contacts: that of usual spur pairs."""
_PLANE_POSITIONS, _FACE_POSITIONS = 0.2, 0.8
"""Error of peak-to-peak between positions over what their search allows."""


@dataclass(frozen=True)
class ExpectedError:
    """Error of mean or peak-to-peak STE, whichever is worse, at the load where it is largest.

    Parts are of the size that a tolerance counts by: of the quantity or, where that is less, of the size at
    which the floor holds.

    Attributes
    ----------
    mesh : float
        Finite elements.
    slices : float
        Slices of the face; 0 in the plane.
    model : float
        The plane standing in for three dimensions; 0 over the face.
    positions : float
        Interpolation between positions.
    method : float
        What the method leaves out of full contact, however fine the mesh (`model_error`).
    mean, peak_to_peak : float or None
        The largest errors over the loads, m; None where no size is known before the run.
    """

    mesh: float
    slices: float
    model: float
    positions: float = 0.0
    method: float = 0.0
    mean: float | None = None
    peak_to_peak: float | None = None

    @property
    def discretization(self) -> float:
        """The part that finer meshes, more slices and positions reduce."""
        return float(np.sqrt(self.mesh**2 + self.slices**2 + self.positions**2))

    @property
    def lasting(self) -> float:
        """The part that none of them reduces."""
        return float(np.hypot(self.model, self.method))

    @property
    def total(self) -> float:
        """Of all, which are independent of each other."""
        return float(np.hypot(self.discretization, self.lasting))

    def to_json(self) -> Json:
        """Return plain JSON."""
        parts = {name: getattr(self, name) for name in ("mesh", "slices", "model", "positions", "method")}
        return parts | {"total": self.total, "mean_m": self.mean, "peak_to_peak_m": self.peak_to_peak}


def expected_error(pair: ParallelAxes, plan: Plan, curves: ExpectedCurves | None = None) -> ExpectedError:
    """Say the error of a plan.

    Parameters
    ----------
    pair : GearPair or InternalGearPair
    plan : Plan
    curves : ExpectedCurves, optional
        What is known of mean and peak-to-peak before the run; default: those of usual pairs.
    """
    known = curves or usual_curves(pair, plan)
    parts = _parts(pair, plan, known)
    absolute = np.sqrt(sum(np.square(part) for part in parts.values()))
    relative = absolute / known.scale
    worst = np.unravel_index(int(np.argmax(relative)), relative.shape)
    at_worst = {name: float((part / known.scale)[worst]) for name, part in parts.items()}
    mean, ripple = (float(value) for value in absolute.max(axis=1)) if known.absolute else (None, None)
    return ExpectedError(**at_worst, mean=mean, peak_to_peak=ripple)


def usual_mesh_error(pair: ParallelAxes, plan: Plan) -> tuple[float, float]:
    """Return the median error by mesh of mean and of peak-to-peak, in parts of what the load adds."""
    if not isinstance(plan.discretization, FaceDiscretization):
        return _PLANE[plan.level]
    if pair.base_helix_angle == 0.0:
        return _SPUR[plan.level]
    modified = any(gear.modification.varies_along_profile for gear in (pair.pinion, pair.wheel))
    return (_RELIEVED if modified else _HELICAL)[plan.level]


def _parts(pair: ParallelAxes, plan: Plan, known: ExpectedCurves) -> dict[str, FloatArray]:
    """Return the errors of mean and peak-to-peak by source, each (2, C) in m."""
    made = plan.discretization
    mean, ripple = known.mean, known.peak_to_peak
    own = np.stack([mean, ripple])
    by_mesh = np.outer(usual_mesh_error(pair, plan), known.added)
    nothing = np.zeros_like(by_mesh)
    slices, model = nothing.copy(), nothing.copy()
    if isinstance(made, FaceDiscretization):
        helical = pair.base_helix_angle != 0.0
        part = _HELICAL_SLICES * pair.overlap_ratio if helical else _SPUR_SLICES
        slices[1] = part * (_SLICES / made.slices) ** SLICE_ORDER * known.added
    elif made.corrected:
        model = _CORRECTION * finite_width_excess(pair) * np.stack([mean, _WIDTH_RIPPLE * mean])
    else:
        model = LEFT_OUT * left_out(pair, made) * of_bending(pair, own)
    left = model_errors if known.absolute else in_small_displacements  # large ones are known in m alone
    method = left(pair, known.force, own)
    positions = nothing.copy()
    over_allowed = _FACE_POSITIONS if isinstance(made, FaceDiscretization) else _PLANE_POSITIONS
    positions[1] = over_allowed * plan.nodes.tolerance * np.maximum(ripple, plan.nodes.least_ripple)
    return {"mesh": by_mesh, "slices": slices, "model": model, "positions": positions, "method": method}


def left_out(pair: ParallelAxes, made: Discretization) -> float:
    """Return the relative part of the mean STE that a plane leaves out of a finite width; 0 if none.

    Plane strain deflects less than the gear, plane stress more. The plane that is corrected leaves nothing
    out, nor do three dimensions.
    """
    if isinstance(made, FaceDiscretization) or made.corrected:
        return 0.0
    thin = made.hypothesis is PlaneHypothesis.PLANE_STRESS
    return plane_stress_excess(pair) if thin else finite_width_excess(pair)
