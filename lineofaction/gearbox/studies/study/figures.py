"""The figures of a study in the units of the boundary."""

from __future__ import annotations

from typing import Any

import numpy as np

from dynamics.study import Study
from lineofaction.gearbox.studies.figures import figures_of
from lineofaction.gearbox.studies.study import StudyFigures
from lineofaction.gearbox.units import UM

Json = dict[str, Any]


def facts(result: Study) -> Json:
    """Return factors, statistics of all responses, worst and failed points in the units of the boundary."""
    wall = np.nanmean(result.seconds[:, 1]) if result.usable else None
    failed = [(k, reason) for k, reason in enumerate(result.reason) if reason]
    return figures_of(
        StudyFigures,
        result,
        result.facts,
        points=len(result.reason),
        factors=[{"path": name, "kind": kind} for name, kind in zip(result.factor, result.kind, strict=True)],
        responses=[_response(result, k) for k in range(len(result.response))],
        worst=[_point(result, int(k)) for k in result.worst],
        failed=[{"point": k, "values": _values(result, k), "reason": reason} for k, reason in failed],
        cpu_seconds={"mean": float(np.mean(result.seconds[:, 0])), "integration_wall_mean": wall},
    )


def in_boundary_units(result: Study, response: int) -> tuple[str, float]:
    """Return the unit of a response at the boundary, and what one of it is in SI."""
    unit = result.unit[response]
    return ("um", UM) if unit == "m" else (unit, 1.0)


def _response(result: Study, response: int) -> Json:
    """Return the statistics of a response by combination of grid and list."""
    unit, one = in_boundary_units(result, response)
    spread, correlation = result.spread(response), result.correlation(response)
    sampled = [k for k, kind in enumerate(result.kind) if kind not in ("grid", "list")]
    others = [k for k in range(len(result.factor)) if k not in sampled]
    quantiles = zip(spread.fraction, spread.quantile.T, spread.low.T, spread.high.T, strict=True)
    return {
        "name": result.response[response],
        "unit": unit,
        "mean": spread.mean / one,
        "standard_error": spread.standard_error / one,
        "confidence": result.confidence,
        "quantiles": [
            {"fraction": fraction, "value": value / one, "low": low / one, "high": high / one}
            for fraction, value, low, high in quantiles
        ],
        "spread_of_level_means": {result.factor[k]: result.swing(k, response) / one for k in others},
        "rank_correlation": {result.factor[k]: correlation[k] for k in sampled},
    }


def _point(result: Study, point: int) -> Json:
    """Return one point with its responses and their stated errors."""
    figures = {}
    for k, name in enumerate(result.response):
        unit, one = in_boundary_units(result, k)
        value, error = result.figure[point, k] / one, result.error[point, k] / one
        figures[name] = {"value": value, "unit": unit, "error": error}
    return {"point": point, "values": _values(result, point), "responses": figures}


def _values(result: Study, point: int) -> dict[str, float]:
    return dict(zip(result.factor, map(float, result.value[point]), strict=True))
