"""The shafts, rotors and stages of a gear unit, and how fast each turns beside the others."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bounds.types import FloatArray
from lineofaction.gearbox.from_rexs.gear_unit import Connection, GearStage, GearUnit, Part, PlanetarySet
from lineofaction.gearbox.from_rexs.placement import (
    FIXED,
    SAME_PLACE,
    PlacedShaft,
    Placement,
    SceneAxes,
)
from lineofaction.gearbox.problems import BadInput

# What turns together: a shaft by itself, or all parts of a planet carrier; and what the ground holds.


_RIGID_ROTATION = 1e12
"""N m/rad; no coupling of a gear unit is as stiff: files write 1e17 and more for one that does not yield."""


@dataclass(frozen=True)
class _Rotors:
    """The rotating bodies of a gear unit."""

    of: Mapping[int, int]
    """The rotor of a shaft or side plate: the lowest id of the components that turn as one."""
    held: frozenset[int]
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
        return tuple(part for part, own in self.of.items() if own == rotor)


def _rotors_of(unit: GearUnit, sets: Sequence[PlanetarySet]) -> _Rotors:
    """Return the rotors: the parts of a carrier are one, with what is rigidly coupled to them."""
    of = {part.id: part.id for part in unit.of_type("shaft", "side_plate")}
    joined = [
        entry
        for entry in unit.couplings
        if entry.on_ground is None and {entry.inner.id, entry.outer.id} <= of.keys()
    ]
    for planets in sets:
        _merge(of, [part.id for part in planets.carrier])
    carriers = {of[planets.carrier[0].id] for planets in sets}
    changed = True
    while changed:
        changed = False
        for entry in joined:
            ends = of[entry.inner.id], of[entry.outer.id]
            if ends[0] != ends[1] and carriers & set(ends) and _rotation(entry) >= _RIGID_ROTATION:
                carriers.add(_merge(of, list(ends)))
                changed = True
    grounded = [entry for entry in unit.couplings if entry.on_ground is not None]
    held = frozenset(of[entry.held.id] for entry in grounded if entry.held.id in of and _rotation(entry))
    between = tuple(entry for entry in joined if of[entry.inner.id] != of[entry.outer.id])
    for entry in joined:
        if entry not in between:
            entry.part.say("", "derived", "rigid: its sides are parts of one planet carrier")
    return _Rotors(of, held, between, tuple(sets))


def _merge(of: dict[int, int], parts: list[int]) -> int:
    rotors = {of[part] for part in parts}
    lowest = min(rotors)
    for part, rotor in of.items():
        if rotor in rotors:
            of[part] = lowest
    return lowest


def _rotation(entry: Connection) -> float:
    """Return the torsional stiffness of a coupling, N m/rad; rigid where the file says none."""
    item, words = "rotational_stiffness", "torsional stiffness, N mm/rad"
    return entry.part.number(item, words, _RIGID_ROTATION, "rigid: the file gives none")


# Where shafts stand: as the file says, else by the angles of the stages and by couplings.


_ANGLE = "rotating_angle_around_neg_u_axis"


def _shaft_places(
    unit: GearUnit, stages: Sequence[GearStage], sets: Sequence[PlanetarySet]
) -> dict[int, Placement]:
    """Return the places of the shafts by their ids; those that nothing places are left out.

    A shaft without a place of its own follows from a placed one: in a stage at the center distance, in the
    direction w turned about -u by the stage's angle, the gears face to face; or along a coupling. If none is
    placed, the first shaft of a stage is the origin. A carrier's shaft that only its set places is on the
    axis of the central shafts, its u = 0 at theirs.
    """
    shafts = unit.of_type("shaft")
    places = {shaft.id: place for shaft in shafts if (place := Placement.of(shaft)) is not None}
    if not places and stages:
        first = stages[0].shafts[0]
        places[first.id] = FIXED
        first.say("support_vector", "defaulted", "no shaft has a place; the first is the origin")
    _spread(unit, stages, places)
    for planets in sets:
        pins = {pin.id for pin in planets.pins}
        for shaft in planets.carrier:
            base = next((places[part.id] for part in planets.central if part.id in places), None)
            if shaft.type == "shaft" and base is not None and shaft.id not in {*places, *pins}:
                places[shaft.id] = base
                words = "on the axis of the central shafts, its begin at theirs"
                shaft.say("support_vector", "defaulted", words)
    _spread(unit, stages, places)
    for shaft in shafts:
        if shaft.id not in places:
            shaft.say("", "refused", "neither a place, a stage nor a coupling says where it stands")
    return places


def _spread(unit: GearUnit, stages: Sequence[GearStage], places: dict[int, Placement]) -> None:
    joined = (*unit.couplings, *unit.bearings)
    while True:
        before = len(places)
        for stage in stages:
            _by_stage(stage, places)
        for entry in joined:
            _by_coupling(entry, places)
        if len(places) == before:
            return


def _by_stage(stage: GearStage, places: dict[int, Placement]) -> None:
    known = [shaft.id in places for shaft in stage.shafts]
    if not stage.is_cylindrical or known[0] == known[1]:
        return
    center_distance = stage.stage.number("center_distance", "center distance of the stage, mm")
    if center_distance is None:
        return
    angle = stage.stage.number(_ANGLE, "direction from gear 1 to gear 2, deg", 0.0, "0 deg")
    way = 1.0 if known[0] else -1.0
    base, new = (stage.shafts[index] for index in ((0, 1) if known[0] else (1, 0)))
    u, v, w = places[base.id].axes
    across = way * center_distance * (math.sin(angle) * v + math.cos(angle) * w)
    ends = [_u(gear, "u_coordinate_on_shaft") for gear in stage.gears]
    offset = across + way * (ends[0] - ends[1]) * u
    _place(new, base, offset, f"center distance and {_ANGLE} of component {stage.stage.id}", places)


def _by_coupling(coupling: Connection, places: dict[int, Placement]) -> None:
    sides = (coupling.inner, coupling.outer)
    known = [side.id in places for side in sides]
    if known[0] == known[1] or any(side.type != "shaft" for side in sides):
        return
    base, new = sides if known[0] else sides[::-1]
    inner, outer = (_u(coupling.part, f"u_coordinate_on_shaft_{side}_side") for side in ("inner", "outer"))
    offset = (1.0 if known[0] else -1.0) * (inner - outer) * places[base.id].u
    _place(new, base, offset, f"coaxial: component {coupling.part.id}", places)


def _u(part: Part, item: str) -> float:
    return part.number(item, "place along the shaft, mm") or 0.0


def _place(shaft: Part, base: Part, offset: FloatArray, words: str, places: dict[int, Placement]) -> None:
    beside = places[base.id]
    places[shaft.id] = Placement(np.asarray(beside.origin + offset), beside.axes)
    shaft.say("support_vector", "derived", words)


@dataclass(frozen=True)
class Layout:
    """Where everything is."""

    unit: GearUnit
    axes: SceneAxes
    """The frame of the scene."""
    shafts: Mapping[int, PlacedShaft]
    """The shafts parallel to z, by id."""
    rotors: _Rotors
    """What turns together."""
    stages: tuple[GearStage, ...]
    """All stages with two gears."""

    @classmethod
    def of(cls, unit: GearUnit) -> Layout:
        """Return the layout; the account says what is left out."""
        stages, sets = unit.stages, unit.planetary_sets
        places = _shaft_places(unit, stages, sets)
        root = next(iter(unit.of_type("gear_unit")), None)
        first = [shaft.id for stage in stages if stage.is_cylindrical for shaft in stage.shafts]
        lines = [places[shaft] for shaft in (*first, *places) if shaft in places]
        axes = SceneAxes.of(None if root is None else Placement.of(root), lines)
        shafts = {}
        for part in unit.of_type("shaft"):
            place = places.get(part.id)
            if place is None:
                continue
            if axes.sense(place) == 0:
                words = "not parallel to the shafts of the first stage: left out of the scene"
                part.say("", "refused", words)
                continue
            shafts[part.id] = PlacedShaft.of(part, place, axes)
        rotors = _rotors_of(unit, sets)
        turning = tuple(s for s in stages if len({rotors.of[shaft.id] for shaft in s.shafts}) == 2)
        return cls(unit, axes, shafts, rotors, turning)

    def sense(self, shaft: int) -> int:
        """Return +1 or -1 for u along z or against it; +1 of shafts that are not parallel."""
        return self.shafts[shaft].sense if shaft in self.shafts else 1

    def turn(self, part: Part, held: Part) -> FloatArray:
        """Return the matrix that takes u, v, w of a part on a shaft to x, y, z."""
        return self.axes.turn(Placement.of(part) or self.shafts[held.id].place)

    def rotor(self, shaft: int) -> int:
        """Return the rotor of a shaft."""
        return self.rotors.of[shaft]

    def carrier(self, stage: GearStage) -> int | None:
        """Return the rotor of the carrier that a stage runs on, None for the ground."""
        return self.rotors.carrier_of(*(shaft.id for shaft in stage.shafts))

    def joined(self, stage: GearStage) -> set[int]:
        """Return the rotors that a stage joins: its shafts', and the carrier that it runs on."""
        rotors = {self.rotor(shaft.id) for shaft in stage.shafts}
        return rotors if (carrier := self.carrier(stage)) is None else rotors | {carrier}

    def is_computed(self, stage: GearStage) -> bool:
        """Return whether a stage has parallel axes, and so a case."""
        return stage.is_cylindrical and all(shaft.id in self.shafts for shaft in stage.shafts)

    def u_on(self, shaft: PlacedShaft, part: Part, item: str = "u_coordinate_on_shaft") -> float:
        """Return u of a part on a shaft, m: by its place, else by its coordinate, else 0."""
        place = Placement.of(part)
        stated = part.number(item, "place along the shaft, mm")
        if place is None:
            if stated is None:
                part.say(item, "defaulted", "0 mm: the file gives no place")
            return stated or 0.0
        u = shaft.place.along(place.origin)
        if stated is not None and not math.isclose(stated, u, abs_tol=1e2 * SAME_PLACE):
            words = (
                f"{stated * 1e3:.6g} mm; its place (support_vector) is at {u * 1e3:.6g} mm, which is taken"
            )
            part.say(item, "ignored", words)
        if (off_axis := shaft.off_axis(place.origin)) > 1e2 * SAME_PLACE:
            words = f"{off_axis * 1e3:.4g} mm off the axis of its shaft; taken along the axis alone"
            part.say("support_vector", "refused", words)
        return u

    def z_on(self, shaft: PlacedShaft, part: Part, item: str = "u_coordinate_on_shaft") -> float:
        """Return z of a part on a shaft in the scene, m: see `u_on`."""
        return float(shaft.start[2]) + shaft.sense * self.u_on(shaft, part, item)


# Speeds and torques of a gear train: the ratios of its stages, and the statics that follow from them.


EQUAL = 1e-9
"""Relative; ratios of whole numbers, solved in floating point."""
_MOST_ROTORS = 300
"""The largest trains that are solved have fewer; so many take 0.1 s."""


@dataclass(frozen=True)
class Train:
    """The rotors of a train and what their ratios are."""

    rotors: tuple[int, ...]
    """Their ids, the columns."""
    stages: tuple[GearStage, ...]
    """The first rows."""
    rows: FloatArray
    """Stages, then couplings. Shape (n, m)."""
    held: tuple[int, ...]
    """Columns of rotors at rest."""

    @classmethod
    def of(cls, layout: Layout) -> Train:
        """Return the train of stages and couplings; all speeds and torques are about z.

        Those of a shaft that is not parallel are about its own u: the sense in which a bevel stage turns what
        lies behind it is left open by the file, its power is not.
        """
        stages, rotors = layout.stages, layout.rotors
        ids = tuple(sorted(set(rotors.of.values())))
        if len(ids) > _MOST_ROTORS:
            raise BadInput.of("model", f"{len(ids)} shafts and side plates", f"at most {_MOST_ROTORS}")
        rows = np.zeros((len(stages) + len(rotors.couplings), len(ids)))
        for row, stage in zip(rows, stages, strict=False):
            first, second = (ids.index(rotors.of[shaft.id]) for shaft in stage.shafts)
            sign = -1.0 if stage.internal else 1.0
            row[first] += stage.teeth[0]
            row[second] += sign * stage.teeth[1]
            carrier = layout.carrier(stage)
            if carrier is not None:
                row[ids.index(carrier)] -= stage.teeth[0] + sign * stage.teeth[1]
        for row, entry in zip(rows[len(stages) :], rotors.couplings, strict=True):
            row[ids.index(rotors.of[entry.inner.id])] += 1.0
            row[ids.index(rotors.of[entry.outer.id])] -= 1.0
        return cls(ids, stages, rows, tuple(ids.index(rotor) for rotor in sorted(rotors.held)))

    def speeds(self, known: Mapping[int, float]) -> FloatArray | None:
        """Return the speeds of all rotors, rad/s, None where the known ones do not fit or leave some open.

        Rotors that nothing joins to the known ones are at rest. `known`: speeds by rotor.
        """
        free = self._free(set(self.rotors) - self.joined_to(known))
        columns = [self.rotors.index(rotor) for rotor in known]
        values = np.array(list(known.values()))
        if free.shape[1] == 0 or np.linalg.matrix_rank(free[columns], tol=EQUAL) < free.shape[1]:
            return None
        shares, *_ = np.linalg.lstsq(free[columns], values, rcond=None)
        scale = float(np.max(np.abs(values), initial=0.0))
        if np.any(np.abs(free[columns] @ shares - values) > 1e3 * EQUAL * scale):
            return None
        return np.asarray(free @ shares)

    def joined_to(self, rotors: Iterable[int]) -> set[int]:
        """Return these rotors and all that stages and couplings join to them."""
        joined = np.isin(self.rotors, list(rotors))
        count = -1
        while count < (count := int(joined.sum())):
            joined |= np.any(self.rows[np.any(self.rows[:, joined], axis=1)], axis=0)
        return {rotor for rotor, is_joined in zip(self.rotors, joined, strict=True) if is_joined}

    def _free(self, resting: set[int]) -> FloatArray:
        """Return an orthonormal base (rotors, freedoms) of the speeds that ratios and resting ones permit."""
        columns = [*self.held, *map(self.rotors.index, resting)]
        held = np.zeros((len(columns), len(self.rotors)))
        held[range(len(columns)), columns] = 1.0
        scale = np.linalg.norm(self.rows, axis=1, keepdims=True)
        return _null_space(np.vstack([self.rows / scale, held]))

    def forces(self, known: Mapping[int, float], open_rotors: Sequence[int]) -> Flow | None:
        """Return the torques of stages and open rotors that balance the known ones.

        Parameters
        ----------
        known : mapping of int to float
            Torques on rotors from outside, N m.
        open_rotors : sequence of int
            Rotors on which a torque from outside is unknown. Held rotors are such, too.

        Returns
        -------
        Flow or None
            None where no torque balances the known ones, or some open torque is not determined by them.
            Stages whose shares statics leaves open (planets, power splits) share by least squares.
        """
        outside = [*(self.rotors.index(rotor) for rotor in open_rotors), *self.held]
        load = np.zeros(len(self.rotors))
        for rotor, torque in known.items():
            load[self.rotors.index(rotor)] += torque
        columns = np.zeros((len(self.rotors), len(outside)))
        columns[outside, range(len(outside))] = 1.0
        matrix = np.hstack([self.rows.T, columns])
        solution, *_ = np.linalg.lstsq(matrix, -load, rcond=None)
        left = matrix @ solution + load
        if np.any(np.abs(left) > 1e3 * EQUAL * float(np.max(np.abs(load), initial=0.0))):
            return None
        loose = _null_space(matrix)[len(self.rows) :]
        if np.any(np.abs(loose) > 1e3 * EQUAL):
            return None
        count = len(self.rows)
        return Flow(
            self.rows * solution[:count, None],
            dict(zip(open_rotors, map(float, solution[count:]), strict=False)),
            bool(_null_space(self.rows.T).shape[1]),
        )


@dataclass(frozen=True)
class Flow:
    """Torques through a train."""

    on_rotor: FloatArray
    """Torque of each stage and coupling on each rotor, N m. Shape (rows, rotors)."""
    outside: Mapping[int, float]
    """Torque on each open rotor from outside, N m."""
    is_shared: bool
    """Statics leaves open how parallel stages share the load."""


def _null_space(matrix: FloatArray) -> FloatArray:
    """Return an orthonormal base of the null space, by columns."""
    if matrix.size == 0:
        return np.eye(matrix.shape[1])
    _, values, base = np.linalg.svd(matrix)
    rank = int(np.sum(values > EQUAL * max(1.0, float(values[0]))))
    return np.asarray(base[rank:].T)
