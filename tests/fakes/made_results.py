"""Results that the work of processes makes here, without a service, into the store that a service reads."""

from __future__ import annotations

import json
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from lineofaction.gearbox.result_files import stamp
from service.store.places import stored_results
from service.store.results import StoredResult
from service.worker.order import WorkOrder
from service.worker.preparations import files_read
from service.worker.process import default_registry

Json = dict[str, Any]


def make(home: Path, process: str, inputs: Json) -> list[StoredResult]:
    """Do a process, and store what it makes; a study of a run does that too."""
    offered, store = default_registry()[process], stored_results(home)
    if "run" in offered.inputs.model_fields and offered.inputs.model_fields["run"].is_required():
        *_, run = make(home, "simulate", {"scene": inputs["scene"]})
        inputs = inputs | {"run": run.key}
    prepared = offered.prepare(offered.inputs.model_validate_json(json.dumps(inputs)), store)
    module, _, name = offered.entry.partition(":")
    with TemporaryDirectory(dir=home) as folder:
        stored = files_read(prepared, store)
        order = WorkOrder(offered.entry, prepared, offered.key(prepared), Path(folder), home, stored=stored)
        products = getattr(import_module(module), name)(order, lambda *_: None)
        for product in products:
            stamp(product.file, product.warnings or [])
            store.put(product.key, product.kind, product.file)
    return [store.verified(product.key, product.kind) for product in products]
