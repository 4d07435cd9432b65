"""Weak gap of one tooth pair over the face: the gaps of its sections, against hats along the face."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fe_contact.types import FloatArray
from verification.full_contact.condensation.linearized_contact import rotation, turned_back
from verification.full_contact.condensation.weak_gap import WeakGap
from verification.full_contact.over_face.layers import Layers

Section = Callable[[float], tuple[WeakGap, float]]
"""The weak gap at a face position from mid-face, m, and the angle by which gear 2 is turned there, rad."""


@dataclass(frozen=True)
class FaceGap:
    """Weak gap of one pair; h = i j hats, i along the profile times j = 2 p - 1 over the face."""

    gap: FloatArray
    weight: FloatArray
    """`gap`, `weight`: Weak gaps without pressure or lag, m^3, and weights of the hats, m^2. Shape (h,) each.
    """
    closing: FloatArray
    """-dG by the lag of the driven gear, m^2. Shape (h,)."""
    forces: tuple[FloatArray, FloatArray]
    """Forces on the functions of both gears' strips by unit pressures, m^2, in the half of positive and of
    negative face position, each as seen from mid-face. They are in the frames of the meshes. ((2, 2 k_1 f,
    h), (2, 2 k_2 f, h)) arrays.
    """


def face_gap(section: Section, layers: Layers) -> FaceGap:
    """Integrate the sections over the face, three in each layer of either half."""
    z, weights = layers.quadrature
    hats, functions = layers.hats(z), layers.functions(z)
    planes = len(layers.planes)
    scalars, forces = [], []
    for side in (1, -1):
        sections = [section(side * position) for position in z.tolist()]
        over = np.zeros((len(z), 2 * planes - 1))
        over[:, planes - 1 :] = hats
        over = over if side > 0 else over[:, ::-1]
        weighted = weights[:, None] * over
        gaps = [np.stack([gap.gap, gap.weight, gap.closing]) for gap, _ in sections]
        scalars.append(np.einsum("qsi,qj->sij", np.array(gaps), weighted))
        products = (functions[:, :, None] * weighted[:, None]).reshape(len(z), -1)
        first = np.array([gap.forces[0] for gap, _ in sections])
        second = np.array([turned_back(gap.forces[1], rotation(turn)) for gap, turn in sections])
        forces.append([_over_functions(of_gear, products, functions.shape[1]) for of_gear in (first, second)])
    gap, weight, closing = (scalars[0] + scalars[1]).reshape(3, -1)
    on_first, on_second = (np.stack(pair) for pair in zip(*forces, strict=True))
    return FaceGap(gap, weight, closing, (on_first, on_second))


def _over_functions(sections: FloatArray, products: FloatArray, functions: int) -> FloatArray:
    """Return forces (2 k f, i j) from those of sections (q, 2 k, i) and products of f and hats (q, f j)."""
    points, rows, hats = sections.shape
    total = (sections.reshape(points, -1).T @ products).reshape(rows, hats, functions, -1)
    return np.asarray(total.transpose(0, 2, 1, 3).reshape(rows * functions, -1))
