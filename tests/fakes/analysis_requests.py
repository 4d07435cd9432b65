"""Request objects from keywords as `analyze` takes them, for tests over several requests."""

from collections.abc import Iterable
from dataclasses import fields
from typing import Any

from fe_contact.allowed_error import AllowedError
from fe_contact.geometry import ParallelAxes
from fe_contact.microgeometry.optimization import OptimizationRequest
from fe_contact.microgeometry.scatter import Scatter
from fe_contact.microgeometry.variables import DesignVariable
from fe_contact.options import AnalysisOptions, Levels, OperatingPoint, TableAxes


def table_request(**keywords: Any) -> tuple[TableAxes, AnalysisOptions]:
    options = _options(keywords)
    return TableAxes(**keywords), options


def point_request(**keywords: Any) -> tuple[OperatingPoint, AnalysisOptions]:
    options = _options(keywords)
    return OperatingPoint(**keywords), options


def _options(keywords: dict[str, Any]) -> AnalysisOptions:
    """Take the options out of keywords; a number is the relative part of a tolerance."""
    found = {one.name: keywords.pop(one.name) for one in fields(AnalysisOptions) if one.name in keywords}
    return AnalysisOptions(**found | {"tolerance": AllowedError.from_value(found.get("tolerance"))})


def design_request(
    pair: ParallelAxes,
    torques: Levels,
    variables: Iterable[DesignVariable],
    *scatter: Scatter,
    **keywords: Any,
) -> OptimizationRequest:
    """Return the request of a search among designs that positions and keywords ask for."""
    options = _options(keywords)
    return OptimizationRequest(pair, torques, tuple(variables), *scatter, **keywords, options=options)
