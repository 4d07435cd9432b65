"""Sound power of the panels and regions of a housing at one order and speed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from dynamics.acoustics import (
    Air,
    Hull,
    ModelComparison,
    PanelModel,
    RadiationModel,
    compare_models,
    outer_hull,
    panel_power,
)
from dynamics.acoustics.hull import shared_edges
from dynamics.acoustics.radiation import EquivalentRadiatedPower
from dynamics.housings.reduced_housing import PointMotion, ReducedHousing
from dynamics.noise.coarse_hull import RadiatingHull, radiating_hull
from dynamics.noise.housing_radiation import HousingRadiation
from dynamics.types import ComplexArray, FloatArray, IntArray
from dynamics.vibration import BearingHarmonics, housing_motion, seat_forces
from host.optional_modules import csgraph, sparse
from model_studies.progress import Progress, silent

SMALL = 0.02
"""Part of the hull's area below which a region joins the neighbor with the longest common edge."""
AXES = "xyz"


def models_at(
    response: BearingHarmonics,
    housing: ReducedHousing,
    bearings: Sequence[str] | None,
    at: tuple[int, int],
    models: Sequence[RadiationModel],
    progress: Progress = silent,
    offered: Sequence[RadiationModel] = (),
    cache: Path | None = None,
) -> ModelComparison:
    """Compute the sound power at one speed and order by several radiation models, on one hull in usual air.

    Raises `InputError` as `radiated_sound` does, or nothing moves.

    Parameters
    ----------
    response, housing, bearings
        Arguments of `radiated_sound`.
    at : (int, int)
        Numbers of speed and order.
    models : sequence of RadiationModel
        Radiation models from coarse to fine.
    progress, offered, cache
        Arguments of `compare_models`.
    """
    air, hertz = Air(), float(response.frequency[at])
    hull = radiating_hull(outer_hull(housing), hertz, air.sound_speed)
    velocity = hull.shapes @ _coordinate_velocity(response, housing, bearings, at)
    return compare_models(hull.hull, hertz, velocity, air, models, progress, offered, cache)


def _coordinate_velocity(
    response: BearingHarmonics,
    housing: ReducedHousing,
    bearings: Sequence[str] | None,
    at: tuple[int, int],
) -> ComplexArray:
    """Return the velocity of a housing's coordinates at one speed and order, (r,), m/s."""
    force, hertz = seat_forces(response, housing, bearings)[at], response.frequency[at]
    return np.asarray(2j * np.pi * hertz * housing_motion(housing, np.asarray(hertz), force))


@dataclass(frozen=True)
class PanelSound:
    """Sound power of the panels of a hull."""

    hull: Hull
    """Hull that the radiation model takes at this frequency."""
    power: FloatArray
    """Sound power of each panel, W; negative where a panel takes power that others radiate. The sum is the
    power of the hull. Shape (T,).
    """

    @classmethod
    def of_all(cls, sounds: Sequence[PanelSound]) -> PanelSound:
        """Return the panels of several housings as those of one hull, in their order."""
        first = np.cumsum([0, *(len(sound.hull.nodes) for sound in sounds[:-1])])
        corners = [sound.hull.triangles + start for sound, start in zip(sounds, first, strict=True)]
        hull = Hull(np.concatenate([sound.hull.nodes for sound in sounds]), np.concatenate(corners))
        return cls(hull, np.concatenate([sound.power for sound in sounds]))

    @property
    def intensity(self) -> FloatArray:
        """Return the active intensity normal to the hull, (T,), W/m^2, > 0 outwards."""
        return np.asarray(self.power / self.hull.areas)


def panel_sound(
    response: BearingHarmonics,
    housing: ReducedHousing,
    bearings: Sequence[str] | None,
    radiation: HousingRadiation,
    at: tuple[int, int],
    model: PanelModel,
    air: Air | None = None,
) -> PanelSound:
    """Return the sound power of the panels at one speed and order.

    The powers of panels are computed at the frequencies of the radiation resistance and interpolated between
    them, as the resistance is. Their sum is the power of `radiated_sound`. Where boundary elements correct
    that power, the panels share it as by the model. Raises `InputError` as `radiated_sound` does.

    Parameters
    ----------
    response, housing, bearings, radiation
        Arguments of `radiated_sound`.
    at : (int, int)
        Numbers of speed and order.
    model, air
        Model and air of the radiation.
    """
    air, outer = air or Air(), outer_hull(housing)
    velocity, hertz = _coordinate_velocity(response, housing, bearings, at), float(response.frequency[at])
    weights = radiation.weights(hertz)  # frequencies of the resistance, and their weights at this one
    resolved = [(knot, weight) for knot, weight in weights if radiation.hull_at(outer, knot, air.sound_speed)]
    resolved = resolved or list(weights)
    highest, _ = resolved[-1]
    panels = radiation.hull_at(outer, highest, air.sound_speed)
    if panels is None:  # no mesh resolves the frequency
        panels, model = RadiatingHull(outer.hull, outer.shapes), EquivalentRadiatedPower()
    power = np.zeros(len(panels.shapes))
    for knot, weight in resolved:
        panel_velocity = np.asarray(panels.shapes @ radiation.radiating(velocity, knot))
        power = power + weight * panel_power(model, panels.hull, knot, panel_velocity, air)
    total_power = float(radiation.power(np.array([hertz]), velocity[None])[0])
    scale = total_power / power.sum() if total_power > 0.0 else 1.0
    return PanelSound(panels.hull, np.asarray(power * scale))


@dataclass(frozen=True)
class Region:
    """Connected panels that face the same axis of the mesh rather than any other."""

    facing: str
    """Axis that it faces, such as "+y"."""
    points: tuple[str, ...]
    """Named points of the housing next to it."""
    normal: FloatArray
    """Mean outward normal, of length 1. Shape (3,)."""
    center: FloatArray
    """Center of the region, m. Shape (3,)."""
    area: float
    """Area of the region, m^2."""
    power: float
    """Sound power, W; negative where the region takes power from others."""


def regions(sound: PanelSound, points: Sequence[PointMotion] = ()) -> tuple[Region, ...]:
    """Return the regions of a hull by falling power; the sum of their powers is that of the hull.

    A region below `SMALL` of the hull's area joins the neighbor with the longest common edge. Each of the
    named `points` belongs to the region of the panel with the nearest center.
    """
    number = _region_numbers(sound.hull)
    region_by_point = {
        point.name: int(number[np.argmin(np.linalg.norm(sound.hull.centers - point.position, axis=1))])
        for point in points
    }
    every_region = []
    for index in np.unique(number):
        names = tuple(name for name, region in region_by_point.items() if region == index)
        every_region.append(_region(sound, number == index, names))
    return tuple(sorted(every_region, key=lambda region: -region.power))


def _region_numbers(hull: Hull) -> IntArray:
    """Return the number of the region of each panel, (T,)."""
    first, second, nodes = shared_edges(hull.triangles)
    length = np.linalg.norm(hull.nodes[nodes[:, 0]] - hull.nodes[nodes[:, 1]], axis=1)
    faces = _facing(hull.normals)
    same = faces[first] == faces[second]
    adjacent = sparse.coo_array((np.ones(same.sum()), (first[same], second[same])), shape=(len(faces),) * 2)
    number = csgraph.connected_components(adjacent, directed=False)[1]
    return _without_small(number.astype(int), hull.areas, first, second, length)


def _facing(normals: FloatArray) -> IntArray:
    """Return the axis that each normal is nearest to: 0, 1, 2 along x, y, z, and 3, 4, 5 against them."""
    return np.asarray(np.argmax(np.concatenate([normals, -normals], axis=1), axis=1))


def _without_small(
    number: IntArray, areas: FloatArray, first: IntArray, second: IntArray, length: FloatArray
) -> IntArray:
    """Join small regions, the smallest first, to their neighbors; return the new numbers of panels (T,).

    `first` and `second` (E,) are the panels on both sides of edges of a `length` (E,) in m.
    """
    while True:
        area = np.bincount(number, areas)
        small = np.flatnonzero((area > 0.0) & (area < SMALL * areas.sum()))
        for region in small[np.argsort(area[small], kind="stable")]:
            border = (number[first] == region) != (number[second] == region)
            if np.any(border):
                neighbor = np.where(number[first] == region, number[second], number[first])[border]
                number[number == region] = np.argmax(np.bincount(neighbor, length[border]))
                break
        else:
            return number


def _region(sound: PanelSound, panels: FloatArray, points: tuple[str, ...]) -> Region:
    hull = sound.hull
    area, vector = hull.areas[panels], hull.area_vectors[panels].sum(axis=0)
    normal = vector / max(float(np.linalg.norm(vector)), 1e-300)  # 0 for a region around a whole body
    side, axis = divmod(int(_facing(normal[None])[0]), 3)
    return Region(
        "+-"[side] + AXES[axis],
        points,
        normal,
        np.asarray(area @ hull.centers[panels] / area.sum()),
        float(area.sum()),
        float(sound.power[panels].sum()),
    )
