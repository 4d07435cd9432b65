"""Panels and regions of the housings through which the sound leaves at the loudest points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from dynamics.acoustics import PanelModel
from dynamics.housing_modes import ReducedHousing
from dynamics.noise import (
    HousingRadiation,
    PanelSound,
    RadiatedSound,
    Region,
    loudest,
    panel_sound,
    regions,
    side_by_side,
)
from dynamics.vibration import BearingHarmonics

Json = dict[str, Any]


@dataclass(frozen=True)
class SoundingHousing:
    """A housing that radiates: its name, its reduction, the bearings in its seats, its radiation."""

    name: str
    body: ReducedHousing
    bearings: tuple[str, ...]
    radiation: HousingRadiation


def with_regions(
    sound: RadiatedSound, response: BearingHarmonics, housings: Sequence[SoundingHousing], model: PanelModel
) -> RadiatedSound:
    """Return a sound with the panels of its loudest point, and the fact `regions` of all of `loudest`."""
    told: list[list[Json]] = []
    for point in loudest(sound):
        at = point.speed_index, point.order_index
        panels = [_panels(response, housing, at, model) for housing in housings]
        if not told:
            sound = _with_panels(sound, side_by_side(panels))
        rows = [
            _region(housing.name, region, float(sound.power[at]))
            for housing, own in zip(housings, panels, strict=True)
            for region in regions(own, housing.body.points)
        ]
        told.append(sorted(rows, key=lambda row: -row["power"]))
    return replace(sound, facts={**sound.facts, "regions": told})


def _panels(
    response: BearingHarmonics, housing: SoundingHousing, at: tuple[int, int], model: PanelModel
) -> PanelSound:
    """Return the power of the panels of a housing."""
    return panel_sound(response, housing.body, housing.bearings, housing.radiation, at, model)


def _with_panels(sound: RadiatedSound, panels: PanelSound) -> RadiatedSound:
    """Return a sound with the panels of its loudest point."""
    hull = panels.hull
    return replace(sound, panel_node=hull.nodes, panel_corner=hull.triangles, panel_power=panels.power)


def _region(housing: str, region: Region, whole: float) -> Json:
    """Return a region as plain JSON, SI, with its share of the power of the point."""
    plain = {name: np.asarray(getattr(region, name)).tolist() for name in ("normal", "center")}
    own = {"facing": region.facing, "points": list(region.points), "area": region.area, "power": region.power}
    return {"housing": housing, **own, **plain, "share": region.power / whole}
