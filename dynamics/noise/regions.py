"""Regions of a hull that face one way, and what each of them radiates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from dynamics.acoustics import Hull
from dynamics.acoustics.hull import shared_edges
from dynamics.housing_modes.reduced_housing import PointMotion
from dynamics.noise.panel_sound import PanelSound
from dynamics.types import FloatArray, IntArray

SMALL = 0.02
"""Part of the hull's area below which a region joins the neighbor with the longest common edge."""
AXES = "xyz"


@dataclass(frozen=True)
class Region:
    """Connected panels that face the same axis of the mesh rather than any other.

    Attributes
    ----------
    facing : str
        The axis, such as "+y".
    points : tuple of str
        Named points of the housing next to it.
    normal : (3,) array
        Mean outward normal, of length 1.
    center : (3,) array
        m.
    area : float
        m^2.
    power : float
        W, negative where it takes power from the others.
    """

    facing: str
    points: tuple[str, ...]
    normal: FloatArray
    center: FloatArray
    area: float
    power: float


def regions(sound: PanelSound, points: Sequence[PointMotion] = ()) -> tuple[Region, ...]:
    """Return the regions of a hull, those that radiate most first; their powers add up to the whole.

    A region below 2 % of the hull's area joins the neighbor with the longest common edge.

    Parameters
    ----------
    sound : PanelSound
    points : sequence of PointMotion
        Named points; each belongs to the region of the panel with the nearest center.
    """
    number = _region_numbers(sound.hull)
    own = {
        point.name: int(number[np.argmin(np.linalg.norm(sound.hull.centers - point.position, axis=1))])
        for point in points
    }
    made = [
        _region(sound, number == each, tuple(name for name, where in own.items() if where == each))
        for each in np.unique(number)
    ]
    return tuple(sorted(made, key=lambda region: -region.power))


def _region_numbers(hull: Hull) -> IntArray:
    """Return the region of each panel, (T,)."""
    one, other, nodes = shared_edges(hull.triangles)
    length = np.linalg.norm(hull.nodes[nodes[:, 0]] - hull.nodes[nodes[:, 1]], axis=1)
    faces = _facing(hull.normals)
    same = faces[one] == faces[other]
    joined = coo_array((np.ones(same.sum()), (one[same], other[same])), shape=(len(faces),) * 2)
    number = connected_components(joined, directed=False)[1]
    return _without_small(number.astype(int), hull.areas, one, other, length)


def _facing(normals: FloatArray) -> IntArray:
    """Return the axis that each normal is nearest to: 0, 1, 2 along x, y, z, and 3, 4, 5 against them."""
    return np.asarray(np.argmax(np.concatenate([normals, -normals], axis=1), axis=1))


def _without_small(
    number: IntArray, areas: FloatArray, one: IntArray, other: IntArray, length: FloatArray
) -> IntArray:
    """Join small regions, the smallest first, to their neighbors."""
    while True:
        area = np.bincount(number, areas)
        small = np.flatnonzero((area > 0.0) & (area < SMALL * areas.sum()))
        for region in small[np.argsort(area[small], kind="stable")]:
            near = (number[one] == region) != (number[other] == region)
            if np.any(near):
                beyond = np.where(number[one] == region, number[other], number[one])[near]
                number[number == region] = np.argmax(np.bincount(beyond, length[near]))
                break
        else:
            return number


def _region(sound: PanelSound, panels: FloatArray, points: tuple[str, ...]) -> Region:
    """Put a region together."""
    hull = sound.hull
    area, vector = hull.areas[panels], hull.area_vectors[panels].sum(axis=0)
    normal = vector / max(float(np.linalg.norm(vector)), 1e-300)
    side, axis = divmod(int(_facing(normal[None])[0]), 3)
    return Region(
        "+-"[side] + AXES[axis],
        points,
        normal,
        np.asarray(area @ hull.centers[panels] / area.sum()),
        float(area.sum()),
        float(sound.power[panels].sum()),
    )
