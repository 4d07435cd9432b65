"""The assembled system as plain arrays, which the compiled loops read.

A law sets the speed of a shaft over time: a drive, or the free rotation of a train without a drive. The
kinematic motion turns all shafts by exact ratios to the laws; freedoms q are the deviations from it. Local
coordinates y = G q + y0 are those in which a force element has its law.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from dynamics.arrays.sparse_rows import SparseMatrices, sparse_matrices
from dynamics.forces.elements import Elements
from dynamics.kernels.cubics import Cubics
from dynamics.loads import AngleLaw, TimeLaw
from dynamics.types import FloatArray, IntArray


def slope(law: TimeLaw | AngleLaw, moment: FloatArray) -> FloatArray:
    """Return the derivative of `law` at `moment` (s), from the right where it jumps."""
    start, coefficient = law.polynomials()
    piece = np.searchsorted(start[1:], moment, side="right")
    elapsed, c = moment - start[piece], coefficient[piece]
    return np.asarray(c[..., 1] + elapsed * (2.0 * c[..., 2] + 3.0 * elapsed * c[..., 3]), dtype=float)


def revolutions(law: TimeLaw | AngleLaw) -> tuple[FloatArray, FloatArray]:
    """Return whole and fractional revolutions at the start of each piece of a speed law; 0 at t = 0."""
    start, coefficient = law.polynomials()
    span = np.diff(start)
    turned = np.concatenate([[0.0], np.cumsum(_integral(coefficient[:-1], span))])
    piece = int(np.searchsorted(start[1:], 0.0, side="right"))
    origin = turned[piece] + _integral(coefficient[piece], np.array(-start[piece]))
    turns = (turned - origin) / (2.0 * math.pi)
    return np.floor(turns), turns - np.floor(turns)


def _integral(c: FloatArray, s: FloatArray) -> FloatArray:
    """Integral of cubics from 0 to s."""
    value = s * (c[..., 0] + s * (c[..., 1] / 2.0 + s * (c[..., 2] / 3.0 + s * c[..., 3] / 4.0)))
    return np.asarray(value, dtype=float)


class KinematicMotion(NamedTuple):
    """The kinematic motion: every shaft turns by its exact ratios to the k laws (drives, free rotations)."""

    speed: Cubics
    """Speed of each law, rad/s."""
    full_turns: FloatArray
    fraction: FloatArray
    """`full_turns`, `fraction`: Revolutions of the law at the start of each piece, integer and remainder.
    Shape (S,) each.
    """
    numerator: IntArray
    denominator: IntArray
    """`numerator`, `denominator`: Base pitches per revolution of each law for each mesh, then revolutions of
    each of f frames against another, exact fractions. Shape (m + f, k) each.
    """
    per_radian: FloatArray
    """Base pitches, or revolutions of frames, per radian of each law, rounded. Shape (m + f, k)."""
    offset: FloatArray
    """Position of each mesh at t = 0, base pitches; 0 for frames. Shape (m + f,)."""
    period: IntArray
    """Base pitches after which the mesh's table repeats; 1 for frames. Shape (m + f,)."""
    freedom: IntArray
    """Index in q of the shaft's rotation that the law of a free train sets; -1 for a drive. Shape (k,)."""
    vector: FloatArray
    """Change of q when the law's shaft turns by one radian and all parts with it. Shape (k, n)."""


class Loads(NamedTuple):
    """Load torques."""

    torque: Cubics
    """One law per load, N m."""
    direction: FloatArray
    """Generalized force per unit torque. Shape (l, n)."""
    reference: FloatArray
    """Work per unit torque and per unit angle of each law in the kinematic motion. Shape (l, k)."""
    drive: FloatArray
    """Torque on the shaft of each rigid drive per unit torque. Shape (l, k)."""


class Drives(NamedTuple):
    """Torque of each law's shaft, about +z; zero for free rotations.

    T_k = direction f + stiffness q + damping q' + inertia phi'' - constant - loads, phi'' those of all laws.
    """

    direction: FloatArray
    """Derivative of the elements' local coordinates in the rotation of a rigid drive's shaft alone. Shape (k,
    R).
    """
    stiffness: FloatArray
    damping: FloatArray
    """`stiffness`, `damping`: Stiffness and damping of the parts that the shaft's rotation strains, or of the
    drive's spring. Shape (k, n) each.
    """
    inertia: FloatArray
    """Inertia that each law's torque accelerates, per law, kg m^2. Shape (k, k)."""
    constant: FloatArray
    """Torque of pins off their nominal position, N m. Shape (k,)."""


class SystemArrays(NamedTuple):
    """n freedoms q (deviations from the kinematic motion), m meshes, force elements with R rows in all.

    M q'' + C q' + K q + G^T f(G q + y0, G q', x) = external(t).
    k laws set the kinematic motion.
    """

    mass: FloatArray
    damping: FloatArray
    stiffness: FloatArray
    """`mass`, `damping`, `stiffness`: M, C, K; symmetric. Shape (n, n) each."""
    direction: FloatArray
    """G: derivative of the elements' local coordinates in q. The first m elements are the driving flanks,
    whose first coordinate is the transmission error. Shape (R, n).
    """
    position_gradient: FloatArray
    """Derivative of the meshes' positions in q, base pitches; 0 for frames. Shape (m + f, n)."""
    sparse: SparseMatrices
    """M, C, K, G and `position_gradient` by their entries: who changes them takes `with_matrices`."""
    constant: FloatArray
    """External force that never changes: of pins off their nominal position, of preloaded bearings, of
    gravity. Shape (n,).
    """
    inertial: FloatArray
    """External force per angular acceleration of each law: minus inertia times kinematic vector. Shape (k,
    n).
    """
    total_inertia: FloatArray
    """Inertia of all bodies as seen at the laws, kg m^2: gives the kinetic energy of the kinematic motion.
    Shape (k, k).
    """
    drive: Drives
    """Arrays that give the torques of the drives, see `Drives`."""
    scale: FloatArray
    """Meters per unit of q, for error norms: 1, or a base radius for rotations. Shape (n,)."""
    rate_scale: FloatArray
    """Meters per unit of q': `scale` over the natural frequency of the freedom alone, held by its bushings
    and meshes. An error of the rate becomes an error of the displacement of this size a quarter period later.
    Shape (n,).
    """
    elements: Elements
    reference: KinematicMotion
    load: Loads

    def with_matrices(self, **matrices: Any) -> SystemArrays:
        """Return these arrays with others of the matrices that `sparse` holds, and their entries."""
        changed = self._replace(**matrices)
        springs = (changed.drive.stiffness, changed.drive.damping)
        others = (changed.inertial, changed.reference.vector, changed.load.direction, *springs)
        matrices_of_motion = (changed.mass, changed.damping, changed.stiffness)
        sparse = sparse_matrices(*matrices_of_motion, changed.direction, changed.position_gradient, others)
        return changed._replace(sparse=sparse)
