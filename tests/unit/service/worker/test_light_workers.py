"""A worker loads what its own work needs: one of a small job starts soon and holds little memory."""

from running_service import until

from service.worker.order import WorkOrder
from service.worker.worker import Worker

HEAVY = {"dynamics", "fastapi", "gmsh", "h5py", "numba", "pydantic", "scipy", "skfem", "sqlalchemy", "xarray"}


def test_the_worker_of_a_small_job_loads_no_library_that_computes(tmp_path, monkeypatch):
    """Python itself tells what is imported until the job has ended: warnings go into its result last."""
    monkeypatch.setenv("PYTHONPROFILEIMPORTTIME", "1")
    workspace, log = tmp_path / "work", tmp_path / "log"
    workspace.mkdir()
    inputs = {"wish": {"mode": "write", "text": "small"}}
    worker = Worker(WorkOrder("service_fake_work:work", inputs, "ab" * 32, workspace, tmp_path), log)
    until(lambda: worker.listen()[1])
    assert [product.kind for product in worker.finish().products] == ["database"]
    lines = (line for line in log.read_text().splitlines() if line.startswith("import time:"))
    imported = {line.rpartition("|")[2].strip() for line in lines}
    assert {"service.worker.usage", "fe_contact.errors"} <= imported  # by the worker, by its work
    assert HEAVY & {name.partition(".")[0] for name in imported} == set()
