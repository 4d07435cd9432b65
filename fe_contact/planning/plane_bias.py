"""Estimate of the bias of a plane model of gears of finite width, before a run."""

from __future__ import annotations

from fe_contact.compliance import PlaneHypothesis
from fe_contact.geometry import ParallelAxes
from fe_contact.geometry.finite_width import finite_width_excess, plane_stress_excess
from fe_contact.planning.discretization import Discretization, FaceDiscretization
from fe_contact.planning.model_error import bending_ripple
from fe_contact.ste.plane_bias import PlaneBias


def plane_bias(pair: ParallelAxes, discretization: Discretization) -> PlaneBias | None:
    """Return the bias of a discretization; None in three dimensions and in a plane that is corrected."""
    if isinstance(discretization, FaceDiscretization) or discretization.corrected:
        return None
    if discretization.hypothesis is PlaneHypothesis.PLANE_STRESS:
        mean, ripple = (1.0 / (1.0 + excess) - 1.0 for excess in plane_stress_excess(pair))
    else:
        mean, ripple = finite_width_excess(pair)
    model, width = discretization.hypothesis.value.replace("_", " "), 1e3 * pair.face_width
    return PlaneBias(f"{model}: over the face of {width:.4g} mm", mean, ripple, bending_ripple(pair))
