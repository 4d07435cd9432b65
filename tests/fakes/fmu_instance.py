"""An FMU in the hands of FMPy, by the names of its variables."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

fmpy = pytest.importorskip("fmpy", reason="FMPy is not installed: pip install fmpy")
from fmpy.fmi2 import FMU2Slave  # noqa: E402


class Instance:
    """One instance; use as a context."""

    def __init__(self, file: Path, guid: str | None = None) -> None:
        self.said: list[str] = []
        self.description = fmpy.read_model_description(str(file))
        self.folder = Path(fmpy.extract(str(file)))
        self.places = {v.name: (v.type, v.valueReference) for v in self.description.modelVariables}
        self.unit = FMU2Slave(
            guid=guid or self.description.guid,
            unzipDirectory=str(self.folder),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="mesh",
            fmiCallLogger=None,
        )
        try:
            self.unit.instantiate()
        except BaseException:
            self._remove()
            raise

    def __enter__(self) -> Instance:
        return self

    def __exit__(self, *_: object) -> None:
        self.unit.freeInstance()
        self._remove()

    def _remove(self) -> None:
        shutil.rmtree(self.folder, ignore_errors=True)

    def start(self, **values: float) -> Instance:
        self.unit.setupExperiment(startTime=0.0)
        self.unit.enterInitializationMode()
        self.set(**values)
        self.unit.exitInitializationMode()
        return self

    def set(self, **values: float) -> None:
        for name, value in values.items():
            kind, place = self.places[name]
            getattr(self.unit, f"set{kind}")([place], [value])

    def get(self, *names: str) -> list[float]:
        found = []
        for name in names:
            kind, place = self.places[name]
            found += getattr(self.unit, f"get{kind}")([place])
        return found
