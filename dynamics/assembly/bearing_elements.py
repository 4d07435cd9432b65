"""The force elements of bearings: those that are not linear, and linear ones in housings that move."""

from __future__ import annotations

from functools import cache
from typing import Any

from dynamics.assembly.model import Model
from dynamics.bearings.linear_bearing import LinearBearingLaws
from dynamics.forces.elements import Element
from dynamics.forces.laws import LAW_BY_ARRAYS
from dynamics.kernels.by_address import by_address
from dynamics.mechanism.bearing_elements import supports_by_name
from dynamics.mechanism.housed_bearings import housed_bearing_elements, housed_bearings
from dynamics.mechanism.phases import repeating_phases
from dynamics.mechanism.supports import seat_error, seat_motion


def bearing_elements(model: Model) -> tuple[tuple[Element, ...], dict[str, Any]]:
    """Return the elements of all nonlinear bearing laws, and their laws by the fields of `ElementLaws`.

    Where rolling elements pass one by one, the row reads the turn of its cage. Positions of meshes come
    first, then those of repeating phases, then those of cages; -1: the element reads none.
    """
    mechanism, scene = model.mechanism, model.mechanism.scene
    first_cage = len(scene.meshes) + len(repeating_phases(scene, mechanism.kinematics))
    passing = [part.name for part in scene.rolling_bearings if part.name in mechanism.passing]
    cage = {name: first_cage + index for index, name in enumerate(passing)}
    supports, elements = supports_by_name(mechanism.rotors), []
    entries: dict[Any, list[Any]] = {arrays: [] for arrays in LAW_BY_ARRAYS}
    for part, bearing in zip(scene.laws_with(mechanism.passing), mechanism.bearings, strict=True):
        rotor, support = supports[bearing.name]
        gradient = bearing.directions @ seat_motion(mechanism.rotors, rotor, support)
        offset = -bearing.directions @ seat_error(mechanism.rotors, rotor, support)
        law, law_entries = LAW_BY_ARRAYS[part.arrays], entries[part.arrays]
        position, stiffness = cage.get(bearing.name, -1), bearing.row_stiffness
        elements.append(Element(law, len(law_entries), position, gradient, offset, stiffness=stiffness))
        law_entries.append(part.array_entry(mechanism.bearing_duty[bearing.name]))
    packed = {
        law.name.lower(): arrays.packed(entries[arrays]) if entries[arrays] else _empty_arrays(arrays)
        for arrays, law in LAW_BY_ARRAYS.items()
    }
    return tuple(elements), packed


@cache
def _empty_arrays(arrays: Any) -> Any:
    """Return the arrays of a law that no bearing has."""
    return by_address(arrays.packed([]))


def housed_elements(model: Model) -> tuple[tuple[Element, ...], LinearBearingLaws]:
    """Return the elements of linear bearings in housings that move, and their laws."""
    rotors = model.mechanism.rotors
    return housed_bearing_elements(rotors, housed_bearings(model.mechanism.scene, rotors))
