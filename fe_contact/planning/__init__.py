"""From a case and an accuracy to a plan, and from a run to its receipt."""

from fe_contact.planning.plan import Accuracy, Plan, make_plan
from fe_contact.planning.receipt import StageClock

__all__ = ["Accuracy", "Plan", "StageClock", "make_plan"]
