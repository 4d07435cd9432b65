"""Forced response of a scene: amplitudes by order."""

from __future__ import annotations

from typing import Any

import numpy as np

from dynamics.assembly.assemble import assemble
from dynamics.linearize import ForcedResponse, PowerBalance, forced_response, peaks
from dynamics.scene import Scene
from lineofaction.gearbox.convert.case import boundary_errors
from lineofaction.gearbox.schemas.studied import OverOrders
from lineofaction.gearbox.studies.computation import Computation, Means
from lineofaction.gearbox.studies.equilibrium import equilibrium_figures
from lineofaction.gearbox.studies.figures import Row, figures_of, rows
from lineofaction.gearbox.studies.housing_costs import kept_costs, with_housing_costs
from lineofaction.gearbox.studies.response import ResponseFigures
from lineofaction.gearbox.studies.result_file import array_file
from lineofaction.gearbox.units import RPM

Json = dict[str, Any]


def response_of(scene: Scene, inputs: OverOrders, means: Means) -> ForcedResponse:
    """Return the forced response of a scene."""
    with boundary_errors():
        return forced_response(
            assemble(scene),
            [value * RPM for value in inputs.speed_rpm],
            inputs.orders,
            progress=lambda fraction: means.report("response", fraction),
        )


def facts(response: ForcedResponse) -> Json:
    """Return all amplitudes (lists by order, then by speed) and the peaks."""
    about, force = response.facts, response.bearing_force
    return figures_of(
        ResponseFigures,
        response,
        about,
        meshes={name: _mesh(row) for name, row in rows(response, response.mesh).items()},
        bearings={
            name: {"force": np.sqrt(np.sum(np.abs(force[b, :3]) ** 2, axis=0)).T}
            for b, name in enumerate(response.bearing)
        },
        peaks=peaks(response),
        parting=response.speed[~response.in_contact],
        power=_power(response.power),
        equilibrium=equilibrium_figures(about["equilibrium"]),
        reduction_cost=kept_costs(about),
    )


def _mesh(row: Row) -> tuple[Any, ...]:
    """Return a mesh with its amplitudes by order, then by speed."""
    return row, {
        "static_transmission_error": np.abs(row.static_transmission_error),
        "dynamic_transmission_error": np.abs(row.dynamic_transmission_error).T,
        "mesh_force": np.abs(row.mesh_force).T,
    }


def _power(power: PowerBalance) -> Json:
    """Return where the power comes from and goes to."""
    sinks = zip(power.sink, power.kind, power.loss, strict=True)
    return {
        "input": {name: own.T for name, own in zip(power.source, power.input, strict=True)},
        "losses": [{"part": name, "kind": kind, "loss": own.T} for name, kind, own in sinks],
        "residual": power.residual,
    }


RUN = Computation(
    with_housing_costs(response_of),
    facts,
    array_file(ForcedResponse),
)
