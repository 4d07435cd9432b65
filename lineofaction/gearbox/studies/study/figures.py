"""The figures of a study in the units of the boundary."""

from __future__ import annotations

from typing import Any

import numpy as np

from dynamics.study import Study
from lineofaction.gearbox.units import UM

Json = dict[str, Any]


def facts(result: Study) -> Json:
    """Return factors, statistics of all responses, worst and failed points in the units of the boundary."""
    return {
        "points": len(result.reason),
        "usable": result.usable,
        "samples": result.samples,
        "factors": [
            {"path": name, "kind": kind} for name, kind in zip(result.factor, result.kind, strict=True)
        ],
        "responses": [_response_json(result, k) for k in range(len(result.response))],
        "worst": [_point_json(result, int(k)) for k in result.worst],
        "failed": [
            {"point": k, "values": _values(result, k), "reason": reason}
            for k, reason in enumerate(result.reason)
            if reason
        ],
        "cpu_seconds": {
            "mean": float(np.mean(result.seconds[:, 0])),
            "integration_wall_mean": _number(np.nanmean(result.seconds[:, 1])) if result.usable else None,
        },
        **{name: result.facts[name] for name in ("seed", "start", "receipt", "neglected", "design", "runs")},
    }


def in_boundary_units(result: Study, response: int) -> tuple[str, float]:
    """Return the unit of a response at the boundary, and what one of it is in SI."""
    unit = result.unit[response]
    return ("um", UM) if unit == "m" else (unit, 1.0)


def _response_json(result: Study, response: int) -> Json:
    """Return the statistics of a response by combination of grid and list."""
    unit, one = in_boundary_units(result, response)
    spread = result.spread(response)
    correlation = result.correlation(response)
    sampled = [k for k, kind in enumerate(result.kind) if kind not in ("grid", "list")]
    others = [k for k in range(len(result.factor)) if k not in sampled]
    return {
        "name": result.response[response],
        "unit": unit,
        "mean": [_number(v / one) for v in spread.mean],
        "standard_error": [_number(v / one) for v in spread.standard_error],
        "confidence": result.confidence,
        "quantiles": [
            {
                "fraction": float(fraction),
                "value": [_number(v / one) for v in spread.quantile[:, q]],
                "low": [_number(v / one) for v in spread.low[:, q]],
                "high": [_number(v / one) for v in spread.high[:, q]],
            }
            for q, fraction in enumerate(spread.fraction)
        ],
        "spread_of_level_means": {result.factor[k]: _number(result.swing(k, response) / one) for k in others},
        "rank_correlation": {result.factor[k]: _number(correlation[k]) for k in sampled},
    }


def _point_json(result: Study, point: int) -> Json:
    """Return one point with its responses and their stated errors."""
    figures = {}
    for k, name in enumerate(result.response):
        unit, one = in_boundary_units(result, k)
        error = _number(result.error[point, k] / one)
        figures[name] = {"value": _number(result.figure[point, k] / one), "unit": unit, "error": error}
    return {"point": point, "values": _values(result, point), "responses": figures}


def _values(result: Study, point: int) -> dict[str, float]:
    return dict(zip(result.factor, map(float, result.value[point]), strict=True))


def _number(value: Any) -> float | None:
    """Return a number of JSON, None for what is not finite."""
    return float(value) if np.isfinite(value) else None
