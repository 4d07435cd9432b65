"""Rotors: bodies that turn as one, a single shaft or all parts of a planet carrier."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from lineofaction.gearbox.from_rexs.gear_unit import Connection, GearUnit, PlanetarySet

_RIGID_ROTATION = 1e12
"""Torsional stiffness in N m/rad from which a coupling counts as rigid. No coupling of a gear unit is as
stiff: files write 1e17 and more for a coupling that does not yield."""


@dataclass(frozen=True)
class Rotors:
    """The rotating bodies of a gear unit."""

    of: Mapping[int, int]
    """The rotor of a shaft or side plate: the lowest id of the components that turn as one."""
    grounded: frozenset[int]
    """Rotors that a coupling holds on the ground."""
    couplings: tuple[Connection, ...]
    """Couplings between two rotors."""
    sets: tuple[PlanetarySet, ...]
    """The planetary sets."""

    def carrier_of(self, *shafts: int) -> int | None:
        """Return the carrier's rotor if one of the shafts is a planet's, None otherwise."""
        for planets in self.sets:
            if {shaft.id for shaft in planets.planets} & set(shafts):
                return self.of[planets.carrier[0].id]
        return None

    def members(self, rotor: int) -> tuple[int, ...]:
        """Return the ids of the components that make up a rotor."""
        return tuple(part for part, part_rotor in self.of.items() if part_rotor == rotor)


def rotors_of(unit: GearUnit, sets: Sequence[PlanetarySet]) -> Rotors:
    """Return the rotors: the parts of a carrier are one rotor, with all parts rigidly coupled to them."""
    rotor_of = {part.id: part.id for part in unit.of_type("shaft", "side_plate")}
    joined = [
        entry
        for entry in unit.couplings
        if entry.on_ground is None and {entry.inner.id, entry.outer.id} <= rotor_of.keys()
    ]
    for planets in sets:
        _merge(rotor_of, [part.id for part in planets.carrier])
    carriers = {rotor_of[planets.carrier[0].id] for planets in sets}
    changed = True
    while changed:
        changed = False
        for entry in joined:
            ends = rotor_of[entry.inner.id], rotor_of[entry.outer.id]
            if ends[0] != ends[1] and carriers & set(ends) and _rotation(entry) >= _RIGID_ROTATION:
                carriers.add(_merge(rotor_of, list(ends)))
                changed = True
    grounded = [entry for entry in unit.couplings if entry.on_ground is not None]
    grounded_rotors = frozenset(
        rotor_of[entry.rotor_side.id]
        for entry in grounded
        if entry.rotor_side.id in rotor_of and _rotation(entry)
    )
    between = tuple(entry for entry in joined if rotor_of[entry.inner.id] != rotor_of[entry.outer.id])
    for entry in joined:
        if entry not in between:
            entry.part.say("", "derived", "rigid: its sides are parts of one planet carrier")
    return Rotors(rotor_of, grounded_rotors, between, tuple(sets))


def _merge(rotor_of: dict[int, int], parts: list[int]) -> int:
    rotors = {rotor_of[part] for part in parts}
    lowest = min(rotors)
    for part, rotor in rotor_of.items():
        if rotor in rotors:
            rotor_of[part] = lowest
    return lowest


def _rotation(entry: Connection) -> float:
    """Return the torsional stiffness of a coupling, N m/rad; rigid where the file says none."""
    item, meaning = "rotational_stiffness", "torsional stiffness, N mm/rad"
    return entry.part.number(item, meaning, _RIGID_ROTATION, "rigid: the file gives none")
