"""Rest of bodies on nonlinear bearings under known forces, and the bearings' tangents there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from dynamics.arrays.arrays import SystemArrays
from dynamics.bearings import Bushing, PlanetBearing
from dynamics.bearings.matrix import congruent, matrix_rows
from dynamics.bearings.seat import SEAT, seat_matrix
from dynamics.errors import SolveError
from dynamics.forces.elements import Elements, potential
from dynamics.forces.laws import BEARING_LAW_KINDS, BEARING_PARTS, Law, among
from dynamics.kernels.by_address import by_address
from dynamics.kernels.compiled import compiled
from dynamics.kernels.local_state import LocalState
from dynamics.mechanism.bearing_elements import BearingElement
from dynamics.motion.force_balance import at_mean_loads, mean_loads, stiffness_across
from dynamics.motion.observation import local_state
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray, IntArray

ITERATIONS = 200  # most damped Newton steps
SETTLED = 1e-12  # unbalanced force over the largest force, at which the search ends
SOFTEST = 1e-9  # least damping of a step, over the largest stiffness
UNRESISTED = 1e-13  # stiffness over the largest, below which no spring resists a motion


class _Rest(NamedTuple):
    """Whether forces balance, deviation (n,) from the kinematic motion, and force left, N."""

    settled: bool
    displacement: FloatArray
    residual: float


def rest_on_bearings(arrays: SystemArrays, matrix: FloatArray, force: FloatArray) -> _Rest:
    """Return q (n,) with matrix q + bearing forces = force, `matrix` (n, n) that of all but the bearings.

    Damped Newton steps reduce energy less work of the forces, which has one lowest place: no law of a bearing
    softens. Motions that no bearing resists, wherever it is, stay zero. Where all bearings are linear,
    steps are whole from the first on.
    """
    ways = _resisted(arrays, matrix)
    largest = float(np.max(np.abs(ways.T @ matrix @ ways), initial=1.0))
    q, damping = np.zeros(force.size), max(largest, float(np.max(arrays.elements.stiffness, initial=0.0)))
    bearing = among(arrays.elements.law, BEARING_LAW_KINDS)
    if np.all(arrays.elements.law[bearing] == Law.LINEAR_BEARING):
        damping = 0.0
    now = _on_bearings(arrays, matrix, q)
    for _ in range(ITERATIONS):
        missing = ways.T @ (force - now.force)
        residual = float(np.max(np.abs(missing), initial=0.0))
        scale = max(float(np.max(np.abs(ways.T @ force), initial=0.0)), now.largest)
        if residual <= SETTLED * scale:
            return _Rest(True, q, residual)
        stiffness = ways.T @ now.stiffness @ ways
        floor = SOFTEST * float(np.max(np.abs(stiffness)))
        damping = max(damping, floor)
        step = ways @ np.linalg.solve(stiffness + damping * np.eye(missing.size), missing)
        then = _on_bearings(arrays, matrix, q + step)
        gained = float(force @ step) - (then.energy - now.energy)
        closer = np.max(np.abs(ways.T @ (force - then.force))) < residual
        if gained > 0.0 or closer:
            q, now, damping = q + step, then, damping / 10.0
        else:
            damping *= 4.0
    return _Rest(False, q, residual)


def bearing_rows(arrays: SystemArrays) -> IntArray:
    """Return the rows of bearings that are not linear."""
    bearing = among(arrays.elements.law, BEARING_LAW_KINDS)
    return np.flatnonzero(np.repeat(bearing, np.diff(arrays.elements.first)))


class _Answer(NamedTuple):
    """Force (n,) and stiffness (n, n) of all springs, the energy in them, the largest force of a bearing."""

    force: FloatArray
    stiffness: FloatArray
    energy: float
    largest: float


def _resisted(arrays: SystemArrays, matrix: FloatArray) -> FloatArray:
    """Return the motions (n, m) that springs or bearings resist, orthonormal in meters."""
    gradient = arrays.direction[bearing_rows(arrays)]
    row_stiffness = arrays.elements.stiffness[bearing_rows(arrays)]
    stiffness = matrix + gradient.T @ (row_stiffness[:, None] * gradient)
    value, vector = np.linalg.eigh(stiffness / np.outer(arrays.scale, arrays.scale))
    return np.asarray(vector[:, value > UNRESISTED * value[-1]] / arrays.scale[:, None])


def _on_bearings(arrays: SystemArrays, matrix: FloatArray, q: FloatArray) -> _Answer:
    elements = arrays.elements
    local, force, stiffness = local_state(arrays, 0.0, q, np.zeros(q.size)), matrix @ q, matrix.copy()
    largest = float(np.max(np.abs(force / arrays.scale), initial=0.0))
    bearings = np.flatnonzero(among(elements.law, BEARING_LAW_KINDS))
    for e in bearings:
        rows = slice(elements.first[e], elements.first[e + 1])
        gradient = arrays.direction[rows]
        force = force + gradient.T @ local.force[rows]
        stiffness += gradient.T @ local.tangent[rows, : gradient.shape[0]] @ gradient
        largest = max(largest, float(np.max(np.abs(local.force[rows]))))
    stored = _stored(by_address(elements), by_address(local), bearings)
    return _Answer(force, stiffness, 0.5 * float(q @ matrix @ q) + stored, largest)


@compiled
def _stored(elements: Elements, local: LocalState, chosen: IntArray) -> float:
    """Return the energy that the elements `chosen` store, J."""
    energy = 0.0
    for e in chosen:
        energy += potential(elements, local, e)[0]
    return energy


def linear_scene(
    scene: Scene,
    arrays: SystemArrays,
    bearings: Sequence[tuple[str, BearingElement]],
    supports: Mapping[str, Bushing | PlanetBearing],
    push: FloatArray,
) -> Scene:
    """Return the scene with linear bearings in place of those that are not.

    They have the tangent stiffness and damping, and by their preload the force, of where the bodies rest on
    the bearings under the forces `push` (n,) of the meshes and the loads at t = 0. `bearings` are the last
    elements with the names of their bearings, `supports` these with their dampings filled in. Raises
    `SolveError`: they do not rest.
    """
    arrays = at_mean_loads(arrays)
    torque = np.array([float(load.torque(0.0)) for load in scene.loads])
    matrix = arrays.stiffness + stiffness_across(arrays, 0.0)
    push = push + mean_loads(arrays, 0.0)
    rest = rest_on_bearings(arrays, matrix, arrays.constant + torque @ arrays.load.direction + push)
    if not rest.settled:
        raise SolveError(f"the shafts do not rest on their bearings: {rest.residual:.3g} N are left")
    q = rest.displacement
    local, linear = local_state(arrays, 0.0, q, np.zeros(q.size)), dict(supports)
    first = arrays.elements.first[arrays.elements.law.size - len(bearings) :]
    for start, (name, at) in zip(first, bearings, strict=False):
        linear[name] = _with_tangent(linear[name], at, local, slice(start, start + at.directions.shape[0]))
    parts = [linear[part.name] for part in (*scene.ground_bearings, *scene.planet_bearings)]
    none: dict[str, Any] = dict.fromkeys(BEARING_PARTS, ())
    return replace(
        scene,
        bushings=tuple(part for part in parts if isinstance(part, Bushing)),
        planet_bearings=tuple(part for part in parts if isinstance(part, PlanetBearing)),
        rolling_bearings=(),
        **none,
    )


def _with_tangent(
    bearing: Bushing | PlanetBearing, at: BearingElement, local: LocalState, rows: slice
) -> Bushing | PlanetBearing:
    """Return `bearing` with tangents and force that an element has in its `rows`."""
    spread, size = at.local_rows, at.directions.shape[0]
    added = np.zeros(SEAT) if bearing.preload is None else np.array(bearing.preload)
    stiffness = local.tangent[rows, :size]
    symmetric = 0.5 * (stiffness + stiffness.T)
    preload = added + (symmetric @ local.coordinate[rows] - local.force[rows]) @ spread
    return replace(
        bearing,
        stiffness=matrix_rows(bearing.added_stiffness + congruent(symmetric, spread)),
        damping=matrix_rows(seat_matrix(bearing.damping) + congruent(local.viscous[rows, :size], spread)),
        preload=tuple(float(value) for value in preload),
    )
