"""From a pair, an accuracy and a contact model to a plan."""

from fe_contact.planning.cost_model import Prediction, predict_run
from fe_contact.planning.cycle_cost import MOST_ROWS, CycleCost, cycle_cost, refuse_long_cycle
from fe_contact.planning.discretization import FaceDiscretization, PlaneDiscretization
from fe_contact.planning.model_error import flank_tilt
from fe_contact.planning.plan import NodeRule, Plan, make_plan
from fe_contact.planning.planned import (
    LEFT_OUT,
    ExpectedCurves,
    ExpectedError,
    MeshChoice,
    MeshOption,
    chosen_mesh,
    expected_error,
    left_out,
    planned,
    usual_curves,
    usual_mesh_error,
)
from fe_contact.planning.root_recipes import FaceRootMeshes, PlaneRootMeshes, root_meshes

__all__ = [
    "LEFT_OUT",
    "MOST_ROWS",
    "CycleCost",
    "ExpectedCurves",
    "ExpectedError",
    "FaceDiscretization",
    "FaceRootMeshes",
    "MeshChoice",
    "MeshOption",
    "NodeRule",
    "Plan",
    "PlaneDiscretization",
    "PlaneRootMeshes",
    "Prediction",
    "chosen_mesh",
    "cycle_cost",
    "expected_error",
    "flank_tilt",
    "left_out",
    "make_plan",
    "planned",
    "predict_run",
    "refuse_long_cycle",
    "root_meshes",
    "usual_curves",
    "usual_mesh_error",
]
