"""Phases of the meshes of a train: where the teeth of a gear stand decides the position of all its meshes.

A mesh puts one flank of the driver and one of the driven gear at its pitch point. The other flanks of both
follow from their tooth thickness, the other gears of a shaft from the angle between their teeth.

The angle of a flank or a tooth is in pitches of its gear, about +z. It is not reduced to one turn, since its
whole number counts teeth. A flank has a key: its gear, and its side 1 or -1, to which it faces about +z. A
flank or gear is placed once its angle is known. A train is a set of gears that mesh or turn at one speed.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from bounds import Quantity, Text, exactly
from dynamics.errors import InputError
from dynamics.identity_cache import cached_by
from dynamics.mechanism.flank_at_mesh import FlankAtMesh, base_thickness, flanks_at_mesh
from dynamics.mechanism.line_of_action import lines_of_action
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray

FIT = 1e-3
"""Pitches by which a stated phase may differ from the geometry: axes are stated with some six digits."""
ROUNDING = 1e-9
"""Pitches below a whole number that count as that number: the rounding of angles."""


@dataclass(frozen=True)
class AssumedAngle:
    """An angle between two gears of one speed that no part of the scene states: tooth centers in line."""

    shaft: str
    """Shaft of the second gear; the first gear is on it, or on a shaft coupled to it."""
    gears: tuple[str, str]
    moves: FloatArray
    """Base pitches by which the position of each mesh moves per pitch of the second gear. Shape (m,)."""


@dataclass(frozen=True)
class TrainPhases:
    """Positions of all meshes at the start of the motion, and the assumptions on them beyond the geometry."""

    position: FloatArray
    """Base pitches; stated ones as they are, others within the period of their table. Shape (m,)."""
    angles: tuple[AssumedAngle, ...] = ()
    thickness: tuple[str, ...] = ()
    """Gears whose tooth thickness is assumed."""


NO_PHASES = TrainPhases(np.zeros(0))


def _parts(scene: Scene) -> tuple[object, ...]:
    return (scene.shafts, scene.gears, scene.couplings, scene.meshes)


@cached_by(_parts)
def train_phases(scene: Scene, senses: tuple[int, ...]) -> TrainPhases:
    """Return the positions of all meshes, and the assumptions on them beyond the geometry.

    A train starts where its first mesh touches at the pitch point, or where that is stated; what the teeth
    require comes next, then assumed thicknesses and angles. `senses` (m,): sense of rotation of each driver
    about +z, 1 or -1. Raises `InputError`: a stated position or angle contradicts the geometry.
    """
    return _phases(_Train(scene, senses))


class _Train:
    """The gears of a scene in mesh: their flanks, the placed ones among them, and the assumptions made."""

    def __init__(self, scene: Scene, senses: tuple[int, ...]) -> None:
        self.scene = scene
        self.pairs: list[tuple[FlankAtMesh, FlankAtMesh]] = []
        self.first: dict[int, FlankAtMesh] = {}  # flank of each gear at its first mesh
        self.thickness: dict[int, float] = {}  # of each gear, stated or assumed, in pitches
        self.count: dict[int, int] = {}  # meshes of each gear
        for index, line in enumerate(lines_of_action(scene, senses)):
            pair = flanks_at_mesh(scene, index, line, senses[index])
            self.pairs.append(pair)
            for flank in pair:
                self.first.setdefault(flank.gear, flank)
                self.thickness.setdefault(flank.gear, base_thickness(scene, flank, index, line))
                self.count[flank.gear] = self.count.get(flank.gear, 0) + 1
        self.used = {flank.key for pair in self.pairs for flank in pair}
        self.angle: dict[tuple[int, int], float] = {}  # angle of each placed flank, by gear and side
        # motion of each gear, pitches per pitch of each assumed angle
        self.moves: dict[int, dict[int, float]] = {}
        self.assumed_angles: list[tuple[int, int]] = []
        # gears of assumed thickness, in the order of the assumptions
        self.assumed_thickness: dict[int, None] = {}

    def assign(self, key: tuple[int, int], angle: float, moves: dict[int, float]) -> None:
        """Place a flank at an angle; `moves` are those of its gear by assumed angles."""
        self.angle[key] = angle
        self.moves.setdefault(key[0], moves)

    def is_placed(self, gear: int) -> bool:
        """Whether a gear has its place."""
        return self.first[gear].key in self.angle

    def states_thickness(self, gear: int) -> bool:
        """Whether the tooth thickness of a gear is stated."""
        return self.scene.gears[gear].base_tooth_thickness is not None

    def position(self, index: int) -> float:
        """Return the position of a mesh, by the angle of one of its gears: they may count teeth differently.

        It is the gear with more meshes, and of two alike the one that stands first in the scene.
        """
        flank = min(self.pairs[index], key=lambda at: (-self.count[at.gear], at.gear))
        return flank.position(self.angle[flank.key])

    def tooth_center(self, gear: int) -> float:
        """Return the angle of the tooth that touches last before the pitch point of the gear's first mesh."""
        flank = self.first[gear]
        position = flank.position(self.angle[flank.key])
        at_mesh = flank.angle(position - math.floor(position + ROUNDING))
        return at_mesh - flank.side * 0.5 * self._actual_thickness(gear)

    def _actual_thickness(self, gear: int) -> float:
        """Return the tooth thickness, pitches, between placed flanks, else the stated or assumed one."""
        thickness = self.thickness[gear]
        if (gear, 1) in self.angle and (gear, -1) in self.angle:
            thickness += _off(self.angle[gear, 1] - self.angle[gear, -1] - thickness)
        return thickness


def _off(pitches: float) -> float:
    """Return the difference of pitches from the nearest whole number."""
    return pitches - round(pitches)


def _phases(train: _Train) -> TrainPhases:
    """Return the phases of all meshes; raises `InputError`: what is stated contradicts the teeth."""
    for meshes in _trains(train.scene):
        _assign_train(train, meshes)
    _check_angles(train)
    positions = [
        _wrapped(train.position(index), mesh.table.period)
        if mesh.position_offset is None
        else mesh.position_offset
        for index, mesh in enumerate(train.scene.meshes)
    ]
    angles = tuple(_assumed_angle(train, number) for number in range(len(train.assumed_angles)))
    thickness = tuple(train.scene.gears[gear].name for gear in train.assumed_thickness)
    return TrainPhases(np.array(positions, dtype=float), angles, thickness)


def _assign_train(train: _Train, meshes: list[int]) -> None:
    """Place the meshes of a train, the first at its stated position or at the pitch point."""
    start = train.scene.meshes[meshes[0]].position_offset
    _state(train, meshes[0], start or 0.0)
    for index in meshes[1:]:
        position = train.scene.meshes[index].position_offset
        if position is not None:
            _state(train, index, position)
    _assume(train)


def _trains(scene: Scene) -> list[list[int]]:
    """Return the meshes of each train: of gears that mesh or turn at one speed."""
    groups = _coupled(scene)
    sides = [[scene.gear(name).shaft for name in (mesh.driver, mesh.driven)] for mesh in scene.meshes]
    for first, second in sides:
        _join(groups, first, second)
    trains: dict[int, list[int]] = {}
    for index, (shaft, _) in enumerate(sides):
        trains.setdefault(groups[shaft], []).append(index)
    return list(trains.values())


def _join(groups: dict[str, int], first: str, second: str) -> None:
    """Put two shafts, and those of the groups of both, into one group."""
    old, new = groups[second], groups[first]
    groups.update({name: new for name, group in groups.items() if group == old})


def _wrapped(position: float, period: int) -> float:
    # + 0.0 makes 0 of -0
    return max(position - period * math.floor((position + ROUNDING) / period), 0.0) + 0.0


def _assumed_angle(train: _Train, number: int) -> AssumedAngle:
    first, second = (train.scene.gears[gear] for gear in train.assumed_angles[number])
    moves = np.array([train.moves[driver.gear].get(number, 0.0) for driver, _ in train.pairs])
    return AssumedAngle(second.shaft, (first.name, second.name), moves)


def _state(train: _Train, index: int, position: float) -> None:
    """Place a mesh at a stated position, or raise `InputError` if the train is at another one already."""
    driver, _ = train.pairs[index]
    if driver.key not in train.angle:
        train.assign(driver.key, driver.angle(position), {})
        _follow(train)
        return
    if abs(_off(position - driver.position(train.angle[driver.key]))) > FIT:
        raise _contradiction(train, index, position)


def _contradiction(train: _Train, index: int, position: float) -> InputError:
    driver, _ = train.pairs[index]
    geometry = _wrapped(driver.position(train.angle[driver.key]), 1)
    note = ", where its teeth touch with the first mesh of its train as it is, or a whole number more"
    bound = exactly(round(geometry, 9), note=note)
    remedy = "Leave it out: it follows from tooth numbers, tooth thickness and the places of the axes."
    return InputError(f"meshes[{index}].position_offset", position, bound, remedy)


def _follow(train: _Train) -> None:
    """Place all flanks that meshes and stated thicknesses fix; raises `InputError`: teeth do not fit."""
    placed = -1  # less than any number of flanks, so that meshes are checked at least once
    while placed < len(train.angle):
        placed = len(train.angle)
        for index, pair in enumerate(train.pairs):
            for source, target in (pair, pair[::-1]):
                if source.key in train.angle and target.key not in train.angle:
                    position = source.position(train.angle[source.key])
                    train.assign(target.key, target.angle(position), train.moves[source.gear])
            _check_mesh(train, index)
        for gear, side in list(train.angle):
            if train.states_thickness(gear):
                _assign_back_flank(train, gear, side)


def _check_mesh(train: _Train, index: int) -> None:
    """Refuse a mesh whose gears the rest of the train puts at different positions."""
    driver, driven = train.pairs[index]
    if driver.key not in train.angle:
        return
    off = _off(driver.position(train.angle[driver.key]) - driven.position(train.angle[driven.key]))
    if abs(off) > FIT:
        mesh = train.scene.meshes[index]
        raise _misfit(f"meshes[{index}]", mesh.name, off, "the rest of the train")


def _assign_back_flank(train: _Train, gear: int, side: int) -> None:
    """Place the other flank of a tooth, or refuse a gear that does not fit between its meshes."""
    angle = train.angle[gear, side] - side * train.thickness[gear]
    off = _off(train.angle.setdefault((gear, -side), angle) - angle)
    if abs(off) > FIT:
        raise _misfit(f"gears[{gear}]", train.scene.gears[gear].name, off, "all gears that it meshes with")


def _misfit(field: str, name: str, off: float, others: str) -> InputError:
    bound = f"of teeth that fit {others}; they are off by {off:.6g} pitches"
    remedy = (
        "Change tooth numbers, tooth thickness or axes, or stated positions: nobody can assemble the train."
    )
    return InputError(field, name, bound, remedy)


def _assume(train: _Train) -> None:
    """Place all gears that follow by assumed thicknesses, and by stated or assumed angles on shafts."""
    while _assume_thickness(train) or _follow_shaft(train):
        _follow(train)


def _assume_thickness(train: _Train) -> bool:
    """Assume the thickness of a gear that carries on both flanks; return whether there was one."""
    for (gear, side), angle in train.angle.items():
        if (gear, -side) in train.used and (gear, -side) not in train.angle:
            train.angle[gear, -side] = angle - side * train.thickness[gear]
            train.assumed_thickness[gear] = None
            return True
    return False


def _follow_shaft(train: _Train) -> bool:
    """Place a gear by another gear of the same speed; return whether there was one."""
    for first, second, angle in _neighbors(train):
        if train.is_placed(first) and not train.is_placed(second):
            ratio = train.scene.gears[second].teeth / train.scene.gears[first].teeth
            moves = {number: ratio * rate for number, rate in train.moves[first].items()}
            if angle is None:
                moves[len(train.assumed_angles)] = 1.0
                train.assumed_angles.append((first, second))
            center = ratio * train.tooth_center(first) + (angle or 0.0)
            flank = train.first[second]
            train.assign(flank.key, center + flank.side * 0.5 * train.thickness[second], moves)
            unknown = (gear for gear in (first, second) if not train.states_thickness(gear))
            train.assumed_thickness.update(dict.fromkeys(unknown))
            return True
    return False


def _neighbors(train: _Train) -> Iterator[tuple[int, int, float | None]]:
    """Yield pairs of gears of one speed, and the angle from the first to the second gear.

    The angle is in pitches of the second; None: it is not stated. Stated angles come first, then gears of one
    shaft, then those of coupled shafts.
    """
    angles = list(_specified_angles(train))
    for first, second, angle in angles:
        yield first, second, angle
        yield second, first, -angle * train.scene.gears[first].teeth / train.scene.gears[second].teeth
    groups = _coupled(train.scene)
    gears = [(gear, train.scene.gears[gear].shaft) for gear in train.first]
    # gears of one shaft, then those of coupled shafts
    for alike in (lambda a, b: a == b, lambda a, b: groups[a] == groups[b]):
        for first, shaft in gears:
            yield from (
                (first, second, None) for second, other in gears if alike(shaft, other) and first != second
            )


def _specified_angles(train: _Train) -> Iterator[tuple[int, int, float]]:
    """Yield neighbors on a shaft, and the stated angle between their teeth in pitches of the second."""
    for shaft in train.scene.shafts:
        gears = [index for index, gear in enumerate(train.scene.gears) if gear.shaft == shaft.name]
        angles = dict(zip(gears, shaft.tooth_angles or (), strict=False))
        meshing = [gear for gear in angles if gear in train.first]
        for first, second in pairwise(meshing):
            turn = (angles[second] - angles[first]) / (2.0 * math.pi)
            yield first, second, turn * train.scene.gears[second].teeth


def _coupled(scene: Scene) -> dict[str, int]:
    """Return the number of the group of coupled shafts that each shaft belongs to, by name."""
    groups = {shaft.name: index for index, shaft in enumerate(scene.shafts)}
    for coupling in scene.couplings:
        if coupling.joins_rotations:
            _join(groups, coupling.first, coupling.second)
    return groups


def _check_angles(train: _Train) -> None:
    """Refuse a stated angle between two gears of a shaft if the rest of the train requires another angle.

    Which tooth is meant does not matter: a tooth further on gear 1 is z_2 / z_1 pitches of gear 2, on gear 2
    it is one pitch. So angles are equal up to multiples of gcd(z_1, z_2) / z_1 pitches of gear 2.
    """
    for first, second, angle in _specified_angles(train):
        if not (train.states_thickness(first) and train.states_thickness(second)):
            continue
        z_1, z_2 = (train.scene.gears[gear].teeth for gear in (first, second))
        step = math.gcd(z_1, z_2) / z_1
        more = train.tooth_center(second) - z_2 / z_1 * train.tooth_center(first) - angle
        off = step * _off(more / step)
        if abs(off) > FIT:
            raise _angle_contradiction(train.scene, second, off / z_2)


def _angle_contradiction(scene: Scene, gear: int, turns: float) -> InputError:
    """Return the error for the stated angle of a gear, which the train requires to be `turns` larger."""
    name = scene.gears[gear].shaft
    number = [part.name for part in scene.gears if part.shaft == name].index(scene.gears[gear].name)
    angle = (scene.shaft(name).tooth_angles or ())[number]
    geometry = Quantity(angle + 2.0 * math.pi * turns, "rad", digits=9)
    field = f"shafts[{scene.shaft_index(name)}].tooth_angles[{number}]"
    remedy = "Leave tooth_angles out: the train leaves the shaft no other angle."
    bound = Text.of(geometry, ", where the teeth of its train touch, or whole pitches more")
    return InputError(field, Quantity(angle, "rad", digits=9), bound, remedy)
