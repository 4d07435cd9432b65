"""Shafts of different frames: which lie on one axis, and what may join them."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from dynamics.bearings import Bushing, PlanetBearing, RollingBearing
from dynamics.checks import finite, one_of
from dynamics.errors import InputError
from dynamics.joints import Coupling
from dynamics.scene.housing_check import alike_across
from dynamics.shafts import Shaft

AXIS_AGREEMENT = 1e-9  # of a shaft's length: shafts nearer than this share an axis


def check_frames(shafts: tuple[Shaft, ...], planet_bearings: tuple[PlanetBearing, ...]) -> None:
    """Frames are those of carriers, pins turn with the planet's own carrier."""
    by_name = {shaft.name: shaft for shaft in shafts}
    for index, shaft in enumerate(shafts):
        if shaft.frame is None:
            continue
        one_of(f"shafts[{index}].frame", shaft.frame, list(by_name))
        if by_name[shaft.frame].frame != shaft.frame:
            bound = "a carrier: a shaft described in its own frame"
            raise InputError(f"shafts[{index}].frame", shaft.frame, bound, "Let the carrier name itself.")
    for index, bearing in enumerate(planet_bearings):
        field = f"planet_bearings[{index}].carrier"
        one_of(
            field, bearing.carrier, [by_name[bearing.shaft].frame or ""], "The frame of its planet's shaft."
        )
        if bearing.carrier == bearing.shaft:
            raise InputError(field, bearing.carrier, "another shaft than the planet's")


def check_on_axis(shafts: tuple[Shaft, ...], kind: str, bearings: Sequence[Bushing | RollingBearing]) -> None:
    """Planets have no bearings to the ground; `kind` is what a scene calls these."""
    by_name = {shaft.name: shaft for shaft in shafts}
    for index, bearing in enumerate(bearings):
        shaft = by_name[bearing.shaft]
        if shaft.frame is not None and not on_axis(shaft, by_name[shaft.frame]):
            bound = "a shaft on the carrier's axis"
            raise InputError(f"{kind}[{index}].shaft", shaft.name, bound, "Planets rest on planet bearings.")


def check_gravity(shafts: tuple[Shaft, ...], gravity: tuple[float, float, float]) -> None:
    """Gravity turns against rotating frames, unless it lies along the axis."""
    for axis, value in zip("xyz", gravity, strict=True):
        finite(f"gravity.{axis}", value)
    if any(gravity[:2]) and any(shaft.frame is not None for shaft in shafts):
        bound = "zero in x and y where shafts are described in a carrier's frame, which turns against it"
        raise InputError("gravity", gravity, bound)


def check_couplings(shafts: tuple[Shaft, ...], couplings: tuple[Coupling, ...]) -> None:
    """Couplings with matrices join coaxial shafts, those across frames alike in all directions."""
    by_name = {shaft.name: shaft for shaft in shafts}
    for index, coupling in enumerate(couplings):
        first, second = by_name[coupling.first], by_name[coupling.second]
        if coupling.stiffness is None and coupling.damping is None:
            continue
        if not on_axis(first, second):
            suggestion = "Leave the matrices out: torsion alone joins any two shafts."
            raise InputError(f"couplings[{index}].second", second.name, "coaxial with the first", suggestion)
        if not crosses_frames(first, second, coupling):
            continue
        for side, shaft in (("first", first), ("second", second)):
            if shaft.frame is not None and not on_axis(shaft, by_name[shaft.frame]):
                bound = f"on the axis of its carrier {shaft.frame}, as it joins shafts of different frames"
                raise InputError(f"couplings[{index}].{side}", shaft.name, bound)
        for name, matrix in (("stiffness", coupling.stiffness), ("damping", coupling.damping)):
            if matrix is not None and not alike_across(np.asarray(matrix, dtype=float)):
                bound = "the same in all directions across the axis, without terms between these and the axis"
                suggestion = "The frames of its shafts turn against each other."
                raise InputError(f"couplings[{index}].{name}", coupling.name, bound, suggestion)


def crosses_frames(first: Shaft, second: Shaft, coupling: Coupling) -> bool:
    """Whether a coupling has matrices and joins shafts of different frames."""
    return first.frame != second.frame and (coupling.stiffness is not None or coupling.damping is not None)


def on_axis(shaft: Shaft, carrier: Shaft) -> bool:
    """Whether `shaft` lies on the axis of `carrier`."""
    apart = math.dist(shaft.origin[:2], carrier.origin[:2])
    return apart <= AXIS_AGREEMENT * max(shaft.length, carrier.length)
