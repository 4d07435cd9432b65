"""Workers for independent tasks: this process, an executor, or a Dask cluster; results do not depend on it.

A task is a plain function of something large that all tasks share and of one small item. Items are fixed by
the caller, whatever the number of workers, and results come in the order of the items.
"""

from model_studies.workers.dask_cluster import ByDask, dask_workers
from model_studies.workers.dispatch import divided, pays, spent
from model_studies.workers.executor import ByExecutor, local_processes
from model_studies.workers.fallback import LocalFallback
from model_studies.workers.in_process import InProcess, Workers, WorkersLost, cluster_cached
from model_studies.workers.remembering import Remembering
from model_studies.workers.remote_task import task_cpu_seconds
from model_studies.workers.run_cost import RunCost

__all__ = [
    "ByDask",
    "ByExecutor",
    "InProcess",
    "LocalFallback",
    "Remembering",
    "RunCost",
    "Workers",
    "WorkersLost",
    "cluster_cached",
    "dask_workers",
    "divided",
    "local_processes",
    "pays",
    "spent",
    "task_cpu_seconds",
]
