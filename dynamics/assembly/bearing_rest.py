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
    """The end of the search for a rest."""

    settled: bool
    """Whether the forces balance."""
    displacement: FloatArray
    """Deviation from the kinematic motion. Shape (n,)."""
    residual: float
    """Largest unbalanced force, N."""


def rest_on_bearings(arrays: SystemArrays, matrix: FloatArray, force: FloatArray) -> _Rest:
    """Return q (n,) with matrix q + bearing forces = force, `matrix` (n, n) that of all but the bearings.

    Damped Newton steps lower the potential: the energy of the springs less the work of the forces. It has a
    single minimum, because no law of a bearing softens. Motions that no bearing resists at any displacement
    stay zero. Where all bearings are linear, the first step is undamped and leads to the rest.
    """
    motions = _resisted(arrays, matrix)
    largest = float(np.max(np.abs(motions.T @ matrix @ motions), initial=1.0))
    q, damping = np.zeros(force.size), max(largest, float(np.max(arrays.elements.stiffness, initial=0.0)))
    bearing = among(arrays.elements.law, BEARING_LAW_KINDS)
    if np.all(arrays.elements.law[bearing] == Law.LINEAR_BEARING):
        damping = 0.0
    reaction = _on_bearings(arrays, matrix, q)
    for _ in range(ITERATIONS):
        unbalanced = motions.T @ (force - reaction.force)
        residual = float(np.max(np.abs(unbalanced), initial=0.0))
        scale = max(float(np.max(np.abs(motions.T @ force), initial=0.0)), reaction.largest)
        if residual <= SETTLED * scale:
            return _Rest(settled=True, displacement=q, residual=residual)
        stiffness = motions.T @ reaction.stiffness @ motions
        damping = max(damping, SOFTEST * float(np.max(np.abs(stiffness))))
        step = motions @ np.linalg.solve(stiffness + damping * np.eye(unbalanced.size), unbalanced)
        trial = _on_bearings(arrays, matrix, q + step)
        potential_drop = float(force @ step) - (trial.energy - reaction.energy)
        is_closer = np.max(np.abs(motions.T @ (force - trial.force))) < residual
        if potential_drop > 0.0 or is_closer:
            q, reaction, damping = q + step, trial, damping / 10.0
        else:
            damping *= 4.0
    return _Rest(settled=False, displacement=q, residual=residual)


def bearing_rows(arrays: SystemArrays) -> IntArray:
    """Return the rows of bearings that are not linear."""
    bearing = among(arrays.elements.law, BEARING_LAW_KINDS)
    return np.flatnonzero(np.repeat(bearing, np.diff(arrays.elements.first)))


class _Reaction(NamedTuple):
    """The reaction of all springs, bearings among them, to a displacement."""

    force: FloatArray
    """Force on the freedoms. Shape (n,)."""
    stiffness: FloatArray
    """Derivative of the force. Shape (n, n)."""
    energy: float
    """Energy in the springs, J."""
    largest: float
    """Largest force, of a bearing or of the other springs, N."""


def _resisted(arrays: SystemArrays, matrix: FloatArray) -> FloatArray:
    """Return the motions (n, m) that springs or bearings resist, orthonormal in meters."""
    gradient = arrays.direction[bearing_rows(arrays)]
    row_stiffness = arrays.elements.stiffness[bearing_rows(arrays)]
    stiffness = matrix + gradient.T @ (row_stiffness[:, None] * gradient)
    value, vector = np.linalg.eigh(stiffness / np.outer(arrays.scale, arrays.scale))
    return np.asarray(vector[:, value > UNRESISTED * value[-1]] / arrays.scale[:, None])


def _on_bearings(arrays: SystemArrays, matrix: FloatArray, q: FloatArray) -> _Reaction:
    elements = arrays.elements
    local = local_state(arrays, time=0.0, q=q, v=np.zeros(q.size))
    force, stiffness = matrix @ q, matrix.copy()
    largest = float(np.max(np.abs(force / arrays.scale), initial=0.0))
    bearings = np.flatnonzero(among(elements.law, BEARING_LAW_KINDS))
    for e in bearings:
        rows = slice(elements.first[e], elements.first[e + 1])
        gradient = arrays.direction[rows]
        force = force + gradient.T @ local.force[rows]
        stiffness += gradient.T @ local.tangent[rows, : gradient.shape[0]] @ gradient
        largest = max(largest, float(np.max(np.abs(local.force[rows]))))
    stored = _stored(by_address(elements), by_address(local), bearings)
    return _Reaction(force, stiffness, 0.5 * float(q @ matrix @ q) + stored, largest)


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
    mesh_force: FloatArray,
) -> Scene:
    """Return the scene with a linear bearing in place of each nonlinear one.

    The bodies rest on the bearings under the forces `mesh_force` (n,) of the meshes and the loads at t = 0. A
    linear bearing has the tangent stiffness and damping of the nonlinear one in this rest, and by its preload
    the same force.

    `bearings` are the last elements of `arrays`, with the names of their bearings. `supports` are these
    bearings by name, with their dampings filled in. Raises `SolveError`: the bodies do not rest.
    """
    arrays = at_mean_loads(arrays)
    torque = np.array([float(load.torque(0.0)) for load in scene.loads])
    matrix = arrays.stiffness + stiffness_across(arrays, 0.0)
    known_force = mesh_force + mean_loads(arrays, 0.0)
    force = arrays.constant + torque @ arrays.load.direction + known_force
    rest = rest_on_bearings(arrays, matrix, force)
    if not rest.settled:
        raise SolveError(f"the shafts do not rest on their bearings: {rest.residual:.3g} N are left")
    q = rest.displacement
    local, linear = local_state(arrays, time=0.0, q=q, v=np.zeros(q.size)), dict(supports)
    first = arrays.elements.first[arrays.elements.law.size - len(bearings) :]  # and the end of the last one
    for start, (name, element) in zip(first, bearings, strict=False):
        rows = slice(start, start + element.directions.shape[0])
        linear[name] = _with_tangent(linear[name], element, local, rows)
    parts = [linear[part.name] for part in (*scene.ground_bearings, *scene.planet_bearings)]
    no_laws: dict[str, Any] = dict.fromkeys(BEARING_PARTS, ())
    return replace(
        scene,
        bushings=tuple(part for part in parts if isinstance(part, Bushing)),
        planet_bearings=tuple(part for part in parts if isinstance(part, PlanetBearing)),
        rolling_bearings=(),
        **no_laws,
    )


def _with_tangent(
    bearing: Bushing | PlanetBearing, element: BearingElement, local: LocalState, rows: slice
) -> Bushing | PlanetBearing:
    """Return `bearing` with the tangents and the force that its element has in its `rows`."""
    seat_rows, size = (
        element.local_rows,
        element.directions.shape[0],
    )  # strains of the element per seat motion
    preload = np.zeros(SEAT) if bearing.preload is None else np.array(bearing.preload)
    stiffness = local.tangent[rows, :size]
    symmetric = 0.5 * (stiffness + stiffness.T)
    preload = preload + (symmetric @ local.coordinate[rows] - local.force[rows]) @ seat_rows
    return replace(
        bearing,
        stiffness=matrix_rows(bearing.added_stiffness + congruent(symmetric, seat_rows)),
        damping=matrix_rows(seat_matrix(bearing.damping) + congruent(local.viscous[rows, :size], seat_rows)),
        preload=tuple(float(value) for value in preload),
    )
