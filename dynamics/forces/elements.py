"""Compiled force elements: one evaluation for all, which hands each to its law by kind.

An element is one flank, bearing, load or coupling with its local coordinates y = G q + y0 in meters. Its law
gives the force; `entry` is its place in the arrays of that law.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from inspect import signature
from typing import Any, NamedTuple, get_args, get_type_hints

import numpy as np

from dynamics.bearings.linear_bearing import linear_bearing
from dynamics.forces.laws import COMPILED, Compiled, ElementLaws, Law
from dynamics.kernels.by_address import by_address
from dynamics.kernels.compiled import inner
from dynamics.kernels.local_state import LocalState
from dynamics.kernels.routine import routine
from dynamics.meshes.spatial_flank import spatial_energy
from dynamics.types import FloatArray, IntArray

# numba takes the numbers of kinds from names of this file
FLANK, SPATIAL_FLANK, ROTATING_FRAME = int(Law.FLANK), int(Law.SPATIAL_FLANK), int(Law.ROTATING_FRAME)
SPEED_TORQUE, APPLIED_FORCE, UNBALANCE = int(Law.SPEED_TORQUE), int(Law.APPLIED_FORCE), int(Law.UNBALANCE)
LINEAR_BEARING = int(Law.LINEAR_BEARING)
TURNED = tuple(int(law) for law, row in COMPILED.items() if "turned" in signature(row.force).parameters)
"""Laws whose position is the turn of a frame or a cage."""

_ARGUMENTS = {
    "entry": "elements.entry[e]",
    "local": "local",
    "row": "elements.first[e]",
    "e": "e",
    "mesh": "elements.mesh[e]",
    "turned": "elements.mesh[e]",
}


@dataclass(frozen=True)
class Element:
    """One element with p local coordinates y = gradient q + offset, in meters."""

    law: Law
    entry: int
    """Index of the element in the arrays of its law."""
    mesh: int
    """Mesh whose position the element reads; -1: none."""
    gradient: FloatArray
    """Gradient of the local coordinates in the six freedoms of all r rotors. Shape (p, N)."""
    offset: FloatArray
    """Local coordinates at q = 0, m. Shape (p,)."""
    drift: FloatArray | None = None
    """Rate of the coordinates per unit speed of each law of the kinematic motion, m/rad; None: 0. Shape (p,
    k).
    """
    stiffness: FloatArray | None = None
    """Typical stiffness of a bearing, N/m; None: 0. Shape (p,)."""
    speed: FloatArray | None = None
    """Spin and speed of the frame per unit speed of each law, for rotating-frame terms; None: 0. Shape (2,
    k).
    """


class Elements(NamedTuple):
    """E elements with R local coordinates in all, of m meshes: one array a field of `Element`."""

    law: IntArray
    entry: IntArray
    """`law`, `entry`: Number of each element's law, and index of the element in the arrays of the law. Shape
    (E,) each.
    """
    first: IntArray
    """First row of each element, and R. Shape (E + 1,)."""
    mesh: IntArray
    """Mesh whose position each element reads; from m on the frame or cage whose turn it reads. Shape (E,)."""
    offset: FloatArray
    """`offset`, `stiffness`: Those of `Element`; the stiffness serves error norms and first guesses. Shape
    (R,) each.
    """
    drift: FloatArray
    """Rate of the coordinates per unit speed of each law; 0 for flanks, whose coordinates the kinematic
    motion does not change. Shape (k, R).
    """
    stiffness: FloatArray
    speed: FloatArray
    """Spin and speed of the frame per unit speed of each law. Shape (k, E, 2)."""
    carried: int
    turned: int
    """`carried`, `turned`: The first row with drift, and the first element with speed; R and E: none."""
    laws: ElementLaws

    @classmethod
    def packed(cls, elements: Sequence[Element], laws: ElementLaws, motions: int) -> Elements:
        """Lay out `elements`, their rows one after the other, in a kinematic motion of that many laws."""
        first = np.cumsum([0, *(element.offset.size for element in elements)], dtype=np.int64)
        rows = int(first[-1])
        drift, stiffness = np.zeros((rows, motions)), np.zeros(rows)
        speed = np.zeros((len(elements), 2, motions))
        for element, start, end, rates in zip(elements, first[:-1], first[1:], speed, strict=True):
            if element.drift is not None:
                drift[start:end] = element.drift
            if element.stiffness is not None:
                stiffness[start:end] = element.stiffness
            if element.speed is not None:
                rates[:] = element.speed
        drifting_rows = np.flatnonzero(np.any(drift, axis=1))
        turning_elements = np.flatnonzero(np.any(speed, axis=(1, 2)))
        return by_address(
            cls(
                law=np.array([int(element.law) for element in elements], dtype=np.int64),
                entry=np.array([element.entry for element in elements], dtype=np.int64),
                first=first,
                mesh=np.array([element.mesh for element in elements], dtype=np.int64),
                offset=np.concatenate([np.empty(0), *(element.offset for element in elements)]),
                drift=np.ascontiguousarray(drift.T),
                stiffness=stiffness,
                speed=np.ascontiguousarray(np.moveaxis(speed, 2, 0)),
                carried=int(drifting_rows[0]) if drifting_rows.size else rows,
                turned=int(turning_elements[0]) if turning_elements.size else len(elements),
                laws=laws,
            )
        )

    def prepare(self, elements: Elements) -> None:
        """Compile the routines that its laws call; `elements` are these elements as they take them."""
        present = (Law(law) for law in np.unique(self.law))
        routines = [
            (law, target) for law in present for target in COMPILED[law].routines if not target.prepared
        ]
        common = [target for target in (evaluate_all, potential) if not target.prepared]
        local = by_address(make_local(self, 0)) if routines or common else None
        for law, target in routines:
            target.prepare(by_address(getattr(self.laws, law.name.lower())), local)
        for target in common:
            target.prepare(elements, local)


def make_local(elements: Elements, meshes: int) -> LocalState:
    """Allocate for `elements` of that many meshes."""
    maximum = int(np.max(np.diff(elements.first), initial=1))
    return LocalState.empty(elements.offset.size, maximum, meshes, elements.law.size, elements.drift.shape[0])


def _call(law: Law, function: Callable[..., Any]) -> str:
    arguments = {**_ARGUMENTS, "laws": f"elements.laws.{law.name.lower()}"}
    return f"{function.__name__}({', '.join(arguments[name] for name in signature(function).parameters)})"


def _potential(law: Law, row: Compiled) -> str:
    """Return the source of a call of `row.energy` for energy and its derivative in the position."""
    if row.energy is None:
        return "return 0.0, 0.0"
    call, parts = _call(law, row.energy), len(get_args(get_type_hints(row.energy)["return"]))
    if parts == 0:
        return f"return {call}, 0.0"
    return f"return {call}" if parts == 2 else f"energy = {call}\n        return energy[0], energy[1]"


def _dispatch(name: str, branch: Callable[[Law, Compiled], str], otherwise: str) -> Any:
    """Compile a function of elements, local state and one element `e` with a `branch` per law."""
    lines = [f"def {name}(elements, local, e):", "    kind = elements.law[e]"]
    for law, row in COMPILED.items():
        lines += [f"    {'if' if law == 0 else 'elif'} kind == {int(law)}:", f"        {branch(law, row)}"]
    functions = [call for row in COMPILED.values() for call in (row.force, row.energy) if call is not None]
    names = {call.__name__: call for call in functions} | {"__name__": __name__}
    text = "\n".join([*lines, f"    {otherwise}"])
    exec(text, names)
    names[name].__source__ = text  # no file has it
    return inner(names[name])


evaluate: Callable[[Elements, LocalState, int], None] = _dispatch(
    "evaluate", lambda law, row: _call(law, row.force), "return"
)
"""Write forces and derivatives of element `e` at the coordinates, rates and position in `local`."""
_stored: Callable[[Elements, LocalState, int], tuple[float, float]] = _dispatch(
    "stored", _potential, "return 0.0, 0.0"
)


@routine
def potential(elements: Elements, local: LocalState, e: int) -> tuple[float, float]:
    """Return the energy element `e` stores, J, and its derivative in the position, J per base pitch."""
    return _stored(elements, local, e)


@routine
def evaluate_all(elements: Elements, local: LocalState) -> None:
    """Evaluate all elements."""
    for e in range(elements.law.size):
        evaluate(elements, local, e)


@inner
def is_linear(elements: Elements, e: int) -> bool:
    """Return whether forces are constant matrices times coordinates and rates: stages eliminate them."""
    return bool(elements.law[e] == LINEAR_BEARING)


@inner
def evaluate_linear(elements: Elements, local: LocalState, e: int) -> None:
    """Evaluate an element that `is_linear`, as `evaluate` does."""
    linear_bearing(elements.laws.linear_bearing, elements.entry[e], local, elements.first[e])


@inner
def power_along_axes(elements: Elements, local: LocalState, e: int) -> tuple[float, float]:
    """Return two powers by motion along a table's axes, W: on the bodies, and stored in the table.

    The elastic forces along the axes give the first. The second is the change of the energy of the table as
    it is read elsewhere along them.
    """
    power, stored = 0.0, 0.0
    if elements.law[e] == SPATIAL_FLANK:
        row, entry, laws = elements.first[e], elements.entry[e], elements.laws.spatial_flank
        for axis in range(2):
            to = laws.row[entry, axis]
            if to > 0:
                power += local.elastic[row + to] * local.rate[row + to]
        to_m, to_a = laws.row[entry, 0], laws.row[entry, 1]
        if laws.follows[entry, 0] + laws.follows[entry, 1] > 0:
            _, _, in_m, in_a = spatial_energy(laws, entry, local, row, elements.mesh[e])
            stored += in_m * local.rate[row + to_m] if to_m > 0 else 0.0
            stored += in_a * local.rate[row + to_a] if to_a > 0 else 0.0
    return power, stored


@inner
def power_by_frames(elements: Elements, local: LocalState, e: int) -> float:
    """Return the power that the rotation of frames and cages stores in an element, W."""
    if elements.mesh[e] < 0 or elements.law[e] not in TURNED:
        return 0.0
    return float(potential(elements, local, e)[1] * local.pace[elements.mesh[e]])


@inner
def slides(elements: Elements, e: int, row: int) -> bool:
    """Return whether `row` of element `e` carries sliding friction."""
    if elements.law[e] != SPATIAL_FLANK:
        return False
    first = elements.laws.spatial_flank.row[elements.entry[e], 2]
    return bool(first > 0 and row >= elements.first[e] + first)


@inner
def has_unbalance(elements: Elements) -> bool:
    """Return whether forces depend on accelerations."""
    laws = elements.laws.unbalance
    return bool(laws.amount.size > 0 and not laws.steady[0])
