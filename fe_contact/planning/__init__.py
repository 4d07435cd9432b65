"""From a pair, an accuracy and a contact model to a plan."""

from fe_contact.planning.cost_model import Prediction, predict_run
from fe_contact.planning.discretization import FaceDiscretization, PlaneDiscretization
from fe_contact.planning.model_error import flank_tilt
from fe_contact.planning.plan import (
    MOST_ROWS,
    CycleCost,
    NodeRule,
    Plan,
    cycle_cost,
    make_plan,
    refuse_long_cycle,
)
from fe_contact.planning.planned import (
    LEFT_OUT,
    ExpectedCurves,
    ExpectedError,
    FaceRootMeshes,
    MeshChoice,
    MeshOption,
    PlaneRootMeshes,
    chosen_mesh,
    expected_error,
    left_out,
    planned,
    root_meshes,
    usual_curves,
    usual_mesh_error,
)

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
