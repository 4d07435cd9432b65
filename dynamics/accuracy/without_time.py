"""Fidelities that integrate nothing: the quasi-static one, and the linear response about the equilibrium."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.accuracy.vibration import Blocks, Vibration, vibration_of
from dynamics.assembly.assemble import System, assemble
from dynamics.errors import SolveError
from dynamics.integrators import static_equilibrium
from dynamics.linearize import HarmonicResponse, harmonic_response
from dynamics.motion.observation import observe_laws, static_deflections
from dynamics.scene import Scene
from dynamics.types import FloatArray

ORDER_MATCH = 1e-6


@dataclass(frozen=True)
class QuasiStatic:
    """Static transmission error under the forces that balance loads and imposed accelerations.

    Mesh and bearing forces do not vibrate: their orders are 0.
    """

    name: str = "quasi_static"
    title: str = "quasi-static"
    family: str = "model"

    def refusal(self, scene: Scene) -> str | None:
        """Say nothing: it is valid for every scene."""
        return None

    def run(self, scene: Scene, blocks: Blocks) -> Vibration:
        """Read the tables at the positions and forces of every block."""
        system = assemble(scene)
        error = np.zeros_like(blocks.position)
        for (first, stop), middle in zip(blocks.bounds, blocks.middle, strict=True):
            rest = static_equilibrium(system, float(middle))
            if not rest.status.usable:
                raise SolveError(f"no static equilibrium at {middle:.6g} s")
            for f, force in enumerate(rest.mesh_force):
                position = np.ascontiguousarray(blocks.position[f, first:stop])
                deflection = np.empty_like(position)
                static_deflections(system.flanks.static, f, position, float(force), deflection)
                error[f, first:stop] = deflection
        return vibration_of(blocks, error, np.zeros((len(system.supports.name), 3, blocks.time.size)))


@dataclass(frozen=True)
class LinearResponse:
    """Harmonic response to the static transmission errors, with mean stiffnesses."""

    name: str = "harmonic_response"
    title: str = "harmonic response"
    family: str = "model"

    def refusal(self, scene: Scene) -> str | None:
        """Say nothing: what it cannot hold shows when it runs."""
        return None

    def run(self, scene: Scene, blocks: Blocks) -> Vibration:
        """Respond at the speed in the middle of every block."""
        system = assemble(scene)
        speeds = np.abs(observe_laws(system.arrays, blocks.middle)[2])
        law = int(np.flatnonzero(np.max(speeds, axis=1) > 0.0)[0])
        parts = [
            _of_one_speed(
                harmonic_response(system, np.array([speed]), 4 * blocks.orders, float(time)), system, blocks
            )
            for speed, time in zip(speeds[law], blocks.middle, strict=True)
        ]
        return Vibration(*(np.array([getattr(part, name) for part in parts]) for name in _FIELDS))


_FIELDS = ("rms", "error_orders", "force_orders")


def _of_one_speed(response: HarmonicResponse, system: System, blocks: Blocks) -> Vibration:
    """Pick each mesh's own orders, and those of the first mesh for bearings."""
    pace = np.abs(blocks.position[:, -1] - blocks.position[:, 0])
    ratio = pace / pace[0]
    size = np.abs(response.dynamic_transmission_error[:, 0])
    errors = [_at(response.order, size[f], ratio[f], blocks.orders) for f in range(len(size))]
    pushed = np.linalg.norm(np.abs(response.bearing_force[:, :3, 0]), axis=1)
    forces = [_at(response.order, line, 1.0, blocks.orders) for line in pushed]
    empty = np.zeros((0, blocks.orders))
    return Vibration(
        np.sqrt(0.5 * np.sum(size**2, axis=1)), np.array(errors), np.array(forces) if forces else empty
    )


def _at(order: FloatArray, amplitude: FloatArray, ratio: float, orders: int) -> FloatArray:
    """Amplitudes at the multiples 1 to `orders` of `ratio`; 0 where nothing is excited."""
    own = ratio * np.arange(1, orders + 1)
    match = np.abs(order[None, :] - own[:, None]) <= ORDER_MATCH * own[:, None]
    return np.asarray(np.sum(np.where(match, amplitude[None, :], 0.0), axis=1))
