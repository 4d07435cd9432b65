"""A service with a key and all processes, whose work is written, not computed (`written_work`)."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest
from named_run import put_named_run
from served_app import served
from service_surroundings import FAKES

from service.access.key_file import KeyFile
from service.app import create_app
from service.settings import Settings
from service.store.places import stored_results
from service.worker.process import Registry, default_registry


@dataclass(frozen=True)
class Service:
    url: str
    key: str
    description: dict[str, Any]

    @property
    def headers(self) -> dict[str, str]:
        return {"Authorization": f"Bearer {self.key}"}


@contextmanager
def written_service(directory: Path) -> Iterator[Service]:
    offered = (replace(p, entry=f"written_work:{p.kind}") for p in default_registry().values())
    put_named_run(stored_results(directory))
    with running_service(directory, Registry(*offered)) as service:
        yield service


@contextmanager
def running_service(directory: Path, registry: Registry) -> Iterator[Service]:
    """Run a service with a key while the context lasts; its workers find the fakes."""
    key = KeyFile(directory / "keys.json").add("foreign")
    with pytest.MonkeyPatch.context() as patched:
        patched.setenv("PYTHONPATH", FAKES)
        app = create_app(Settings(data_directory=directory), registry)
        with served(app) as port:
            yield Service(f"http://127.0.0.1:{port}", key, app.openapi())
