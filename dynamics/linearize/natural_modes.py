"""The natural modes of a linearized system."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from bounds import engineering
from dynamics.assembly.assemble import System
from dynamics.errors import SolveError
from dynamics.linearize.linear_system import LinearSystem, linearize
from dynamics.linearize.mode_energy import strain_shares
from dynamics.types import ComplexArray, FloatArray
from host.optional_modules import linalg


@dataclass(frozen=True)
class Modes:
    """Natural modes, by rising frequency; the motions that nothing resists come first, at 0 Hz exactly."""

    frequency: FloatArray
    """Undamped, Hz. Shape (n,)."""
    damping_ratio: FloatArray
    """Modal: shape^T C shape / (2 omega); 0 for the modes at 0 Hz. Shape (n,)."""
    shape: FloatArray
    """One mode per row, per freedom in m and rad, of unit modal mass: shape M shape^T = 1. Shape (n, n)."""
    freedom: tuple[str, ...]
    """Names of the columns, "shaft.kind"."""
    scale: FloatArray
    """Meters per unit of each freedom: ``shape * scale`` compares translations and rotations. Shape (n,)."""
    spring: tuple[str, ...]
    """Names of the springs: meshes, bearings with direction, elastic drives."""
    strain_energy: FloatArray
    """Share of each spring in the strain energy of each mode; 0 at 0 Hz. Shape (n, p)."""
    kinetic_energy: FloatArray
    """Share of each freedom in the kinetic energy of each mode. Shape (n, n)."""


def natural_modes(system: System | LinearSystem, time: float = 0.0) -> Modes:
    """Return the natural modes of `system` about its static equilibrium under the loads at `time`.

    Raises
    ------
    SolveError
        If there is no static equilibrium.
    """
    linear = linearize(system, time) if isinstance(system, System) else system
    square, shape = _solve(linear)
    omega = np.sqrt(np.maximum(square, 0.0))
    damping = np.einsum("ai,ij,aj->a", shape, linear.damping, shape)
    still = omega == 0.0
    ratio = np.where(still, 0.0, damping / np.where(still, 1.0, 2.0 * omega))
    return Modes(
        frequency=omega / (2.0 * math.pi),
        damping_ratio=ratio,
        shape=shape,
        freedom=linear.freedom,
        scale=linear.scale,
        spring=linear.spring,
        strain_energy=strain_shares(linear, shape, still),
        kinetic_energy=shape * (shape @ linear.mass),
    )


def _solve(linear: LinearSystem) -> tuple[FloatArray, FloatArray]:
    """Return squared circular frequencies (n,) and shapes (n, n) of unit modal mass.

    Rigid motions are known, so that their frequency is 0 exactly. The eigenproblem is solved for motions that
    are orthogonal to them by mass.
    """
    per_meter = 1.0 / linear.scale
    mass, stiffness = (per_meter[:, None] * a * per_meter for a in (linear.mass, linear.stiffness))
    rigid = linear.rigid * linear.scale
    if rigid.shape[0] == 0:
        square, vectors = linalg.eigh(stiffness, mass)
        return square, np.asarray(vectors.T * per_meter)
    still = np.linalg.solve(np.linalg.cholesky(rigid @ mass @ rigid.T), rigid)
    rest = linalg.null_space(still @ mass)
    square, vectors = linalg.eigh(rest.T @ stiffness @ rest, rest.T @ mass @ rest)
    shapes = np.concatenate([still, (rest @ vectors).T])
    return np.concatenate([np.zeros(still.shape[0]), square]), np.asarray(shapes * per_meter)


def unbounded(linear: LinearSystem, omega: FloatArray | ComplexArray) -> SolveError:
    """Return the error for a vibration without bound at one of the frequencies `omega`, rad/s.

    It names the mode for which the relative distance of its frequency from an excited one, plus its damping
    ratio, is the least.
    """
    modes, excited = natural_modes(linear), np.unique(np.abs(omega)) / (2.0 * math.pi)
    elastic = np.flatnonzero(modes.frequency)
    reason = "a harmonic of the speed excites an undamped mode"
    if elastic.size:
        hertz = modes.frequency[elastic]
        off = np.abs(excited[:, None] / hertz - 1.0) + modes.damping_ratio[elastic]
        at, mode = np.unravel_index(np.argmin(off), off.shape)
        part = modes.freedom[int(np.argmax(modes.kinetic_energy[elastic[mode]]))]
        reason = (
            f"{excited[at]:.6g} Hz excite the mode at {hertz[mode]:.6g} Hz, in which {part} moves most and "
        )
        reason += f"whose damping ratio is {engineering(modes.damping_ratio[elastic[mode]], 1)}"
    remedy = "Give the meshes, shafts or supports damping, or leave that speed out"
    return SolveError(f"the vibration is unbounded: {reason}. {remedy}")
