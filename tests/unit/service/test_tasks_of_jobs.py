"""Tasks of a job: which are given to a Dask cluster, and what becomes of them where it is away."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from importlib import import_module
from pathlib import Path
from tempfile import mkdtemp
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from divided_work import CASE, GEAR, SEARCH
from running_service import bench
from service_fakes import REGISTRY
from structlog.testing import capture_logs

from fe_contact.analysis.pairs import contact_lines
from fe_contact.ste import SteDatabase
from lineofaction.gearbox.problems import BadInput
from model_studies.workers import RunCost, dask_cluster, dispatch
from service.settings import Settings, load_settings
from service.worker import job_executor as cluster
from service.worker.order import WorkOrder
from service.worker.process import ANALYZE, Process, default_registry

ADDRESS = "tcp://127.0.0.1:1"  # nobody may listen there
WIDE = {"teeth": 21, "face_width_mm": 10.0, "bore_diameter_mm": 40.0}
OVER_FACE = {
    "case": {
        "pair": CASE["pair"]
        | {"helix_angle_deg": 12.0, "center_distance_mm": 84.0, "pinion": GEAR, "wheel": WIDE},
        "load": {"torque_n_m": [40.0]},
        "accuracy": {"level": "draft"},
    },
    "torque_n_m": 40.0,
}
DEVIATIONS = {"misalignment_um": [0.0], "center_distance_change_percent": [0.0, 0.1]}
NOTHING_STORED = SimpleNamespace(find=lambda *_: None)


@pytest.fixture(autouse=True)
def small_tasks(monkeypatch):
    """Cut small tables as large ones are."""
    monkeypatch.setattr(contact_lines, "TASK_SECONDS", 1e-4)
    monkeypatch.setattr(dispatch, "START_SECONDS", 0.0)


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    return tmp_path_factory.mktemp("service")


def done(
    process: Process, inputs: dict[str, Any], data: Path, scheduler: str | None, workspace: Path | None = None
) -> Path:
    """Do the work of a process as its worker would; return the file it made."""
    given = process.inputs.model_validate_json(json.dumps(inputs))
    prepared = process.prepare(given, NOTHING_STORED)
    workspace = workspace or Path(mkdtemp(dir=data))
    order = WorkOrder(process.entry, prepared, "0" * 64, workspace, data, scheduler=scheduler)
    module, _, name = process.entry.partition(":")
    (product,) = getattr(import_module(module), name)(order, lambda *_: None)
    return Path(product.file)


class Recording:
    """A cluster that is this process."""

    def __init__(self) -> None:
        self.functions: set[str] = set()
        self.closed = False

    @property
    def client(self) -> Recording:
        return self

    def close(self) -> None:
        self.closed = True

    def run(self, function: Callable[[Any, Any], Any], shared: Any, items: Sequence[Any]) -> Iterator[Any]:
        self.functions.add(function.__name__)
        return (function(shared, item) for item in items)


@pytest.mark.drawn
@pytest.mark.law
@pytest.mark.parametrize(
    ("process", "further", "task"),
    [
        (ANALYZE, {}, "solve_block"),
        (default_registry()["sensitivity"], DEVIATIONS, "solve_block"),
        (default_registry()["optimize"], SEARCH, "_search_one"),
        (default_registry()["scatter"], {"samples": 30}, "curves_of_samples"),
        (default_registry()["ablate"], {"only": ["profile_modification"]}, "solve_block"),
        (default_registry()["flank"], OVER_FACE, "condense"),
        (default_registry()["root-stress"], OVER_FACE, "condense"),
    ],
    ids=lambda given: given.id if isinstance(given, Process) else "",
)
def test_these_jobs_give_their_tasks_to_the_cluster(process, further, task, tmp_path, monkeypatch):
    recording = Recording()

    def connected(address, spent):
        assert address == ADDRESS
        return recording

    monkeypatch.setattr(cluster, "_connected_cluster", connected)
    done(process, {"case": CASE, **further}, tmp_path, ADDRESS)
    assert task in recording.functions and recording.closed


def test_a_job_whose_cluster_is_away_is_done_here_and_says_so(data, monkeypatch, caplog):
    pytest.importorskip("distributed", reason="the extra dask is not installed")
    monkeypatch.setattr(dask_cluster, "CONNECT_S", 0.2)
    asked = {"case": CASE}
    alone, left = (
        SteDatabase.from_netcdf(done(ANALYZE, asked, data, address)) for address in (None, ADDRESS)
    )
    for name in ("static_transmission_error", "tangent_compliance", "error_estimate", "residuals"):
        np.testing.assert_array_equal(getattr(left, name), getattr(alone, name), err_msg=name)
    receipt = left.metadata.receipt["elsewhere"]
    assert receipt["tasks"] == 0 and ADDRESS in receipt["lost"]
    (told,) = [record for record in caplog.records if record.name.startswith("service")]
    assert "cluster away, the job goes on here" in told.getMessage() and ADDRESS in told.getMessage()


def test_a_job_without_tasks_does_not_look_for_the_cluster(data, monkeypatch):
    monkeypatch.setattr(dispatch, "START_SECONDS", 1e3)
    monkeypatch.setattr(cluster, "_connected_cluster", None)  # were it called, it would be a TypeError
    assert done(ANALYZE, {"case": CASE}, data, ADDRESS).exists()


class Dying(Recording):
    """This process, which ends after so many tasks of a table."""

    def __init__(self, maximum: int) -> None:
        super().__init__()
        self.maximum, self.done, self.cost = maximum, 0, RunCost()

    def run(self, function: Callable[[Any, Any], Any], shared: Any, items: Sequence[Any]) -> Iterator[Any]:
        for item in items:
            if self.done == self.maximum:
                raise RuntimeError("killed")
            self.done += 1
            yield function(shared, item)


def test_a_second_attempt_takes_up_the_table_of_the_first(tmp_path, data, monkeypatch):
    many = CASE["accuracy"] | {"positions": 64}
    inputs = {"case": {**CASE, "accuracy": many, "errors": {"center_distance_change_mm": [0.0, 0.08]}}}
    first, second, alone = Dying(6), Dying(1000), Dying(1000)
    monkeypatch.setattr(cluster, "InProcess", lambda: first)
    with pytest.raises(RuntimeError, match="killed"):
        done(ANALYZE, inputs, data, None, tmp_path)
    monkeypatch.setattr(cluster, "InProcess", lambda: second)
    again = SteDatabase.from_netcdf(done(ANALYZE, inputs, data, None, tmp_path))
    monkeypatch.setattr(cluster, "InProcess", lambda: alone)
    whole = SteDatabase.from_netcdf(done(ANALYZE, inputs, data, None))
    assert second.done == alone.done - 6 > 6
    for name in ("static_transmission_error", "error_estimate", "residuals"):
        np.testing.assert_array_equal(getattr(again, name), getattr(whole, name), err_msg=name)


def test_what_a_worker_warns_of_is_in_the_log_of_the_service(tmp_path):
    with capture_logs() as log:
        machine = bench(tmp_path, REGISTRY, workers=1)
        machine.scheduler.start()
        try:
            assert machine.ended(machine.submit(mode="warn")).status == "successful"
        finally:
            machine.close()
    (warning,) = [entry for entry in log if entry["event"] == "worker warns"]
    assert warning["reason"] == "the cluster is away" and warning["log_level"] == "warning"


def test_the_address_comes_from_the_environment(monkeypatch):
    monkeypatch.setattr("service.settings.find_spec", lambda _: object())
    monkeypatch.setenv("LOA_SCHEDULER", "tls://gears.example:8786")
    assert load_settings().scheduler == "tls://gears.example:8786"
    monkeypatch.setenv("LOA_SCHEDULER", "")
    assert load_settings().scheduler is None


@pytest.mark.parametrize(
    "address", ["gears.example:8786", "http://gears.example:8786", "tcp://gears.example"]
)
def test_what_is_no_address_is_refused_at_the_start(address):
    with pytest.raises(BadInput) as caught:
        load_settings(scheduler=address)
    (fault,) = caught.value.faults
    assert (fault.field, fault.value) == ("scheduler", address)
    assert "tcp://host:8786" in fault.bound and "LOA_SCHEDULER" in str(fault.suggestion)


def test_an_address_without_the_extra_is_refused_at_the_start(monkeypatch):
    monkeypatch.setattr("service.settings.find_spec", lambda _: None)
    with pytest.raises(BadInput, match="extra dask"):
        load_settings(scheduler="tls://gears.example:8786")
    assert Settings().scheduler is None
