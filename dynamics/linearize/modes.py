"""Natural modes of a linearized system: frequencies, shapes, damping, and where their energy is."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh, null_space

from dynamics.assembly.assemble import System
from dynamics.linearize.energy_shares import strain_shares
from dynamics.linearize.linear_system import LinearSystem, linearize
from dynamics.types import FloatArray


@dataclass(frozen=True)
class Modes:
    """Natural modes, by rising frequency; the motions that nothing resists come first, at 0 Hz exactly.

    Attributes
    ----------
    frequency : (n,) array
        Undamped, Hz.
    damping_ratio : (n,) array
        Modal: shape^T C shape / (2 omega); 0 for the modes at 0 Hz.
    shape : (n, n) array
        One mode per row, per freedom in m and rad, of unit modal mass: shape M shape^T = 1.
    freedom : tuple of str
        Names of the columns, "shaft.kind".
    scale : (n,) array
        Meters per unit of each freedom: ``shape * scale`` compares translations and rotations.
    spring : tuple of str
        Names of the springs: meshes, bearings with direction, elastic drives.
    strain_energy : (n, p) array
        Share of each spring in the strain energy of each mode; 0 at 0 Hz.
    kinetic_energy : (n, n) array
        Share of each freedom in the kinetic energy of each mode.
    """

    frequency: FloatArray
    damping_ratio: FloatArray
    shape: FloatArray
    freedom: tuple[str, ...]
    scale: FloatArray
    spring: tuple[str, ...]
    strain_energy: FloatArray
    kinetic_energy: FloatArray


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
        omega / (2.0 * math.pi),
        ratio,
        shape,
        linear.freedom,
        linear.scale,
        linear.spring,
        strain_shares(linear, shape, still),
        shape * (shape @ linear.mass),
    )


def _solve(linear: LinearSystem) -> tuple[FloatArray, FloatArray]:
    """Squared circular frequencies (n,) and shapes (n, n) of unit modal mass, rigid motions exactly."""
    per_meter = 1.0 / linear.scale
    mass, stiffness = (per_meter[:, None] * a * per_meter for a in (linear.mass, linear.stiffness))
    rigid = linear.rigid * linear.scale
    if rigid.shape[0] == 0:
        square, vectors = eigh(stiffness, mass)
        return square, np.asarray(vectors.T * per_meter)
    still = np.linalg.solve(np.linalg.cholesky(rigid @ mass @ rigid.T), rigid)
    rest = null_space(still @ mass)
    square, vectors = eigh(rest.T @ stiffness @ rest, rest.T @ mass @ rest)
    shapes = np.concatenate([still, (rest @ vectors).T])
    return np.concatenate([np.zeros(still.shape[0]), square]), np.asarray(shapes * per_meter)
