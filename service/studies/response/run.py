"""Forced response of a scene: amplitudes by order."""

from __future__ import annotations

from typing import Any

import numpy as np

from dynamics.assembly.assemble import assemble
from dynamics.linearize import ForcedResponse, Peak, forced_response, peaks
from dynamics.scene import Scene
from service.convert.case import boundary_errors
from service.studies.computation import Computation, Means
from service.studies.response import Inputs
from service.units import N_PER_UM, RPM, UM

Json = dict[str, Any]


def response_of(scene: Scene, inputs: Inputs, means: Means) -> ForcedResponse:
    """Return the forced response of a scene."""
    with boundary_errors():
        return forced_response(
            assemble(scene),
            [value * RPM for value in inputs.speed_rpm],
            inputs.orders,
            progress=lambda fraction: means.report("response", fraction),
        )


def facts(found: ForcedResponse) -> Json:
    """Return all amplitudes (lists by order, then by speed) and the peaks."""
    about = found.facts
    return {
        "leading_shaft": about["leading_shaft"],
        "speed_rpm": (found.speed / RPM).tolist(),
        "order": found.order.tolist(),
        "meshes": {name: _mesh_json(found, index) for index, name in enumerate(found.mesh)},
        "bearings": {
            name: {"force_n": np.sqrt(np.sum(np.abs(found.bearing_force[index, :3]) ** 2, axis=0)).T.tolist()}
            for index, name in enumerate(found.bearing)
        },
        "peaks": [_peak_json(peak) for peak in peaks(found)],
        "parting_rpm": (found.speed[~found.in_contact] / RPM).tolist(),
        "natural_frequency_hz": found.natural_frequency.tolist(),
        "residual": found.residual,
        "equilibrium": {
            "status": about["equilibrium"]["status"].lower(),
            "residual_n": about["equilibrium"]["residual"],
        },
        "cpu_seconds": about["seconds"],
        "effect_ledger": about["effect_ledger"],
    }


def _mesh_json(found: ForcedResponse, mesh: int) -> Json:
    """One mesh."""
    return {
        "mean_force_n": float(found.mean_force[mesh]),
        "mean_stiffness_n_per_um": float(found.mean_stiffness[mesh]) / N_PER_UM,
        "static_transmission_error_um": (np.abs(found.static_transmission_error[mesh]) / UM).tolist(),
        "dynamic_transmission_error_um": (np.abs(found.dynamic_transmission_error[mesh]).T / UM).tolist(),
        "mesh_force_n": np.abs(found.mesh_force[mesh]).T.tolist(),
        "least_mesh_force_n": found.least_mesh_force[mesh].tolist(),
        "excitation_difference": found.excitation_difference[mesh].tolist(),
    }


def _peak_json(peak: Peak) -> Json:
    """One peak."""
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
    response_of,
    facts,
    ForcedResponse.from_netcdf,
    marks={"schema": ForcedResponse.SCHEMA},
    write=ForcedResponse.to_netcdf,
)
