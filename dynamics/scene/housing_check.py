"""Housings and bushings with matrices: what they can carry, and where."""

from __future__ import annotations

import numpy as np

from bounds import Quantity, Text
from dynamics.bearings import Bushing
from dynamics.bearings.matrix import least_share
from dynamics.bearings.seat import SEAT
from dynamics.checks import one_of
from dynamics.errors import InputError
from dynamics.joints import Housing
from dynamics.joints.housing import DEFINITE
from dynamics.shafts import Shaft
from dynamics.types import FloatArray

ISOTROPY = 1e-9  # relative
SEAT_AGREEMENT = 1e-3  # m; a bearing acts at its middle, which need not be that of its bore
IRRATIONAL = 1.0  # rad; what this turn leaves alone any turn does


def check_housings(
    shafts: tuple[Shaft, ...],
    bushings: tuple[Bushing, ...],
    housings: tuple[Housing, ...],
    lawful: frozenset[str],
) -> None:
    """Each bushing sits in one housing at most; what a rotating frame holds is alike in all directions.

    A housing under a bearing that is not linear, of those named in `lawful`, is held in all directions.
    """
    by_name = {bushing.name: bushing for bushing in bushings}
    frames = {shaft.name: shaft.frame for shaft in shafts}
    taken: dict[str, str] = {}
    for index, housing in enumerate(housings):
        for position, name in enumerate(housing.bushings):
            field = f"housings[{index}].bushings[{position}]"
            one_of(field, name, list(by_name))
            if name in taken:
                raise InputError(field, name, f'in one housing only; "{taken[name]}" has it')
            if frames[by_name[name].shaft] is not None:
                bound = "a bushing of a shaft described in the fixed frame"
                raise InputError(field, name, bound, "A planetary set's frame turns against the housing.")
            taken[name] = housing.name
        _check_positions(index, housing, shafts, by_name)
        if not lawful.isdisjoint(housing.bushings) and least_share(housing.matrices()[0]) <= DEFINITE:
            bound = "positive definite under bearings that are not linear"
            advice = "Hold the housing at its feet, or on mounts, in every direction that has a row."
            raise InputError(f"housings[{index}].stiffness", housing.name, bound, advice)
    for index, bushing in enumerate(bushings):
        if frames[bushing.shaft] is not None:
            _check_isotropic(f"bushings[{index}]", bushing)


def _check_positions(
    index: int, housing: Housing, shafts: tuple[Shaft, ...], bushings: dict[str, Bushing]
) -> None:
    """Refuse a seat of a housing that is not where its bearing is."""
    origins = {shaft.name: shaft.origin for shaft in shafts}
    for seat, (name, at) in enumerate(zip(housing.bushings, housing.seat_positions or (), strict=False)):
        bearing = bushings[name]
        expected = np.add(origins[bearing.shaft], (0.0, 0.0, bearing.position))
        off = np.subtract(at, expected)
        if float(np.max(np.abs(off))) > SEAT_AGREEMENT:
            x, y, z = (Quantity(float(value), "m", digits=3) for value in off)
            limit = Quantity(SEAT_AGREEMENT, "m")
            bound = Text.of("within ", limit, f' of "{name}"; it is off by ', x, ", ", y, ", ", z)
            advice = "Move and turn the mesh so that it stands as the scene does, z along the shafts."
            raise InputError(f"housings[{index}].seat_positions[{seat}]", at, bound, advice)


def _check_isotropic(field: str, bushing: Bushing) -> None:
    """Refuse a bushing seen from a rotating frame unless all directions across the axis are alike."""
    for name, matrix in (("stiffness", bushing.seat_stiffness), ("damping", bushing.seat_damping)):
        if not alike_across(matrix):
            bound = "the same in all directions across the axis"
            raise InputError(f"{field}.{name}", bushing.name, bound, "The carrier's frame turns against it.")
    preload = np.zeros(SEAT) if bushing.preload is None else np.abs(bushing.preload)
    if np.any(preload[[0, 1, 3, 4]] > ISOTROPY * np.max(preload)):
        bound = "zero across the axis: the carrier's frame turns against it"
        raise InputError(f"{field}.preload", bushing.preload, bound)


def alike_across(matrix: FloatArray) -> bool:
    """Whether a matrix in x, y, z, tilt_x, tilt_y (and rotation) is the same turned by any angle about z."""
    turn = np.eye(matrix.shape[0])
    c, s = np.cos(IRRATIONAL), np.sin(IRRATIONAL)
    turn[:2, :2] = turn[3:5, 3:5] = [[c, -s], [s, c]]
    off = np.abs(turn @ matrix @ turn.T - matrix)
    return bool(np.all(off <= ISOTROPY * np.max(np.abs(matrix), initial=0.0)))
