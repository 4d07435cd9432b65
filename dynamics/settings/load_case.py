"""A load case of a geared system: share of the duration, speed, torque, forces and the flanks that carry."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from bounds import Declared, Kind, between, declared, described, one_of, up_to
from dynamics.checks import declared_fields, distinct, finite
from dynamics.errors import InputError

Vector = tuple[float, float, float]

_FORCE_FACTOR = Declared(
    Kind.RATIO,
    "",
    between(-1e6, 1e6),
    "Factor on the scene's force and moment, in place of values of its own",
    0.5,
)
_ONE = "Give the case's own force and moment, or a factor on the scene's."
"""Remedy of a force with both kinds of values, or with none."""
DRIVE, COAST = "drive", "coast"
_SHARE = Declared(Kind.RATIO, "", up_to(1e9), "Share of the duration, relative to the other load cases", 1.0)
_FACTOR = Declared(Kind.RATIO, "", up_to(1e6), "Factor on the scene's loads, not on its forces", 1.0)
_TORQUE = Declared(
    Kind.LOAD, "N m", up_to(1e9), "Torque on the leading shaft, in place of a factor on the loads", 100.0
)
_FASTEST = 1e7 * math.pi / 30.0  # rad/s, of 1e7 rpm
_SPEED = Declared(
    Kind.SPEED, "rad/s", up_to(_FASTEST), "Speed of the leading shaft; left out: the scene's", 150.0
)
_DIRECTION = Declared(
    Kind.CHOICE,
    "",
    one_of((DRIVE, COAST)),
    "Flanks that carry: the driving ones of the scene, or the others",
    DRIVE,
)


@described
@dataclass(frozen=True)
class CaseForce:
    """Size of the force `name` of a scene under a load case.

    Either `force` (N) and `moment` (N m) replace those of the scene, along and about the same axes; one that
    is left out is as in the scene. Or `factor` multiplies both. The scene decides the point of action, the
    course and the shaft with which the force turns.
    """

    name: str
    force: Vector | None = None
    moment: Vector | None = None
    factor: float | None = declared(None, _FORCE_FACTOR)

    def __post_init__(self) -> None:
        declared_fields(self)
        force_and_moment = {"force": self.force, "moment": self.moment}
        vectors = {name: vector for name, vector in force_and_moment.items() if vector is not None}
        for name, vector in vectors.items():
            for axis, value in zip("xyz", vector, strict=True):
                finite(f"{name}.{axis}", value)
        if vectors and self.factor is not None:
            first = min(vectors)  # "force" before "moment"
            raise InputError("factor", self.factor, f"left out if a {first} is given", _ONE)
        if not vectors and self.factor is None:
            raise InputError("force", None, "given, or a moment, or a factor", _ONE)


@described
@dataclass(frozen=True)
class LoadCase:
    """A load of a scene and the share of its duration.

    The leading shaft is that of the first drive that turns, or of the first free rotation if none does. A
    factor scales all loads of the scene at t = 0; a torque on the leading shaft gives this factor. Torques
    that depend on speed follow the speed alone. On the coast side all torques of loads and drives are
    reversed and the other flanks carry: turned end for end, the same pair driven in the other sense.

    Forces of the scene act as it states them, whatever the factor and on either side, but for those of which
    `forces` says otherwise: belt pull and weight do not follow the torque.
    """

    name: str
    share: float = declared(1.0, _SHARE)
    factor: float = declared(1.0, _FACTOR)
    torque: float | None = declared(None, _TORQUE)
    speed: float | None = declared(None, _SPEED)
    direction: str = declared(DRIVE, _DIRECTION)
    forces: tuple[CaseForce, ...] = ()

    def __post_init__(self) -> None:
        declared_fields(self)
        distinct("forces", [part.name for part in self.forces])
        if self.torque is not None and self.factor != 1.0:
            raise InputError("factor", self.factor, "left out if a torque is given", "Give one of them.")


def check_forces(cases: Iterable[LoadCase], names: Sequence[str]) -> None:
    """Refuse load cases that state a force which is not one of the scene's, by their names.

    Raises `InputError` naming the load case and its force.
    """
    for number, case in enumerate(cases):
        for index, part in enumerate(case.forces):
            if part.name not in names:
                known = ", ".join(f'"{name}"' for name in names)
                bound = f"a force of the scene: {known}" if names else "a force of the scene, which has none"
                remedy = "Add it to the scene's forces, where it acts; its values there may be 0."
                raise InputError(f"load_cases[{number}].forces[{index}].name", part.name, bound, remedy)
