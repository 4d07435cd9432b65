"""Rest of bodies on nonlinear bearings under known forces, and the bearings' tangents there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from dynamics.arrays.arrays import SystemArrays
from dynamics.assembly.frame_couplings import stiffness_across
from dynamics.forces.element_laws import Law
from dynamics.joints import Bushing, PlanetBearing
from dynamics.joints.matrix import Matrix, congruent
from dynamics.joints.seat import SEAT, seat_matrix
from dynamics.mechanism.bearing_elements import BearingElement
from dynamics.motion.observation import local_state
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray, IntArray

ITERATIONS = 200
SETTLED = 1e-13  # of the largest displacement


def rest_on_bearings(arrays: SystemArrays, matrix: FloatArray, force: FloatArray) -> FloatArray:
    """Return q (n,) with matrix q + bearing forces = force, `matrix` (n, n) that of all but the bearings.

    Rolling contacts count as springs of the secant that their force so far has, which is right at once where
    statics alone fixes the forces; curves as their tangents. Motions that nothing resists stay zero.
    """
    rows = bearing_rows(arrays)
    gradient = arrays.direction[rows]
    stiffness, offset = arrays.elements.stiffness[rows], np.zeros(rows.size)
    q = np.zeros(force.size)
    for _ in range(ITERATIONS):
        left = matrix + gradient.T @ (stiffness[:, None] * gradient)
        solution = np.asarray(np.linalg.lstsq(left, force - offset @ gradient, rcond=1e-13)[0])
        if np.max(np.abs(solution - q), initial=0.0) <= SETTLED * np.max(np.abs(solution), initial=0.0):
            return solution
        q = solution
        stiffness, offset = _springs(arrays, q, rows, stiffness * (gradient @ q) + offset)
    return q


def bearing_rows(arrays: SystemArrays) -> IntArray:
    """Return the rows of bearings that are not linear."""
    bearing = np.isin(arrays.elements.law, (Law.ROLLING_CONTACT, Law.SPRING_CURVE))
    return np.flatnonzero(np.repeat(bearing, np.diff(arrays.elements.first)))


def _springs(
    arrays: SystemArrays, q: FloatArray, rows: IntArray, force: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Stiffnesses and forces at no displacement of the bearings' rows, which now carry `force`."""
    elements, laws = arrays.elements, arrays.elements.laws
    local = local_state(arrays, 0.0, q, np.zeros(q.size))
    on_row = np.zeros(elements.offset.size)
    on_row[rows] = force
    stiffness, offset = np.zeros(elements.offset.size), np.zeros(elements.offset.size)
    for e, law in enumerate(elements.law):
        first, end = elements.first[e], elements.first[e + 1]
        if law == Law.ROLLING_CONTACT:
            entry = elements.entry[e]
            carried = float(np.linalg.norm(on_row[first:end]))
            press = (carried / laws.rolling_contact.stiffness[entry]) ** (
                1.0 / laws.rolling_contact.exponent[entry]
            )
            way = laws.rolling_contact.clearance[entry] + press
            stiffness[first:end] = carried / way if way > 0.0 else 0.0
        elif law == Law.SPRING_CURVE:
            stiffness[first] = local.tangent[first, 0]
            offset[first] = local.force[first] - local.tangent[first, 0] * local.coordinate[first]
    return stiffness[rows], offset[rows]


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
    elements with the names of their bearings, `supports` these with their dampings filled in.
    """
    torque = np.array([float(load.torque(0.0)) for load in scene.loads])
    matrix = arrays.stiffness + stiffness_across(arrays, 0.0)
    q = rest_on_bearings(arrays, matrix, arrays.constant + torque @ arrays.load.direction + push)
    local, linear = local_state(arrays, 0.0, q, np.zeros(q.size)), dict(supports)
    first = arrays.elements.first[arrays.elements.law.size - len(bearings) :]
    for start, (name, at) in zip(first, bearings, strict=False):
        size = at.way.shape[0]
        rows = slice(start, start + size)
        state = (
            local.force[rows],
            local.tangent[rows, :size],
            local.viscous[rows, :size],
            local.coordinate[rows],
        )
        linear[name] = with_tangent(linear[name], at, *state)
    parts = [linear[part.name] for part in (*scene.bushings, *scene.planet_bearings)]
    return replace(
        scene,
        bushings=tuple(part for part in parts if isinstance(part, Bushing)),
        planet_bearings=tuple(part for part in parts if isinstance(part, PlanetBearing)),
        rolling_contacts=(),
        spring_curves=(),
    )


def with_tangent(
    bearing: Bushing | PlanetBearing,
    at: BearingElement,
    force: FloatArray,
    stiffness: FloatArray,
    damping: FloatArray,
    coordinate: FloatArray,
) -> Bushing | PlanetBearing:
    """Return `bearing` with an element's tangents (p, p) and its `force` (p,) at the `coordinate` (p,)."""
    spread = at.own
    added = np.zeros(SEAT) if bearing.preload is None else np.array(bearing.preload)
    symmetric = 0.5 * (stiffness + stiffness.T)
    return replace(
        bearing,
        stiffness=_rows(bearing.added_stiffness + congruent(symmetric, spread)),
        damping=_rows(seat_matrix(bearing.damping) + congruent(damping, spread)),
        preload=tuple(float(value) for value in added + (symmetric @ coordinate - force) @ spread),
    )


def _rows(matrix: FloatArray) -> Matrix:
    """Return a matrix as tuples."""
    return tuple(tuple(float(value) for value in row) for row in matrix)
