"""Figures of bearings under load cases: loads, displacements and rating life."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bounds.types import FloatArray, Json
from dynamics.deflection import BearingLoad, CaseDeflection, equivalent_load, life_duration
from lineofaction.gearbox.units import MRAD, RPM, UM

HOUR = 3600.0  # s
ROUNDING, ROUNDING_OF_ALL = 1e-9, 1e-12
"""Parts of the largest force of a bearing, and of all bearings: smaller ones are zero. Moments: times 1 m.
Displacements as forces of all bearings."""


def loads_by_case(cases: Sequence[CaseDeflection]) -> list[list[BearingLoad]]:
    """Return the loads of all bearings in every case, forces and displacements within rounding zero."""
    largest = [
        max(float(np.max(np.abs(load.force[:3]))) for load in loads)
        for loads in zip(*(case.bearings for case in cases), strict=True)
    ]
    of_all = ROUNDING_OF_ALL * max(largest, default=0.0)
    least = [max(ROUNDING * own, of_all) for own in largest]
    loads = [load for case in cases for load in case.bearings]
    moved = max((_largest_part(load) for load in loads), default=0.0)
    return [
        [
            _without_rounding(load, each, ROUNDING_OF_ALL * moved)
            for load, each in zip(case.bearings, least, strict=True)
        ]
        for case in cases
    ]


def _largest_part(load: BearingLoad) -> float:
    """Return the largest displacement in x, y, z, m."""
    return max(float(np.max(np.abs(part[:3]))) for part in (load.elastic, load.clearance, load.seat))


def _without_rounding(load: BearingLoad, least: float, moved: float) -> BearingLoad:
    """Return a load whose forces below `least`, N, and displacements below `moved`, m and rad, are zero."""
    return replace(
        load,
        force=_at_least(load.force, least),
        largest_radial=load.largest_radial if load.largest_radial >= least else 0.0,
        elastic=_at_least(load.elastic, moved),
        clearance=_at_least(load.clearance, moved),
        seat=_at_least(load.seat, moved),
    )


def _at_least(values: FloatArray, least: float) -> FloatArray:
    """Return values, zero where they are smaller than `least`."""
    return np.asarray(np.where(np.abs(values) < least, 0.0, values))


def bearing_in_case(load: BearingLoad) -> Json:
    """Return one bearing under one load case."""
    return {
        "name": load.name,
        "shaft": load.shaft,
        "speed_rpm": load.speed / RPM,
        "force_n": load.force[:3].tolist(),
        "moment_n_m": load.force[3:].tolist(),
        "radial_force_n": load.radial,
        "axial_force_n": load.axial,
        "largest_radial_force_n": load.largest_radial,
        "elastic_um": (load.elastic[:3] / UM).tolist(),
        "clearance_um": (load.clearance[:3] / UM).tolist(),
        "seat_um": (load.seat[:3] / UM).tolist(),
        "tilt_mrad": ((load.elastic + load.clearance)[3:] / MRAD).tolist(),
        **_life([load], [1.0]),
    }


def bearing_over_cases(loads: Sequence[BearingLoad], weights: Sequence[float]) -> Json:
    """Return the life of a bearing over all load cases, and the constant loads of the same life."""
    speed = [load.speed for load in loads]
    radial, axial = [load.radial for load in loads], [abs(load.axial) for load in loads]
    return {
        "name": loads[0].name,
        "mean_speed_rpm": float(np.dot(weights, speed)) / RPM,
        "largest_radial_force_n": max(load.largest_radial for load in loads),
        "equivalent_radial_force_n": {
            "ball": equivalent_load(radial, speed, weights, 3.0),
            "roller": equivalent_load(radial, speed, weights),
        },
        "equivalent_axial_force_n": {
            "ball": equivalent_load(axial, speed, weights, 3.0),
            "roller": equivalent_load(axial, speed, weights),
        },
        **_life(loads, weights),
    }


def _life(loads: Sequence[BearingLoad], weights: Sequence[float]) -> Json:
    """Return the life over load cases in h, and why there is no number."""
    revolutions = [load.rating_life for load in loads]
    seconds = life_duration(revolutions, [load.speed for load in loads], weights)
    if math.isnan(seconds):
        status = "none: no capacity"
    else:
        status = "limited" if math.isfinite(seconds) else "unlimited"
    return {"rating_life_hours": known(seconds / HOUR), "rating_life": status}


def known(value: float) -> float | None:
    """Return a number, None if it is not known."""
    return float(value) if math.isfinite(value) else None
