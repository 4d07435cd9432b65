"""Natural modes of a linearized system: frequencies, shapes, damping, and where their energy is."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh, null_space

from dynamics.assembly.assemble import System
from dynamics.linearize.linear_system import LinearSystem, linearize
from dynamics.types import ComplexArray, FloatArray

# Distribution of the energy of a mode: strain energy by spring, kinetic energy by freedom.


HELD_BY = ("mesh", "bearing", "coupling", "drive", "shaft", "housing")
MOVES = {
    "x": "lateral",
    "y": "lateral",
    "z": "axial",
    "tilt_x": "tilting",
    "tilt_y": "tilting",
    "rotation": "torsional",
    "bending_x": "bending",
    "bending_y": "bending",
    "stretch": "axial",
    "twist": "torsional",
    "mode": "housing",
}


def strain_shares(
    linear: LinearSystem, shape: FloatArray | ComplexArray, still: NDArray[np.bool_] | None = None
) -> FloatArray:
    """Return the share of each spring in the strain energy of each mode, (a, p); mean over a cycle.

    `shape` (a, n) holds one mode per row; those that are `still` (a,), motions that nothing resists, get 0.
    """
    energy = linear.spring_stiffness * np.abs(shape @ linear.strain.T) ** 2
    total = np.sum(energy, axis=1, keepdims=True)
    none = total <= 0.0 if still is None else (total <= 0.0) | still[:, None]
    return np.asarray(np.where(none, 0.0, energy / np.where(total > 0.0, total, 1.0)))


def kinetic_shares(linear: LinearSystem, shape: FloatArray | ComplexArray) -> FloatArray:
    """Return the share of each freedom in the kinetic energy of each mode, (a, n); mean over a cycle."""
    energy = np.real(np.conj(shape) * (shape @ linear.mass))
    return np.asarray(energy / np.sum(energy, axis=1, keepdims=True))


def spring_parts(system: System, spring: Sequence[str]) -> tuple[tuple[str, str], ...]:
    """Return the part that each of `spring` belongs to and its kind, one of `HELD_BY`.

    The springs of a bearing's directions are one part, and so are the modes of a housing; a housing without
    mass is one with its bearings. What is no mesh, bearing, housing, coupling or drive is of a shaft that
    bends.
    """
    scene = system.scene
    kinds = {part.name: "housing" for part in system.rotors.housings}
    condensed = (part.name for part in scene.housings if part.name not in kinds)
    kinds |= dict.fromkeys((*system.supports.name, *condensed), "bearing")
    kinds |= {part.name: "coupling" for part in scene.couplings}
    kinds |= {part.name: "drive" for part in scene.drives}
    meshes = {mesh.name for mesh in scene.meshes}
    parts = []
    for index, name in enumerate(spring):
        part = name
        if index < len(scene.meshes) and name in meshes:
            parts.append((name, "mesh"))
            continue
        if name not in kinds:
            part = name.rpartition(".")[0]
        parts.append((part or name, kinds.get(part, "shaft")))
    return tuple(parts)


def freedom_parts(freedom: Sequence[str]) -> tuple[tuple[str, str], ...]:
    """Return the body of each freedom "body.kind" and how it moves along it, one of the `MOVES`."""
    pairs = [name.rpartition(".")[::2] for name in freedom]
    return tuple((shaft, MOVES[kind.rstrip("_0123456789")]) for shaft, kind in pairs)


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
