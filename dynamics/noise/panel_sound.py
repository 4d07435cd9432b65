"""Through which panels of a housing its sound leaves at one order and speed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dynamics.acoustics import Air, Hull, PanelModel, outer_hull, panel_power
from dynamics.acoustics.equivalent_radiated_power import EquivalentRadiatedPower
from dynamics.acoustics.hull import ComplexArray
from dynamics.housing_modes.reduced_housing import ReducedHousing
from dynamics.noise.coarse_hull import RadiatingHull
from dynamics.noise.housing_radiation import HousingRadiation
from dynamics.noise.model_comparison import coordinate_velocity
from dynamics.types import FloatArray
from dynamics.vibration import BearingHarmonics


@dataclass(frozen=True)
class PanelSound:
    """Sound power of the panels of a hull.

    Attributes
    ----------
    hull : Hull
        That the radiation model takes at this frequency.
    power : (T,) array
        W, negative where a panel takes power that others radiate; the sum is the power of the hull.
    """

    hull: Hull
    power: FloatArray

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

    Between the frequencies of the radiation resistance powers of panels are interpolated as it is: their sum
    is the power that `radiated_sound` has there.

    Parameters
    ----------
    response, housing, bearings, radiation
        As of `radiated_sound`.
    at : (int, int)
        Numbers of speed and order.
    model, air
        Those of the radiation.

    Raises
    ------
    InputError
        As `radiated_sound` does.
    """
    air, outer = air or Air(), outer_hull(housing)
    velocity = coordinate_velocity(response, housing, bearings, at)
    weights = radiation.weights(float(response.frequency[at]))
    panels = radiation.hull_at(outer, weights[0][0], air.sound_speed)
    if panels is None:
        panels, model = RadiatingHull(outer.hull, outer.shapes), EquivalentRadiatedPower()
    moving: ComplexArray = np.asarray(panels.shapes @ velocity)
    parts = [weight * panel_power(model, panels.hull, knot, moving, air) for knot, weight in weights]
    return PanelSound(panels.hull, np.asarray(np.sum(parts, axis=0)))


def side_by_side(sounds: Sequence[PanelSound]) -> PanelSound:
    """Return the panels of several housings as those of one hull, in their order."""
    first = np.cumsum([0, *(len(sound.hull.nodes) for sound in sounds[:-1])])
    corners = [sound.hull.triangles + start for sound, start in zip(sounds, first, strict=True)]
    hull = Hull(np.concatenate([sound.hull.nodes for sound in sounds]), np.concatenate(corners))
    return PanelSound(hull, np.concatenate([sound.power for sound in sounds]))
