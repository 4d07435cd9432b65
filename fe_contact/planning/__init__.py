"""From a pair, an accuracy and a contact model to a plan."""

from fe_contact.planning.accuracy import Accuracy
from fe_contact.planning.cycle_cost import MOST_ROWS, CycleCost, cycle_cost, refuse_long_cycle
from fe_contact.planning.discretisation import FaceDiscretisation, PlaneDiscretisation
from fe_contact.planning.plan import NodeRule, Plan, make_plan
from fe_contact.planning.root_recipes import FaceRootMeshes, PlaneRootMeshes, root_meshes

__all__ = [
    "MOST_ROWS",
    "Accuracy",
    "CycleCost",
    "FaceDiscretisation",
    "FaceRootMeshes",
    "NodeRule",
    "Plan",
    "PlaneDiscretisation",
    "PlaneRootMeshes",
    "cycle_cost",
    "make_plan",
    "refuse_long_cycle",
    "root_meshes",
]
