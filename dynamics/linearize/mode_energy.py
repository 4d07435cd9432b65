"""The energy of a mode by parts: strain energy by spring, kinetic energy by freedom."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from dynamics.assembly.assemble import System
from dynamics.linearize.linear_system import LinearSystem
from dynamics.types import ComplexArray, FloatArray

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
    without = total <= 0.0 if still is None else (total <= 0.0) | still[:, None]
    return np.asarray(np.where(without, 0.0, energy / np.where(total > 0.0, total, 1.0)))


def kinetic_shares(linear: LinearSystem, shape: FloatArray | ComplexArray) -> FloatArray:
    """Return the share of each freedom in the kinetic energy of each mode, (a, n); mean over a cycle."""
    energy = np.real(np.conj(shape) * (shape @ linear.mass))
    return np.asarray(energy / np.sum(energy, axis=1, keepdims=True))


def spring_parts(system: System, spring: Sequence[str]) -> tuple[tuple[str, str], ...]:
    """Return the part that each of `spring` belongs to and its kind, one of `SPRING_KINDS`.

    The springs of a bearing's directions are one part, and so are the modes of a housing; a housing without
    mass is one with its bearings. All other springs are those of shafts that bend. Meshes come first, in the
    order of the scene; a name "part.direction" is a spring of that part.
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
