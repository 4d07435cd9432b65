"""Loading of modules that requests will need, while the service already answers."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from importlib import import_module

from lineofaction.gearbox.loading import LOADING
from service.page.files import PLOTLY, page_file

HEAVY = (
    "service.worker.preparations",
    "lineofaction.gearbox.convert.answers",
    "lineofaction.gearbox.convert.live",
    "lineofaction.gearbox.convert.outline",
    "lineofaction.gearbox.convert.plan",
    "lineofaction.gearbox.result_files",
    "service.worker.study_work",
    "fe_contact.ste.compiled_force",
)
"""The modules that handlers import when they are called: both libraries."""


def warm_up(modules: Sequence[str] = HEAVY) -> threading.Thread:
    """Import modules in a thread, then pack plotly.js; a request that needs a module waits for all."""
    thread = threading.Thread(target=_load, args=(modules,), name="warm-up", daemon=True)
    thread.start()
    return thread


def _load(modules: Sequence[str]) -> None:
    with LOADING:
        for module in modules:
            import_module(module)
    if (plotly := page_file(PLOTLY)) is not None:
        _ = plotly.packed
