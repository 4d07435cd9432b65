"""The contract of executors: every study gives the same figures to the last bit, whoever does its tasks.

The questions are the rows of the contract of studies. A study whose row sends no task is named in `WHOLE`,
with the reason.
"""

import json
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import pytest
from study_rows import ROWS, StudyRow
from study_runs import unmeasured

import lineofaction as loa
from fe_contact.analysis.pairs import contact_lines
from model_studies.workers import ByDask, InProcess, RunCost, Workers, dispatch, local_processes

Figures = dict[str, Any]
CASES = {"whole": 1.0, "half": 0.5, "less": 0.25}

WHOLE = {
    "flank-case": "one load in the plane is a moment's work; over the face its blocks are those of tables",
    "root-stress-case": "as flank",
    "frontier-case": "its fidelities are timed against each other, one after the other in one warm process",
    "frontier-scene": "as that of a case",
    "complaint-case": "kinematics of teeth and speeds alone",
    "complaint-scene": "kinematics and one linear response are a second's work",
    "modes-scene": "a linear study is a second's work at any number of speeds",
    "response-scene": "as modes",
    "vibration-scene": "as modes",
    "listen-scene": "the runs that it takes are given, and one recording is a moment's work",
}
"""Rows that are one task, beside the tables of their scenes, and why."""
WIDER: dict[str, Figures] = {
    "ablate-scene": {"only": ["lateral", "axial", "tilt"]},
    "frontier-case": {"rungs": ["iso6336", "thin_slices", "corrected_draft", "corrected"]},
    "frontier-scene": {"rungs": ["quasi_static", "100_nm", "10_nm", "1_nm"]},
    "noise-scene": {"radiation": "monopoles"},
    "steady-scene": {"speed_rpm": [2500.0, 3000.0]},
    "deflect-scene": {"load_cases": [{"name": name, "factor": part} for name, part in CASES.items()]},
}
"""What some rows have in place of a question too small to have parts."""
BY_DASK = ("ablate-scene", "sweep-case")


@dataclass(frozen=True)
class Noting:
    """Workers that note where the functions of their tasks stand."""

    others: Workers
    modules: list[str] = field(default_factory=list)

    @property
    def cost(self) -> RunCost:
        return self.others.cost

    def run(self, function: Callable[..., Any], shared: Any, items: Sequence[Any]) -> Iterator[Any]:
        self.modules.extend([function.__module__] * len(items))
        return self.others.run(function, shared, items)

    def own(self, row: StudyRow) -> list[str]:
        """Return those that are not of the tables of a scene."""
        tables = ("fe_contact.analysis", "fe_contact.compliance") if row.subject == "scene" else ()
        return [module for module in self.modules if not module.startswith(tables)]


Ask = Callable[[StudyRow, Workers], Figures]


@pytest.fixture(scope="module", autouse=True)
def small_tasks():
    """Divide small questions as large ones are."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(contact_lines, "TASK_SECONDS", 0.0005)
        patch.setattr(dispatch, "START_SECONDS", 0.0)
        yield patch


@pytest.fixture(scope="module")
def ask(small_tasks, tmp_path_factory):
    """Return what puts the question of a row in Python, with a cache of its own."""

    def figures(row, workers):
        small_tasks.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        inputs, study = row.inputs | WIDER.get(str(row), {}), row.registered
        subject = inputs.pop(row.subject)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            run = {"run": loa.simulate(subject)} if study.name == "listen" else {}
            result = getattr(loa, study.package)(subject, inputs, workers=workers, **run)
        plain: Figures = json.loads(json.dumps(study.run.figures(result), allow_nan=False))
        answer: Figures = unmeasured(plain, (*row.own, "knee"))
        return answer

    return figures


@pytest.fixture(scope="module")
def here(ask):
    known: dict[str, Figures] = {}

    def figures(row):
        if str(row) not in known:
            known[str(row)] = ask(row, InProcess())
        return known[str(row)]

    return figures


NIGHTLY = pytest.mark.nightly


@pytest.fixture(scope="module", params=[pytest.param(1, marks=NIGHTLY), 2, pytest.param(4, marks=NIGHTLY)])
def pool(request):
    with local_processes(request.param) as processes:
        yield processes


@pytest.mark.drawn
@pytest.mark.law
@pytest.mark.parametrize("row", ROWS, ids=str)
def test_a_study_gives_the_same_bits_by_any_number_of_processes(row, pool, ask, here):
    workers, before = Noting(pool), pool.cost.cpu_seconds
    assert ask(row, workers) == here(row)
    assert (len(workers.own(row)) > 0) is (str(row) not in WHOLE)
    assert (pool.cost.cpu_seconds > before) is (len(workers.modules) > 0)


@pytest.mark.law
@pytest.mark.nightly
@pytest.mark.filterwarnings("ignore")
def test_a_study_gives_the_same_bits_by_a_cluster(ask, here):
    distributed = pytest.importorskip("distributed", reason="the extra dask is not installed")
    rows = [row for row in ROWS if str(row) in BY_DASK]
    assert len(rows) == len(BY_DASK)
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=None, host="127.0.0.1"
        ) as cluster,
        distributed.Client(cluster, set_as_default=False) as client,
    ):
        for row in rows:
            workers = ByDask(client)
            assert ask(row, workers) == here(row)
            assert workers.cost.tasks > 0 and workers.cost.cpu_seconds > 0.0
