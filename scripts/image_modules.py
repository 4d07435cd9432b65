"""Load the modules of the service and its workers, so that Python writes their byte code into the image."""

from __future__ import annotations

import compileall
import importlib
import pkgutil
from pathlib import Path

import service.worker

LOADED_AT_THE_START = (
    "h5netcdf.legacyapi",
    "lineofaction.cli",
    "lineofaction.cli.analyze",
    "lineofaction.cli.ste",
    "rich.live",
    "service.app",
    "uvicorn.protocols.http.auto",
    "uvicorn.lifespan.on",
)
OURS = ("host", "bounds", "model_studies", "fe_contact", "dynamics", "lineofaction", "service")


def main() -> None:
    """Compile our own packages whole and of the libraries what they import."""
    for name in OURS:
        path = importlib.import_module(name).__file__
        assert path is not None
        compileall.compile_dir(Path(path).parent, quiet=1)
    for name in LOADED_AT_THE_START:
        importlib.import_module(name)
    for found in pkgutil.iter_modules(service.worker.__path__, "service.worker."):
        if found.name.endswith("_work"):
            importlib.import_module(found.name)


if __name__ == "__main__":
    main()
