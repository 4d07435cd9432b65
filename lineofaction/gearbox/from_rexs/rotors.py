"""What turns together: a shaft by itself, or all parts of a planet carrier; and what the ground holds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from lineofaction.gearbox.from_rexs.connections import Connection, couplings
from lineofaction.gearbox.from_rexs.gear_unit import GearUnit
from lineofaction.gearbox.from_rexs.planetary_set import PlanetarySet

RIGID_ROTATION = 1e12
"""N m/rad; no coupling of a gear unit is as stiff: files write 1e17 and more for one that does not yield."""


@dataclass(frozen=True)
class Rotors:
    """The rotating bodies of a gear unit.

    Attributes
    ----------
    of : mapping of int to int
        The rotor of a shaft or side plate: the lowest id of the components that turn as one.
    held : frozenset of int
        Rotors that a coupling holds on the ground.
    couplings : tuple of Connection
        Couplings between two rotors.
    sets : tuple of PlanetarySet
        The planetary sets.
    """

    of: Mapping[int, int]
    held: frozenset[int]
    couplings: tuple[Connection, ...]
    sets: tuple[PlanetarySet, ...]

    def carrier_of(self, *shafts: int) -> int | None:
        """Return the carrier's rotor if one of the shafts is a planet's, None otherwise."""
        for planets in self.sets:
            if {shaft.id for shaft in planets.planets} & set(shafts):
                return self.of[planets.carrier[0].id]
        return None

    def members(self, rotor: int) -> tuple[int, ...]:
        """Return the ids of the components that make up a rotor."""
        return tuple(part for part, own in self.of.items() if own == rotor)


def rotors_of(unit: GearUnit, sets: Sequence[PlanetarySet]) -> Rotors:
    """Return the rotors: the parts of a carrier are one, with what is rigidly coupled to them."""
    of = {part.id: part.id for part in unit.of_type("shaft", "side_plate")}
    joined = [entry for entry in couplings(unit) if entry.on_ground is None and _turn(entry, of)]
    for planets in sets:
        _merge(of, [part.id for part in planets.carrier])
    carriers = {of[planets.carrier[0].id] for planets in sets}
    changed = True
    while changed:
        changed = False
        for entry in joined:
            ends = of[entry.inner.id], of[entry.outer.id]
            if ends[0] != ends[1] and carriers & set(ends) and _rigid(entry):
                carriers.add(_merge(of, list(ends)))
                changed = True
    grounded = [entry for entry in couplings(unit) if entry.on_ground is not None]
    held = frozenset(of[entry.held.id] for entry in grounded if entry.held.id in of and _rotation(entry))
    between = tuple(entry for entry in joined if of[entry.inner.id] != of[entry.outer.id])
    for entry in joined:
        if entry not in between:
            entry.part.say("", "derived", "rigid: its sides are parts of one planet carrier")
    return Rotors(of, held, between, tuple(sets))


def _turn(entry: Connection, of: Mapping[int, int]) -> bool:
    return entry.inner.id in of and entry.outer.id in of


def _merge(of: dict[int, int], parts: list[int]) -> int:
    """Make one rotor of several, and return it."""
    rotors = {of[part] for part in parts}
    lowest = min(rotors)
    for part, rotor in of.items():
        if rotor in rotors:
            of[part] = lowest
    return lowest


def _rigid(entry: Connection) -> bool:
    """Return whether a coupling does not yield in rotation."""
    return _rotation(entry) >= RIGID_ROTATION


def _rotation(entry: Connection) -> float:
    """Return the torsional stiffness of a coupling, N m/rad; rigid where the file says none."""
    value = entry.part.number("rotational_stiffness", "torsional stiffness, N mm/rad")
    if value is None:
        entry.part.say("rotational_stiffness", "defaulted", "rigid: the file gives none")
        return RIGID_ROTATION
    return value
