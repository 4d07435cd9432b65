"""Rows over all freedoms of all bodies.

Six rigid ones of each rotor, then flexible shafts' elastic coordinates, then the amplitudes of housings.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.rotor import Rotor
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray

Wrench = Callable[[FloatArray], FloatArray]
"""Force and moment (6,) about a point (3,) of the axis: a row of the motion of a body about that point."""


def column_count(rotors: Bodies) -> int:
    """Return N, the number of freedoms of all bodies."""
    return rotors.freedoms


def elastic_columns(rotors: Bodies, index: int) -> slice:
    """Return where the elastic coordinates of the rotor `index` are among the freedoms."""
    first = 6 * len(rotors) + sum(rotor.elastic_count for rotor in rotors[:index])
    return slice(first, first + rotors[index].elastic_count)


def housing_columns(rotors: Bodies, index: int) -> slice:
    """Return where the amplitudes of the housing `index` are among the freedoms."""
    sizes = [housing.stiffness.size for housing in rotors.housings[: index + 1]]
    first = rotors.first_of_housings + sum(sizes[:index])
    return slice(first, first + sizes[index])


def rigid_motion(arm: FloatArray) -> FloatArray:
    """Return displacement and rotation at `arm` (3,) from a body's center per freedom of the body, (6, 6).

    u_point = u + r x arm for the small rotation r.
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
    """Return the sum over gears, by name, of the row their wrenches are, (N,).

    A gear is rigid and moves as the section of its shaft at mid-face.
    """
    row = np.zeros(column_count(rotors))
    for name, wrench in parts:
        gear = scene.gear(name)
        index = scene.shaft_index(gear.shaft)
        rotor = rotors[index]
        row[6 * index : 6 * index + 6] += wrench(rotor.center)
        if rotor.elastic is not None:
            middle = np.array([*rotor.center[:2], rotor.shaft.origin[2] + gear.position])
            moves = rotor.elastic.motion(gear.position)
            row[elastic_columns(rotors, index)] += wrench(middle) @ moves
    return row


def turn_row(rotors: Bodies, index: int, position: float) -> FloatArray:
    """Return the rotation of the rotor `index` at `position` (m) along its shaft per freedom, (N,)."""
    rows = section_rows(rotors, index, rotors[index].shaft.origin[2] + position)
    return np.asarray(rows[5], dtype=float)


def elastic_terms(rotors: Bodies) -> tuple[FloatArray, FloatArray]:
    """Return stiffness (N,) and damping (N, N) of the bodies themselves: elastic coordinates, amplitudes."""
    count = column_count(rotors)
    stiffness, damping = np.zeros(count), np.zeros((count, count))
    for index, rotor in enumerate(rotors):
        if rotor.elastic is not None:
            at = elastic_columns(rotors, index)
            stiffness[at], damping[at, at] = (
                rotor.elastic.stiffness,
                np.diag(rotor.elastic.damping),
            )
    for index, housing in enumerate(rotors.housings):
        at = housing_columns(rotors, index)
        stiffness[at], damping[at, at] = housing.stiffness, housing.damping
    return stiffness, damping


def mass_terms(rotors: Bodies) -> tuple[FloatArray, FloatArray]:
    """Return the diagonal of the mass matrix, (N,), and how rotations couple with all freedoms, (N, r).

    Rigid freedoms are those of the centers of mass, which elastic coordinates leave at rest. Only where a
    rotation is imposed at one position, torsion is measured against that and coupled with it. Amplitudes of
    housings have unit modal mass.
    """
    inertia = [rotor.inertia for rotor in rotors]
    rigid = [[i.mass, i.mass, i.mass, i.transverse, i.transverse, i.polar] for i in inertia]
    diagonal = np.zeros(column_count(rotors))
    diagonal[: 6 * len(rotors)] = np.array(rigid, dtype=float).ravel()
    turned = np.zeros((diagonal.size, len(rotors)))
    for index, rotor in enumerate(rotors):
        if rotor.elastic is not None:
            columns = elastic_columns(rotors, index)
            diagonal[columns], turned[columns, index] = rotor.elastic.mass, rotor.elastic.turned
    diagonal[rotors.first_of_housings :] = 1.0
    return diagonal, turned


def times_mass(rotors: Bodies, rows: FloatArray) -> FloatArray:
    """Return `rows` (k, N) times the mass matrix."""
    diagonal, turned = mass_terms(rotors)
    product = rows * diagonal
    if np.any(turned):
        rotations = 6 * np.arange(len(rotors)) + 5
        product = product + rows[:, rotations] @ turned.T
        product[:, rotations] += rows @ turned
    return np.asarray(product)
