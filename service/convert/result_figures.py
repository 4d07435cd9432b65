"""What a stored file says in JSON, by the kind of the result."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from dynamics.linearize import ForcedResponse, ModalAnalysis
from dynamics.periodic import SteadyStates
from fe_contact.analysis import LoadDistribution
from service.convert.flanks import flank_json
from service.convert.modal import modes_json
from service.convert.response import response_json
from service.convert.runs import run_json
from service.convert.sensitivity import studies_json
from service.convert.sensitivity_file import read_studies
from service.convert.stamp import WARNINGS, stamped
from service.convert.steady import steady_json

_FIGURES: dict[str, Callable[[Path], dict[str, Any]]] = {
    "run": run_json,
    "flanks": lambda file: flank_json(LoadDistribution.from_netcdf(file)),
    "sensitivity": lambda file: studies_json(read_studies(file)),
    "modes": lambda file: modes_json(ModalAnalysis.from_netcdf(file)),
    "response": lambda file: response_json(ForcedResponse.from_netcdf(file)),
    "steady": lambda file: steady_json(SteadyStates.from_netcdf(file)),
}
"""Of the kinds kept as netCDF, but for databases, which stay open."""


def figures_of(kind: str, file: Path) -> dict[str, Any]:
    """Return what a stored file of a kind says, its warnings included."""
    return _FIGURES[kind](file) | {WARNINGS: stamped(file)}
