"""Power balance of a harmonic vibration: what excitation puts in, and what parts lose, by harmonic."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from dynamics.linearize.absorbers import Absorber, absorbers
from dynamics.linearize.load_harmonics import load_harmonics
from dynamics.linearize.steady_vibration import ComplexArray, Excited, Steady, gyroscopic_terms
from dynamics.types import FloatArray

LOADS = "loads"
FRAMES = "rotating frames"


@dataclass(frozen=True)
class PowerBalance:
    """Mean powers of H harmonics at S speeds, W; p sources, a sinks.

    Attributes
    ----------
    source : tuple of str
        Meshes, by their transmission errors; `LOADS`: forces and unbalances, where they excite.
    input : (p, S, H) array
        By each, negative where it brakes the vibration.
    sink, kind : tuple of str
        Parts and what they are, one of `KINDS`.
    loss : (a, S, H) array
        In each. A mesh whose friction feeds the vibration has a negative one.
    """

    source: tuple[str, ...]
    input: FloatArray
    sink: tuple[str, ...]
    kind: tuple[str, ...]
    loss: FloatArray

    @property
    def residual(self) -> float:
        """Power that is put in and lost nowhere over that put in, all harmonics, at the worst speed."""
        missing = np.abs(np.sum(self.input, axis=0) - np.sum(self.loss, axis=0)).sum(axis=-1)
        turned = np.abs(self.input).sum(axis=(0, 2))
        return float(np.max(missing / np.maximum(turned, 1e-300), initial=0.0))

    def by_kind(self) -> dict[str, FloatArray]:
        """Return what parts of a kind lose together, all harmonics, (S,)."""
        total = np.sum(self.loss, axis=2)
        return {
            kind: np.sum(total[[own == kind for own in self.kind]], axis=0)
            for kind in dict.fromkeys(self.kind)
        }


def power_balance(at: Excited, speed: FloatArray, steady: Steady) -> PowerBalance:
    """Return where the power of a vibration at `speed` (S,) comes from and goes to.

    Forces of complex amplitude F on coordinates of amplitude y put in Re(F conj(i w y))/2. Each part is
    assembled by itself, so the residual tells what the linear solves and the sum of the parts leave.
    """
    u, omega = steady.displacement, steady.omega
    rate = 1j * omega[..., None] * u
    source, gained = _inputs(at, speed, steady, rate)
    lost: dict[tuple[str, str], FloatArray] = {}
    for name, kind, power in _losses(at, speed, u, rate):
        lost[name, kind] = lost.get((name, kind), 0.0) + power
    return PowerBalance(
        source,
        gained.reshape(len(source), *omega.shape),
        tuple(name for name, _ in lost),
        tuple(kind for _, kind in lost),
        np.array(list(lost.values())).reshape(len(lost), *omega.shape),
    )


def _inputs(
    at: Excited, speed: FloatArray, steady: Steady, rate: ComplexArray
) -> tuple[tuple[str, ...], FloatArray]:
    """Return the sources and the power of each, (p, S, H)."""
    direction = at.system.arrays.direction
    names = [mesh.name for mesh in at.system.scene.meshes]
    powers = [_power(steady.force[cycle.rows].T, rate @ direction[cycle.rows].T) for cycle in at.cycles]
    loads = load_harmonics(at.system, at.period, speed, steady.harmonics, at.time)
    if np.any(loads):
        names.append(LOADS)
        powers.append(_power(loads, rate))
    return tuple(names), np.array(powers)


def _losses(
    at: Excited, speed: FloatArray, u: ComplexArray, rate: ComplexArray
) -> Iterable[tuple[str, str, FloatArray]]:
    """Yield name, kind and power (S, H) of parts; one part may come several times."""
    for part in absorbers(at.system, at.linear, at.cycles, at.time):
        yield part.name, part.kind, _lost(part, u, rate)
    if at.turning:
        terms = gyroscopic_terms(at.system, speed)
        damping, stiffness = (np.stack([term[k] for term in terms]) for k in (0, 1))
        force = np.einsum("sij,shj->shi", damping, rate) + np.einsum("sij,shj->shi", stiffness, u)
        yield FRAMES, "frame", _power(force, rate)


def _lost(part: Absorber, u: ComplexArray, rate: ComplexArray) -> FloatArray:
    """Return the power that one part takes, (S, H)."""
    along = rate @ part.rows.T
    return _power((u @ part.rows.T) @ part.stiffness.T + along @ part.damping.T, along)


def _power(force: ComplexArray, rate: ComplexArray) -> FloatArray:
    """Return the mean power of forces (..., k) on rates (..., k), peak amplitudes, W."""
    return np.asarray(0.5 * np.real(np.sum(force * rate.conj(), axis=-1)))
