"""Through which panels of a housing its sound leaves at one order and speed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from dynamics.acoustics import (
    Air,
    Hull,
    ModelLadder,
    PanelModel,
    RadiationModel,
    compare_models,
    outer_hull,
    panel_power,
)
from dynamics.acoustics.equivalent_radiated_power import EquivalentRadiatedPower
from dynamics.acoustics.hull import ComplexArray
from dynamics.housing_modes.reduced_housing import ReducedHousing
from dynamics.noise.coarse_hull import RadiatingHull, radiating_hull
from dynamics.noise.housing_radiation import HousingRadiation
from dynamics.types import FloatArray
from dynamics.vibration import BearingHarmonics, housing_motion, seat_forces
from model_studies.progress import Progress, silent

# Radiation models side by side at one order and speed.


def models_at(
    response: BearingHarmonics,
    housing: ReducedHousing,
    bearings: Sequence[str] | None,
    at: tuple[int, int],
    models: Sequence[RadiationModel],
    progress: Progress = silent,
    offered: Sequence[RadiationModel] = (),
    cache: Path | None = None,
) -> ModelLadder:
    """Compute the sound power at one speed and order by several radiation models, on one hull in usual air.

    Parameters
    ----------
    response, housing, bearings
        As of `radiated_sound`.
    at : (int, int)
        Numbers of speed and order.
    models : sequence of RadiationModel
        From coarse to fine.
    progress, offered, cache
        As of `compare_models`.

    Raises
    ------
    InputError
        As `radiated_sound` does, or nothing moves.
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
    velocity = _coordinate_velocity(response, housing, bearings, at)
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
