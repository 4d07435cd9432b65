"""The figures of a stored file in JSON, by the kind of the result."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from fe_contact.analysis import LoadDistribution
from service.convert.flanks import flank_json
from service.convert.runs import run_json
from service.convert.sensitivity import studies_json
from service.convert.sensitivity_file import read_studies
from service.convert.stamp import WARNINGS, stamped
from service.registry import study_of

_FIGURES: dict[str, Callable[[Path], dict[str, Any]]] = {
    "run": run_json,
    "flanks": lambda file: flank_json(LoadDistribution.from_netcdf(file)),
    "sensitivity": lambda file: studies_json(read_studies(file)),
}
"""Of the kinds kept as netCDF that no study makes, but for databases, which stay open."""


def figures_of(kind: str, file: Path) -> dict[str, Any]:
    """Return what a stored file of a kind says, its warnings included."""
    study = study_of(kind)
    figures = _FIGURES[kind](file) if study is None else study.run.facts(study.run.read(file))
    return figures | {WARNINGS: stamped(file)}
