"""Mesh orders above the band of a run's output, by the linear response at its highest speed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dynamics.assembly.assemble import System, assemble
from dynamics.errors import InputError, SolveError
from dynamics.linearize.harmonic_response import HarmonicResponse, harmonic_response
from dynamics.linearize.operating_speeds import leading_law
from dynamics.mechanism.sampling import SPEED_POINTS
from dynamics.types import Json

MAX = 1e6
"""Highest band of an output, Hz."""


def linear_orders(system: System) -> Json:
    """Return the entry of the receipt of a run on orders above its band.

    It is empty where there are none, or where the scene has no linear response. Shafts are resolved to these
    orders; amplitudes are peak values.
    """
    scene, sampling = system.scene, system.sampling
    top = sampling.mesh_orders * sampling.mesh_frequency
    if scene.outputs.sample_rate is not None or top <= sampling.band:
        return {}
    wide = replace(scene, outputs=replace(scene.outputs, band=min(top, MAX)))
    try:
        resolved = assemble(wide)
        law = wide.references[leading_law(resolved)]
        time = np.linspace(0.0, scene.duration, SPEED_POINTS)
        speed = np.broadcast_to(np.abs(law.speed(time)), time.shape)
        fastest = int(np.argmax(speed))
        instant = float(time[fastest])
        response = harmonic_response(resolved, speed[fastest : fastest + 1], sampling.mesh_orders, instant)
    except (InputError, SolveError):
        return {}
    return {"linear_orders": _above(response, sampling.band)}


def _above(response: HarmonicResponse, band: float) -> Json:
    """Return the amplitudes by order, mesh and bearing, SI."""
    above = response.frequency[0] > band
    force = np.sqrt(np.sum(np.abs(response.bearing_force[:, :3, 0]) ** 2, axis=1))
    error = np.abs(response.dynamic_transmission_error[:, 0])
    return {
        "source": "above the band of the output: linear response, mean mesh stiffness, highest speed",
        "speed": float(response.speed[0]),
        "speed_unit": "rad/s",
        "band": band,
        "order": response.order[above].tolist(),
        "frequency": response.frequency[0, above].tolist(),
        "dynamic_transmission_error": dict(zip(response.mesh, error[:, above].tolist(), strict=True)),
        "dynamic_transmission_error_unit": "m",
        "bearing_force": dict(zip(response.bearing, force[:, above].tolist(), strict=True)),
        "bearing_force_unit": "N",
    }
