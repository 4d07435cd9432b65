"""From a case and an accuracy to a plan, and from a run to its receipt."""

from fe_contact.planning.accuracy import Accuracy
from fe_contact.planning.discretisation import FaceDiscretisation, PlaneDiscretisation
from fe_contact.planning.plan import NodeRule, Plan, make_plan
from fe_contact.planning.receipt import StageClock

__all__ = [
    "Accuracy",
    "FaceDiscretisation",
    "NodeRule",
    "Plan",
    "PlaneDiscretisation",
    "StageClock",
    "make_plan",
]
