"""Excitations by their order of a shaft: teeth in mesh, planets, turns of shafts, elements of bearings.

An order counts repetitions per revolution of the shaft. In functions, `turns` are the speeds of shafts with
their senses and `rates` the tooth frequencies of meshes, both in one unit.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from dynamics.errors import InputError
from dynamics.mechanism.kinematics import Kinematics, proportional_speeds
from dynamics.meshes.gear_mesh import GearMesh
from dynamics.scene.scene import Scene, on_axis
from dynamics.shafts.rigid_bodies import GearBody
from dynamics.types import FloatArray

MESH, SIDEBAND, SHAFT, BEARING = "mesh", "sideband", "shaft", "bearing"
TURNS, PASSINGS = 4, 3
"""Number of harmonics that are listed: of shafts (unbalance, misalignment, ovality), and of bearings."""
SAME = 1e-9
"""Relative difference of orders, below which they are the same."""


@dataclass(frozen=True)
class Excitation:
    """An excitation that repeats at a fixed order of a shaft."""

    kind: str
    """`MESH`, `SIDEBAND`, `SHAFT` or `BEARING`."""
    name: str
    """`name`, `part`: Name of the mesh, shaft or bearing. The part is the ring or element of a bearing that
    is passed, or the side of a sideband.
    """
    part: str
    rate: float
    """Repetitions per revolution of the shaft that orders are of, > 0."""
    harmonics: int
    """Number of multiples of the rate that are listed, from 1."""
    shift: tuple[float, ...] = ()
    """Shift of the order of each harmonic, for sidebands; empty: no shift."""

    def order(self, harmonic: int) -> float:
        """Return the order of a harmonic."""
        return harmonic * self.rate + (self.shift[harmonic - 1] if self.shift else 0.0)


@dataclass(frozen=True)
class Passing:
    """A harmonic of an excitation near the order of a complaint."""

    excitation: Excitation
    harmonic: int
    """Multiple of the excitation's rate, from 1."""
    order: float
    """Per revolution of the complaint's shaft."""
    distance: float
    """Relative: positive, it passes above the complaint."""

    def within(self, tolerance: float) -> bool:
        """Whether the distance is at most a relative tolerance."""
        return abs(self.distance) <= tolerance


def excitations(scene: Scene, kinematics: Kinematics, shaft: str, harmonics: int) -> tuple[Excitation, ...]:
    """Return the excitations of `shaft`: meshes to their `harmonics`, shafts, rolling bearings.

    All drives keep the proportion of their extreme speeds. Parts at rest excite nothing.

    Raises
    ------
    InputError
        The shaft is at rest.
    """
    rates, turns = _rates(scene, kinematics)
    unit = abs(float(turns[scene.shaft_index(shaft)]))
    if unit <= SAME * float(np.max(np.abs(turns))):
        moving = ", ".join(s.name for s, turn in zip(scene.shafts, turns, strict=True) if turn)
        raise InputError("shaft", shaft, f"a shaft that turns: {moving}")
    rates = rates / unit
    parts = []
    for mesh, rate in zip(scene.meshes, rates, strict=True):
        parts.append(Excitation(MESH, mesh.name, "", float(rate), harmonics))
    for part, turn in zip(scene.shafts, turns, strict=True):
        parts.append(Excitation(SHAFT, part.name, "", abs(float(turn)) / unit, TURNS))
    parts += _of_planets(scene, turns / unit, rates, harmonics)
    parts += _of_bearings(scene, np.abs(turns) / unit)
    return tuple(excitation for excitation in parts if excitation.rate > SAME)


def shaft_rates(scene: Scene, kinematics: Kinematics, shaft: str) -> dict[str, float]:
    """Return the revolutions of every shaft per revolution of `shaft`, without senses, by name."""
    turns = np.abs(_rates(scene, kinematics)[1])
    unit = float(turns[scene.shaft_index(shaft)])
    return {part.name: float(turn) / unit for part, turn in zip(scene.shafts, turns, strict=True)}


def _rates(scene: Scene, kinematics: Kinematics) -> tuple[FloatArray, FloatArray]:
    """Return the rates of meshes (m,), and the speeds of shafts (s,) with their senses, in one unit."""
    law = proportional_speeds(scene)
    return np.abs(kinematics.float_mesh_rate @ law), np.asarray(kinematics.float_ratio @ law)


def turning_orders(scene: Scene, kinematics: Kinematics) -> dict[str, dict[str, float]]:
    """Return the orders of each mesh frequency, and of one revolution of each gear and shaft.

    ``{"mesh": {name: order}, "shaft": {name: order}}``, what is at rest left out. Orders count by the first
    mesh that turns, or by the leading shaft without one. The turns of a gear are those against its carrier.
    """
    rates, turns = _rates(scene, kinematics)
    meshes = {mesh.name: float(rate) for mesh, rate in zip(scene.meshes, rates, strict=True)}
    gears = {
        name: float(rate) / scene.gear(name).teeth
        for mesh, rate in zip(scene.meshes, rates, strict=True)
        for name in (mesh.driver, mesh.driven)
    }
    shafts = {part.name: abs(float(turn)) for part, turn in zip(scene.shafts, turns, strict=True)}
    turning = gears | {name: turn for name, turn in shafts.items() if name not in gears}
    minimum = SAME * float(np.max(np.abs(turns)))
    driven = (abs(float(turns[shaft])) for shaft in kinematics.law_shaft)
    unit = next((rate for rate in (*meshes.values(), *driven) if rate > minimum), 1.0)
    return {
        kind: {name: rate / unit for name, rate in orders.items() if rate > minimum}
        for kind, orders in (("mesh", meshes), ("shaft", turning))
    }


def _of_planets(scene: Scene, turns: FloatArray, rates: FloatArray, harmonics: int) -> Iterator[Excitation]:
    """Yield the sidebands next to the harmonics of meshes of equally spaced planets on a carrier that turns.

    Planet p of N stands at the angle phi_p on the carrier, and theta is the angle of the carrier against the
    central gear, which has Z teeth. The phase of its mesh is Z (theta + phi_p), and it passes a place on the
    ground with the phase theta + phi_p. A mesh harmonic k modulated n times per revolution of the carrier has
    a sum over the planets where k Z + n is a multiple of N, and cancels elsewhere (McFadden and Smith 1985).
    Z is negative for a gear that overtakes the carrier.
    """
    central = [_central_gear(scene, mesh) for mesh in scene.meshes]
    for mesh, gear, rate in zip(scene.meshes, central, rates, strict=True):
        number = sum(gear is not None and other is gear for other in central)
        if gear is None or number < 2:
            continue
        shaft = scene.shaft_index(gear.shaft)
        carrier = scene.frame_index(shaft)
        assert carrier is not None  # a central gear is on the axis of one
        turn = float(turns[carrier])
        teeth = gear.teeth if (turn - float(turns[shaft])) * turn >= 0.0 else -gear.teeth
        # the least n in either direction, 1 to N: k Z - n, k Z + n divisible by N
        below = [(harmonic * teeth) % number or number for harmonic in range(1, harmonics + 1)]
        sides = {"lower": [-n for n in below], "upper": [number - n or number for n in below]}
        for side, passes in sides.items():
            passes_per_turn = tuple(n * abs(turn) for n in passes)
            if abs(turn) > SAME:
                yield Excitation(SIDEBAND, mesh.name, side, float(rate), harmonics, passes_per_turn)


def _central_gear(scene: Scene, mesh: GearMesh) -> GearBody | None:
    """Return the sun or ring of a mesh with a planet, None of any other."""
    gears = [scene.gear(name) for name in (mesh.driver, mesh.driven)]
    shafts = [scene.shaft(gear.shaft) for gear in gears]
    frame = shafts[0].frame
    if frame is None or frame != shafts[1].frame:
        return None
    central = [gear for gear, shaft in zip(gears, shafts, strict=True) if on_axis(shaft, scene.shaft(frame))]
    return central[0] if len(central) == 1 else None


def _of_bearings(scene: Scene, turns: FloatArray) -> Iterator[Excitation]:
    """Yield the excitation by a flaw of each ring and of one element; the outer ring is at rest."""
    for bearing in scene.rolling_bearings:
        row, turn = bearing.row, float(turns[scene.shaft_index(bearing.shaft)])
        gamma = row.slenderness
        rates = {
            "outer ring": row.count * row.cage_ratio,
            "inner ring": row.count * (1.0 - row.cage_ratio),
            "element": row.pitch_diameter / row.diameter * (1.0 - gamma**2),
        }
        for part, rate in rates.items():
            yield Excitation(BEARING, bearing.name, part, rate * turn, PASSINGS)


def passing(every: Iterable[Excitation], order: float) -> list[Passing]:
    """Return all harmonics of excitations, the nearest to an order first.

    Equally near ones keep their sequence.

    Parameters
    ----------
    order : float
        Per revolution of the shaft that the rates are of, > 0.
    """
    passings = [
        Passing(part, harmonic, part.order(harmonic), part.order(harmonic) / order - 1.0)
        for part in every
        for harmonic in range(1, part.harmonics + 1)
    ]
    # distances that are the same but for rounding are equally near
    return sorted(passings, key=lambda passing: round(abs(passing.distance) / SAME))
