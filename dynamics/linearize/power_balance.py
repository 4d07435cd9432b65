"""Power balance of a harmonic vibration: power put in by excitations and lost in parts, by harmonic.

Sources are the meshes, by their transmission errors, and the loads. Sinks are all parts with damping.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from dynamics.linearize.absorbers import (
    bearing_absorbers,
    body_absorbers,
    coupling_absorbers,
    element_absorbers,
)
from dynamics.linearize.load_harmonics import load_harmonics
from dynamics.linearize.steady_vibration import Excited, Steady, gyroscopic_terms, speed_blocks
from dynamics.types import ComplexArray, FloatArray

LOADS = "loads"
FRAMES = "rotating frames"


@dataclass(frozen=True)
class PowerBalance:
    """Mean powers of H harmonics at S speeds, W; p sources, a sinks."""

    source: tuple[str, ...]
    """Meshes, by their transmission errors; `LOADS`: forces and unbalances, where they excite."""
    input: FloatArray
    """Power put in by each source, W; negative where the source brakes the vibration. Shape (p, S, H)."""
    sink: tuple[str, ...]
    kind: tuple[str, ...]
    """`sink`, `kind`: Parts and what they are, one of `KINDS`."""
    loss: FloatArray
    """Power lost in each sink, W; negative in a mesh whose friction feeds the vibration. Shape (a, S, H)."""

    @property
    def fields(self) -> dict[str, Any]:
        """The powers as fields of `ForcedResponse`, by name."""
        powers = {"source": self.source, "input": self.input, "sink": self.sink}
        powers |= {"sink_kind": self.kind, "loss": self.loss}
        return {f"power_{name}": value for name, value in powers.items()}

    @property
    def residual(self) -> float:
        """Power put in but lost in no part, over the power put in: all harmonics, at the worst speed."""
        missing = np.abs(np.sum(self.input, axis=0) - np.sum(self.loss, axis=0)).sum(axis=-1)
        total = np.abs(self.input).sum(axis=(0, 2))
        return float(np.max(missing / np.maximum(total, 1e-300), initial=0.0))  # 0 over 0 is 0

    def by_kind(self) -> dict[str, FloatArray]:
        """Return the power that the parts of a kind lose together, all harmonics, (S,)."""
        total = np.sum(self.loss, axis=2)
        return {
            kind: np.sum(total[[part_kind == kind for part_kind in self.kind]], axis=0)
            for kind in dict.fromkeys(self.kind)
        }


def power_balance(at: Excited, speed: FloatArray, steady: Steady) -> PowerBalance:
    """Return where the power of a vibration at `speed` (S,) comes from and goes to.

    Forces of complex amplitude F on coordinates of amplitude y put in Re(F conj(i w y))/2. Each part is
    assembled by itself, so the residual tells what the linear solves and the sum of the parts leave.
    """
    gains: dict[str, list[FloatArray]] = {mesh.name: [] for mesh in at.system.scene.meshes}
    losses: dict[tuple[str, str], list[FloatArray]] = {}
    loaded = False
    for part in speed_blocks(steady.omega.shape, steady.displacement.shape[2]):
        u, absorbed = steady.displacement[part], dict[tuple[str, str], FloatArray]()
        rate = 1j * steady.omega[part, :, None] * u
        # the meshes come first in `gains`; after the first block `LOADS` follows, which has no cycle
        for name, cycle in zip(gains, at.cycles, strict=False):
            along = rate @ at.system.arrays.direction[cycle.rows].T
            # forces that do not depend on speed have one row
            force = steady.force if len(steady.force) == 1 else steady.force[part]
            gains[name].append(_power(np.swapaxes(force[:, cycle.rows], 1, 2), along))
        loads = load_harmonics(at.system, at.period, speed[part], steady.harmonics, at.time)
        loaded = loaded or bool(np.any(loads))
        gains.setdefault(LOADS, []).append(_power(loads, rate))
        for name, kind, power in _losses(at, speed[part], u, rate):
            absorbed[name, kind] = absorbed.get((name, kind), 0.0) + power
        for key, power in absorbed.items():
            losses.setdefault(key, []).append(power)
    if not loaded:
        gains.pop(LOADS, None)
    return PowerBalance(
        tuple(gains),
        np.array([np.concatenate(powers) for powers in gains.values()]).reshape(-1, *steady.omega.shape),
        tuple(name for name, _ in losses),
        tuple(kind for _, kind in losses),
        np.array([np.concatenate(powers) for powers in losses.values()]).reshape(-1, *steady.omega.shape),
    )


def _losses(
    at: Excited, speed: FloatArray, u: ComplexArray, rate: ComplexArray
) -> Iterable[tuple[str, str, FloatArray]]:
    """Yield name, kind and power (S, H) of parts; one part may come several times.

    The sum of all parts with damping about the equilibrium, driving flanks by their mean tangents, is the
    damping of `LinearSystem`. The power of gyroscopic and frame terms comes last.
    """
    elements = element_absorbers(at.system, at.linear, at.cycles, at.time)
    system = at.system
    springs = (*bearing_absorbers(system), *coupling_absorbers(system), *body_absorbers(system))
    for part in (*elements, *springs):
        if not (np.any(part.damping) or np.any(part.stiffness)):
            continue
        along = rate @ part.rows.T
        force = (u @ part.rows.T) @ part.stiffness.T + along @ part.damping.T
        yield part.name, part.kind, _power(force, along)
    if at.turning:
        terms = gyroscopic_terms(at.system, speed)
        damping = np.stack([damping_term for damping_term, _ in terms])  # (S, n, n)
        stiffness = np.stack([stiffness_term for _, stiffness_term in terms])
        force = np.einsum("sij,shj->shi", damping, rate) + np.einsum("sij,shj->shi", stiffness, u)
        yield FRAMES, "frame", _power(force, rate)


def _power(force: ComplexArray, rate: ComplexArray) -> FloatArray:
    """Return the mean power of forces (..., k) on rates (..., k), peak amplitudes, W."""
    return np.asarray(0.5 * np.real(np.sum(force * rate.conj(), axis=-1)))
