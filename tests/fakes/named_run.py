"""The run that example inputs name: stored, and never opened."""

import tempfile
from pathlib import Path

from service.schemas.examples import INPUTS
from service.store.results import ResultStore

RUN: str = INPUTS["listen"]["run"]


def put_named_run(store: ResultStore) -> None:
    with tempfile.TemporaryDirectory(prefix="loa-run-") as folder:
        file = Path(folder) / "run.nc"
        file.touch()
        store.put(RUN, "run", file)
