"""Forced response of a scene: amplitudes by order."""

from __future__ import annotations

from typing import Any

import numpy as np

from dynamics.assembly.assemble import assemble
from dynamics.linearize import ForcedResponse, Peak, PowerBalance, forced_response, peaks
from dynamics.scene import Scene
from lineofaction.gearbox.convert.case import boundary_errors
from lineofaction.gearbox.schemas.speeds import OverOrders
from lineofaction.gearbox.studies.computation import Computation, Means
from lineofaction.gearbox.studies.equilibrium import equilibrium_figures
from lineofaction.gearbox.studies.housing_costs import reduction_figures, with_housing_costs
from lineofaction.gearbox.studies.result_file import array_file
from lineofaction.gearbox.units import N_PER_UM, RPM, UM

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
    about = response.facts
    return {
        "leading_shaft": about["leading_shaft"],
        "speed_rpm": (response.speed / RPM).tolist(),
        "order": response.order.tolist(),
        "meshes": {name: _mesh_json(response, index) for index, name in enumerate(response.mesh)},
        "bearings": {
            name: {"force_n": np.sqrt(np.sum(np.abs(response.bearing_force[b, :3]) ** 2, axis=0)).T.tolist()}
            for b, name in enumerate(response.bearing)
        },
        "peaks": [_peak_json(peak) for peak in peaks(response)],
        "parting_rpm": (response.speed[~response.in_contact] / RPM).tolist(),
        "natural_frequency_hz": response.natural_frequency.tolist(),
        "power": _power_json(response.power),
        "residual": response.residual,
        "equilibrium": equilibrium_figures(about["equilibrium"]),
        "cpu_seconds": about["seconds"],
        "reduction_cost": reduction_figures(about),
        "effect_ledger": about["effect_ledger"],
    }


def _mesh_json(response: ForcedResponse, mesh: int) -> Json:
    return {
        "mean_force_n": float(response.mean_force[mesh]),
        "mean_stiffness_n_per_um": float(response.mean_stiffness[mesh]) / N_PER_UM,
        "static_transmission_error_um": (np.abs(response.static_transmission_error[mesh]) / UM).tolist(),
        "dynamic_transmission_error_um": (np.abs(response.dynamic_transmission_error[mesh]).T / UM).tolist(),
        "mesh_force_n": np.abs(response.mesh_force[mesh]).T.tolist(),
        "least_mesh_force_n": response.least_mesh_force[mesh].tolist(),
        "excitation_difference": response.excitation_difference[mesh].tolist(),
    }


def _power_json(power: PowerBalance) -> Json:
    """Where the power comes from and goes to."""
    sinks = zip(power.sink, power.kind, power.loss, strict=True)
    return {
        "input_w": {name: own.T.tolist() for name, own in zip(power.source, power.input, strict=True)},
        "losses": [{"part": name, "kind": kind, "loss_w": own.T.tolist()} for name, kind, own in sinks],
        "residual": power.residual,
    }


def _peak_json(peak: Peak) -> Json:
    return {
        "quantity": peak.quantity,
        "name": peak.name,
        "order": peak.order,
        "speed_rpm": peak.speed / RPM,
        "frequency_hz": peak.frequency,
        "amplitude_n": peak.amplitude,
        "amplification": peak.amplification,
        "natural_frequency_hz": peak.natural_frequency,
    }


RUN = Computation(
    with_housing_costs(response_of),
    facts,
    array_file(ForcedResponse),
)
