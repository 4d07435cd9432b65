"""Rows over all freedoms of all bodies: motions, forces and mass terms as arrays with N columns.

The N freedoms are, in this order: six rigid ones of each of r rotors (displacements along x, y, z, m, then
rotations about x, y, z, rad), the elastic coordinates of the flexible shafts, the amplitudes of the housings.
A rotor turns about z.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.rotor import Rotor
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray

Wrench = Callable[[FloatArray], FloatArray]
"""Function of a point (3,), m, of a body's axis: unit force and its moment about that point, (6,).

The dot product with displacement and rotation (6,) at the point is the displacement along the force.
"""

AXIAL_ROTATION = 5
"""Index of the rotation about z among the six rigid freedoms of a rotor."""


def column_count(rotors: Bodies) -> int:
    """Return N, the number of freedoms of all bodies."""
    return rotors.freedoms


def elastic_columns(rotors: Bodies, index: int) -> slice:
    """Return the columns of the elastic coordinates of the rotor `index` among the freedoms."""
    first = 6 * len(rotors) + sum(rotor.elastic_count for rotor in rotors[:index])
    return slice(first, first + rotors[index].elastic_count)


def housing_columns(rotors: Bodies, index: int) -> slice:
    """Return the columns of the amplitudes of the housing `index` among the freedoms."""
    sizes = [housing.stiffness.size for housing in rotors.housings[: index + 1]]
    first = rotors.first_of_housings + sum(sizes[:index])
    return slice(first, first + sizes[index])


def rigid_motion(arm: FloatArray) -> FloatArray:
    """Return displacement and rotation of a point per rigid freedom of its body, (6, 6).

    The point is at `arm` (3,), m, from the body's center: u_point = u + r x arm for the small rotation r.
    """
    x, y, z = arm.tolist()
    return np.array(
        [
            [1.0, 0.0, 0.0, 0.0, z, -y],
            [0.0, 1.0, 0.0, -z, 0.0, x],
            [0.0, 0.0, 1.0, y, -x, 0.0],
            [0.0, 0.0, 0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
        ]
    )


def section(rotor: Rotor, point: FloatArray) -> FloatArray:
    """Return the motion of a rotor at `point` (3,) per rigid freedom, (6, 6): displacement and rotation."""
    return rigid_motion(point - rotor.center)


def section_rows(rotors: Bodies, index: int, z: float) -> FloatArray:
    """Return the motion of the section at the height z of the rotor `index` per freedom, (6, N)."""
    rotor, rows = rotors[index], np.zeros((6, column_count(rotors)))
    rows[:, 6 * index : 6 * index + 6] = section(rotor, np.array([*rotor.center[:2], z]))
    if rotor.elastic is not None:
        along = rotor.on_shaft(z - rotor.shaft.origin[2])
        rows[:, elastic_columns(rotors, index)] = rotor.elastic.motion(along)
    return rows


def gear_row(scene: Scene, rotors: Bodies, parts: Sequence[tuple[str, Wrench]]) -> FloatArray:
    """Return the displacement along forces on gears per freedom, summed over the gears, (N,).

    `parts` are names of gears with the wrench on each. A gear is rigid and moves as the section of its shaft
    at mid-face.
    """
    row = np.zeros(column_count(rotors))
    for name, wrench in parts:
        gear = scene.gear(name)
        index = scene.shaft_index(gear.shaft)
        rotor = rotors[index]
        row[6 * index : 6 * index + 6] += wrench(rotor.center)
        if rotor.elastic is not None:
            middle = np.array([*rotor.center[:2], rotor.shaft.origin[2] + gear.position])
            motion = rotor.elastic.motion(gear.position)
            row[elastic_columns(rotors, index)] += wrench(middle) @ motion
    return row


def turn_row(rotors: Bodies, index: int, position: float) -> FloatArray:
    """Return the rotation of the rotor `index` at `position` (m) along its shaft per freedom, (N,)."""
    rows = section_rows(rotors, index, rotors[index].shaft.origin[2] + position)
    return np.asarray(rows[AXIAL_ROTATION], dtype=float)


def elastic_terms(rotors: Bodies) -> tuple[FloatArray, FloatArray]:
    """Return the modal stiffness (N,) and damping (N, N) of flexible shafts and housings.

    Rigid freedoms have zeros: bearings and meshes are not part of the bodies.
    """
    count = column_count(rotors)
    stiffness, damping = np.zeros(count), np.zeros((count, count))
    for index, rotor in enumerate(rotors):
        if rotor.elastic is not None:
            columns = elastic_columns(rotors, index)
            stiffness[columns] = rotor.elastic.stiffness
            damping[columns, columns] = np.diag(rotor.elastic.damping)
    for index, housing in enumerate(rotors.housings):
        columns = housing_columns(rotors, index)
        stiffness[columns] = housing.stiffness
        damping[columns, columns] = housing.damping
    return stiffness, damping


def mass_terms(rotors: Bodies) -> tuple[FloatArray, FloatArray]:
    """Return the diagonal of the mass matrix, (N,), and its coupling of rotations with all freedoms, (N, r).

    Column k of the coupling belongs to the rotation of rotor k about z. Rigid freedoms are the motions of the
    centers of mass, which elastic coordinates leave at rest, so most couplings are 0. A shaft whose rotation
    is imposed at one position is the exception: its torsion is relative to that position, and its torsional
    coordinates couple with the rotation. Amplitudes of housings have unit modal mass.
    """
    inertia = [rotor.inertia for rotor in rotors]
    rigid = [[i.mass, i.mass, i.mass, i.transverse, i.transverse, i.polar] for i in inertia]  # (r, 6)
    diagonal = np.zeros(column_count(rotors))
    diagonal[: 6 * len(rotors)] = np.array(rigid, dtype=float).ravel()
    coupling = np.zeros((diagonal.size, len(rotors)))
    for index, rotor in enumerate(rotors):
        if rotor.elastic is not None:
            columns = elastic_columns(rotors, index)
            diagonal[columns] = rotor.elastic.mass
            coupling[columns, index] = rotor.elastic.turned
    diagonal[rotors.first_of_housings :] = 1.0
    return diagonal, coupling


def times_mass(rotors: Bodies, rows: FloatArray) -> FloatArray:
    """Return `rows` (k, N) times the mass matrix."""
    diagonal, coupling = mass_terms(rotors)
    product = rows * diagonal
    if np.any(coupling):
        rotations = 6 * np.arange(len(rotors)) + AXIAL_ROTATION
        product = product + rows[:, rotations] @ coupling.T
        product[:, rotations] += rows @ coupling
    return np.asarray(product)
