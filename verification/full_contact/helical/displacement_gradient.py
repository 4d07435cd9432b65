"""Derivatives of a displacement as sums of parts, and the moduli that any two parts contribute by."""

from __future__ import annotations

from itertools import product
from typing import NamedTuple

from fe_contact.material import Material
from verification.full_contact.over_face.extruded_stiffness import X, Y, Z


class Part(NamedTuple):
    """Term of a displacement gradient: component, plane operator, whether z differentiates, factor."""

    component: int
    plane: str
    along: bool
    factor: float


_Gradient = dict[tuple[int, int], list[Part]]


def _gradient(along: dict[int, list[Part]]) -> _Gradient:
    """Return all nine derivatives of the displacement from those along z."""
    plane = {
        (i, j): [Part(i, name, along=False, factor=1.0)]
        for i in (X, Y, Z)
        for j, name in ((X, "x"), (Y, "y"))
    }
    return plane | {(i, Z): along[i] for i in (X, Y, Z)}


def turning(twist: float) -> _Gradient:
    """Return the derivatives in the frame that turns by `twist`, rad/m."""
    along = {
        i: [Part(i, "1", along=True, factor=1.0), Part(i, "d", along=False, factor=-twist)] for i in (X, Y, Z)
    }
    along[X].append(Part(Y, "1", along=False, factor=-twist))
    along[Y].append(Part(X, "1", along=False, factor=twist))
    return _gradient(along)


def along_line() -> _Gradient:
    """Return the gradient of a field that does not vary along the contact line."""
    return _gradient({i: [Part(i, "t", along=False, factor=1.0)] for i in (X, Y, Z)})


def part_pairs(
    gradient: _Gradient, material: Material
) -> dict[tuple[int, int], list[tuple[Part, Part, float]]]:
    """Return for any two components the pairs of parts of linear elasticity with their moduli, Pa."""
    modulus, nu = material.youngs_modulus, material.poissons_ratio
    shear = modulus / (2.0 * (1.0 + nu))
    bulk = modulus * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))
    by_components: dict[tuple[int, int], list[tuple[Part, Part, float]]] = {
        (i, k): [] for i in (X, Y, Z) for k in (X, Y, Z)
    }
    for i, j, k, n in product((X, Y, Z), repeat=4):
        value = bulk * (i == j) * (k == n) + shear * ((i == k) * (j == n) + (i == n) * (j == k))
        if value:
            for one, other in product(gradient[i, j], gradient[k, n]):
                by_components[one.component, other.component].append(
                    (one, other, value * one.factor * other.factor)
                )
    return by_components
