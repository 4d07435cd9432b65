"""What passes at which order of a shaft: teeth in mesh, turns of shafts, elements of bearings."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from dynamics.errors import InputError
from dynamics.mechanism.kinematics import Kinematics
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray

MESH, SHAFT, BEARING = "mesh", "shaft", "bearing"
TURNS, PASSINGS = 4, 3
"""Harmonics of shafts (unbalance, misalignment, ovality) and of bearings that are looked at."""
SAME = 1e-9
"""Relative difference of orders that are one."""


@dataclass(frozen=True)
class Excitation:
    """What repeats at a fixed order of a shaft.

    Attributes
    ----------
    kind : str
        `MESH`, `SHAFT` or `BEARING`.
    name : str
        Of the mesh, shaft or bearing; `part` of a bearing is the ring or element that is passed.
    rate : float
        Repetitions per revolution of the shaft that orders are of, > 0.
    harmonics : int
        Multiples of the rate that are looked at, from 1.
    """

    kind: str
    name: str
    part: str
    rate: float
    harmonics: int


@dataclass(frozen=True)
class Passing:
    """A harmonic of an excitation beside the order of a complaint.

    Attributes
    ----------
    harmonic : int
        Multiple of the excitation's rate, from 1.
    order : float
        Per revolution of the complaint's shaft.
    distance : float
        Relative: positive, it passes above the complaint.
    """

    excitation: Excitation
    harmonic: int
    order: float
    distance: float

    def within(self, tolerance: float) -> bool:
        """Whether it is off by at most a relative tolerance."""
        return abs(self.distance) <= tolerance


def excitations(scene: Scene, kinematics: Kinematics, shaft: str, harmonics: int) -> tuple[Excitation, ...]:
    """Return what passes per revolution of `shaft`: meshes to their `harmonics`, shafts, rolling bearings.

    All drives keep the proportion of their extreme speeds. What is at rest does not pass.

    Raises
    ------
    InputError
        The shaft is at rest.
    """
    law = _law_speeds(scene)
    turns = kinematics.float_ratio @ law
    unit = abs(float(turns[scene.shaft_index(shaft)]))
    if unit <= SAME * float(np.max(np.abs(turns))):
        moving = ", ".join(s.name for s, turn in zip(scene.shafts, turns, strict=True) if turn)
        raise InputError("shaft", shaft, f"a shaft that turns: {moving}")
    rates = np.abs(kinematics.float_mesh_rate @ law) / unit
    parts = [
        *(
            Excitation(MESH, mesh.name, "", float(rate), harmonics)
            for mesh, rate in zip(scene.meshes, rates, strict=True)
        ),
        *(
            Excitation(SHAFT, part.name, "", abs(float(turn)) / unit, TURNS)
            for part, turn in zip(scene.shafts, turns, strict=True)
        ),
        *_of_bearings(scene, np.abs(turns) / unit),
    ]
    return tuple(part for part in parts if part.rate > SAME)


def shaft_rates(scene: Scene, kinematics: Kinematics, shaft: str) -> dict[str, float]:
    """Return the revolutions of every shaft per revolution of `shaft`, without senses, by name."""
    turns = np.abs(kinematics.float_ratio @ _law_speeds(scene))
    unit = float(turns[scene.shaft_index(shaft)])
    return {part.name: float(turn) / unit for part, turn in zip(scene.shafts, turns, strict=True)}


def _law_speeds(scene: Scene) -> FloatArray:
    """Return the speeds (k,) of all laws in proportion; trains that all start from rest, alike."""
    extreme = np.array([part.speed.extreme for part in scene.references])
    return extreme if np.any(extreme) else np.ones(extreme.size)


def _of_bearings(scene: Scene, turns: FloatArray) -> Iterator[Excitation]:
    """Yield what a flaw of each ring and of one element repeats at, the outer ring at rest, without slip."""
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
    beside = [
        Passing(each, harmonic, harmonic * each.rate, harmonic * each.rate / order - 1.0)
        for each in every
        for harmonic in range(1, each.harmonics + 1)
    ]
    return sorted(beside, key=lambda one: round(abs(one.distance) / SAME))
