"""Housings and bushings with matrices: what they can carry."""

from __future__ import annotations

import numpy as np

from dynamics.bodies import Shaft
from dynamics.checks import one_of
from dynamics.errors import InputError
from dynamics.joints import Bushing, Housing
from dynamics.joints.seat import SEAT
from dynamics.types import FloatArray

ISOTROPY = 1e-9  # relative


def check_housings(
    shafts: tuple[Shaft, ...], bushings: tuple[Bushing, ...], housings: tuple[Housing, ...]
) -> None:
    """Each bushing sits in one housing at most; what a turning frame holds is alike in all directions."""
    by_name = {bushing.name: bushing for bushing in bushings}
    frames = {shaft.name: shaft.frame for shaft in shafts}
    taken: dict[str, str] = {}
    for index, housing in enumerate(housings):
        for place, name in enumerate(housing.bushings):
            field = f"housings[{index}].bushings[{place}]"
            one_of(field, name, list(by_name))
            if name in taken:
                raise InputError(field, name, f'in one housing only; "{taken[name]}" has it')
            if frames[by_name[name].shaft] is not None:
                bound = "a bushing of a shaft described in the fixed frame"
                raise InputError(field, name, bound, "A planetary set's frame turns against the housing.")
            taken[name] = housing.name
    for index, bushing in enumerate(bushings):
        if frames[bushing.shaft] is not None:
            _check_isotropic(f"bushings[{index}]", bushing)


def _check_isotropic(field: str, bushing: Bushing) -> None:
    """Refuse a bushing seen from a turning frame unless all directions across the axis are alike."""
    for name, matrix in (("stiffness", bushing.seat_stiffness), ("damping", bushing.seat_damping)):
        if np.any(np.abs(_quarter_turned(matrix) - matrix) > ISOTROPY * np.max(np.abs(matrix), initial=0.0)):
            bound = "the same in all directions across the axis"
            raise InputError(f"{field}.{name}", bushing.name, bound, "The carrier's frame turns against it.")
    if bushing.preload is not None and any(bushing.preload[kind] != 0.0 for kind in (0, 1, 3, 4)):
        bound = "zero across the axis: the carrier's frame turns against it"
        raise InputError(f"{field}.preload", bushing.preload, bound)


def _quarter_turned(matrix: FloatArray) -> FloatArray:
    """Return the matrix of the bushing turned by a quarter about z."""
    turn = np.zeros((SEAT, SEAT))
    turn[0, 1], turn[1, 0], turn[3, 4], turn[4, 3], turn[2, 2] = -1.0, 1.0, -1.0, 1.0, 1.0
    return np.asarray(turn @ matrix @ turn.T)
