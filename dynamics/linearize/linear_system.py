"""Mass, damping and stiffness of a system about its static equilibrium."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.errors import SolveError
from dynamics.forces.flank_force import flank_force
from dynamics.integrators import StaticSolution, static_equilibrium
from dynamics.system.assemble import System
from dynamics.system.observation import observe_flanks
from dynamics.types import FloatArray


@dataclass(frozen=True)
class LinearSystem:
    """M dq'' + C dq' + K dq = 0 for small dq about the equilibrium, n freedoms, m flanks.

    How forces change with the flanks' positions is left out: of the order of a deflection over a base pitch.

    Attributes
    ----------
    freedom : tuple of str
        "shaft.kind", as in `Freedoms`.
    scale : (n,) array
        Metres per unit of each freedom: 1, or a radius for rotations.
    mass, damping, stiffness : (n, n) arrays
        M, C, K; symmetric.
    rigid : (k, n) array
        Motions that nothing resists: those of trains without a drive.
    spring : tuple of str
        Names of all springs: meshes, bearings with direction, couplings (once per principal stiffness),
        elastic drives.
    strain : (p, n) array
        Strain of each spring per freedom, m or rad.
    spring_stiffness : (p,) array
        N/m or N m/rad.
    equilibrium : StaticSolution
    """

    freedom: tuple[str, ...]
    scale: FloatArray
    mass: FloatArray
    damping: FloatArray
    stiffness: FloatArray
    rigid: FloatArray
    spring: tuple[str, ...]
    strain: FloatArray
    spring_stiffness: FloatArray
    equilibrium: StaticSolution


def linearize(system: System, time: float = 0.0) -> LinearSystem:
    """Linearise `system` about its static equilibrium under the loads at `time`.

    Raises
    ------
    SolveError
        If there is no static equilibrium.
    """
    start = static_equilibrium(system, time)
    if not start.status.usable:
        raise SolveError(f"no static equilibrium: {start.status.name.lower()}, {start.residual:.3g} N left")
    arrays = system.arrays
    tangent, viscous = _flank_derivatives(system, time, start.displacement)
    free = arrays.reference.freedom >= 0
    names, strain, coefficient = _springs(system, tangent)
    return LinearSystem(
        system.freedoms.name,
        arrays.scale,
        arrays.mass,
        arrays.damping + np.einsum("fi,f,fj->ij", arrays.direction, viscous, arrays.direction),
        arrays.stiffness + np.einsum("fi,f,fj->ij", arrays.direction, tangent, arrays.direction),
        arrays.reference.vector[free],
        names,
        strain,
        coefficient,
        start,
    )


def _flank_derivatives(system: System, time: float, q: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Tangent stiffness and damping of every flank at rest in `q`, (m,) each."""
    arrays = system.arrays
    observed = observe_flanks(arrays, np.array([time]), q[None, :], np.zeros((1, q.size)))[:, :, 0]
    laws = [
        flank_force(arrays.flank, f, observed[0, f], observed[1, f], 0.0, 0) for f in range(observed.shape[1])
    ]
    return np.array([law[2] for law in laws]), np.array([law[3] for law in laws])


def _springs(system: System, tangent: FloatArray) -> tuple[tuple[str, ...], FloatArray, FloatArray]:
    """Names, strains per freedom and stiffnesses of all springs."""
    names = [mesh.name for mesh in system.scene.meshes]
    rows, stiffness = [system.arrays.direction], [tangent]
    supports = system.supports
    moves = system.freedoms.keep(supports.motion)
    names += [f"{name}.{axis}" for name in supports.name for axis in "xyz"]
    rows.append(moves.reshape(-1, moves.shape[-1]))
    stiffness.append(supports.stiffness.ravel())
    for name, motion, matrix in zip(
        system.couplings.name, system.couplings.motion, system.couplings.stiffness, strict=True
    ):
        values, vectors = np.linalg.eigh(matrix)
        for value, vector in zip(values, vectors.T, strict=True):
            if value > 0.0:
                names.append(name)
                rows.append(system.freedoms.keep(vector @ motion)[None, :])
                stiffness.append(np.array([value]))
    for shaft, drive in zip(system.kinematics.law_shaft, system.scene.drives, strict=False):
        if drive.stiffness is not None:
            names.append(drive.name)
            rows.append((system.freedoms.place == 6 * shaft + 5).astype(float)[None, :])
            stiffness.append(np.array([drive.stiffness]))
    return tuple(names), np.concatenate(rows), np.concatenate(stiffness)
