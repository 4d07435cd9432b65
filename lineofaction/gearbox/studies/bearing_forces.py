"""The bearing forces that studies of housings start from: of the linear response, or of a run."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from dynamics.orders import BearingOrders, bearing_orders
from dynamics.scene import Scene
from dynamics.vibration import ReportedHarmonics
from host import cpu_seconds
from lineofaction.gearbox.convert.case import boundary_errors
from lineofaction.gearbox.schemas.studied import OverOrders
from lineofaction.gearbox.studies.computation import Means
from lineofaction.gearbox.studies.listen.through_housing import other_housings
from lineofaction.gearbox.studies.response.run import response_of

Json = dict[str, Any]
LINEAR: Json = {"source": "linear response"}


def forces_of(scene: Scene, inputs: OverOrders, means: Means) -> ReportedHarmonics:
    """Return the orders of the bearing forces in the run, without one in the linear response.

    The facts of both have `forces`: where they come from, and of a run how its windows hold.
    """
    if means.run is None:
        response = response_of(scene, inputs, means)
        return replace(response, facts=response.facts | {"forces": LINEAR})
    began = cpu_seconds()
    with boundary_errors():
        orders = bearing_orders(means.run, inputs.orders)
    seconds = {"orders": cpu_seconds() - began}
    forces = _run_forces(orders) | {"other_housings": list(other_housings(scene.housings, means.run))}
    return replace(orders, facts=orders.facts | {"forces": forces, "seconds": seconds})


def _run_forces(orders: BearingOrders) -> Json:
    """Return how the windows of a run hold, by order, then by window."""
    known = bool(np.all(np.isfinite(orders.smearing)))
    return {
        "source": "run",
        "time_s": orders.time.tolist(),
        "window_pitches": orders.facts["pitches"],
        "windows_left_out": orders.facts["windows_left_out"],
        "speed_change": orders.sweep.tolist(),
        "smearing": orders.smearing.T.tolist() if known else None,
        "remainder": dict(zip(orders.bearing, orders.remainder.tolist(), strict=True)),
    }
