"""Durable jobs: a table, a scheduler, and one child process per computation."""

from service.jobs.claims import Claim, Claims
from service.jobs.key import content_key, solver_version
from service.jobs.order import Outcome, Product, Progress, WorkOrder
from service.jobs.process import Process, Registry, Stage
from service.jobs.scheduler import Scheduler
from service.jobs.submissions import Job, Submissions

__all__ = [
    "Claim",
    "Claims",
    "Job",
    "Outcome",
    "Process",
    "Product",
    "Progress",
    "Registry",
    "Scheduler",
    "Stage",
    "Submissions",
    "WorkOrder",
    "content_key",
    "solver_version",
]
