"""The mesh force as an element of Exudyn, for gears on parallel axes that move in their plane.

Exudyn itself (extra ``exudyn``) is needed only when an element is added to one of its systems.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from dynamics.engines.mesh_element import MeshElement
from dynamics.errors import InputError
from dynamics.forces.by_address import by_address
from dynamics.forces.compiled import compiled
from dynamics.forces.flank_force import FlankLaws, flank_force
from dynamics.forces.packed_tables import pack_tables
from dynamics.forces.technique import table_at
from dynamics.types import FloatArray, IntArray

Drive = Callable[[float], tuple[float, float]]
"""Angle (rad) and speed (rad/s) of the driver about +z at a time."""

Force = Callable[[Any, float, int, Any, Any], FloatArray]
Jacobian = Callable[[Any, float, int, Any, Any, float, float], FloatArray]


@dataclass(frozen=True)
class PlanarMesh:
    """A mesh between two bodies with the freedoms x, y and the rotation about +z.

    Attributes
    ----------
    element : MeshElement
        Used at `misalignment` and `center_distance_change`.
    direction : (float, float)
        Unit vector along which the driver pushes the driven gear.
    sense : int
        +1 or -1: in which the driver turns about +z.
    internal : bool
        One of the gears is a ring gear.
    misalignment, center_distance_change : float
        Operating point of the table, m.
    """

    element: MeshElement
    direction: tuple[float, float]
    sense: int
    internal: bool = False
    misalignment: float = 0.0
    center_distance_change: float = 0.0

    @property
    def gradient(self) -> FloatArray:
        """Derivative of the transmission error in (x, y, angle) of driver and driven gear, (6,)."""
        n, (r1, r2) = np.array(self.direction), self.element.base_radius
        driven = self.sense * (-r2 if self.internal else r2)
        return np.array([*n, self.sense * r1, *-n, driven])

    @property
    def turn(self) -> float:
        """Base pitches per radian of the driver about +z."""
        return self.sense * self.element.teeth[0] / (2.0 * np.pi)

    def laws(self) -> FlankLaws:
        """Return the force law for the compiled look-up."""
        table = table_at(self.element.table, self.misalignment, self.center_distance_change)
        damping, reach = np.array([self.element.damping]), np.array([self.element.reach])
        return by_address(FlankLaws(pack_tables([table]), damping, reach))


def add_gear_mesh(mbs: Any, mesh: PlanarMesh, nodes: tuple[Any, Any], drive: Drive | None = None) -> Any:
    """Add the mesh to an Exudyn system as an object on the nodes of two bodies.

    Parameters
    ----------
    mbs : exudyn.MainSystem
    mesh : PlanarMesh
    nodes : (node index, node index)
        Of the driver and the driven gear: `NodeRigidBody2D`. With a `drive` the driver's is a `NodePoint2D`.
    drive : callable or None
        The driver's rotation, if it is imposed and no coordinate.

    Returns
    -------
    exudyn.ObjectIndex
        An `ObjectGenericODE2` without mass, with the force and its derivatives as user functions.

    Raises
    ------
    InputError
        If Exudyn is not installed.
    """
    items = exudyn().itemInterface
    force, jacobian = user_functions(mesh, drive)
    columns = 6 if drive is None else 5
    zero = np.zeros((columns, columns))
    return mbs.AddObject(
        items.ObjectGenericODE2(
            nodeNumbers=list(nodes),
            massMatrix=zero,
            stiffnessMatrix=zero,
            dampingMatrix=zero,
            forceVector=np.zeros(columns),
            forceUserFunction=force,
            jacobianUserFunction=jacobian,
        )
    )


def user_functions(mesh: PlanarMesh, drive: Drive | None = None) -> tuple[Force, Jacobian]:
    """Return the two functions of the mesh that Exudyn calls.

    Force: (system, t, item, q, v) to the generalized forces on the coordinates q, which are x, y, angle of
    the driver and of the driven gear, without the driver's angle if there is a `drive`. Jacobian: (system, t,
    item, q, v, a, b) to -a df/dq - b df/dv at constant position.
    """
    law, gradient = mesh.laws(), mesh.gradient if drive is None else np.delete(mesh.gradient, 2)
    facts = np.array([mesh.element.position_offset, mesh.turn, mesh.gradient[2]])
    imposed, values, hint = np.zeros(2), np.zeros(3), np.zeros(1, dtype=np.int64)
    outer = np.outer(gradient, gradient)

    def evaluate(t: float, q: Any, v: Any) -> None:
        coordinate, rate = np.asarray(q), np.asarray(v)
        if drive is not None:
            imposed[0], imposed[1] = drive(t)
        angle = coordinate[2] if drive is None else imposed[0]
        _evaluate(law, facts, gradient, angle, imposed, coordinate, rate, hint, values)

    def force(_mbs: Any, t: float, _item: int, q: Any, v: Any) -> FloatArray:
        evaluate(t, q, v)
        return np.asarray(-values[0] * gradient)

    def jacobian(_mbs: Any, t: float, _item: int, q: Any, v: Any, stiff: float, viscous: float) -> FloatArray:
        evaluate(t, q, v)
        return np.asarray((stiff * values[1] + viscous * values[2]) * outer)

    return force, jacobian


def exudyn() -> Any:
    """Return the package.

    Raises
    ------
    InputError
        If it is not installed.
    """
    try:
        import exudyn as package  # noqa: PLC0415 - an extra
        import exudyn.itemInterface  # noqa: PLC0415
    except ImportError:
        raise InputError(
            "exudyn", None, "installed", "Install the extra: pip install lineofaction[exudyn]"
        ) from None
    return package


@compiled
def _evaluate(
    law: FlankLaws,
    facts: FloatArray,
    gradient: FloatArray,
    angle: float,
    imposed: FloatArray,
    coordinate: FloatArray,
    rate: FloatArray,
    hint: IntArray,
    values: FloatArray,
) -> None:
    """Write force, stiffness and viscosity into `values`; `imposed` is what the coordinates do not hold."""
    deflection, speed = facts[2] * imposed[0], facts[2] * imposed[1]
    for k in range(gradient.size):
        deflection += gradient[k] * coordinate[k]
        speed += gradient[k] * rate[k]
    x = facts[0] + facts[1] * angle
    force, _, tangent, viscous, interval = flank_force(law, 0, x, deflection, speed, hint[0])
    values[0], values[1], values[2], hint[0] = force, tangent, viscous, interval
