"""From a pair, an accuracy and a contact model to a plan."""

from fe_contact.planning.accuracy import Accuracy
from fe_contact.planning.discretisation import FaceDiscretisation, PlaneDiscretisation
from fe_contact.planning.plan import NodeRule, Plan, make_plan

__all__ = [
    "Accuracy",
    "FaceDiscretisation",
    "NodeRule",
    "Plan",
    "PlaneDiscretisation",
    "make_plan",
]
